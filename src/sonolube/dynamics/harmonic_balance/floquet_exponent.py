"""Whether a periodic vibration is stable: how small disturbances of it grow from period to period."""

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Complexes, Floats, Integers
from sonolube.dynamics.gap_law import GapLaw
from sonolube.dynamics.harmonic_balance.contact_kernel import equilibrium_displacement, law_of
from sonolube.dynamics.harmonic_balance.floquet_kernel import SQUARINGS, growth_rates, period_room
from sonolube.dynamics.harmonic_balance.receptance import ContactPort
from sonolube.dynamics.kernels.simd import LANES

GROWTH = 1e-6  # per period, beyond what rounding may feign
_KICKS = 8  # a radian of the structure's fastest mode
_MOST_KICKS = 2**22  # a period, which take seconds


def too_slow(port: ContactPort, omega: Floats) -> NDArray[np.bool_]:
    """Return at which angular frequencies, in rad/s, a period holds too many swings of the fastest mode to judge."""
    return np.asarray(_KICKS * _fastest(port) > _MOST_KICKS * omega)


def growth(
    port: ContactPort,
    gap_law: GapLaw,
    omega: Floats,
    load: Floats,
    mean: Floats,
    harmonics: Complexes,
    count: Integers,
    samples: Integers,
) -> Floats:
    """Return the logarithm of the largest modulus of the multipliers, at least as many kicks a period as samples."""
    compiled, law = law_of(gap_law)
    needed = np.where(too_slow(port, omega), 0.0, np.ceil(_KICKS * _fastest(port) / omega))
    kicks = np.maximum(samples, needed.astype(np.int64))
    chosen = np.lexsort((count, kicks))
    first = np.arange(0, chosen.size, LANES)  # of each block of lanes, which all take as many kicks
    kicks[chosen] = np.repeat(np.maximum.reduceat(kicks[chosen], first), LANES)[: chosen.size]
    given = np.stack([omega, load, equilibrium_displacement(gap_law, load), mean], axis=1)
    free = _free_motion(port, 2 * np.pi / (kicks * omega))
    room, (powers, norms) = period_room(2 * port.trace.size, int(count.max(initial=0))), np.empty((2, omega.size))
    pairs = _pair_columns(port)
    parts = np.ascontiguousarray(harmonics).view(np.float64)
    growth_rates(*compiled, law, pairs, given, free, parts, count, kicks, chosen, room, powers, norms)
    # log |M^(2n)| - log |M^n| is n times the rate wanted, whatever the eigenvectors; the latter's norm is within a
    # factor of two of the power of two taken out
    return np.asarray((powers * np.log(2.0) + 0.5 * np.log(norms)) / 2.0 ** (SQUARINGS - 1))


def _fastest(port: ContactPort) -> float:
    return float(np.sqrt(np.abs(port.determinant).max()))


def _pair_columns(port: ContactPort) -> Floats:
    """Return PUSH, SEE and MOVE of every pair, shape (m, 6)."""
    return np.hstack([port.push, port.displacement, port.velocity])


def _free_motion(port: ContactPort, duration: Floats) -> Floats:
    """Return exp(A duration) of every pair, shape (p, 4 m), row by row.

    A is half its trace plus a part whose square is a number.
    """
    half = 0.5 * port.trace[:, np.newaxis]
    square = half * half - port.determinant[:, np.newaxis]
    angle = np.sqrt(np.abs(square)) * duration
    fading, growing = np.exp(half * duration), square > 0
    # where it does not swing, the slower and the faster exponential, neither of which overflows
    exponent = np.where(growing, angle, 0.0)
    slow, fast = np.exp(half * duration + exponent), np.exp(half * duration - exponent)
    even = np.where(growing, 0.5 * (slow + fast), fading * np.cos(angle))
    odd = np.where(growing, 0.5 * (slow - fast), fading * np.sin(angle))
    odd = np.where(angle > 1e-9, odd / np.maximum(angle, 1e-9), fading) * duration
    own = port.generator - half[:, :, np.newaxis] * np.eye(2)
    moved = even.T[:, :, np.newaxis, np.newaxis] * np.eye(2) + np.einsum("mij,mp->pmij", own, odd)
    return np.asarray(moved.reshape(duration.size, 4 * port.trace.size))
