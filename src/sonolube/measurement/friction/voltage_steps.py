"""Friction and its reduction at each step of a drive voltage that is raised in steps."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.ndimage import maximum_filter1d, minimum_filter1d

from sonolube.checks import Floats, require_finite, require_positive
from sonolube.errors import InvalidInput
from sonolube.facts.metrics import friction_reduction
from sonolube.measurement.friction.force_cycle import StickSlipEstimate, not_detected
from sonolube.measurement.friction.rotation import CLOCK_UNCERTAINTY
from sonolube.measurement.friction.sliding import sliding_steps
from sonolube.measurement.friction.step_means import (
    SampledParts,
    StepMeans,
    mean_of_parts,
    sampled_parts,
    without_wobble,
    wobble_columns,
)
from sonolube.measurement.friction.stick_slip import stick_slip_of_parts
from sonolube.measurement.friction.wobble import harmonic_columns
from sonolube.measurement.statistics.autocorrelation import correlated_mean, correlated_regression
from sonolube.measurement.time_series import require_equal_length, require_time_series, uniform_sample_interval

_MIN_AT_REST = 20  # samples, from which their mean tells the zero of the force
_TENSION = 0.3  # of the highest level, above which a force at rest is that of a holder under tension, not a zero
_SAME_SPEED = 0.05  # relative deviation of speeds that are the same


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
    sliding_speed : float or None
        Median over the step; None where it is not known. [m/s]
    friction_reduction : float or None
        Against the steps without voltage at the same speed; None for these themselves and where there are none. []
    friction_reduction_uncertainty : float or None
        Its standard uncertainty. []
    force_zero : float
        Mean force at rest that was taken off; 0 where none is known by a speed. [N]
    stick_slip : StickSlipEstimate
        In the step after the settling time, without wobble.
    """

    voltage_peak_to_peak: float
    start_time: float
    end_time: float
    friction_force: float
    friction_force_deviation: float
    friction_force_uncertainty: float
    sliding_speed: float | None
    friction_reduction: float | None
    friction_reduction_uncertainty: float | None
    force_zero: float
    stick_slip: StickSlipEstimate


