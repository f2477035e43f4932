"""Rotation of a disc from the pulses of magnets at its rim, and friction force from the current of its motor."""

from dataclasses import dataclass
from math import sqrt
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import stats
from scipy.interpolate import PchipInterpolator
from scipy.signal import find_peaks

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive, require_within
from sonolube.errors import InvalidInput
from sonolube.facts.metrics import friction_from_current, linear_speed
from sonolube.measurement.time_series import require_time_series

_MULTIPLE_TOLERANCE = 0.25  # relative deviation of an interval with missing pulses from a multiple of its neighbours
_MAX_MISSING = 5  # consecutive pulses


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class DiscRotation:
    """Rotation of a disc: pulse times, revolutions and speeds.

    Parameters
    ----------
    time : ndarray, shape (pulses,)
        Time of the peak of each pulse. [s]
    revolutions : ndarray, shape (pulses,)
        Revolutions since the first pulse. []
    interpolated : ndarray of bool, shape (pulses,)
        Whether a pulse was missing and its time interpolated between its neighbours.
    rotation_speed : ndarray, shape (turns,)
        Rotational speed over each revolution, from a pulse to the next of the same magnet. [1/s]
    sliding_speed : ndarray, shape (turns,)
        Speed at the wear track. [m/s]
    mean_rotation_speed : float
        Revolutions over time from the first to the last pulse, in 1/s.
    rotation_speed_uncertainty : float
        Standard uncertainty of that mean, by the times of its two pulses and the clock of the recording. [1/s]
    """

    time: Floats
    revolutions: Floats
    interpolated: NDArray[np.bool_]
    rotation_speed: Floats
    sliding_speed: Floats
    mean_rotation_speed: float
    rotation_speed_uncertainty: float


def hall_pulse_times(*, time: ArrayLike, magnetic_flux_density: ArrayLike, prominence: float = 0.25) -> Floats:
    """Times of the pulses in a Hall probe signal by peak detection with parabolic interpolation. [s]

    Parameters
    ----------
    time : array_like, shape (samples,)
        Increasing. [s]
    magnetic_flux_density : array_like, shape (samples,)
        Reading of the probe, of either sign; any unit is accepted. [T]
    prominence : float
        Prominence of the weakest pulse that counts, as a fraction of the strongest; lower it for unequal magnets.

    Returns
    -------
    ndarray, shape (pulses,)
        Between samples, at the vertex of a parabola through the highest three.

    Raises
    ------
    InvalidInput
        If the reading does not vary, or no pulse has the prominence.
    """
    require_within(0.01, 1.0, prominence=prominence)
    t, b = require_time_series(time=time, magnetic_flux_density=magnetic_flux_density)
    known = np.isfinite(b)
    t, b = t[known], b[known] - np.median(b[known])
    b = b if b.max() >= -b.min() else -b  # a magnet of reversed polarity gives negative pulses
    if b.max() <= 0:
        raise InvalidInput("magnetic_flux_density does not vary")
    peaks = find_peaks(b, prominence=prominence * float(b.max()), plateau_size=1)[0]
    if not peaks.size:
        raise InvalidInput("magnetic_flux_density shows no pulse")
    return _parabola_vertices(t, b, peaks)


def _parabola_vertices(t: Floats, b: Floats, peaks: NDArray[np.int64]) -> Floats:
    """Times of the vertices of parabolas through each peak sample and its neighbours."""
    before, at, after = b[peaks - 1], b[peaks], b[peaks + 1]
    left, right = t[peaks] - t[peaks - 1], t[peaks + 1] - t[peaks]
    rise, fall = (at - before) / left, (at - after) / right
    shift = 0.5 * (rise * right - fall * left) / np.where(rise + fall > 0, rise + fall, np.inf)
    return np.asarray(t[peaks] + shift)


_MIN_SECOND: Final = 2  # second differences that tell a scatter
_CORRELATED: Final = 1 + 2 * ((2 / 3) ** 2 + (1 / 6) ** 2)  # of them over independent ones, by their correlations

