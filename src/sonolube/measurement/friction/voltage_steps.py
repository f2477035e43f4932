"""Friction and its reduction at each step of a drive voltage that is raised in steps."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.ndimage import maximum_filter1d, minimum_filter1d

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.errors import InvalidInput
from sonolube.facts.metrics import friction_reduction
from sonolube.measurement.friction.step_means import (
    SampledParts,
    StepMeans,
    mean_of_parts,
    sampled_parts,
    without_wobble,
    wobble_columns,
)
from sonolube.measurement.friction.stick_slip import StickSlipEstimate, not_detected, stick_slip_of_parts
from sonolube.measurement.time_series import require_equal_length, require_time_series, uniform_sample_interval

_SECTIONS_PER_STEP = 10  # sections of the shortest step, by whose medians steps are separated
_ONSET_SECTIONS = 200  # of the first step, by whose medians the begin of sliding is found
_REST_SHARE = 0.3  # of the level, below which the force at the begin of a recording is that of rest


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
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
        Mean after the settling time, without wobble and run-in. [N]
    friction_force_deviation : float
        Standard deviation of the samples, wobble and stick-slip included. [N]
    friction_force_uncertainty : float
        Standard error of the mean. [N]
    friction_reduction : float or None
        Against the steps without voltage; None for these themselves. []
    friction_reduction_uncertainty : float or None
        Its standard uncertainty. []
    stick_slip : StickSlipEstimate
        In the step after the settling time, without wobble.
    """

    voltage_peak_to_peak: float
    start_time: float
    end_time: float
    friction_force: float
    friction_force_deviation: float
    friction_force_uncertainty: float
    friction_reduction: float | None
    friction_reduction_uncertainty: float | None
    stick_slip: StickSlipEstimate


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
    revolutions: ArrayLike | None = None,
    harmonics: int = 3,
) -> tuple[VoltageStep, ...]:
    r"""Return mean friction, friction reduction and stick-slip at each step of a voltage.

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
    revolutions : array_like, shape (samples,), or None
        Revolutions of the disc made until each sample, whose speed is corrected by up to half a revolution over the
        recording; without it the rotation is sought in the force. []
    harmonics : int
        Number of harmonics of the rotation that are taken off.

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
    mean_of_parts : the means and their uncertainty, wobble, run-in, drift and stick-slip taken off jointly.
    stick_slip_of_parts : stick-slip in the steps.
    estimate_friction_reduction : reduction between two parts of any recording.

    Notes
    -----
    Settling begins where the voltage changes, in the first step where sliding does. With the mean :math:`F_0` of the
    steps without voltage, weighted by their duration, and the covariance C of the means,

    .. math:: P_f = 1 - \frac{F_1}{F_0} , \qquad u_P^2 = g^T C g , \qquad g = \nabla P_f .

    A step shorter than a revolution is as uncertain as its part of the wobble, which the other steps determine.

    References
    ----------
    .. [1] D 2.1, D 4.1.2, figure 4.3 and Table 4.2.
    """
    t, f, u = require_time_series(time=time, friction_force=friction_force, voltage_peak_to_peak=voltage_peak_to_peak)
    found = _found_steps(t, f, u, shortest_step=shortest_step, settling_time=settling_time, tolerance=tolerance)
    without = np.array([level <= found.threshold for level in found.levels])
    if not any(without):
        lowest = min(found.levels)
        raise InvalidInput(f"voltage_peak_to_peak has no step without voltage; the lowest is {lowest:.3g} V")
    settled, levels = found.settled, found.levels
    parts = sampled_parts(settled, time=t, friction_force=f)
    turned = None if revolutions is None else _revolutions_of_parts(f, require_finite(revolutions=revolutions), settled)
    waves = wobble_columns(parts, revolutions=turned, harmonics=harmonics)[0]
    stick_slip = _stick_slip(parts, without_wobble(parts, waves))
    means = mean_of_parts(parts, waves=waves, stick_slip=stick_slip, onset=float(t[found.onset]))
    reductions = _reductions(means, without, np.array([part.size for part in parts.times]))
    return tuple(
        VoltageStep(
            voltage_peak_to_peak=levels[j],
            start_time=float(t[first]),
            end_time=float(t[last - 1]),
            friction_force=float(means.friction_force[j]),
            friction_force_deviation=float(np.std(parts.forces[j], ddof=1)),
            friction_force_uncertainty=float(np.sqrt(means.covariance[j, j])),
            friction_reduction=None if without[j] else reductions[j][0],
            friction_reduction_uncertainty=None if without[j] else reductions[j][1],
            stick_slip=stick_slip[j],
        )
        for j, (first, last) in enumerate(found.steps)
    )


