"""Steps of a recording: constant voltage and speed, in which the surfaces slide."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from sonolube.checks import Floats, require_non_negative, require_positive
from sonolube.errors import InvalidInput
from sonolube.measurement.friction.sliding import Mask, at_rest, stretches, voltage_threshold

_SECTION = 0.05  # s, by whose medians a disc that coasts down is told from one at rest
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
    t: Floats, f: Floats, u: Floats, v: Floats | None, *, shortest_step: float, settling_time: float, tolerance: float
) -> SlidingSteps:
    """Steps that last long enough, from time, force, voltage and, where it is known, the speed.

    See Also
    --------
    at_rest : the rule for rest.
    """
    require_positive(shortest_step=shortest_step, tolerance=tolerance)
    require_non_negative(settling_time=settling_time)
    threshold = voltage_threshold(voltage_peak_to_peak=u, tolerance=tolerance)
    least = max(shortest_step, 2 * settling_time)
    held = _constant_levels(t, u, threshold, shortest_step)
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
    size = max(1, round(_SECTION / float(np.median(np.diff(t)))))
    force = f[first:last]
    medians = [float(np.nanmedian(force[k : k + size])) for k in range(0, force.size, size)]
    level = max(_COASTS * float(np.nanmedian(np.abs(f[slice(*step)]))), float(np.nanstd(force[force.size // 2 :])))
    moving = np.flatnonzero(np.abs(medians) > level)
    begin = (int(moving[-1]) + 2) * size if moving.size else 0
    return np.asarray(force[begin:][np.isfinite(force[begin:])])


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