CLOCK_UNCERTAINTY: Final = 5e-5 / sqrt(3)
"""Relative standard uncertainty of the clock of a recording: within 50 parts in a million, as makers of cards state."""


def disc_rotation(
    *, time: ArrayLike, groove_diameter: float, magnets: int = 1, sample_interval: float = 0.0
) -> DiscRotation:
    r"""Rotation of a disc from its pulse times, with missing pulses interpolated.

    Parameters
    ----------
    time : array_like, shape (pulses,)
        Times of the pulses, from `hall_pulse_times`. [s]
    groove_diameter : float
        Diameter of the wear track under the pin. [m]
    magnets : int
        Number of magnets at the rim; they need not be equal in strength or spacing.
    sample_interval : float
        Between samples of the probe; 0 where it is not known. [s]

    Returns
    -------
    DiscRotation

    Raises
    ------
    InvalidInput
        If the times do not increase, there are fewer pulses than a revolution needs, or `magnets` is not positive.

    Notes
    -----
    With one magnet, an interval that is a whole multiple of both its neighbours, within 25 %, has missing pulses: a
    change of speed differs from one neighbour only. With several magnets, their fractions of a revolution are
    identified where two consecutive revolutions are most alike, and an interval that matches the sum of several
    fractions has missing pulses. Each revolution is timed from a magnet to the same magnet, so that unequal spacing has
    no effect.

    The mean over N revolutions in the time T depends on the first and the last pulse alone, so that its uncertainty is

    .. math:: u_n = \frac{N}{T} \sqrt{\frac{2 u_t^2}{T^2} + u_c^2} ,

    with that of the clock, :math:`u_c`, and that of the time of a pulse, :math:`u_t`: of second differences of pulses
    of one magnet the mean square is :math:`6 u_t^2` at steady speed, which Student's factor widens where they are few.
    It is at least that of a count, the sample interval over :math:`\sqrt{12}`, and that alone where no magnet has
    passed four times.

    References
    ----------
    .. [1] D 4.1.1 and appendix A 2.1.8.
    """
    t = require_finite(time=time)
    require_positive(groove_diameter=groove_diameter)
    require_non_negative(sample_interval=sample_interval)
    if magnets < 1:
        raise InvalidInput(f"magnets must be positive, got {magnets}")
    if t.ndim != 1 or t.size < magnets + 1:
        raise InvalidInput(f"a revolution needs {magnets + 1} pulses, got {t.size}")
    if np.any(np.diff(t) <= 0):
        raise InvalidInput("time of the pulses must increase")
    fractions, steps = (np.ones(1), _steps_of_one_magnet(t)) if magnets == 1 else _fractions_and_steps(t, magnets)
    times, interpolated = _with_missing_pulses(t, steps, fractions)
    position = np.concatenate([[0.0], np.cumsum(np.resize(fractions, times.size - 1))])
    speed = 1 / (times[magnets:] - times[:-magnets])
    lasts = float(times[-1] - times[0])
    mean, pulse = float(position[-1]) / lasts, _pulse_uncertainty(times, interpolated, magnets, sample_interval)
    return DiscRotation(
        time=times,
        revolutions=position,
        interpolated=interpolated,
        rotation_speed=speed,
        sliding_speed=linear_speed(rotation_speed=speed, groove_diameter=groove_diameter),
        mean_rotation_speed=mean,
        rotation_speed_uncertainty=mean * sqrt(2 * (pulse / lasts) ** 2 + CLOCK_UNCERTAINTY**2),
    )


def _pulse_uncertainty(times: Floats, interpolated: NDArray[np.bool_], magnets: int, sample_interval: float) -> float:
    """Standard uncertainty of the time of a pulse, by second differences over whole turns and the samples. [s]"""
    known = np.where(interpolated, np.nan, times)
    second = known[2 * magnets :] - 2 * known[magnets:-magnets] + known[: -2 * magnets]
    second = second[np.isfinite(second)]
    scatter = 0.0
    if second.size >= _MIN_SECOND:
        freedom = second.size / _CORRELATED
        few = float(stats.t.ppf(0.975, freedom) / stats.norm.ppf(0.975))
        scatter = few * sqrt(float(np.mean(second**2)) / 6)
    return max(scatter, sample_interval / sqrt(12))


