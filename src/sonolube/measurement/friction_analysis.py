"""Friction analyses of a recording (xarray dataset): one function per analysis, each returning a record."""

from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.integrate import cumulative_trapezoid

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput, suggestion
from sonolube.measurement.friction.force_cycle import StickSlipEstimate
from sonolube.measurement.friction.loops import FrictionLoops, FrictionWork, friction_loops, friction_work
from sonolube.measurement.friction.rotation import (
    DiscRotation,
    MotorCalibration,
    MotorFrictionTrace,
    disc_rotation,
    friction_from_motor_current,
    hall_pulse_times,
    revolutions_at,
)
from sonolube.measurement.friction.stated_parts import STATED_STEP
from sonolube.measurement.friction.stick_slip import estimate_stick_slip
from sonolube.measurement.friction.voltage_steps import (
    VoltageStep,
    friction_at_voltage_steps,
    rotation_speed_at_voltage_steps,
    rotation_speed_uncertainty,
)
from sonolube.measurement.friction.windows import (
    DEFAULT_WINDOW_DURATION,
    SteadyStateOnset,
    WindowStatistics,
    steady_state_onset,
    window_statistics,
)
from sonolube.measurement.friction.wobble import WobbleCorrection, remove_wobble
from sonolube.measurement.recorded_conditions import (
    recorded_speed,
    recorded_voltage,
    speed_changes,
    speed_channel,
    speed_of_one_direction,
)

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True, kw_only=True, slots=True)
class RunningIn:
    """Friction in windows, with the onset of the steady state of its mean and of its fluctuation.

    Parameters
    ----------
    windows : WindowStatistics
        Friction in consecutive windows.
    friction : SteadyStateOnset
        Of the windows' means.
    fluctuation : SteadyStateOnset
        Of the fluctuation in the windows, which takes longer when the pin vibrates.
    """

    windows: WindowStatistics
    friction: SteadyStateOnset
    fluctuation: SteadyStateOnset


@dataclass(frozen=True, kw_only=True, slots=True)
class FrictionCycles:
    """Frictional work of a whole recording and, for a reciprocating motion, of each cycle.

    Parameters
    ----------
    work : FrictionWork
        Along the recording.
    loops : FrictionLoops or None
        Cycle by cycle; None where the velocity does not turn positive twice.
    """

    work: FrictionWork
    loops: FrictionLoops | None


def channel_values(recording: "xr.Dataset", name: str) -> Floats:
    """Values of a channel, or of the axis, of a recording.

    Parameters
    ----------
    recording : xarray.Dataset
    name : str
        Of the channel, or "time".

    Returns
    -------
    ndarray, shape (samples,)

    Raises
    ------
    InvalidInput
        If the recording has no such channel, with those it has.
    """
    if name not in recording.variables:
        names = [str(known) for known in recording.variables]
        file = recording.attrs.get("file_name", "the recording")
        known = suggestion(name, names) or "it has " + ", ".join(map(repr, names))
        raise InvalidInput(f"{file} has no channel {name!r}; {known}; sonolube mapping states which column it is")
    values: Floats = recording[name].to_numpy()
    return values


def _channels(recording: "xr.Dataset", *names: str) -> dict[str, Floats]:
    """Values of channels by their names, and the time."""
    return {name: channel_values(recording, name) for name in ("time", *names)}


def analyse_windows(
    recording: "xr.Dataset", *, of: str = "friction_force", window_duration: float = DEFAULT_WINDOW_DURATION
) -> WindowStatistics:
    """Mean and fluctuation of a channel in consecutive windows.

    Parameters
    ----------
    recording : xarray.Dataset
    of : str
        Name of the channel.
    window_duration : float
        Duration of each window. [s]

    Returns
    -------
    WindowStatistics

    See Also
    --------
    window_statistics : of arrays.
    """
    return window_statistics(
        channel_values(recording, of),
        time=channel_values(recording, "time"),
        window_duration=window_duration,
        channel=of,
        unit=str(recording[of].attrs.get("units", "")),
    )


def analyse_running_in(
    recording: "xr.Dataset", *, sliding_speed: float, window_duration: float = DEFAULT_WINDOW_DURATION
) -> RunningIn:
    """Onset of the steady state of friction and of its fluctuation.

    Parameters
    ----------
    recording : xarray.Dataset
        With `friction_force`.
    sliding_speed : float
        Sliding speed. [m/s]
    window_duration : float
        Duration of each window. [s]

    Returns
    -------
    RunningIn
        After D 2.3.3, Table 2.3.

    See Also
    --------
    steady_state_onset : of arrays.
    """
    windows = analyse_windows(recording, window_duration=window_duration)
    friction, fluctuation = (
        steady_state_onset(time=windows.time, friction_force=values, sliding_speed=sliding_speed)
        for values in (windows.mean, windows.fluctuation)
    )
    return RunningIn(windows=windows, friction=friction, fluctuation=fluctuation)


