"""Measures of periodic motions at the contact: extrema of displacement and force, and the time without contact.

Most motions have one maximum and one minimum per period, which Newton's method finds. Motions with more extrema, and
forces that damping shifts against the displacement, are sampled.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Complexes, Floats, Integers
from sonolube.models.dynamics.gap_laws.closed_form import CONTACT_LOSS_THRESHOLD, GapLaw, damped_force

_WEAK_HARMONICS = 0.7  # sum of k^2 |X_k|, k > 1, over |X_1| up to which a motion certainly has two extrema
_CLEAR = 0.99  # level over amplitude, at most, from which the search for its crossing starts
_SLOW = 0.05  # velocity over its peak below which a minimum of the speed is nearly an extremum
_SAMPLES_PER_HARMONIC, _SAMPLES = 16, (256, 512, 1024)  # to find the extrema of any other motion
_SAMPLES_AT_ONCE = 2**18
_NEWTON_STEPS, _CROSSING_STEPS = 20, 5


class ResponseMeasures(NamedTuple):
    """Measures of the contact's motion, one entry of each array per point."""

    vibration_amplitude: Floats  # (p,) m, half of peak to peak
    extremum_phases: Floats  # (p, 2) rad, of maximum and minimum displacement; NaN with more than two extrema
    lowest_displacement: Floats  # (p,) m
    highest_normal_force: Floats  # (p,) N
    lowest_normal_force: Floats  # (p,) N
    contact_loss_fraction: Floats  # (p,) fraction of the period below 0.01 F_N


class _Motions(NamedTuple):
    """Motions x = mean + Re sum X_k z^k at z = exp(i theta)."""

    omega: Floats  # (p,) rad/s
    load: Floats  # (p,) N
    mean: Floats  # (p,) m
    harmonics: Complexes  # (H, p) m, X_1 first

    def select(self, chosen: NDArray[np.intp]) -> "_Motions":
        return _Motions(self.omega[chosen], self.load[chosen], self.mean[chosen], self.harmonics[:, chosen])


def response_measures(
    gap_law: GapLaw, omega: Floats, load: Floats, mean: Floats, harmonics: Complexes, count: Integers
) -> ResponseMeasures:
    """Measures of periodic motions at the contact; `harmonics` has shape (p, H)."""
    most = int(count.max(initial=1))
    rows = np.ascontiguousarray(harmonics[:, :most].T)
    rows[np.arange(1, most + 1)[:, np.newaxis] > count] = 0.0
    motions = _Motions(omega, load, mean, rows)
    size = np.abs(rows[0])
    weak = _acceleration(rows[1:], first=2) < _WEAK_HARMONICS * size
    maximum = np.conj(rows[0]) / (size + 1e-300)  # exp(i phase), of the first harmonic
    minimum = -maximum
    for own, samples in _chunks(np.flatnonzero(~weak), count):
        maximum[own], minimum[own] = _extremum_estimates(motions.select(own), samples)
    has_two_extrema = ~np.isnan(maximum)
    if has_two_extrema.all():
        measures = _between_extrema(gap_law, motions, maximum, minimum)
    else:
        measures = ResponseMeasures(*(np.full((omega.size, 2) if i == 1 else omega.size, np.nan) for i in range(6)))
        clear = np.flatnonzero(has_two_extrema)
        part = _between_extrema(gap_law, motions.select(clear), maximum[clear], minimum[clear])
        for values, results in zip(measures, part, strict=True):
            values[clear] = results
    for own, samples in _chunks(np.flatnonzero(~has_two_extrema | (gap_law.force_damping > 0.0)), count):
        _measure_by_samples(gap_law, motions.select(own), samples, own, has_two_extrema[own], measures)
    return measures


def _chunks(points: NDArray[np.intp], count: Integers) -> Iterator[tuple[NDArray[np.intp], int]]:
    """Yield points and the number of samples that they require, a few points at a time to bound the memory."""
    required = np.searchsorted(_SAMPLES, _SAMPLES_PER_HARMONIC * count[points])
    for index, samples in enumerate(_SAMPLES):
        own, step = points[required == index], _SAMPLES_AT_ONCE // samples
        for start in range(0, own.size, step):
            yield own[start : start + step], samples


def _acceleration(rows: Complexes, *, first: int) -> Floats:
    """Sum of k^2 times the magnitude of harmonic k, the first one of a given order."""
    total = np.zeros(rows.shape[1])
    for k, row in enumerate(rows, start=first):
        total += k * k * (np.abs(row.real) + np.abs(row.imag))
    return total


def _phase_derivatives(harmonics: Complexes, z: Complexes) -> tuple[Floats, Floats, Floats]:
    """Displacement about the mean and its first two derivatives by phase, by Horner's scheme.

    Products are not formed in place: numpy rounds those of a single element otherwise than those of many.
    """
    value = harmonics[-1].copy()
    slope, bend = np.zeros_like(z), np.zeros_like(z)  # z P' and z^2 P''/2
    for k in range(len(harmonics) - 1, -1, -1):
        bend = (bend + slope) * z
        slope = (slope + value) * z
        value = value * z
        if k > 0:
            value += harmonics[k - 1]
    return value.real, -slope.imag, -(slope + 2 * bend).real


