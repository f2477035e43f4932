"""How finely a steady state must be resolved, from the motion with a single harmonic."""

from functools import lru_cache

import numpy as np

from sonolube.checks import Floats, Integers
from sonolube.dynamics.harmonic_balance.harmonic_kernel import Resolution
from sonolube.dynamics.harmonic_balance.receptance import ContactPort

_MOST = 64
_PART = 0.02  # ratio of neighbouring frequencies, less one, at which receptances are bounded
_COUPLING = 0.02  # force per change of the contact from which harmonics belong into Newton's matrix


def orders_of_a_sine(
    port: ContactPort, omega: Floats, load: Floats, change: Floats, amplitude: Floats, tolerance: float, parallel: bool
) -> Resolution:
    """Return the resolution of points whose force is, or is nearly, exponential, driven by a sine.

    Parameters
    ----------
    port : ContactPort
    omega, load, change, amplitude : ndarray, shape (p,)
        Angular frequency, in rad/s, dead load, in N, length over which the contact changes, and amplitude, in m.
    tolerance : float
        Harmonics to leave out, relative to the amplitude.
    parallel : bool
        Whether the stiffness goes with the force, whose harmonics then fall the faster the higher they are.

    Returns
    -------
    Resolution

    Notes
    -----
    Harmonic k of the force of a sine is 2 F_N I_k/I_0, with I_k/I_(k-1) about beta/(k - 1/2 + sqrt((k + 1/2)^2 +
    beta^2)), a little too much [1]_. Bounding receptances by the highest at any higher frequency lets each criterion
    fall with the order, so that orders are counted.

    References
    ----------
    .. [1] D. E. Amos, Math. Comp. 28, 239 (1974). doi:10.1090/S0025-5718-1974-0333287-7
    """
    beta = amplitude / change
    order = np.searchsorted(_steepness(tolerance), beta)
    bound = _receptance_bound(port, omega.min(), _MOST * omega.max())
    place = np.log(omega / omega.min()) / np.log1p(_PART)
    felt, coupling = 0.25 * tolerance * amplitude / load, 0.5 * _COUPLING * change / load
    share, least = np.ones_like(beta), np.minimum(felt, coupling)
    harmonics, coupled = np.zeros((2, beta.size), dtype=np.uint8)
    for k in range(1, int(order.max()) + 1):
        share *= _step(beta, k)
        answer = share * bound[(place + np.log(k) / np.log1p(_PART)).astype(np.int32)]
        if not np.any(answer > least):
            break
        harmonics += (answer > felt).view(np.uint8)
        coupled += (answer > coupling).view(np.uint8)
    first = np.clip(coupled.astype(np.int64), 1, np.maximum(order, 1))
    whole = np.maximum(np.minimum(harmonics.astype(np.int64), order), np.maximum(first, 2))
    needed = order + whole + 6 if parallel else 2 * (order + 3)
    return Resolution(whole, first, np.maximum(4 * whole, 2 * (needed // 2)))


@lru_cache(maxsize=64)
def _steepness(tolerance: float) -> Floats:
    """Return the amplitudes over the length of change at which harmonics 1, 2, ... of the force exceed a share."""
    beta = np.geomspace(1e-7, 1e4, 2000)
    shares = np.cumprod([_step(beta, k) for k in range(1, _MOST)], axis=0)
    return np.asarray(beta[np.argmax(shares >= tolerance, axis=1)])


def _step(beta: Floats, order: int) -> Floats:
    return np.asarray(beta / (order - 0.5 + np.sqrt((order + 0.5) ** 2 + np.square(beta))))


def plain_orders(points: int, given: int) -> Resolution:
    """Return the resolution to begin with where nothing better is known.

    Parameters
    ----------
    points, given : int
        Numbers of points and of harmonics of their drive.

    Returns
    -------
    Resolution
    """
    harmonics = max(8, given)

    def alike(value: int) -> Integers:
        return np.full(points, value, dtype=np.int64)

    return Resolution(alike(harmonics), alike(min(harmonics, 8)), alike(max(64, 4 * harmonics)))


def _receptance_bound(port: ContactPort, lowest: float, highest: float) -> Floats:
    """Return what the contact's receptance stays below from each of a row of angular frequencies on."""
    count = int(np.log(highest / lowest) / np.log1p(_PART)) + 2
    w = lowest * np.exp(np.log1p(_PART) * np.arange(count + 1))[:, np.newaxis]
    above = np.abs(port.constant[0]) + np.abs(port.slope[0]) * w[1:]
    detuned = port.determinant - np.square(w)
    nearest = np.minimum(np.abs(detuned[:-1]), np.abs(detuned[1:]))
    nearest[detuned[:-1] * detuned[1:] < 0] = 0.0
    below = np.sqrt(np.square(nearest) + np.square(port.trace * w[:-1]))
    within = np.sum(above / np.maximum(below, np.finfo(np.float64).tiny), axis=1)
    return np.asarray(np.maximum.accumulate(within[::-1])[::-1])