def analyse_voltage_steps(
    recording: "xr.Dataset",
    *,
    shortest_step: float = 1.0,
    settling_time: float = 0.5,
    rotation: DiscRotation | None = None,
    rotation_speed: float | None = None,
    groove_diameter: float | None = None,
) -> tuple[VoltageStep, ...]:
    """Friction, its reduction and stick-slip at each step of the drive voltage.

    Parameters
    ----------
    recording : xarray.Dataset
        With `friction_force`, and `voltage_peak_to_peak` or `stack_voltage`; a channel of the speed tells rest.
    shortest_step : float
        Duration in seconds below which a level is a transition, not a step.
    settling_time : float
        Left out at the beginning of each step. [s]
    rotation : DiscRotation or None
        From `analyse_rotation`, to take off the wobble of the disc.
    rotation_speed : float or None
        Instead of it, where the speed is constant. [1/s]
    groove_diameter : float or None
        Instead of both, of the wear track: the sliding speed of a channel, or of the motor as set, tells the
        revolutions. The rotation is found in the friction without all three, and where no channel has a speed. [m]

    Returns
    -------
    tuple of VoltageStep

    Raises
    ------
    InvalidInput
        If more than one of the last three is given, or `groove_diameter` is not positive.

    References
    ----------
    .. [1] D 4.1.2, figure 4.3, Table 4.2.
    """
    t = channel_values(recording, "time")
    if sum(each is not None for each in (rotation, rotation_speed, groove_diameter)) > 1:
        raise InvalidInput("give one of rotation, from the pulses, a constant rotation_speed, and groove_diameter")
    revolutions = None
    if rotation is not None:
        revolutions = revolutions_at(rotation, time=t)
    elif rotation_speed is not None:
        revolutions = rotation_speed * (t - t[0])
    elif groove_diameter is not None:
        revolutions = _slid_revolutions(recording, groove_diameter)
    return friction_at_voltage_steps(
        time=t,
        friction_force=channel_values(recording, "friction_force"),
        voltage_peak_to_peak=_voltage(recording),
        shortest_step=shortest_step,
        settling_time=settling_time,
        revolutions=revolutions,
        sliding_speed=speed_of_one_direction(recording),
        stated_steps=channel_values(recording, STATED_STEP) if STATED_STEP in recording else None,
    )


def _slid_revolutions(recording: "xr.Dataset", groove_diameter: float) -> Floats | None:
    """Revolutions made until each sample by the sliding speed; None where no channel tells it."""
    require_positive(groove_diameter=groove_diameter)
    name, speed = speed_channel(recording), recorded_speed(recording)
    if speed is None or name not in ("relative_velocity", "sliding_speed", "sliding_speed_set"):
        return None
    t, known = channel_values(recording, "time"), np.isfinite(speed)
    steady = np.interp(t, t[known], np.abs(speed[known]))
    return np.asarray(cumulative_trapezoid(steady, t, initial=0.0) / (np.pi * groove_diameter))


def analyse_rotation_speed(recording: "xr.Dataset") -> float | None:
    """Rotational speed of the disc by the wobble in its friction at voltage steps; None where unknown. [1/s]

    Parameters
    ----------
    recording : xarray.Dataset
        With `friction_force`, and `voltage_peak_to_peak` or the alternating `stack_voltage`.

    Returns
    -------
    float or None
        None, too, where a channel shows that the speed changes.
    """
    if speed_changes(recording):
        return None
    return rotation_speed_at_voltage_steps(
        time=channel_values(recording, "time"),
        friction_force=channel_values(recording, "friction_force"),
        voltage_peak_to_peak=_voltage(recording),
    )


def analyse_rotation_speed_uncertainty(recording: "xr.Dataset", *, rotation_speed: float) -> float:
    """Standard uncertainty of the rotational speed that `analyse_rotation_speed` found in a recording. [1/s]"""
    return rotation_speed_uncertainty(
        time=channel_values(recording, "time"),
        friction_force=channel_values(recording, "friction_force"),
        voltage_peak_to_peak=_voltage(recording),
        rotation_speed=rotation_speed,
    )


def _voltage(recording: "xr.Dataset") -> Floats:
    """Peak-to-peak voltage of a recording; refuse one without, with the channels it has."""
    voltage = recorded_voltage(recording)
    return channel_values(recording, "stack_voltage") if voltage is None else voltage