def _displacement_and_slope(harmonics: Complexes, z: Complexes) -> tuple[Floats, Floats]:
    """Displacement about the mean and its derivative by phase, by Horner's scheme."""
    value, slope = harmonics[-1].copy(), np.zeros_like(z)
    for k in range(len(harmonics) - 1, -1, -1):
        slope = (slope + value) * z
        value = value * z
        if k > 0:
            value += harmonics[k - 1]
    return value.real, -slope.imag


def _between_extrema(gap_law: GapLaw, motions: _Motions, maximum: Complexes, minimum: Complexes) -> ResponseMeasures:
    """Measures of motions with two extrema, from estimates exp(i phase) of these."""
    upper, high = _extremum(motions.harmonics, maximum)
    lower, low = _extremum(motions.harmonics, minimum)
    high, low = motions.mean + high, motions.mean + low
    loss = gap_law.loss_displacement(motions.load)
    lost = (low >= loss).astype(np.float64)
    partial = np.flatnonzero((low < loss) & (loss < high))
    if partial.size:
        own = motions.select(partial)
        lost[partial] = _fraction_above(own.harmonics, loss[partial] - own.mean, upper[partial], lower[partial])
    return ResponseMeasures(
        vibration_amplitude=0.5 * (high - low),
        extremum_phases=np.stack([upper, lower], axis=1),
        lowest_displacement=low,
        highest_normal_force=gap_law.force(low, motions.load),
        lowest_normal_force=gap_law.force(high, motions.load),
        contact_loss_fraction=lost,
    )


def _extremum(harmonics: Complexes, near: Complexes) -> tuple[Floats, Floats]:
    """Phase of the extremum near exp(i phase), and the displacement there about the mean."""
    z, displacement = near.copy(), np.empty(near.size)
    left: NDArray[np.intp] | slice = slice(None)
    for _ in range(_NEWTON_STEPS):
        x, slope, bend = _phase_derivatives(harmonics[:, left], z[left])
        step = slope / bend
        # back by 2 arctan(step/2), which stays on the unit circle
        z[left] = z[left] * _rotation(-step)
        displacement[left] = x - 0.5 * slope * step
        far = np.abs(step) >= 1e-4  # the error of the displacement is then of the third order
        if not far.any():
            break
        left = np.flatnonzero(far) if isinstance(left, slice) else left[far]
    return np.angle(z), displacement


def _rotation(angle: Floats) -> Complexes:
    """exp(2i arctan(angle/2)), a rational approximation of exp(i angle) on the unit circle."""
    square = 0.25 * angle * angle
    rotation = np.empty(angle.shape, dtype=np.complex128)
    inverse = 1 / (1 + square)
    rotation.real, rotation.imag = (1 - square) * inverse, angle * inverse
    return rotation


def _fraction_above(harmonics: Complexes, level: Floats, upper: Floats, lower: Floats) -> Floats:
    """Fraction of the period in which motions with two extrema exceed a level between these."""
    size = np.abs(harmonics[0])
    cosine = np.clip(level / size, -_CLEAR, _CLEAR)
    first, aside = np.conj(harmonics[0]) / size, 1j * np.sqrt(1 - cosine * cosine)
    after, down = _newton_crossing(harmonics, level, first * (cosine + aside))
    before, up = _newton_crossing(harmonics, level, first * (cosine - aside))
    fraction = np.angle(after * np.conj(before)) / (2 * np.pi) % 1.0
    rest = np.flatnonzero(~((down < 0) & (up > 0)))
    if rest.size:
        own = (harmonics[:, rest], level[rest], upper[rest])
        end = _bracketed_crossing(*own, np.where(lower > upper, lower, lower + 2 * np.pi)[rest])
        start = _bracketed_crossing(*own, np.where(lower < upper, lower, lower - 2 * np.pi)[rest])
        fraction[rest] = (end - start) / (2 * np.pi)
    return np.asarray(fraction)


def _newton_crossing(harmonics: Complexes, level: Floats, near: Complexes) -> tuple[Complexes, Floats]:
    """exp(i phase) of the crossing of a level near a phase, and the slope there: NaN if not converged."""
    z, slope_there = near, np.full(near.size, np.nan)
    left: NDArray[np.intp] | slice = slice(None)
    for _ in range(_CROSSING_STEPS):
        x, slope = _displacement_and_slope(harmonics[:, left], z[left])
        step = (x - level[left]) / slope
        z[left] = z[left] * _rotation(-step)
        far = np.abs(step) >= 1e-4
        slope_there[left] = np.where(far, np.nan, slope)
        if not far.any():
            break
        left = np.flatnonzero(far) if isinstance(left, slice) else left[far]
    return z, slope_there


