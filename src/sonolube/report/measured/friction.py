"""Recordings of friction as sheets: level, fluctuation, running-in, steps of voltage, stick-slip, work, wobble."""

import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sonolube.checks import require_positive
from sonolube.errors import InvalidInput
from sonolube.measurement.analysis import (
    analyse_cycles,
    analyse_motor_current,
    analyse_running_in,
    analyse_staircase,
    analyse_stick_slip,
    analyse_windows,
    analyse_wobble,
    channel,
)
from sonolube.measurement.friction.forces import MotorFriction
from sonolube.measurement.friction.steady_state import SteadyState, steady_state
from sonolube.measurement.friction.windows import DEFAULT_WINDOW, WindowStatistics, streamed_window_statistics
from sonolube.measurement.recordings.mapping import RecordingMapping
from sonolube.measurement.recordings.reader import format_of, read_recording
from sonolube.measurement.recordings.tdms import FORMAT as TDMS
from sonolube.measurement.statistics.correlation import correlated_mean
from sonolube.report.measured import friction_figures as figures
from sonolube.report.measured.sheet import (
    Sheet,
    SheetFigure,
    SheetSection,
    SheetTable,
    SheetValue,
    attempted_section,
    quantity_column,
    quantity_value,
    sheet_from_sections,
)
from sonolube.units import engineering

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

_LARGE = 1 << 29  # bytes of a TDMS file beyond which it is read in blocks, for its windows only
_CHANNELS = ("friction_force", "friction_coefficient")


@dataclass(frozen=True, kw_only=True, slots=True)
class FrictionSettings:
    """What the reduction of a friction recording depends on.

    Parameters
    ----------
    mapping : RecordingMapping or None
        What the columns mean.
    window_duration : float
        Duration of each window. [s]
    sliding_speed : float or None
        Speed of the sliding, for the distance to the steady state. [m/s]
    rotation_speed : float or None
        Turns per time, to take away what the disc's wobble adds. [1/s]
    motor : MotorFriction or None
        To tell friction by the motor's current.

    Raises
    ------
    InvalidInput
        If a duration or speed is not positive.
    """

    mapping: RecordingMapping | None = None
    window_duration: float = DEFAULT_WINDOW
    sliding_speed: float | None = None
    rotation_speed: float | None = None
    motor: MotorFriction | None = None

    def __post_init__(self) -> None:
        require_positive(window_duration=self.window_duration)
        if self.sliding_speed is not None:
            require_positive(sliding_speed=self.sliding_speed)
        if self.rotation_speed is not None:
            require_positive(rotation_speed=self.rotation_speed)


def friction_sheet(path: Path, *, settings: FrictionSettings) -> Sheet:
    """Return what a recording says of friction.

    Parameters
    ----------
    path : Path
        In any format of `read_recording`; TDMS larger than 512 MB is read in blocks, and only its windows are told.
    settings : FrictionSettings

    Returns
    -------
    Sheet

    Raises
    ------
    InvalidInput
        If the file cannot be read or records no friction.
    """
    if path.is_file() and path.stat().st_size > _LARGE and format_of(path) == TDMS:
        return _streamed(path, settings)
    recording = read_recording(path, mapping=settings.mapping)
    motor = settings.motor
    parts = _parts(recording, settings) if motor is None else [_motor(recording, settings, motor)]
    return sheet_from_sections(parts, title=path.name, source=recording_source(recording))


def recording_source(recording: "xr.Dataset") -> dict[str, str]:
    """Return where a recording came from, for its sheet."""
    attributes = recording.attrs
    rate, dropped = attributes.get("sample_rate"), int(attributes.get("dropped_samples", 0))
    return {
        "format": str(attributes.get("file_format", "")),
        "title": str(attributes.get("title", "")),
        "samples": f"{next(iter(recording.sizes.values()))}",
        "sample rate": engineering(float(rate), "Hz") if rate else "",
        "dropped samples": f"{dropped}" if dropped else "",
        "sha256": str(attributes.get("sha256", "")),
    }


def _parts(recording: "xr.Dataset", settings: FrictionSettings) -> list[SheetSection]:
    found = [name for name in _CHANNELS if name in recording.variables]
    if not found:
        channel(recording, "friction_force")  # says which channels there are
    name = found[0]
    parts = [_level(recording, name)]
    if "time" not in recording.variables:
        return [*parts, SheetSection(figures=(_cycle_figure(recording, name),))]
    windows = analyse_windows(recording, of=name, window_duration=settings.window_duration)
    if name != "friction_force":
        return [*parts, _windows(recording, windows, None)]
    steady = None
    if settings.sliding_speed is not None:
        parts.append(
            attempted_section(partial(_running_in, recording, settings, settings.sliding_speed), what="steady state")
        )
        steady = _quietly_steady(windows, settings.sliding_speed)
    parts.append(_windows(recording, windows, steady))
    if {"voltage_peak_to_peak", "stack_voltage"} & set(map(str, recording.variables)):
        parts.append(attempted_section(partial(_staircase, recording), what="steps of the voltage"))
    parts.append(attempted_section(partial(_stick_slip, recording, settings.rotation_speed), what="stick-slip"))
    if "relative_velocity" in recording.variables:
        parts.append(attempted_section(partial(_cycles, recording), what="work of friction"))
    if settings.rotation_speed is not None:
        parts.append(attempted_section(partial(_wobble, recording, settings.rotation_speed), what="wobble"))
    return parts