def analyse_cycles(recording: "xr.Dataset") -> FrictionCycles:
    """Frictional work of a recording, and that of each cycle of a reciprocating motion.

    Parameters
    ----------
    recording : xarray.Dataset
        With `friction_force` and `relative_velocity`.

    Returns
    -------
    FrictionCycles

    References
    ----------
    .. [1] D 4.5.4, figure 4.57.
    """
    signals, loops = _channels(recording, "friction_force", "relative_velocity"), None
    with suppress(InvalidInput):  # of a single stroke, such as a rod pulled through a ring
        loops = friction_loops(**signals)
    return FrictionCycles(work=friction_work(**signals), loops=loops)


def analyse_stick_slip(recording: "xr.Dataset", *, minimum_drop: float | None = None) -> StickSlipEstimate:
    """Whether there is stick-slip, its frequency, the fall of the force in a slip, and when it happens.

    Parameters
    ----------
    recording : xarray.Dataset
        With `friction_force`; it is cut at gaps.
    minimum_drop : float or None
        Smallest mean fall, in N, that counts as stick-slip.

    Returns
    -------
    StickSlipEstimate

    See Also
    --------
    estimate_stick_slip : of arrays.
    analyse_voltage_steps : in a recording with steps of the voltage.

    References
    ----------
    .. [1] D 2.3.2 to 2.3.4.
    """
    return estimate_stick_slip(**_channels(recording, "friction_force"), minimum_drop=minimum_drop)


def analyse_rotation(
    recording: "xr.Dataset", *, groove_diameter: float, magnets: int = 1, prominence: float = 0.25
) -> DiscRotation:
    """Rotation of the disc from a Hall probe signal.

    Parameters
    ----------
    recording : xarray.Dataset
        With `magnetic_flux_density`.
    groove_diameter : float
        Diameter of the wear track under the pin. [m]
    magnets : int
        Number of magnets at the rim.
    prominence : float
        Prominence of the weakest pulse that counts, as a fraction of the strongest.

    Returns
    -------
    DiscRotation

    See Also
    --------
    hall_pulse_times, disc_rotation : of arrays.

    References
    ----------
    .. [1] D 4.1.1.
    """
    pulses = hall_pulse_times(**_channels(recording, "magnetic_flux_density"), prominence=prominence)
    time = channel_values(recording, "time")
    interval = float(time[-1] - time[0]) / max(time.size - 1, 1)
    return disc_rotation(time=pulses, groove_diameter=groove_diameter, magnets=magnets, sample_interval=interval)


def analyse_wobble(
    recording: "xr.Dataset",
    *,
    rotation: DiscRotation | None = None,
    rotation_speed: float | None = None,
    harmonics: int = 3,
) -> WobbleCorrection:
    """Friction force without its harmonics of the rotation, which the disc's wobble causes.

    Parameters
    ----------
    recording : xarray.Dataset
        With `friction_force`.
    rotation : DiscRotation or None
        From `analyse_rotation`.
    rotation_speed : float or None
        Instead of it, where the speed is constant. [1/s]
    harmonics : int
        Number of harmonics of the rotation that are removed.

    Returns
    -------
    WobbleCorrection

    Raises
    ------
    InvalidInput
        If not exactly one of `rotation` and `rotation_speed` is given.

    References
    ----------
    .. [1] D 2.3.3 and 4.1.2 on the wobble of the disc.
    """
    time, force = channel_values(recording, "time"), channel_values(recording, "friction_force")
    if (rotation is None) == (rotation_speed is None):
        raise InvalidInput("give either rotation, from the pulses, or a constant rotation_speed")
    revolutions = (
        revolutions_at(rotation, time=time) if rotation is not None else (rotation_speed or 0.0) * (time - time[0])
    )
    return remove_wobble(revolutions=revolutions, friction_force=force, harmonics=harmonics)


def analyse_motor_current(
    recording: "xr.Dataset", *, motor: MotorCalibration, window_duration: float = DEFAULT_WINDOW_DURATION
) -> MotorFrictionTrace:
    """Friction force from the motor current in consecutive windows.

    Parameters
    ----------
    recording : xarray.Dataset
        With `motor_current`.
    motor : MotorCalibration
    window_duration : float
        Duration of each window. [s]

    Returns
    -------
    MotorFrictionTrace

    See Also
    --------
    friction_from_motor_current : of arrays.

    References
    ----------
    .. [1] D 2.4.4.
    """
    windows = analyse_windows(recording, of="motor_current", window_duration=window_duration)
    known = windows.samples > 1
    force, uncertainty = friction_from_motor_current(
        motor,
        motor_current=windows.mean[known],
        motor_current_uncertainty=windows.deviation[known] / windows.samples[known] ** 0.5,
    )
    return MotorFrictionTrace(time=windows.time[known], friction_force=force, friction_force_uncertainty=uncertainty)
