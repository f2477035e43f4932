"""The steady state with a single harmonic: where the search for the full one starts."""

from typing import NamedTuple

import numpy as np
from scipy.special import wrightomega

from sonolube.checks import Complexes, Floats, Integers
from sonolube.dynamics.gap_law import ExponentialGap, GapLaw, TabulatedGap, length_of_change
from sonolube.dynamics.harmonic_balance.bessel import bessel_logarithm, bessel_ratio
from sonolube.dynamics.harmonic_balance.harmonic_kernel import Resolution
from sonolube.dynamics.harmonic_balance.receptance import ContactPort, receptance
from sonolube.dynamics.harmonic_balance.truncation import orders_of_a_sine, plain_orders

WEAK = 0.2  # contact stiffness times receptance up to which substitution finds the only solution
_ABSCISSAE = np.cos(np.pi * (np.arange(64) + 0.5) / 64)  # of the mean over a period of what depends on cos theta
_FEWER_ABSCISSAE = np.cos(np.pi * (np.arange(24) + 0.5) / 24)  # for a force without corners
_GRID, _AT_ONCE = 32, 4096  # steps of amplitude, and how many of all points to take at once
_SMALL, _NOTHING = 1e-3, 1e-30  # of a length; m, which keeps an amplitude of zero from dividing
_CLOSE = 1e-6
_LONG = 1e3  # m, in place of an infinite length


class FirstGuess(NamedTuple):
    """The steady states of points with one harmonic, one entry of each array to a point."""

    mean: Floats  # (p,) m
    harmonic: Complexes  # (p,) m
    lowest: Floats  # (p,) m: amplitudes that balance
    highest: Floats
    resolution: Resolution


class _Sines(NamedTuple):
    """Sinusoidal motions to balance."""

    gap_law: GapLaw
    static_stiffness: float
    load: Floats  # (p,)
    static_displacement: Floats
    length: Floats  # over which the contact changes
    receptance: Complexes
    free: Floats  # amplitude without contact

    def among(self, chosen: Integers) -> "_Sines":
        return self._replace(**{name: getattr(self, name)[chosen] for name in self._fields[2:]})


def first_guess(
    port: ContactPort,
    gap_law: GapLaw,
    omega: Floats,
    load: Floats,
    static_displacement: Floats,
    free: Complexes,
    *,
    tolerance: float,
    highest: bool,
) -> FirstGuess:
    """Return each point's solutions with one harmonic, and how finely to look for the full one.

    Parameters
    ----------
    port : ContactPort
    gap_law : GapLaw
    omega, load, static_displacement : ndarray, shape (p,)
        Angular frequency, in rad/s, dead load, in N, and mean displacement without contact, in m.
    free : ndarray of complex, shape (p, K)
        Harmonics of the displacement without contact, in m.
    tolerance : float
        Harmonics to leave out, relative to the amplitude.
    highest : bool
        Whether mean and harmonic are those of the highest solution rather than the lowest.

    Returns
    -------
    FirstGuess
    """
    length, own = np.minimum(length_of_change(gap_law, load), _LONG), free[:, 0]
    answer = receptance(port, 0, omega)
    sines = _Sines(gap_law, port.static_stiffness, load, static_displacement, length, answer, np.abs(own))
    lower, upper = _balanced_amplitudes(sines)
    mean, force = _balanced_mean(sines, upper if highest else lower)
    amplitude = upper if highest else lower
    harmonic = own * amplitude / (amplitude + answer * force + _NOTHING)
    smooth = isinstance(gap_law, ExponentialGap | TabulatedGap)
    if smooth and free.shape[1] == 1:
        parallel = isinstance(gap_law, ExponentialGap) and gap_law.force_damping == 0.0
        resolution = orders_of_a_sine(port, omega, load, length, upper, tolerance, parallel)
    else:
        resolution = plain_orders(omega.size, free.shape[1])
    return FirstGuess(mean, harmonic, lower, upper, resolution)


def _balanced_amplitudes(sines: _Sines) -> tuple[Floats, Floats]:
    """Return the lowest and the highest amplitude a with abs(a + receptance force(a)) = free amplitude."""
    if isinstance(sines.gap_law, ExponentialGap) and sines.static_stiffness == 0.0:
        strength = np.abs(sines.receptance) * sines.load / sines.length
    else:
        tiny = _SMALL * sines.length
        steepest = np.maximum(_opposing(sines, tiny) / tiny, _opposing(sines, sines.free) / (sines.free + _NOTHING))
        strength = np.abs(sines.receptance) * steepest
    amplitude = sines.free.copy()
    for _ in range(2):
        share = _opposing(sines, amplitude) / (amplitude + _NOTHING)
        amplitude = sines.free / np.abs(1 + share * sines.receptance)
    lowest, highest = amplitude, amplitude
    strong = np.flatnonzero((strength >= WEAK) & (sines.free > 0))
    if strong.size:
        highest = amplitude.copy()
        lowest[strong], highest[strong] = _strongly_balanced(sines.among(strong))
    return lowest, highest