def _steps_of_one_magnet(t: Floats) -> NDArray[np.int64]:
    """Number of revolutions between neighbouring pulses of one magnet."""
    interval = np.diff(t)
    if interval.size < 2:
        return np.ones(interval.size, dtype=np.int64)
    before = np.concatenate([interval[1:2], interval[:-1]])
    after = np.concatenate([interval[1:], interval[-2:-1]])
    multiple = np.round(interval / np.maximum(before, after)).astype(np.int64)
    fits = [np.abs(interval / other - multiple) <= _MULTIPLE_TOLERANCE * multiple for other in (before, after)]
    missing = fits[0] & fits[1] & (multiple > 1) & (multiple <= _MAX_MISSING + 1)
    return np.where(missing, multiple, 1)


def _fractions_and_steps(t: Floats, magnets: int) -> tuple[Floats, NDArray[np.int64]]:
    """Fractions of a revolution from the first pulse's magnet on, and the magnets passed per interval."""
    interval = np.diff(t)
    first = 0
    revolution = interval[:magnets]
    if interval.size >= 2 * magnets:  # identify the fractions where two consecutive revolutions are most alike
        windows = np.lib.stride_tricks.sliding_window_view(interval, magnets)
        current, following = windows[:-magnets], windows[magnets:]
        first = int(np.argmin(np.max(np.abs(current - following) / (current + following), axis=1)))
        revolution = (current[first] + following[first]) / 2
    duration = float(revolution.sum())
    fractions = revolution / duration
    backward = _magnets_passed(interval[:first][::-1], fractions[::-1], duration)[::-1]
    steps = np.concatenate([backward, _magnets_passed(interval[first:], fractions, duration)])
    return np.roll(fractions, int(backward.sum()) % magnets), steps


def _magnets_passed(interval: Floats, fractions: Floats, duration: float) -> NDArray[np.int64]:
    """Number of magnets that pass in each interval, for slowly varying durations of a revolution."""
    steps = np.ones(interval.size, dtype=np.int64)
    magnet = 0
    for i, dt in enumerate(interval):
        passed = np.cumsum(np.resize(np.roll(fractions, -magnet), _MAX_MISSING + 1))
        steps[i] = int(np.argmin(np.abs(np.log(dt / duration / passed)))) + 1
        duration = float(dt / passed[steps[i] - 1])
        magnet = (magnet + int(steps[i])) % fractions.size
    return steps


def _with_missing_pulses(t: Floats, steps: NDArray[np.int64], fractions: Floats) -> tuple[Floats, NDArray[np.bool_]]:
    """Times of all pulses, the missing ones interpolated, and which these are."""
    index = np.concatenate([[0], np.cumsum(steps)])
    every = np.arange(index[-1] + 1)
    position = np.concatenate([[0.0], np.cumsum(np.resize(fractions, every.size - 1))])
    return np.asarray(np.interp(position, position[index], t)), ~np.isin(every, index)


def revolutions_at(rotation: DiscRotation, *, time: ArrayLike) -> Floats:
    """Revolutions made since the first pulse, by monotone cubic (PCHIP) interpolation between pulses. []

    Parameters
    ----------
    rotation : DiscRotation
    time : array_like, any shape
        Times; before the first and after the last pulse the speed is that of the nearest revolution. [s]

    Returns
    -------
    ndarray, shape of `time`
    """
    t = require_finite(time=time)
    pulse_time, revolutions = rotation.time, rotation.revolutions
    within = PchipInterpolator(pulse_time, revolutions)(np.clip(t, pulse_time[0], pulse_time[-1]))
    before = revolutions[0] + (t - pulse_time[0]) * rotation.rotation_speed[0]
    after = revolutions[-1] + (t - pulse_time[-1]) * rotation.rotation_speed[-1]
    return np.asarray(np.where(t < pulse_time[0], before, np.where(t > pulse_time[-1], after, within)))