def _bracketed_crossing(harmonics: Complexes, level: Floats, upper: Floats, lower: Floats) -> Floats:
    """Phase between maximum and minimum at which a level is crossed, by Newton's method with bisection."""
    inside, outside = upper.copy(), lower.copy()
    phase = upper + (lower - upper) / np.pi * np.arccos(np.clip(level / np.abs(harmonics[0]), -_CLEAR, _CLEAR))
    left = np.arange(phase.size)
    for _ in range(60):
        now = phase[left]
        x, slope = _displacement_and_slope(harmonics[:, left], np.exp(1j * now))
        above = x > level[left]
        inside[left[above]], outside[left[~above]] = now[above], now[~above]
        with np.errstate(divide="ignore", invalid="ignore"):
            step = (x - level[left]) / slope
        after = now - step
        between = (after - inside[left]) * (after - outside[left]) < 0
        phase[left] = np.where(between, after, 0.5 * (inside[left] + outside[left]))
        left = left[~(between & (np.abs(step) < 1e-4))]
        if not left.size:
            break
    return np.asarray(phase)


def _samples(motions: _Motions, count: int) -> tuple[Floats, Floats]:
    """Displacement about the mean and its derivative by phase at equally spaced phases, one row per motion."""
    spectra = np.zeros((2, motions.mean.size, count // 2 + 1), dtype=np.complex128)
    harmonics = motions.harmonics[: count // _SAMPLES_PER_HARMONIC]
    spectra[0, :, 1 : len(harmonics) + 1] = harmonics.T * (count / 2)
    spectra[1] = 1j * np.arange(count // 2 + 1) * spectra[0]
    x, slope = np.fft.irfft(spectra, count)
    return x, slope


def _extremum_estimates(motions: _Motions, samples: int) -> tuple[Complexes, Complexes]:
    """Estimates exp(i phase) of maximum and minimum; NaN for motions with more, or nearly more, extrema."""
    here = _samples(motions, samples)[1]
    before, after = np.roll(here, 1, axis=1), np.roll(here, -1, axis=1)
    slow = _SLOW * np.abs(here).max(axis=1, keepdims=True)
    downward, upward = (before > 0) & (here <= 0), (before <= 0) & (here > 0)
    nearly = (np.abs(here) < slow) & (np.abs(here) <= np.abs(before)) & (np.abs(here) <= np.abs(after))
    nearly &= (here * after > 0) & ~downward & ~upward
    has_two_extrema = (downward.sum(axis=1) == 1) & (upward.sum(axis=1) == 1) & ~nearly.any(axis=1)
    rows, count = np.arange(here.shape[0]), here.shape[1]
    estimates = []
    for crossed in (downward, upward):
        j = crossed.argmax(axis=1)
        earlier, later = before[rows, j], here[rows, j]
        with np.errstate(divide="ignore", invalid="ignore"):
            phase = 2 * np.pi / count * (j - 1 + earlier / (earlier - later))
        estimates.append(np.exp(1j * np.where(has_two_extrema, phase, np.nan)))
    return estimates[0], estimates[1]


def _measure_by_samples(
    gap_law: GapLaw,
    motions: _Motions,
    samples: int,
    own: NDArray[np.intp],
    has_two_extrema: NDArray[np.bool_],
    measures: ResponseMeasures,
) -> None:
    """Write the measures of motions with many extrema, or with a damped force, by samples and parabolas."""
    x, slope = _samples(motions, samples)
    x += motions.mean[:, np.newaxis]
    load, v = motions.load[:, np.newaxis], motions.omega[:, np.newaxis] * slope
    force = damped_force(gap_law, x, v, load)
    here = force - CONTACT_LOSS_THRESHOLD * load
    after = np.roll(here, -1, axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        crossing = np.maximum(-here, -after) / np.abs(here - after)
    lost = np.where((here < 0) & (after < 0), 1.0, np.where(here * after < 0, crossing, 0.0))
    measures.contact_loss_fraction[own] = lost.mean(axis=1)
    measures.highest_normal_force[own] = _parabolic_maximum(force)
    measures.lowest_normal_force[own] = np.maximum(-_parabolic_maximum(-force), 0.0)
    many = own[~has_two_extrema]
    high, low = _parabolic_maximum(x[~has_two_extrema]), -_parabolic_maximum(-x[~has_two_extrema])
    measures.vibration_amplitude[many], measures.lowest_displacement[many] = 0.5 * (high - low), low


def _parabolic_maximum(samples: Floats) -> Floats:
    """Maximum of each row of periodic samples, by a parabola through the highest three."""
    rows, top = np.arange(samples.shape[0]), samples.argmax(axis=1)
    before, here = samples[rows, top - 1], samples[rows, top]
    after = samples[rows, (top + 1) % samples.shape[1]]
    bend = 2 * here - before - after
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.where(bend > 0, here + (after - before) ** 2 / (8 * bend), here))
