"""Rest and sliding in a friction recording, and its steps of constant voltage and speed in which the surfaces slide.

Rest is told by a speed, by the motor as set, or by the force without vibration.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter

from sonolube.checks import Floats, require_non_negative, require_positive
from sonolube.errors import InvalidInput

Mask = NDArray[np.bool_]

NOISE_VOLTAGE = 0.05
"""Voltage up to which it is noise of its channel. [V]"""

_MOVES = 0.05  # of the highest speed, above which the surfaces slide
_REVERSAL = 0.2  # s, up to which a low speed is the reversal of a stroke
_SECTION = 0.05  # s, over which medians of the force are taken
_SECTIONS = 5  # of whose states the median counts
_AT_REST = 0.5  # of the level without voltage, below which the force is that of rest
_LEVEL = 90  # percentile of the sections that is the level: most of a recording may be rest


def at_rest(
    *,
    time: Floats,
    friction_force: Floats,
    voltage_peak_to_peak: Floats | None = None,
    sliding_speed: Floats | None = None,
    tolerance: float = 0.05,
) -> Mask:
    """Whether the surfaces rest at each sample: by the speed where it is known, else by the force without vibration.

    Parameters
    ----------
    time : ndarray, shape (samples,)
        Increasing. [s]
    friction_force : ndarray, shape (samples,)
        NaN is left out. [N]
    voltage_peak_to_peak : ndarray, shape (samples,), or None
        [V]
    sliding_speed : ndarray, shape (samples,), or None
        Measured or set, or in proportion to it. [m/s]
    tolerance : float
        Of the range of the voltage, up to which there is none; 50 mV at least.

    Returns
    -------
    ndarray of bool, shape (samples,)
        False everywhere where neither speed nor voltage are known.
    """
    unknown = np.ones(time.size, bool) if sliding_speed is None else ~np.isfinite(sliding_speed)
    rest = np.zeros(time.size, bool)
    if sliding_speed is not None and not unknown.all():
        rest = rest_by_speed(time=time, speed=sliding_speed)
    if voltage_peak_to_peak is not None and unknown.any():
        without = np.nan_to_num(voltage_peak_to_peak) <= voltage_threshold(
            voltage_peak_to_peak=voltage_peak_to_peak, tolerance=tolerance
        )
        rest |= unknown & rest_by_force(time=time, friction_force=friction_force, without_voltage=without)
    return rest


def voltage_threshold(*, voltage_peak_to_peak: Floats, tolerance: float) -> float:
    """Voltage up to which there is none, and change of it that begins another step: of its range, or of noise, in V.

    50 mV at least.
    """
    return max(tolerance * float(np.nanmax(voltage_peak_to_peak) - np.nanmin(voltage_peak_to_peak)), NOISE_VOLTAGE)


def rest_by_speed(*, time: Floats, speed: Floats) -> Mask:
    """Whether the surfaces rest, by a speed that was measured or set.

    Below a twentieth of the highest speed for over 0.2 s: a stroke that turns back rests for less.
    """
    size = np.abs(speed)
    highest = float(np.nanmax(size)) if np.isfinite(size).any() else 0.0
    slow = size <= _MOVES * highest
    for first, last in stretches(slow):
        if highest and first > 0 and last < time.size and time[last] - time[first] <= _REVERSAL:
            slow[first:last] = False
    return np.asarray(slow)


def rest_by_force(*, time: Floats, friction_force: Floats, without_voltage: Mask) -> Mask:
    """Whether the surfaces rest, by the force where there is no vibration.

    Without voltage and below half of the level there, the 90th percentile of medians over 50 ms. No rest where that
    level is not positive.

    A force that stays when the motor stops, as a holder under tension keeps it, is not told from sliding: that needs a
    speed.
    """
    size = max(1, round(_SECTION / float(np.median(np.diff(time)))))
    starts = np.arange(0, time.size, size)
    known = np.where(without_voltage, friction_force, np.nan)
    sections = [part[np.isfinite(part)] for part in np.split(known, starts[1:])]
    medians = np.array([np.median(part) if part.size else np.nan for part in sections])
    is_known = np.isfinite(medians)
    level = float(np.percentile(medians[is_known], _LEVEL)) if is_known.any() else 0.0
    if level <= 0:
        return np.zeros(time.size, bool)
    low = np.zeros(medians.size, bool)
    low[is_known] = median_filter((medians[is_known] < _AT_REST * level).astype(np.int8), _SECTIONS) > 0
    return np.asarray(np.repeat(low, size)[: time.size] & without_voltage)


def stretches(mask: Mask) -> list[tuple[int, int]]:
    """First sample of each stretch in which a mask holds, and the sample after its last one."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(np.int8)))
    return [(int(first), int(last)) for first, last in list(pairwise(edges))[::2]]


_COASTING_SECTION = 0.05  # s, by whose medians a disc that coasts down is told from one at rest
_COASTS = 0.5  # of the level, above which it does
_SECTIONS_PER_STEP = 10  # sections of the shortest step, by whose medians steps are separated