def voltage_envelope(*, time: ArrayLike, stack_voltage: ArrayLike, window_duration: float = 0.05) -> Floats:
    """Peak-to-peak envelope of an alternating voltage by moving maximum and minimum. [V]

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
    sliding_speed: ArrayLike | None = None,
    harmonics: int = 3,
    stated_steps: ArrayLike | None = None,
) -> tuple[VoltageStep, ...]:
    r"""Mean friction, friction reduction and stick-slip at each step of a voltage.

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
        recording, and a twentieth; without it the rotation is sought in the force. []
    sliding_speed : array_like, shape (samples,), or None
        Measured or set, of one direction: rest is left out by it, and a change begins another step. Without it rest is
        told by the force at the steps without voltage, see `at_rest`. [m/s]
    harmonics : int
        Number of harmonics of the rotation that are taken off.
    stated_steps : array_like, shape (samples,), or None
        Number of the step at each sample, 0 for none, in place of the steps of the voltage.

    Returns
    -------
    tuple of VoltageStep
        In order of time.

    Raises
    ------
    InvalidInput
        If no step in which the surfaces slide is long enough, or the friction without voltage is not positive.

    See Also
    --------
    mean_of_parts : the means and their uncertainty, wobble, run-in, drift and stick-slip taken off jointly.
    stick_slip_of_parts : stick-slip in the steps.

    Notes
    -----
    Settling begins where the voltage or the speed changes, or where sliding begins, so that a break-away peak is in no
    mean. With the mean :math:`F_0` of the steps without voltage at the same speed, weighted by their duration, and the
    covariance C of the means,

    .. math:: P_f = 1 - \frac{F_1}{F_0} , \qquad u_P^2 = g^T C g , \qquad g = \nabla P_f .

    The mean force at rest before the first step, r, is the zero of the force where a speed tells that rest, and is
    taken off; its variance :math:`u_r^2` is added to all elements of C. A force at rest above 0.3 of the level, and
    above its own standard deviation, is no zero: the holder is under tension.

    A step shorter than a revolution is as uncertain as its part of the wobble, which the other steps determine.

    References
    ----------
    .. [1] D 2.1, D 4.1.2, figure 4.3 and Table 4.2.

    Examples
    --------
    >>> import numpy as np
    >>> from sonolube.measurement import friction_at_voltage_steps
    >>> time = np.arange(0, 90, 0.1)
    >>> voltage = np.where((time > 30) & (time < 60), 28.0, 0.0)
    >>> steps = friction_at_voltage_steps(time=time, friction_force=1.0 - voltage / 56, voltage_peak_to_peak=voltage)
    >>> [(step.voltage_peak_to_peak, round(step.friction_force, 3)) for step in steps]
    [(0.0, 1.0), (28.0, 0.5), (0.0, 1.0)]
    """
    t, f, u = require_time_series(time=time, friction_force=friction_force, voltage_peak_to_peak=voltage_peak_to_peak)
    v = None if sliding_speed is None else require_time_series(time=time, sliding_speed=sliding_speed)[1]
    stated = None if stated_steps is None else require_finite(stated_steps=stated_steps)
    rules = {"shortest_step": shortest_step, "settling_time": settling_time, "tolerance": tolerance}
    found = sliding_steps(t, f, u, v, stated=stated, **rules)
    parts = sampled_parts(found.settled, time=t, friction_force=f)
    turned = None if revolutions is None else _of_parts(f, require_finite(revolutions=revolutions), found.settled)
    places = None if v is None else _of_parts(f, _slid(t, v), found.settled)
    waves = wobble_columns(parts, revolutions=turned, places=places, harmonics=harmonics)[0]
    stick_slip = _stick_slip(parts, without_wobble(parts, waves))
    means = mean_of_parts(parts, waves=waves, stick_slip=stick_slip, onset=float(t[found.steps[0][0]]))
    zero, variance = (0.0, 0.0) if v is None else _zero(found.at_rest, means.friction_force)
    means = StepMeans(friction_force=means.friction_force - zero, covariance=means.covariance + variance)
    without = np.array(found.voltages) <= found.threshold
    reductions = _reductions(means, without, found.speeds, np.array([part.size for part in parts.times]))
    return tuple(
        VoltageStep(
            voltage_peak_to_peak=found.voltages[j],
            start_time=float(t[first]),
            end_time=float(t[last - 1]),
            friction_force=float(means.friction_force[j]),
            friction_force_deviation=float(np.std(parts.forces[j], ddof=1)),
            friction_force_uncertainty=float(np.sqrt(means.covariance[j, j])),
            sliding_speed=None if v is None else found.speeds[j],
            friction_reduction=reductions[j][0],
            friction_reduction_uncertainty=reductions[j][1],
            force_zero=zero,
            stick_slip=stick_slip[j],
        )
        for j, (first, last) in enumerate(found.steps)
    )


def rotation_speed_at_voltage_steps(
    *, time: ArrayLike, friction_force: ArrayLike, voltage_peak_to_peak: ArrayLike, harmonics: int = 3
) -> float | None:
    """Rotational speed of the disc by the wobble in its friction; None where none stands out. [1/s]

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
    found = sliding_steps(t, f, u, None, shortest_step=1.0, settling_time=0.5, tolerance=0.05)
    parts = sampled_parts(found.settled, time=t, friction_force=f)
    return wobble_columns(parts, revolutions=None, harmonics=harmonics)[1] or None