def _level(recording: "xr.Dataset", name: str) -> SheetSection:
    mean = correlated_mean(channel(recording, name))
    scatter = SheetValue(
        name=f"{name}_deviation",
        label="Standard deviation of the samples",
        value=mean.deviation,
        unit=str(recording[name].attrs.get("units", "")),
    )
    return SheetSection(values=(quantity_value(name, mean.mean, uncertainty=mean.uncertainty), scatter))


def _windows(recording: "xr.Dataset", windows: WindowStatistics, steady: SteadyState | None) -> SheetSection:
    draw = partial(
        figures.trace,
        channel(recording, "time"),
        channel(recording, windows.channel),
        windows=windows,
        steady=steady,
    )
    return SheetSection(values=(_fluctuation(windows),), figures=(_trace_figure(windows, draw),))


def _fluctuation(windows: WindowStatistics) -> SheetValue:
    span = engineering(windows.window_duration, "s")
    known = np.isfinite(windows.fluctuation)  # of windows with a sample
    squares, weights = windows.fluctuation[known] ** 2, windows.samples[known]
    return SheetValue(
        name=f"{windows.channel}_fluctuation",
        label=f"Root mean square of the fluctuation in windows of {span}",
        value=float(np.sqrt(np.average(squares, weights=weights))),
        unit=windows.unit,
    )


def _trace_figure(windows: WindowStatistics, draw: Callable[[], "Figure"]) -> SheetFigure:
    span = engineering(windows.window_duration, "s")
    return SheetFigure(
        name="trace",
        title="Trace with windows",
        caption=f"Samples in grey; mean of each window of {span}, and as a band the root mean square about it.",
        draw=draw,
    )


def _cycle_figure(recording: "xr.Dataset", name: str) -> SheetFigure:
    along = channel(recording, "revolutions")
    return SheetFigure(
        name="trace",
        title="Trace by cycle",
        caption="One value a cycle, as the instrument gives it.",
        draw=partial(figures.by_cycle, along, channel(recording, name), name),
    )


def _quietly_steady(windows: WindowStatistics, sliding_speed: float) -> SteadyState | None:
    try:
        return steady_state(time=windows.time, friction_force=windows.mean, sliding_speed=sliding_speed)
    except InvalidInput:
        return None


def _running_in(recording: "xr.Dataset", settings: FrictionSettings, sliding_speed: float) -> SheetSection:
    found = analyse_running_in(recording, sliding_speed=sliding_speed, window_duration=settings.window_duration)
    return _steady_part(found.friction, found.fluctuation)


def _steady_part(friction: SteadyState, fluctuation: SteadyState) -> SheetSection:
    if not friction.steady:
        return SheetSection(not_found=(f"steady friction: {friction.reason}",))
    values = [
        SheetValue(
            name="steady_friction_force",
            label="Steady friction force",
            value=friction.friction_force,
            unit="N",
            uncertainty=friction.friction_force_uncertainty,
        ),
        SheetValue(name="steady_time", label="Steady after", value=friction.start_time, unit="s"),
        SheetValue(name="steady_distance", label="Slid until steady", value=friction.sliding_distance, unit="m"),
    ]
    if fluctuation.steady:
        distance = fluctuation.sliding_distance
        values.append(
            SheetValue(
                name="steady_fluctuation_distance",
                label="Slid until the fluctuation is steady",
                value=distance,
                unit="m",
            )
        )
        return SheetSection(values=tuple(values))
    return SheetSection(values=tuple(values), not_found=(f"steady fluctuation: {fluctuation.reason}",))


def _staircase(recording: "xr.Dataset") -> SheetSection:
    steps = analyse_staircase(recording)
    names = (
        "voltage_peak_to_peak",
        "start_time",
        "end_time",
        "friction_force",
        "friction_force_deviation",
        "friction_force_uncertainty",
        "friction_reduction",
        "friction_reduction_uncertainty",
    )
    labels = ("Voltage", "From", "To", "Friction", "Deviation", "Error of the mean", "Reduction", "Its uncertainty")
    table = SheetTable(
        name="steps",
        title="Friction at each step of the voltage",
        columns=tuple(quantity_column(name, label) for name, label in zip(names, labels, strict=True)),
        rows=tuple(tuple(getattr(step, name) for name in names) for step in steps),
    )
    drawn = SheetFigure(
        name="staircase",
        title="Friction over voltage",
        caption="Mean and its standard error at each step, and what the voltage takes from the friction without it.",
        draw=partial(figures.staircase, steps),
    )
    return SheetSection(tables=(table,), figures=(drawn,))