@dataclass(frozen=True, kw_only=True, slots=True)
class SlidingSteps:
    """Steps of constant voltage and speed in which the surfaces slide.

    Parameters
    ----------
    steps : list of (int, int)
        First sample of each, and the sample after its last one.
    settled : list of slice
        Samples of each without the settling.
    voltages : list of float
        Median of each, peak to peak, in V.
    speeds : list of float
        Median sliding speed of each, in m/s; NaN where it is not known.
    threshold : float
        Voltage up to which there is none, in V.
    at_rest : ndarray
        Known force while the surfaces rest before they first slide, in N.
    """

    steps: list[tuple[int, int]]
    settled: list[slice]
    voltages: list[float]
    speeds: list[float]
    threshold: float
    at_rest: Floats


def sliding_steps(
    t: Floats,
    f: Floats,
    u: Floats,
    v: Floats | None,
    *,
    shortest_step: float,
    settling_time: float,
    tolerance: float,
    stated: Floats | None = None,
) -> SlidingSteps:
    """Steps that last long enough, from time, force, voltage, the speed where it is known, and their numbers if stated.

    See Also
    --------
    at_rest : the rule for rest.
    """
    require_positive(shortest_step=shortest_step, tolerance=tolerance)
    require_non_negative(settling_time=settling_time)
    threshold = voltage_threshold(voltage_peak_to_peak=u, tolerance=tolerance)
    least = max(shortest_step, 2 * settling_time)
    held = _constant_levels(t, u, threshold, shortest_step) if stated is None else _stated_ranges(stated)
    if v is not None:
        change = tolerance * float(np.nanmax(np.abs(v)))
        held = _common(held, _constant_levels(t, v, change, shortest_step))
    rest = at_rest(time=t, friction_force=f, voltage_peak_to_peak=u, sliding_speed=v, tolerance=tolerance)
    if not any(t[last - 1] - t[first] > least for first, last in held):
        raise InvalidInput(f"voltage_peak_to_peak is constant nowhere for {least:.3g} s")
    steps = [
        (first + begin, first + end)
        for first, last in held
        for begin, end in stretches(~rest[first:last])
        if t[first + end - 1] - t[first + begin] > least
    ]
    if not steps:
        raise InvalidInput(f"at no constant voltage_peak_to_peak do the surfaces slide for {least:.3g} s")
    settled = [_settled_part(t, first, last, settling_time) for first, last in steps]
    return SlidingSteps(
        steps=steps,
        settled=settled,
        voltages=[float(np.nanmedian(u[part])) for part in settled],
        speeds=[np.nan if v is None else float(np.nanmedian(v[part])) for part in settled],
        threshold=threshold,
        at_rest=_force_before_sliding(t, f, rest, steps[0]),
    )


def _force_before_sliding(t: Floats, f: Floats, rest: Mask, step: tuple[int, int]) -> Floats:
    """Known force in the last rest before the first step, from where a disc that coasts down has come to rest on."""
    found = stretches(rest[: step[0]])
    if not found:
        return np.empty(0)
    first, last = found[-1]
    size = max(1, round(_COASTING_SECTION / float(np.median(np.diff(t)))))
    force = f[first:last]
    medians = [float(np.nanmedian(force[k : k + size])) for k in range(0, force.size, size)]
    level = max(_COASTS * float(np.nanmedian(np.abs(f[slice(*step)]))), float(np.nanstd(force[force.size // 2 :])))
    moving = np.flatnonzero(np.abs(medians) > level)
    begin = (int(moving[-1]) + 2) * size if moving.size else 0
    return np.asarray(force[begin:][np.isfinite(force[begin:])])


def _stated_ranges(stated: Floats) -> list[tuple[int, int]]:
    """Sample ranges of one number, those of 0 left out."""
    edges = [0, *np.flatnonzero(np.diff(stated)) + 1, stated.size]
    return [(int(first), int(last)) for first, last in pairwise(edges) if stated[first]]


def _common(one: list[tuple[int, int]], other: list[tuple[int, int]]) -> list[tuple[int, int]]:
    """Ranges of samples in which both of two levels are constant."""
    overlaps = [(max(a, c), min(b, d)) for a, b in one for c, d in other]
    return sorted((first, last) for first, last in overlaps if last > first)


def _constant_levels(t: Floats, u: Floats, threshold: float, shortest: float) -> list[tuple[int, int]]:
    """Sample ranges of constant level, with those joined that a short disturbance separates."""
    section = max(1, round(shortest / _SECTIONS_PER_STEP / float(np.median(np.diff(t)))))
    starts = np.arange(0, t.size, section)
    level = np.array([np.nanmedian(part) if np.isfinite(part).any() else np.nan for part in np.split(u, starts[1:])])
    known = np.isfinite(level)
    starts, level = starts[known], level[known]
    edges = np.concatenate([[0], np.flatnonzero(np.abs(np.diff(level)) > threshold) + 1, [level.size]])
    ends = np.append(starts[1:], t.size)
    runs: list[tuple[int, int, float]] = []
    for first, last in pairwise(edges):
        if last - first < 2:
            continue
        value = float(np.median(level[first:last]))
        if runs and abs(runs[-1][2] - value) <= threshold:
            runs[-1] = (runs[-1][0], int(ends[last - 1]), runs[-1][2])
        else:
            runs.append((int(starts[first]), int(ends[last - 1]), value))
    return [(first, last) for first, last, _ in runs]


def _settled_part(t: Floats, first: int, last: int, settling: float) -> slice:
    """Samples of a step without the settling at its beginning and a tenth of it at its end."""
    lower = int(np.searchsorted(t, t[first] + settling))
    upper = int(np.searchsorted(t, t[last - 1] - settling / 10, side="right"))
    return slice(lower, upper)