@dataclass(frozen=True, kw_only=True, slots=True)
class MotorCalibration:
    """Torque constant and idle current of the motor that drives a disc, with their uncertainties.

    Parameters
    ----------
    torque_constant : float
        Torque at the disc per current, gear included. [N m/A]
    idle_current : float
        Current at the same speed with the pin lifted. [A]
    groove_diameter : float
        Diameter of the wear track under the pin. [m]
    torque_constant_uncertainty : float
        Standard uncertainty. [N m/A]
    idle_current_uncertainty : float
        Standard uncertainty. [A]

    Raises
    ------
    InvalidInput
        If the torque constant or the diameter is not positive, or another value negative.
    """

    torque_constant: float
    idle_current: float
    groove_diameter: float
    torque_constant_uncertainty: float = 0.0
    idle_current_uncertainty: float = 0.0

    def __post_init__(self) -> None:
        require_positive(torque_constant=self.torque_constant, groove_diameter=self.groove_diameter)
        require_non_negative(
            idle_current=self.idle_current,
            torque_constant_uncertainty=self.torque_constant_uncertainty,
            idle_current_uncertainty=self.idle_current_uncertainty,
        )


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class MotorFrictionTrace:
    """Friction force over time from the motor current.

    Parameters
    ----------
    time : ndarray, shape (windows,)
        Middle of each window. [s]
    friction_force : ndarray, shape (windows,)
        Mean in each window. [N]
    friction_force_uncertainty : ndarray, shape (windows,)
        Standard uncertainty, including the scatter of the current in the window. [N]
    """

    time: Floats
    friction_force: Floats
    friction_force_uncertainty: Floats


def friction_from_motor_current(
    motor: MotorCalibration, *, motor_current: ArrayLike, motor_current_uncertainty: ArrayLike = 0.0
) -> tuple[Floats, Floats]:
    r"""Friction force from the motor current at constant speed, and its standard uncertainty. [N]

    Parameters
    ----------
    motor : MotorCalibration
    motor_current : array_like, any shape
        Current of the motor. [A]
    motor_current_uncertainty : array_like, broadcast against `motor_current`
        Its standard uncertainty. [A]

    Returns
    -------
    friction_force : ndarray, shape of `motor_current`
        Negative below the idle current. [N]
    friction_force_uncertainty : ndarray, shape of the broadcast arguments
        Its standard uncertainty. [N]

    Raises
    ------
    InvalidInput
        If a current is not finite, or an uncertainty negative.

    See Also
    --------
    friction_from_current : the force for constants without a calibration record.

    Notes
    -----
    First-order propagation of uncertainty:

    .. math::

        F_t = \frac{k_m (I_m - I_0)}{D_g/2} , \qquad
        u_F^2 = \left( \frac{2}{D_g} \right)^2 \left[ k_m^2 (u_I^2 + u_{I0}^2) + (I_m - I_0)^2 u_K^2 \right] .

    At constant speed only: an accelerating disc takes current of its own, and the idle current belongs to one speed.

    References
    ----------
    .. [1] D 2.4.4, where the motor's current falls by 0.4 A with the friction.
    """
    current = require_finite(motor_current=motor_current)
    current_uncertainty = np.hypot(
        require_non_negative(motor_current_uncertainty=motor_current_uncertainty), motor.idle_current_uncertainty
    )
    torque_uncertainty = np.hypot(
        motor.torque_constant * current_uncertainty, motor.torque_constant_uncertainty * (current - motor.idle_current)
    )
    friction_force = friction_from_current(
        torque_constant=motor.torque_constant,
        motor_current=current,
        idle_current=motor.idle_current,
        groove_diameter=motor.groove_diameter,
    )
    return friction_force, np.asarray(torque_uncertainty / (motor.groove_diameter / 2))