def _strongly_balanced(sines: _Sines) -> tuple[Floats, Floats]:
    """Return the lowest and the highest of possibly several amplitudes, looked for on a grid."""

    def excess(amplitude: Floats, own: _Sines = sines) -> Floats:
        return np.asarray(np.abs(amplitude + own.receptance * _opposing(own, amplitude)) - own.free)

    spread = np.arcsinh(_beyond(sines) / sines.length)
    edges = sines.length * np.sinh(np.multiply.outer(np.arange(_GRID + 1) / _GRID, spread))
    heights = np.empty_like(edges)
    heights[0] = -sines.free
    together = max(_AT_ONCE // sines.free.size, 1)
    for start in range(1, _GRID + 1, together):
        some = edges[start : start + together]
        own = sines.among(np.tile(np.arange(sines.free.size), len(some)))
        heights[start : start + together] = excess(some.reshape(-1), own).reshape(some.shape)
    rising = (heights[:-1] < 0) & (heights[1:] >= 0)
    first, last = rising.argmax(axis=0), _GRID - 1 - rising[::-1].argmax(axis=0)
    answers: list[Floats] = []
    for cell in (first, last):
        if answers and np.array_equal(first, last):
            break
        points = np.arange(cell.size)
        ends = (edges[cell, points], heights[cell, points], edges[cell + 1, points], heights[cell + 1, points])
        root = _root(excess, *ends, close=1e-4 * sines.free)
        answers.append(np.where(rising.any(axis=0), root, sines.free))
    return answers[0], answers[-1]


def _beyond(sines: _Sines) -> Floats:
    """Return amplitudes that no solution exceeds."""
    largest = 1.1 * sines.free + _SMALL * sines.length
    for _ in range(60):
        force = _opposing(sines, largest)
        above = np.abs(largest + sines.receptance * force) > sines.free
        short = ~(above & (largest > np.abs(sines.receptance) * force))
        if not short.any():
            break
        largest[short] *= 1.5
    return largest


def _root(excess, lower: Floats, short: Floats, upper: Floats, over: Floats, *, close: Floats) -> Floats:  # type: ignore[no-untyped-def]
    """Return where what is short at the lower end and over at the upper one vanishes (false position, Illinois)."""
    middle, above = upper, np.zeros(upper.size, dtype=bool)
    for _ in range(12):
        middle = (lower * over - upper * short) / np.maximum(over - short, _NOTHING)
        value = excess(middle)
        high = value > 0
        halved_short, halved_over = np.where(above, 0.5, 1.0) * short, np.where(above, 1.0, 0.5) * over
        lower, short = np.where(high, lower, middle), np.where(high, halved_short, value)
        upper, over = np.where(high, middle, upper), np.where(high, value, halved_over)
        above = high
        if np.all(np.abs(value) < close):
            break
    return middle


def _opposing(sines: _Sines, amplitude: Floats) -> Floats:
    """Return the amplitude of the contact force that opposes a sinusoidal motion about the mean that balances."""
    return _balanced_mean(sines, amplitude)[1]


def _balanced_mean(sines: _Sines, amplitude: Floats) -> tuple[Floats, Floats]:
    """Return the mean that balances a sinusoidal motion, and the amplitude of the contact force opposing it."""
    if isinstance(sines.gap_law, ExponentialGap):
        beta = amplitude / sines.length
        mean, force = sines.length * bessel_logarithm(beta), sines.load
        if sines.static_stiffness > 0.0:
            mean, force = _held_mean(sines, mean)
        return mean, 2 * force * bessel_ratio(beta)
    return _searched_mean(sines, amplitude)


def _held_mean(sines: _Sines, floating: Floats) -> tuple[Floats, Floats]:
    """Return mean and mean force of an exponential contact on a structure that holds it, by where it would float.

    The force F_N exp((floating - mean)/l) is that of a spring beyond the place where the spring bears the load alone,
    which is Wright's omega function.
    """
    spring = sines.static_stiffness * sines.length
    unloaded = sines.static_displacement - sines.load / sines.static_stiffness
    stretch = wrightomega(np.log(sines.load / spring) + (floating - unloaded) / sines.length)
    return unloaded + sines.length * stretch, spring * stretch


def _searched_mean(sines: _Sines, amplitude: Floats) -> tuple[Floats, Floats]:
    """Return what `_balanced_mean` does, by Newton's method in a bracket."""
    floating = sines.static_stiffness == 0.0
    lower = np.zeros_like(amplitude) if floating else np.minimum(sines.static_displacement, 0.0)
    upper = amplitude.copy() if floating else np.maximum(sines.static_displacement, amplitude)
    mean, opposing = lower.copy(), np.zeros_like(amplitude)
    left, own = np.arange(mean.size), sines
    for _ in range(60):
        with np.errstate(over="ignore"):
            force, opposing[left], slope = _force_moments(own, mean[left], amplitude[left])
        excess = own.static_stiffness * (mean[left] - own.static_displacement) - (force - own.load)
        short = excess < 0
        lower[left[short]], upper[left[~short]] = mean[left[short]], mean[left[~short]]
        with np.errstate(divide="ignore", invalid="ignore"):
            step = excess / (own.static_stiffness + slope)
            if floating and isinstance(sines.gap_law, TabulatedGap):
                step = np.log(own.load / force) * force / slope  # in the logarithm the force is nearly straight
            step[np.isinf(slope)] = np.nan  # which halves the bracket
        after = mean[left] - step
        inside = (lower[left] <= after) & (after <= upper[left])
        mean[left] = np.where(inside, after, 0.5 * (lower[left] + upper[left]))
        left = left[~(np.abs(step) < _CLOSE * (amplitude[left] + _SMALL * own.length))]
        if not left.size:
            break
        own = sines.among(left)
    return mean, opposing


def _force_moments(sines: _Sines, mean: Floats, amplitude: Floats) -> tuple[Floats, Floats, Floats]:
    """Return the mean force, its harmonic against a motion amplitude * cos theta, and the mean stiffness."""
    cosines = _FEWER_ABSCISSAE if isinstance(sines.gap_law, TabulatedGap) else _ABSCISSAE
    x, load = mean[:, np.newaxis] + np.multiply.outer(amplitude, cosines), sines.load[:, np.newaxis]
    force, slope = sines.gap_law.force(x, load), sines.gap_law.stiffness(x, load)
    return force.mean(axis=1), -2 * (force @ cosines) / cosines.size, slope.mean(axis=1)
