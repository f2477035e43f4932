"""Sheets of friction recordings, also of several files: level, fluctuation, running-in, stick-slip, work and wobble."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput
from sonolube.measurement.friction.loops import friction_work
from sonolube.measurement.friction.rotation import MotorCalibration
from sonolube.measurement.friction.sliding import NOISE_VOLTAGE, Mask, stretches
from sonolube.measurement.friction.stated_load import StatedLoad
from sonolube.measurement.friction.stated_parts import STATED_STEP, StatedParts, with_stated_parts
from sonolube.measurement.friction.windows import (
    DEFAULT_WINDOW_DURATION,
    SteadyStateOnset,
    WindowStatistics,
    steady_state_onset,
    streamed_window_statistics,
)
from sonolube.measurement.friction_analysis import (
    analyse_cycles,
    analyse_motor_current,
    analyse_running_in,
    analyse_stick_slip,
    analyse_windows,
    analyse_wobble,
    channel_values,
)
from sonolube.measurement.recorded_conditions import recorded_rest, recorded_speed, recorded_voltage
from sonolube.measurement.recordings.channels_and_parts import join_recordings
from sonolube.measurement.recordings.mapping import RecordingMapping
from sonolube.measurement.recordings.reader import read_recording, recording_format_name
from sonolube.measurement.recordings.tdms import TDMS_FORMAT as TDMS
from sonolube.measurement.statistics.autocorrelation import correlated_mean
from sonolube.report.measured import friction_steps as figures, sheet
from sonolube.report.measured.friction_steps import step_sheet
from sonolube.text.units import format_si
from sonolube.vocabulary import quantities

if TYPE_CHECKING:
    import xarray as xr

_LARGE = 1 << 29  # bytes of a TDMS file beyond which it is read in blocks, for its windows only
_CHANNELS = ("friction_force", "friction_coefficient")
_COEFFICIENTS = {
    "friction_force": ("friction_coefficient", "Coefficient of friction"),
    "steady_friction_force": ("steady_friction_coefficient", "Steady coefficient of friction"),
    "mean_force": ("mean_coefficient", "Mean coefficient of the whole recording"),
}  # and their labels, by the levels of a force
_ONE_VOLTAGE = 0.1  # of the highest voltage, up to which its range is no change of the vibration
_LONG_REST = 0.5  # s, from which a rest is named
_MAX_LISTED = 3


@dataclass(frozen=True, kw_only=True, slots=True)
class FrictionSettings:
    """Settings of the evaluation of a friction recording.

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
    motor : MotorCalibration or None
        To tell friction by the motor's current.
    parts : StatedParts
        Part, rests and steps as stated, in place of those found.
    load : StatedLoad or None
        Load, for the coefficient of a force, or the force of a coefficient, with its uncertainty and that of the zero.

    Raises
    ------
    InvalidInput
        If a duration or speed is not positive.
    """

    mapping: RecordingMapping | None = None
    window_duration: float = DEFAULT_WINDOW_DURATION
    sliding_speed: float | None = None
    rotation_speed: float | None = None
    motor: MotorCalibration | None = None
    parts: StatedParts = field(default_factory=StatedParts)
    load: StatedLoad | None = None

    def __post_init__(self) -> None:
        speeds = {"sliding_speed": self.sliding_speed, "rotation_speed": self.rotation_speed}
        stated = {name: speed for name, speed in speeds.items() if speed is not None}
        require_positive(window_duration=self.window_duration, **stated)


def friction_sheet(path: Path, *, settings: FrictionSettings) -> sheet.Sheet:
    """Friction in a recording: level, fluctuation, running-in, voltage steps, stick-slip, work and wobble."""
    is_whole = settings.parts == StatedParts()
    if is_whole and path.is_file() and path.stat().st_size > _LARGE and recording_format_name(path) == TDMS:
        return _streamed(path, settings)
    return recording_sheet(read_recording(path, mapping=settings.mapping), title=path.name, settings=settings)


def recording_sheet(recording: "xr.Dataset", *, title: str, settings: FrictionSettings) -> sheet.Sheet:
    """Friction in a recording that was read, as `friction_sheet`."""
    motor, name = settings.motor, "friction_force"
    if motor is None:
        recording, name = _with_force(recording, settings.load)
    recording = with_stated_parts(recording, settings.parts)
    sections = _sections(recording, name, settings) if motor is None else [_motor(recording, settings, motor)]
    if settings.load is not None:
        sections.append(_coefficients(sections, settings.load))
    sections.append(sheet.Sheet(caveats=recording_caveats(recording)))
    return sheet.joined(sections, title=title, source=recording_source(recording))


def recording_caveats(recording: "xr.Dataset") -> tuple[str, ...]:
    """Caveats of the reading of a recording: assumptions of the reader, and what its library complained of."""
    return tuple(str(recording.attrs.get("caveats", "")).splitlines())


def friction_channel(recording: "xr.Dataset") -> str:
    """Name of the channel that holds friction: the force, else the coefficient; refuse a recording of neither."""
    found = next((name for name in _CHANNELS if name in recording.variables), None)
    if found is None:
        channel_values(recording, _CHANNELS[0])  # says which channels there are
    return found or _CHANNELS[0]


def recording_source(recording: "xr.Dataset") -> dict[str, str]:
    """Origin of a recording: format, title, samples, sample rate and digest."""
    attributes = recording.attrs
    rate, dropped = attributes.get("sample_rate"), int(attributes.get("dropped_samples", 0))
    return {
        "format": str(attributes.get("file_format", "")),
        "title": str(attributes.get("title", "")),
        "mapping": str(attributes.get("mapping", "")),
        "samples": f"{next(iter(recording.sizes.values()))}",
        "sample rate": format_si(float(rate), "Hz") if rate else "",
        "dropped samples": f"{dropped}" if dropped else "",
        "sha256": str(attributes.get("sha256", "")),
    }


def _with_force(recording: "xr.Dataset", load: StatedLoad | None) -> tuple["xr.Dataset", str]:
    """Recording with a force, and the name of the channel of friction that is reported.

    The force of a recording that has the coefficient alone is that under the load; without a load that under 1 N, by
    which the same analyses tell the coefficient.
    """
    name = friction_channel(recording)
    if name == "friction_force":
        return recording, name
    force = recording[name] * (1.0 if load is None else load.normal_load)
    attributes = {"units": "N", "long_name": quantities()["friction_force"].meaning}
    whole = recording.assign(friction_force=force.assign_attrs(attributes))
    return whole, name if load is None else "friction_force"


def _coefficients(sections: Sequence[sheet.Sheet], load: StatedLoad) -> sheet.Sheet:
    """Coefficients of the levels of a force, with the uncertainties of load and zero."""
    values = []
    for level in (value for section in sections for value in section.values if value.name in _COEFFICIENTS):
        coefficient, error = load.coefficient(level.value, uncertainty=level.uncertainty)
        values.append(sheet.Value(*_COEFFICIENTS[level.name], coefficient, "", uncertainty=error))
    return sheet.Sheet(values=tuple(values))


def _sections(recording: "xr.Dataset", name: str, settings: FrictionSettings) -> list[sheet.Sheet]:
    """Sections of a recording of friction, as far as its channels allow; of a coefficient without those of a force."""
    if "time" not in recording.variables:
        return [_mean_of_all(recording, name), sheet.Sheet(figures=(_cycle_figure(recording, name),))]
    whole, rest = recording, recorded_rest(recording)
    left_out = rest | (whole[STATED_STEP].to_numpy() == 0) if STATED_STEP in whole else rest
    if left_out.any():
        recording = whole.assign({each: whole[each].where(~left_out) for each in {name, "friction_force"}})
    windows = analyse_windows(recording, of=name, window_duration=settings.window_duration)
    sections = [_level(whole, recording, name), *_rest_caveat(whole, rest)]
    steady = None
    if settings.sliding_speed is not None:
        sections.append(
            sheet.attempted(
                partial(_running_in, recording, name, settings, settings.sliding_speed), what="steady state"
            )
        )
        steady = _steady_state_or_none(windows, settings.sliding_speed)
    sections.append(_windows(recording, windows, steady))
    sections += _steps_or_stick_slip(whole, recording, name, settings)
    if name != "friction_force":
        needs = "stick-slip, work and wobble: of a force alone, which a stated load gives"
        return [*sections, sheet.Sheet(not_found=(needs,))]
    if "relative_velocity" in recording.variables:
        sections.append(sheet.attempted(partial(_cycles, whole), what="work of friction"))
    if settings.rotation_speed is not None:
        sections.append(sheet.attempted(partial(_wobble, recording, settings.rotation_speed), what="wobble"))
    return sections


def _level(whole: "xr.Dataset", sliding: "xr.Dataset", name: str) -> sheet.Sheet:
    """Mean friction while sliding, where the vibration does not change; else the mean of the whole recording."""
    voltage, speed = recorded_voltage(whole), recorded_speed(whole)
    if voltage is None:
        return _mean_of_all(whole, name)
    low, high = np.nanmin(voltage), np.nanmax(voltage)
    is_one = high - low <= max(_ONE_VOLTAGE * high, NOISE_VOLTAGE)
    if not is_one or (speed is None and high > NOISE_VOLTAGE):
        return _mean_of_all(whole, name)
    return _mean_sheet(sliding, name, name, quantities()[name].meaning)


def _mean_of_all(recording: "xr.Dataset", name: str) -> sheet.Sheet:
    """Mean of a channel over the whole recording, whatever slid and vibrated in it."""
    kind = name.removeprefix("friction_")
    return _mean_sheet(recording, name, f"mean_{kind}", f"Mean {kind} of the whole recording")


def _mean_sheet(recording: "xr.Dataset", channel: str, name: str, label: str) -> sheet.Sheet:
    """Mean and standard deviation of a channel, the uncertainty of the mean by the autocorrelation."""
    mean = correlated_mean(channel_values(recording, channel))
    unit = _unit(recording, channel)
    scatter = sheet.Value(f"{channel}_deviation", "Standard deviation of the samples", mean.deviation, unit)
    return sheet.Sheet(values=(sheet.Value(name, label, mean.mean, unit, uncertainty=mean.uncertainty), scatter))


def _unit(recording: "xr.Dataset", channel: str) -> str:
    """Unit of a channel, empty for a pure number."""
    unit = str(recording[channel].attrs.get("units", ""))
    return "" if unit == "1" else unit


def _rest_caveat(recording: "xr.Dataset", rest: Mask) -> list[sheet.Sheet]:
    """Samples left out because the surfaces rest, and the evidence for the rest."""
    time = channel_values(recording, "time")
    spans = [(float(time[a]), float(time[b - 1])) for a, b in stretches(rest) if time[b - 1] - time[a] > _LONG_REST]
    if not spans:
        return []
    listed = ", ".join(f"{format_si(a, 's')} to {format_si(b, 's')}" for a, b in spans[:_MAX_LISTED])
    more = f" and {len(spans) - _MAX_LISTED} more" if len(spans) > _MAX_LISTED else ""
    by = "by the force, below half of that without voltage" if recorded_speed(recording) is None else "by the speed"
    told = recording.attrs.get("rest", by)
    return [sheet.Sheet(caveats=(f"at rest {told}, and left out: {listed}{more}",))]


def _windows(recording: "xr.Dataset", windows: WindowStatistics, steady: SteadyStateOnset | None) -> sheet.Sheet:
    """Fluctuation in windows, with the trace."""
    samples = channel_values(recording, "time"), channel_values(recording, windows.channel)
    return _trace(*samples, windows=windows, steady=steady)


def _fluctuation(windows: WindowStatistics) -> sheet.Value:
    """Root mean square of the fluctuation about the means of the windows, weighted by their samples."""
    span = format_si(windows.window_duration, "s")
    filled = np.isfinite(windows.fluctuation)  # windows with samples
    squares, weights = windows.fluctuation[filled] ** 2, windows.samples[filled]
    rms = float(np.sqrt(np.average(squares, weights=weights)))
    label = f"Root mean square of the fluctuation in windows of {span}"
    return sheet.Value(f"{windows.channel}_fluctuation", label, rms, "" if windows.unit == "1" else windows.unit)


def _trace(
    t: Floats | None, signal: Floats | None, *, windows: WindowStatistics, steady: SteadyStateOnset | None
) -> sheet.Sheet:
    """Fluctuation in windows, with the trace of the samples where they are at hand."""
    span = format_si(windows.window_duration, "s")
    caption = f"Samples in grey; mean of each window of {span}, and as a band the root mean square about it."
    trace = sheet.captioned("Trace with windows", caption)(figures.trace_chart)
    return sheet.Sheet(values=(_fluctuation(windows),), figures=(trace(t, signal, windows=windows, steady=steady),))


def _cycle_figure(recording: "xr.Dataset", name: str) -> sheet.Figure:
    """Figure of a recording with one value a cycle."""
    along = channel_values(recording, "revolutions")
    return figures.by_cycle_figure(along, channel_values(recording, name), name)


def _steady_state_or_none(windows: WindowStatistics, sliding_speed: float) -> SteadyStateOnset | None:
    """Steady state of the friction; None where it cannot be determined."""
    try:
        return steady_state_onset(time=windows.time, friction_force=windows.mean, sliding_speed=sliding_speed)
    except InvalidInput:
        return None


def _running_in(recording: "xr.Dataset", name: str, settings: FrictionSettings, sliding_speed: float) -> sheet.Sheet:
    """Steady friction after running-in, and the sliding distance to it."""
    running_in = analyse_running_in(recording, sliding_speed=sliding_speed, window_duration=settings.window_duration)
    return _steady_part(running_in.friction, running_in.fluctuation, name)


def _steady_part(
    friction: SteadyStateOnset, fluctuation: SteadyStateOnset, name: str = "friction_force"
) -> sheet.Sheet:
    """Steady friction with time and distance to it, and the distance to a steady fluctuation."""
    if not friction.steady:
        return sheet.Sheet(not_found=(f"steady friction: {friction.reason}",))
    level, error = friction.friction_force, friction.friction_force_uncertainty
    label, unit = ("friction force", "N") if name == "friction_force" else ("coefficient of friction", "")
    values = (
        sheet.Value(f"steady_{name}", f"Steady {label}", level, unit, uncertainty=error),
        sheet.Value("steady_time", "Time to the steady state", friction.start_time, "s"),
        sheet.Value("steady_distance", "Sliding distance to the steady state", friction.sliding_distance, "m"),
    )
    if not fluctuation.steady:
        return sheet.Sheet(values=values, not_found=(f"steady fluctuation: {fluctuation.reason}",))
    label = "Sliding distance to a steady fluctuation"
    distance = sheet.Value("steady_fluctuation_distance", label, fluctuation.sliding_distance, "m")
    return sheet.Sheet(values=(*values, distance))


def _steps_or_stick_slip(
    whole: "xr.Dataset", sliding: "xr.Dataset", name: str, settings: FrictionSettings
) -> list[sheet.Sheet]:
    """Friction and stick-slip at the steps of a voltage; stick-slip of a force that slides where there are none."""
    steps, rotation_speed = sheet.Sheet(), settings.rotation_speed
    if {"voltage_peak_to_peak", "stack_voltage"} & set(map(str, whole.variables)):
        analysis = partial(step_sheet, whole, rotation_speed=rotation_speed, channel=name, load=settings.load)
        steps = sheet.attempted(analysis, what="steps of the voltage")
    if steps.tables or name != "friction_force":
        return [steps]
    return [steps, sheet.attempted(partial(_stick_slip, sliding, rotation_speed), what="stick-slip")]


def _stick_slip(recording: "xr.Dataset", rotation_speed: float | None) -> sheet.Sheet:
    """Frequency and amplitude of stick-slip, the wobble of the disc removed first."""
    if rotation_speed is not None:  # a wobble would pass for stick-slip at the rotation's frequency
        without_wobble = analyse_wobble(recording, rotation_speed=rotation_speed).friction_force
        recording = recording.assign(friction_force=("time", without_wobble))
    stick_slip = analyse_stick_slip(recording)
    if not stick_slip.detected:
        return sheet.Sheet(not_found=(f"stick-slip: {stick_slip.reason}",))
    values = (
        *(sheet.field_value(stick_slip, f"stick_slip_{name}") for name in ("frequency", "amplitude", "fraction")),
        sheet.Value("force_drops", "Slips found", float(stick_slip.force_drops), ""),
    )
    return sheet.Sheet(values=values)


def _cycles(recording: "xr.Dataset") -> sheet.Sheet:
    """Work of friction and sliding distance, and the work of each cycle of a reciprocating motion."""
    cycles = analyse_cycles(recording)
    values = [
        sheet.quantity_value("frictional_work", float(cycles.work.frictional_work[-1])),
        sheet.quantity_value("sliding_distance", cycles.work.sliding_distance),
    ]
    if cycles.loops is not None:
        work = cycles.loops.frictional_work
        error = float(work.std(ddof=1) / work.size**0.5) if work.size > 1 else None
        label = f"Work of friction per cycle, mean of {work.size}"
        values.append(sheet.Value("work_per_cycle", label, float(work.mean()), "J", uncertainty=error))
    figure = figures.loops_figure(
        channel_values(recording, "relative_velocity"), channel_values(recording, "friction_force")
    )
    return sheet.Sheet(values=tuple(values), figures=(figure,))


def _wobble(recording: "xr.Dataset", rotation_speed: float) -> sheet.Sheet:
    """Amplitudes of the wobble at multiples of the rotation frequency, and the deviation without it."""
    wobble = analyse_wobble(recording, rotation_speed=rotation_speed)
    values = [
        sheet.Value(f"wobble_amplitude_{order}", f"Wobble at {order} times the rotation", float(amplitude), "N")
        for order, amplitude in enumerate(wobble.wobble_amplitude, start=1)
    ]
    deviation, label = wobble.friction_force_deviation, "Standard deviation without the wobble"
    return sheet.Sheet(values=(*values, sheet.Value("deviation_without_wobble", label, deviation, "N")))


def _motor(recording: "xr.Dataset", settings: FrictionSettings, motor: MotorCalibration) -> sheet.Sheet:
    """Friction from the torque of the motor by its current, in windows."""
    trace = analyse_motor_current(recording, motor=motor, window_duration=settings.window_duration)
    mean = float(trace.friction_force.mean())
    # all windows share the errors of torque constant and idle current, so that averaging does not lower them
    error = float(np.sqrt(np.mean(trace.friction_force_uncertainty**2)))
    figure = figures.motor_trace_figure(trace)
    return sheet.Sheet(values=(sheet.quantity_value("friction_force", mean, uncertainty=error),), figures=(figure,))


def _streamed(path: Path, settings: FrictionSettings) -> sheet.Sheet:
    """Level, steady state and fluctuation of a large file, read in blocks."""
    windows = streamed_window_statistics(
        path, channels=["friction_force"], mapping=settings.mapping, window_duration=settings.window_duration
    )["friction_force"]
    mean = correlated_mean(windows.mean)
    label = "Mean force of the whole recording"
    sections = [sheet.Sheet(values=(sheet.Value("mean_force", label, mean.mean, "N", uncertainty=mean.uncertainty),))]
    steady = None
    if settings.sliding_speed is not None:
        steady = _steady_state_or_none(windows, settings.sliding_speed)
        settle = partial(steady_state_onset, time=windows.time, sliding_speed=settings.sliding_speed)
        sections.append(
            sheet.attempted(
                lambda: _steady_part(settle(friction_force=windows.mean), settle(friction_force=windows.fluctuation)),
                what="steady state",
            )
        )
    sections.append(_trace(None, None, windows=windows, steady=steady))
    with path.open("rb") as stream:
        digest = hashlib.file_digest(stream, "sha256").hexdigest()
    source = {"format": TDMS, "samples": f"{int(windows.samples.sum())}, read in blocks", "sha256": digest}
    return sheet.joined(sections, title=path.name, source=source)


_COLUMNS = (sheet.Column("file", "File"), sheet.Column("start_time", "From", "s"), sheet.Column("end_time", "To", "s"))


def joined_friction_sheet(paths: Sequence[Path], *, settings: FrictionSettings) -> sheet.Sheet:
    """Friction in all files of one test, as of one recording, with a table of the files.

    The analyses of `friction_sheet` over all files, so that cycles of a reciprocating motion may extend over several of
    them; and per file its time, mean friction and scatter, and work and distance where the velocity was recorded.
    """
    parts = [read_recording(path, mapping=settings.mapping) for path in paths]
    joined = join_recordings(parts)
    whole = recording_sheet(joined, title=f"{len(paths)} files as one test", settings=settings)
    name = friction_channel(joined)
    unit = _unit(joined, name)
    moving = "relative_velocity" in joined.variables and name == "friction_force"
    columns = [
        *_COLUMNS,
        *sheet.quantity_columns({name: "Friction"}),
        sheet.Column(f"{name}_deviation", "Deviation", unit),
    ]
    if moving:
        columns += sheet.quantity_columns({"frictional_work": "Work", "sliding_distance": "Distance"})
    rows = []
    for path, part, start in zip(paths, parts, joined.attrs["part_starts"], strict=True):
        time, friction = channel_values(part, "time"), channel_values(part, name)
        known = friction[np.isfinite(friction)]
        row: list[sheet.Cell] = [path.name, start, start + float(time[-1] - time[0])]
        row += [float(known.mean()), float(known.std(ddof=1)) if known.size > 1 else None]
        rows.append((*row, *(_work(time, friction, channel_values(part, "relative_velocity")) if moving else ())))
    table = sheet.Table(name="files", title="Friction in each file", columns=tuple(columns), rows=tuple(rows))
    return sheet.joined([whole, sheet.Sheet(tables=(table,))], title=whole.title, source=whole.source)


def _work(time: np.ndarray, friction: np.ndarray, velocity: np.ndarray) -> tuple[sheet.Cell, sheet.Cell]:
    """Work and distance in one file; nothing where it has no sliding."""
    try:
        work = friction_work(time=time, friction_force=friction, relative_velocity=velocity)
    except InvalidInput:
        return None, None
    return float(work.frictional_work[-1]), work.sliding_distance