def rotation_speed_uncertainty(
    *, time: Floats, friction_force: Floats, voltage_peak_to_peak: Floats, rotation_speed: float, harmonics: int = 3
) -> float:
    r"""Standard uncertainty of a rotational speed that was found by the wobble at voltage steps. [1/s]

    With the harmonics at the speed :math:`n` that was found, it is the standard error of the coefficient of the column

    .. math:: \frac{\partial F}{\partial n} = 2 \pi t \sum_k k (b_k \cos k\theta - a_k \sin k\theta)

    beside them and the levels, in white and red noise, together with that of the clock of the recording.
    """
    found = sliding_steps(
        time, friction_force, voltage_peak_to_peak, None, shortest_step=1.0, settling_time=0.5, tolerance=0.05
    )
    parts = sampled_parts(found.settled, time=time, friction_force=friction_force)
    times, values = parts.averaged(parts.times), parts.averaged(parts.forces)
    waves = [harmonic_columns(revolutions=rotation_speed * t, harmonics=harmonics) for t in times]
    levels = np.eye(len(values))
    columns = [np.column_stack([np.tile(levels[j], (t.size, 1)), waves[j]]) for j, t in enumerate(times)]
    fit = correlated_regression(values, columns)
    cosines, sines = np.split(fit.coefficients[len(values) :], 2)
    order = np.arange(1, harmonics + 1)
    turned = np.concatenate([order * sines, -order * cosines])
    slopes = [2 * np.pi * t * (wave @ turned) for t, wave in zip(times, waves, strict=True)]
    fit = correlated_regression(values, [np.column_stack(both) for both in zip(columns, slopes, strict=True)])
    return float(np.hypot(np.sqrt(fit.covariance[-1, -1]), CLOCK_UNCERTAINTY * rotation_speed))


def _of_parts(f: Floats, values: Floats, parts: Sequence[slice]) -> list[Floats]:
    """Values at the samples with a known force of each part."""
    require_equal_length(friction_force=f, revolutions=values)
    return [values[part][np.isfinite(f[part])] for part in parts]


def _slid(t: Floats, v: Floats) -> Floats:
    """Distance slid until each sample over the mean speed while sliding, as a time. [s]"""
    known = np.isfinite(v)
    speed = np.interp(t, t[known], np.abs(v[known]))
    moving = speed > 0
    distance = np.concatenate([[0.0], np.cumsum((speed[1:] + speed[:-1]) / 2 * np.diff(t))])
    return np.asarray(distance / float(speed[moving].mean()) if moving.any() else t - t[0])


def _zero(at_rest: Floats, levels: Floats) -> tuple[float, float]:
    """Zero of the force and its variance, by its mean at rest."""
    if at_rest.size < _MIN_AT_REST:
        return 0.0, 0.0
    mean = correlated_mean(at_rest)
    if abs(mean.mean) > max(_TENSION * float(np.max(np.abs(levels))), mean.deviation):
        return 0.0, 0.0
    return mean.mean, mean.uncertainty**2


def _stick_slip(parts: SampledParts, forces: Sequence[Floats]) -> list[StickSlipEstimate]:
    """Stick-slip of each step; a reason where the samples are uneven or too few."""
    try:
        return stick_slip_of_parts(parts.times, forces)
    except InvalidInput as refusal:
        return [not_detected(str(refusal), 0.0) for _ in parts.times]


def _reductions(
    means: StepMeans, without: NDArray[np.bool_], speeds: Sequence[float], samples: NDArray[np.int64]
) -> list[tuple[float | None, float | None]]:
    """Friction reduction of each part and its standard uncertainty, by the parts of its speed."""
    reductions: list[tuple[float | None, float | None]] = []
    for j, force in enumerate(means.friction_force):
        same = without & np.isclose(speeds, speeds[j], rtol=_SAME_SPEED, equal_nan=True)
        if without[j] or not same.any():
            reductions.append((None, None))
            continue
        weights = np.where(same, samples, 0) / samples[same].sum()
        intrinsic = float(weights @ means.friction_force)
        gradient = weights * force / intrinsic**2
        gradient[j] -= 1 / intrinsic
        reduction = float(friction_reduction(intrinsic_friction_force=intrinsic, reduced_friction_force=float(force)))
        reductions.append((reduction, float(np.sqrt(gradient @ means.covariance @ gradient))))
    return reductions