def _stick_slip(recording: "xr.Dataset", rotation_speed: float | None) -> SheetSection:
    if rotation_speed is not None:  # a wobble would pass for stick-slip at the rotation's frequency
        without_wobble = analyse_wobble(recording, rotation_speed=rotation_speed).friction_force
        recording = recording.assign(friction_force=("time", without_wobble))
    found = analyse_stick_slip(recording)
    if not found.found:
        return SheetSection(not_found=(f"stick-slip: {found.reason}",))
    amplitude = quantity_value(
        "stick_slip_amplitude", found.stick_slip_amplitude, uncertainty=found.stick_slip_amplitude_uncertainty
    )
    return SheetSection(values=(quantity_value("stick_slip_frequency", found.stick_slip_frequency), amplitude))


def _cycles(recording: "xr.Dataset") -> SheetSection:
    found = analyse_cycles(recording)
    values = [
        quantity_value("frictional_work", float(found.work.frictional_work[-1])),
        quantity_value("sliding_distance", found.work.sliding_distance),
    ]
    if found.loops is not None:
        loops = found.loops
        work = loops.frictional_work
        values.append(
            SheetValue(
                name="work_per_cycle",
                label=f"Work of friction per cycle, mean of {work.size}",
                value=float(work.mean()),
                unit="J",
                uncertainty=float(work.std(ddof=1) / work.size**0.5) if work.size > 1 else None,
            )
        )
    drawn = SheetFigure(
        name="loops",
        title="Friction over velocity",
        caption="Every cycle of the recording; the work is the area of the loop over displacement.",
        draw=partial(figures.loops, channel(recording, "relative_velocity"), channel(recording, "friction_force")),
    )
    return SheetSection(values=tuple(values), figures=(drawn,))


def _wobble(recording: "xr.Dataset", rotation_speed: float) -> SheetSection:
    found = analyse_wobble(recording, rotation_speed=rotation_speed)
    values = [
        SheetValue(
            name=f"wobble_amplitude_{order}",
            label=f"Wobble at {order} times the rotation",
            value=float(amplitude),
            unit="N",
        )
        for order, amplitude in enumerate(found.wobble_amplitude, start=1)
    ]
    left = SheetValue(
        name="deviation_without_wobble",
        label="Standard deviation without the wobble",
        value=found.friction_force_deviation,
        unit="N",
    )
    return SheetSection(values=(*values, left))


def _motor(recording: "xr.Dataset", settings: FrictionSettings, motor: MotorFriction) -> SheetSection:
    trace = analyse_motor_current(recording, motor=motor, window_duration=settings.window_duration)
    mean = float(trace.friction_force.mean())
    # all windows share the errors of torque constant and idle current, so that averaging does not lower them
    error = float(np.sqrt(np.mean(trace.friction_force_uncertainty**2)))
    drawn = SheetFigure(
        name="trace",
        title="Friction told by the motor's current",
        caption="Mean in each window with its standard uncertainty.",
        draw=partial(figures.motor_trace, trace),
    )
    return SheetSection(values=(quantity_value("friction_force", mean, uncertainty=error),), figures=(drawn,))


def _streamed(path: Path, settings: FrictionSettings) -> Sheet:
    windows = streamed_window_statistics(
        path, channels=["friction_force"], mapping=settings.mapping, window_duration=settings.window_duration
    )["friction_force"]
    mean = correlated_mean(windows.mean)
    parts = [SheetSection(values=(quantity_value("friction_force", mean.mean, uncertainty=mean.uncertainty),))]
    steady = None
    if settings.sliding_speed is not None:
        steady = _quietly_steady(windows, settings.sliding_speed)
        settle = partial(steady_state, time=windows.time, sliding_speed=settings.sliding_speed)
        parts.append(
            attempted_section(
                lambda: _steady_part(settle(friction_force=windows.mean), settle(friction_force=windows.fluctuation)),
                what="steady state",
            )
        )
    draw = partial(figures.trace, None, None, windows=windows, steady=steady)
    parts.append(SheetSection(values=(_fluctuation(windows),), figures=(_trace_figure(windows, draw),)))
    with path.open("rb") as stream:
        digest = hashlib.file_digest(stream, "sha256").hexdigest()
    source = {"format": TDMS, "samples": f"{int(windows.samples.sum())}, read in blocks", "sha256": digest}
    return sheet_from_sections(parts, title=path.name, source=source)