def rotation_speed_at_voltage_steps(
    *, time: ArrayLike, friction_force: ArrayLike, voltage_peak_to_peak: ArrayLike, harmonics: int = 3
) -> float | None:
    """Return the rotational speed of the disc by the wobble in its friction; None where none stands out. [1/s]

    Parameters
    ----------
    time : array_like, shape (samples,)
        Increasing. [s]
    friction_force : array_like, shape (samples,)
        NaN is left out. [N]
    voltage_peak_to_peak : array_like, shape (samples,)
        Whose steps change the friction. [V]
    harmonics : int
        Number of harmonics of the rotation.

    Returns
    -------
    float or None

    Raises
    ------
    InvalidInput
        If no step is long enough.

    See Also
    --------
    find_rotation_speed : of parts of any recording.
    """
    t, f, u = require_time_series(time=time, friction_force=friction_force, voltage_peak_to_peak=voltage_peak_to_peak)
    found = _found_steps(t, f, u, shortest_step=1.0, settling_time=0.5, tolerance=0.05)
    parts = sampled_parts(found.settled, time=t, friction_force=f)
    return wobble_columns(parts, revolutions=None, harmonics=harmonics)[1] or None


@dataclass(frozen=True, kw_only=True, slots=True)
class _FoundSteps:
    """Steps of a voltage: sample ranges, settled parts, levels, the change that begins one, and the sliding onset."""

    steps: list[tuple[int, int]]
    settled: list[slice]
    levels: list[float]
    threshold: float
    onset: int


def _found_steps(
    t: Floats, f: Floats, u: Floats, *, shortest_step: float, settling_time: float, tolerance: float
) -> _FoundSteps:
    """Return the steps of a voltage that are long enough."""
    require_positive(shortest_step=shortest_step, tolerance=tolerance)
    require_non_negative(settling_time=settling_time)
    threshold = tolerance * float(np.nanmax(u) - np.nanmin(u))
    least = max(shortest_step, 2 * settling_time)
    levels_held = _constant_levels(t, u, threshold, shortest_step)
    steps = [(first, last) for first, last in levels_held if t[last - 1] - t[first] > least]
    if not steps:
        raise InvalidInput(f"voltage_peak_to_peak is constant nowhere for {least:.3g} s")
    onset = _sliding_onset(t, f, *steps[0])
    settled = [_settled_part(t, max(first, onset), last, settling_time) for first, last in steps]
    levels = [float(np.nanmedian(u[part])) for part in settled]
    return _FoundSteps(steps=steps, settled=settled, levels=levels, threshold=threshold, onset=onset)


def _sliding_onset(t: Floats, f: Floats, first: int, last: int) -> int:
    """Return the sample of the first step from which the force stays above half its level."""
    part = np.where(np.isfinite(f[first:last]), f[first:last], 0.0)
    size = max(1, part.size // _ONSET_SECTIONS)
    sections = np.median(part[: part.size // size * size].reshape(-1, size), axis=1)
    level = float(np.median(sections[sections.size // 2 :]))
    at_rest = np.flatnonzero(sections[: sections.size // 2] < 0.5 * level)
    if level <= 0 or not at_rest.size or sections[0] > _REST_SHARE * level:
        return first
    return first + (int(at_rest[-1]) + 1) * size


def _revolutions_of_parts(f: Floats, revolutions: Floats, parts: Sequence[slice]) -> list[Floats]:
    """Return the revolutions at the samples with a known force of each part."""
    require_equal_length(friction_force=f, revolutions=revolutions)
    return [revolutions[part][np.isfinite(f[part])] for part in parts]


def _stick_slip(parts: SampledParts, forces: Sequence[Floats]) -> list[StickSlipEstimate]:
    """Return the stick-slip of each step; a reason where the samples are uneven or too few."""
    try:
        return stick_slip_of_parts(parts.times, forces)
    except InvalidInput as refusal:
        return [not_detected(str(refusal), 0.0) for _ in parts.times]


def _reductions(means: StepMeans, without: NDArray[np.bool_], samples: NDArray[np.int64]) -> list[tuple[float, float]]:
    """Return the friction reduction of each part and its standard uncertainty."""
    weights = np.where(without, samples, 0) / samples[without].sum()
    intrinsic = float(weights @ means.friction_force)
    reductions = []
    for j, force in enumerate(means.friction_force):
        gradient = weights * force / intrinsic**2
        gradient[j] -= 1 / intrinsic
        reduction = float(friction_reduction(intrinsic_friction_force=intrinsic, reduced_friction_force=float(force)))
        reductions.append((reduction, float(np.sqrt(gradient @ means.covariance @ gradient))))
    return reductions


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
