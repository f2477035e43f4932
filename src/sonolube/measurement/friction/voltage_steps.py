"""Friction and its reduction at each step of a drive voltage that is raised in steps."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike
from scipy.ndimage import maximum_filter1d, minimum_filter1d

from sonolube.checks import Floats, require_non_negative, require_positive
from sonolube.errors import InvalidInput
from sonolube.measurement.friction.reduction import estimate_friction_reduction
from sonolube.measurement.statistics.autocorrelation import correlated_mean
from sonolube.measurement.time_series import require_time_series, uniform_sample_interval

_SECTIONS_PER_STEP = 10  # sections of the shortest step, by whose medians steps are separated


@dataclass(frozen=True, kw_only=True, slots=True)
class VoltageStep:
    """Friction during one step of constant voltage, and its reduction against the steps without voltage.

    Parameters
    ----------
    voltage_peak_to_peak : float
        Median over the step. [V]
    start_time : float
        Beginning of the step. [s]
    end_time : float
        End of the step. [s]
    friction_force : float
        Mean after the settling time. [N]
    friction_force_deviation : float
        Standard deviation of the samples. [N]
    friction_force_uncertainty : float
        Standard error of the mean. [N]
    friction_reduction : float or None
        Against the steps without voltage; None for these themselves. []
    friction_reduction_uncertainty : float or None
        Its standard uncertainty. []
    """

    voltage_peak_to_peak: float
    start_time: float
    end_time: float
    friction_force: float
    friction_force_deviation: float
    friction_force_uncertainty: float
    friction_reduction: float | None
    friction_reduction_uncertainty: float | None


def voltage_envelope(*, time: ArrayLike, stack_voltage: ArrayLike, window_duration: float = 0.05) -> Floats:
    """Return the peak-to-peak envelope of an alternating voltage by moving maximum and minimum. [V]

    Parameters
    ----------
    time : array_like, shape (samples,)
        Evenly spaced. [s]
    stack_voltage : array_like, shape (samples,)
        Alternating voltage; NaN is left out. [V]
    window_duration : float
        Duration of the window over which maximum and minimum are taken. [s]

    Returns
    -------
    ndarray, shape of `time`

    Raises
    ------
    InvalidInput
        If the time has gaps, or the window holds fewer than eight samples.

    Notes
    -----
    A voltage may alternate faster than it is sampled, as long as the drive frequency differs from every multiple of
    half the sampling rate by more than 1/window: at such a multiple all samples have the same phases, and the envelope
    is too low or zero.
    """
    require_positive(window_duration=window_duration)
    t, u = require_time_series(time=time, stack_voltage=stack_voltage)
    samples = round(window_duration / uniform_sample_interval(time=t))
    if samples < 8:
        raise InvalidInput(f"window_duration of {window_duration:.3g} s holds {samples} samples; at least 8 are needed")
    highest = maximum_filter1d(np.where(np.isnan(u), -np.inf, u), samples, mode="nearest")
    lowest = minimum_filter1d(np.where(np.isnan(u), np.inf, u), samples, mode="nearest")
    return np.asarray(np.where(np.isfinite(highest), highest - lowest, np.nan))


def friction_at_voltage_steps(
    *,
    time: ArrayLike,
    friction_force: ArrayLike,
    voltage_peak_to_peak: ArrayLike,
    shortest_step: float = 1.0,
    settling_time: float = 0.5,
    tolerance: float = 0.05,
) -> tuple[VoltageStep, ...]:
    """Return mean friction and friction reduction at each step of a voltage.

    Parameters
    ----------
    time : array_like, shape (samples,)
        Increasing. [s]
    friction_force : array_like, shape (samples,)
        NaN is left out. [N]
    voltage_peak_to_peak : array_like, shape (samples,)
        As set, or from `voltage_envelope`. [V]
    shortest_step : float
        Duration in seconds below which a level is a transition, not a step.
    settling_time : float
        Left out at the beginning of each step, and a tenth of it at the end. [s]
    tolerance : float
        Change of voltage that begins another step, as a fraction of the range of the voltage.

    Returns
    -------
    tuple of VoltageStep
        In order of time.

    Raises
    ------
    InvalidInput
        If no step is long enough, none is without voltage, or the friction without voltage is not positive.

    See Also
    --------
    estimate_friction_reduction : reduction and uncertainty of one step.

    References
    ----------
    .. [1] D 4.1.2, figure 4.3 and Table 4.2.
    """
    require_positive(shortest_step=shortest_step, tolerance=tolerance)
    require_non_negative(settling_time=settling_time)
    t, f, u = require_time_series(time=time, friction_force=friction_force, voltage_peak_to_peak=voltage_peak_to_peak)
    threshold = tolerance * float(np.nanmax(u) - np.nanmin(u))
    least = max(shortest_step, 2 * settling_time)
    levels_held = _constant_levels(t, u, threshold, shortest_step)
    steps = [(first, last) for first, last in levels_held if t[last - 1] - t[first] > least]
    if not steps:
        raise InvalidInput(f"voltage_peak_to_peak is constant nowhere for {least:.3g} s")
    settled = [_settled_part(t, first, last, settling_time) for first, last in steps]
    levels = [float(np.nanmedian(u[part])) for part in settled]
    without = [level <= threshold for level in levels]
    if not any(without):
        raise InvalidInput(f"voltage_peak_to_peak has no step without voltage; the lowest is {min(levels):.3g} V")
    intrinsic = np.concatenate([f[part] for part, off in zip(settled, without, strict=True) if off])
    return tuple(
        _voltage_step(t, f, level, step, part, None if off else intrinsic)
        for level, step, part, off in zip(levels, steps, settled, without, strict=True)
    )


def _constant_levels(t: Floats, u: Floats, threshold: float, shortest: float) -> list[tuple[int, int]]:
    """Return the sample ranges of constant level, with those joined that a short disturbance separates."""
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
    """Return the samples of a step without the settling at its beginning and a tenth of it at its end."""
    lower = int(np.searchsorted(t, t[first] + settling))
    upper = int(np.searchsorted(t, t[last - 1] - settling / 10, side="right"))
    return slice(lower, upper)


def _voltage_step(
    t: Floats, f: Floats, level: float, step: tuple[int, int], part: slice, intrinsic: Floats | None
) -> VoltageStep:
    """Return the record of one step, with its reduction where the intrinsic friction is given."""
    mean = correlated_mean(f[part])
    reduction = (
        None
        if intrinsic is None
        else estimate_friction_reduction(intrinsic_friction_force=intrinsic, reduced_friction_force=f[part])
    )
    return VoltageStep(
        voltage_peak_to_peak=level,
        start_time=float(t[step[0]]),
        end_time=float(t[step[1] - 1]),
        friction_force=mean.mean,
        friction_force_deviation=mean.deviation,
        friction_force_uncertainty=mean.uncertainty,
        friction_reduction=reduction.friction_reduction if reduction else None,
        friction_reduction_uncertainty=reduction.friction_reduction_uncertainty if reduction else None,
    )
