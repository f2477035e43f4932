"""What a periodic motion does at the contact: its turning points, its forces and how long the contact is lost."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Complexes, Floats, Integers
from sonolube.dynamics.gap_law import LOST, GapLaw

_PLAIN = 0.7  # share of the higher harmonics' accelerations up to which a motion surely turns only twice
_CLEAR = 0.99  # level over amplitude at which to begin looking for its passage at most
_SLOW = 0.05  # share of the peak velocity below which a minimum of the speed is nearly a turn
_SCAN, _FEWEST = 16, 256  # samples per harmonic to find the turns of any other motion, and at least
_SAMPLES = 2**18  # at once
_NEWTON, _PASSES = 20, 5  # steps


class Measures(NamedTuple):
    """Measures of the motion, one entry of each array to a point."""

    amplitude: Floats  # (p,) m, half of peak to peak
    turns: Floats  # (p, 2): phases of the upper and the lower turn; NaN where there are more
    lowest_displacement: Floats  # (p,) m
    force: Floats  # (p, 2) N: highest and lowest
    lost: Floats  # (p,) share of the period


class _Motions(NamedTuple):
    """Motions x = mean + Re sum X_k z^k at z = exp(i theta)."""

    omega: Floats  # (p,) rad/s
    load: Floats  # (p,) N
    mean: Floats  # (p,) m
    harmonics: Complexes  # (H, p) m, X_1 first

    def among(self, chosen: NDArray[np.intp]) -> "_Motions":
        return _Motions(self.omega[chosen], self.load[chosen], self.mean[chosen], self.harmonics[:, chosen])


def measure(
    gap_law: GapLaw, omega: Floats, load: Floats, mean: Floats, harmonics: Complexes, count: Integers
) -> Measures:
    """Measure every motion.

    Parameters
    ----------
    gap_law : GapLaw
    omega, load, mean : ndarray, shape (p,)
        Angular frequency, in rad/s, dead load, in N, and mean displacement, in m.
    harmonics : ndarray of complex, shape (p, room)
    count : ndarray of int, shape (p,)
        Harmonics of each motion.

    Returns
    -------
    Measures
    """
    most = int(count.max(initial=1))
    rows = np.ascontiguousarray(harmonics[:, :most].T)
    rows[np.arange(1, most + 1)[:, np.newaxis] > count] = 0.0
    motions = _Motions(omega, load, mean, rows)
    size = np.abs(rows[0])
    plain = _acceleration(rows[1:], first=2) < _PLAIN * size
    measures = Measures(
        *(np.full(shape, np.nan) for shape in (omega.size, (omega.size, 2), omega.size, (omega.size, 2), omega.size))
    )
    above = np.conj(rows[0]) / (size + 1e-300)  # where the first harmonic turns
    below = -above
    for own in _in_parts(np.flatnonzero(~plain), most):
        above[own], below[own] = _two_turns(motions.among(own))
    twice = ~np.isnan(above)
    _measure_two_turns(gap_law, motions, above, below, twice, measures)
    for own in _in_parts(np.flatnonzero(~twice | (gap_law.force_damping > 0.0)), most):
        _scan(gap_law, motions.among(own), own, twice[own], measures)
    return measures


def _in_parts(points: NDArray[np.intp], harmonics: int) -> Iterator[NDArray[np.intp]]:
    """Yield points a few at a time, so that their samples do not fill the memory."""
    step = max(_SAMPLES // max(_SCAN * harmonics, _FEWEST), 1)
    for start in range(0, points.size, step):
        yield points[start : start + step]


def _acceleration(rows: Complexes, *, first: int) -> Floats:
    total = np.zeros(rows.shape[1])
    for k, row in enumerate(rows, start=first):
        total += k * k * (np.abs(row.real) + np.abs(row.imag))
    return total


def _swing(harmonics: Complexes, z: Complexes) -> tuple[Floats, Floats, Floats]:
    """Return displacement about the mean and its first two derivatives by phase (Horner's scheme)."""
    value = harmonics[-1].copy()
    slope, bend = np.zeros_like(z), np.zeros_like(z)  # z P' and z^2 P''/2
    for k in range(len(harmonics) - 1, -1, -1):
        bend += slope
        bend *= z
        slope += value
        slope *= z
        value *= z
        if k > 0:
            value += harmonics[k - 1]
    return value.real, -slope.imag, -(slope + 2 * bend).real


def _position(harmonics: Complexes, z: Complexes) -> tuple[Floats, Floats]:
    """Return displacement about the mean and its derivative by phase."""
    value, slope = harmonics[-1].copy(), np.zeros_like(z)
    for k in range(len(harmonics) - 1, -1, -1):
        slope += value
        slope *= z
        value *= z
        if k > 0:
            value += harmonics[k - 1]
    return value.real, -slope.imag


def _measure_two_turns(
    gap_law: GapLaw,
    motions: _Motions,
    above: Complexes,
    below: Complexes,
    twice: NDArray[np.bool_],
    measures: Measures,
) -> None:
    if not twice.all():
        own = np.flatnonzero(twice)
        part = Measures(*(values[own] for values in measures))
        _measure_two_turns(gap_law, motions.among(own), above[own], below[own], twice[own], part)
        for values, answers in zip(measures, part, strict=True):
            values[own] = answers
        return
    upper, high = _turn(motions.harmonics, above)
    lower, low = _turn(motions.harmonics, below)
    high, low = motions.mean + high, motions.mean + low
    measures.turns[:, 0], measures.turns[:, 1] = upper, lower
    measures.force[:, 0] = gap_law.force(low, motions.load)
    measures.force[:, 1] = gap_law.force(high, motions.load)
    measures.amplitude[:] = 0.5 * (high - low)
    measures.lowest_displacement[:] = low
    beyond = gap_law.loss_displacement(motions.load)
    measures.lost[:] = low >= beyond
    hops = np.flatnonzero((low < beyond) & (beyond < high))
    if hops.size:
        among = motions.among(hops)
        level = beyond[hops] - among.mean
        measures.lost[hops] = _share_above(among.harmonics, level, upper[hops], lower[hops])


def _turn(harmonics: Complexes, near: Complexes) -> tuple[Floats, Floats]:
    """Return the phase nearby at which the velocity vanishes, and the displacement there about the mean."""
    z, displacement = near.copy(), np.empty(near.size)
    left: NDArray[np.intp] | slice = slice(None)
    for _ in range(_NEWTON):
        x, rate, bend = _swing(harmonics[:, left], z[left])
        step = rate / bend
        # back by 2 arctan(step/2), which stays on the circle
        z[left] *= _turned(-step)
        displacement[left] = x - 0.5 * rate * step
        far = np.abs(step) >= 1e-4  # the displacement is then right to its third power
        if not far.any():
            break
        left = np.flatnonzero(far) if isinstance(left, slice) else left[far]
    return np.angle(z), displacement


def _turned(angle: Floats) -> Complexes:
    """Return exp(2i arctan(angle/2))."""
    square = 0.25 * angle * angle
    turned = np.empty(angle.shape, dtype=np.complex128)
    inverse = 1 / (1 + square)
    turned.real, turned.imag = (1 - square) * inverse, angle * inverse
    return turned


def _share_above(harmonics: Complexes, level: Floats, upper: Floats, lower: Floats) -> Floats:
    """Return the share of the period in which motions of two turns lie above a level between them."""
    size = np.abs(harmonics[0])
    cosine = np.clip(level / size, -_CLEAR, _CLEAR)
    turn, aside = np.conj(harmonics[0]) / size, 1j * np.sqrt(1 - cosine * cosine)
    after, down = _passage(harmonics, level, turn * (cosine + aside))
    before, up = _passage(harmonics, level, turn * (cosine - aside))
    share = np.angle(after * np.conj(before)) / (2 * np.pi) % 1.0
    rest = np.flatnonzero(~((down < 0) & (up > 0)))
    if rest.size:
        own = (harmonics[:, rest], level[rest], upper[rest])
        end = _crossing(*own, np.where(lower > upper, lower, lower + 2 * np.pi)[rest])
        start = _crossing(*own, np.where(lower < upper, lower, lower - 2 * np.pi)[rest])
        share[rest] = (end - start) / (2 * np.pi)
    return np.asarray(share)


def _passage(harmonics: Complexes, level: Floats, near: Complexes) -> tuple[Complexes, Floats]:
    """Return exp(i phase) nearby at which a displacement is passed and the rate there, NaN if a few steps miss it."""
    z, rate = near, np.full(near.size, np.nan)
    left: NDArray[np.intp] | slice = slice(None)
    for _ in range(_PASSES):
        x, slope = _position(harmonics[:, left], z[left])
        step = (x - level[left]) / slope
        z[left] *= _turned(-step)
        far = np.abs(step) >= 1e-4
        rate[left] = np.where(far, np.nan, slope)
        if not far.any():
            break
        left = np.flatnonzero(far) if isinstance(left, slice) else left[far]
    return z, rate


def _crossing(harmonics: Complexes, level: Floats, upper: Floats, lower: Floats) -> Floats:
    """Return the phase between two turns at which a displacement is passed."""
    inside, outside = upper.copy(), lower.copy()
    phase = upper + (lower - upper) / np.pi * np.arccos(np.clip(level / np.abs(harmonics[0]), -0.99, 0.99))
    left = np.arange(phase.size)
    for _ in range(60):
        now = phase[left]
        x, rate = _position(harmonics[:, left], np.exp(1j * now))
        above = x > level[left]
        inside[left[above]], outside[left[~above]] = now[above], now[~above]
        with np.errstate(divide="ignore", invalid="ignore"):
            step = (x - level[left]) / rate
        after = now - step
        between = (after - inside[left]) * (after - outside[left]) < 0
        phase[left] = np.where(between, after, 0.5 * (inside[left] + outside[left]))
        left = left[~(between & (np.abs(step) < 1e-4))]
        if not left.size:
            break
    return np.asarray(phase)


def _sampled(motions: _Motions) -> tuple[Floats, Floats]:
    """Return displacement about the mean and its derivative by phase at even phases, one row to a motion."""
    most = len(motions.harmonics)
    count = max(_SCAN * most, _FEWEST)
    spectra = np.zeros((2, motions.mean.size, count // 2 + 1), dtype=np.complex128)
    spectra[0, :, 1 : most + 1] = motions.harmonics.T * (count / 2)
    spectra[1] = 1j * np.arange(count // 2 + 1) * spectra[0]
    x, rate = np.fft.irfft(spectra, count)
    return x, rate


def _two_turns(motions: _Motions) -> tuple[Complexes, Complexes]:
    """Return exp(i phase) about where motions turn down and up, NaN if they turn, or nearly do, more than twice."""
    here = _sampled(motions)[1]
    before, after = np.roll(here, 1, axis=1), np.roll(here, -1, axis=1)
    slow = _SLOW * np.abs(here).max(axis=1, keepdims=True)
    downward, upward = (before > 0) & (here <= 0), (before <= 0) & (here > 0)
    nearly = (np.abs(here) < slow) & (np.abs(here) <= np.abs(before)) & (np.abs(here) <= np.abs(after))
    nearly &= (here * after > 0) & ~downward & ~upward
    twice = (downward.sum(axis=1) == 1) & (upward.sum(axis=1) == 1) & ~nearly.any(axis=1)
    rows, count = np.arange(here.shape[0]), here.shape[1]
    turns = []
    for crossed in (downward, upward):
        j = crossed.argmax(axis=1)
        earlier, later = before[rows, j], here[rows, j]
        with np.errstate(divide="ignore", invalid="ignore"):
            phase = 2 * np.pi / count * (j - 1 + earlier / (earlier - later))
        turns.append(np.exp(1j * np.where(twice, phase, np.nan)))
    return turns[0], turns[1]


def _scan(
    gap_law: GapLaw, motions: _Motions, own: NDArray[np.intp], twice: NDArray[np.bool_], measures: Measures
) -> None:
    """Measure motions of many turns, or whose force lags, by samples with parabolas through the extremes."""
    x, rate = _sampled(motions)
    x += motions.mean[:, np.newaxis]
    load, v = motions.load[:, np.newaxis], motions.omega[:, np.newaxis] * rate
    force = gap_law.force(x, load) * np.maximum(1 - gap_law.force_damping * v, 0.0)
    here = force - LOST * load
    after = np.roll(here, -1, axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        crossing = np.maximum(-here, -after) / np.abs(here - after)
    absent = np.where((here < 0) & (after < 0), 1.0, np.where(here * after < 0, crossing, 0.0))
    measures.lost[own] = absent.mean(axis=1)
    measures.force[own, 0] = _highest(force)
    measures.force[own, 1] = np.maximum(-_highest(-force), 0.0)
    many = own[~twice]
    high, low = _highest(x[~twice]), -_highest(-x[~twice])
    measures.amplitude[many], measures.lowest_displacement[many] = 0.5 * (high - low), low


def _highest(samples: Floats) -> Floats:
    """Return the highest of each row of samples of a period."""
    rows, top = np.arange(samples.shape[0]), samples.argmax(axis=1)
    before, here = samples[rows, top - 1], samples[rows, top]
    after = samples[rows, (top + 1) % samples.shape[1]]
    bend = 2 * here - before - after
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.where(bend > 0, here + (after - before) ** 2 / (8 * bend), here))
