"""Sheets of sensors with their charts: force gauges, Hall probes of a disc, and recorded temperatures."""

from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sonolube.charts import Axis, Band, Chart, Line, Panel, Part, Points, Rule, envelope, one_panel
from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.friction.rotation import DiscRotation
from sonolube.measurement.friction_analysis import analyse_rotation, channel_values
from sonolube.measurement.gauge.calibration import (
    BranchCalibration,
    ForceEstimate,
    PreisachCalibration,
    fit_branches,
    fit_preisach,
    force_from_preisach,
    major_loop_dissipation,
)
from sonolube.measurement.recordings.mapping import RecordingMapping
from sonolube.measurement.recordings.reader import read_recording
from sonolube.measurement.temperature import TemperatureResponse, fit_temperature_response, temperature_rise_by_stage
from sonolube.report.measured import sheet
from sonolube.report.measured.friction import recording_source
from sonolube.report.measured.sheet import captioned

if TYPE_CHECKING:
    import xarray as xr


@captioned("Force over displacement", "Measured loops and those of the Preisach model; below, the residual.")
def loops_figure(x: Floats, force: Floats, calibration: PreisachCalibration) -> Chart:
    """Force over displacement, measured and by the Preisach model, above the residual."""
    model = force_from_preisach(calibration, displacement=x).applied_force
    um, across = 1e6 * x, Axis("Displacement", "µm")
    curves = (
        Points(x=um, y=force, label="measured", colour="0.55", is_faint=True),
        Line(x=um, y=model, label="Preisach model", colour=1, weight=0.7),
    )
    residual = (Points(x=um, y=force - model, is_faint=True), Rule(value=0.0, along="y", colour="0.5", dash=0))
    panels = (
        Panel(x=across, y=Axis("Force", "N"), parts=curves),
        Panel(x=across, y=Axis("Residual", "N"), parts=residual),
    )
    return Chart(panels=panels, size=(5.0, 4.8), heights=(3, 1), shares_x=True)


@captioned("Force by the displacement", "With its standard uncertainty as a band.")
def force_figure(t: Floats, estimate: ForceEstimate) -> Chart:
    """Force over time with its standard uncertainty as a band."""
    f, u = estimate.applied_force, estimate.applied_force_uncertainty
    band = Band(x=t, low=f - u, high=f + u, label="standard uncertainty", colour=5, opacity=0.6)
    time, curve = envelope(t, f)
    parts = (band, Line(x=time, y=curve, weight=0.7))
    return one_panel(Axis("Time", "s"), Axis("Force", "N"), parts, size=(6.4, 3.0))


@dataclass(frozen=True, kw_only=True, slots=True)
class CalibrationSettings:
    """Settings of the calibration of a displacement sensor as a force gauge.

    Parameters
    ----------
    mapping : RecordingMapping or None
        What the columns mean.
    degree : int
        Of the polynomials for loading and unloading.
    levels : int
        Of displacement in Preisach's model.
    displacement_uncertainty : float
        Standard uncertainty of a reading. [m]
    """

    mapping: RecordingMapping | None = None
    degree: int = 3
    levels: int = 16
    displacement_uncertainty: float = 0.0


def calibration_sheet(path: Path, *, settings: CalibrationSettings) -> sheet.Sheet:
    """Calibration of a force gauge by the Preisach model and by polynomials, from recorded loops."""
    recording = read_recording(path, mapping=settings.mapping)
    x, force = channel_values(recording, "displacement"), _applied_force(recording)
    hysteresis = fit_preisach(displacement=x, applied_force=force, levels=settings.levels)
    span, deviation, energy = float(np.ptp(force)), hysteresis.force_deviation, major_loop_dissipation(hysteresis)
    values = (
        sheet.Value("hysteresis_deviation", "Deviation about the Preisach model", deviation, "N"),
        sheet.Value("relative_deviation", "Relative deviation, over the range of force", deviation / span, ""),
        sheet.Value("dissipated_energy", "Energy dissipated in the greatest loop", energy, "J"),
        sheet.Value("mean_stiffness", "Mean stiffness over the whole range", span / float(np.ptp(x)), "N/m"),
    )
    loop = loops_figure(x, force, hysteresis)
    branches = sheet.attempted(partial(_branches, x, force, settings.degree), what="polynomials of the branches")
    loops = sheet.Sheet(values=values, figures=(loop,))
    return sheet.joined([loops, branches], title=path.name, source=recording_source(recording))


def _applied_force(recording: "xr.Dataset") -> Floats:
    """Force of a calibration: that of the load cell which else measures friction, where no other was recorded."""
    is_pulled = "applied_force" not in recording and "friction_force" in recording
    return channel_values(recording, "friction_force" if is_pulled else "applied_force")


def calibrated_hysteresis(path: Path, *, settings: CalibrationSettings) -> PreisachCalibration:
    """Preisach model of a force gauge, fitted to recorded loops."""
    recording = read_recording(path, mapping=settings.mapping)
    x, force = channel_values(recording, "displacement"), _applied_force(recording)
    return fit_preisach(displacement=x, applied_force=force, levels=settings.levels)


def force_sheet(path: Path, *, calibration: PreisachCalibration, settings: CalibrationSettings) -> sheet.Sheet:
    """Force by a calibrated gauge from a recorded displacement, with its uncertainty."""
    recording = read_recording(path, mapping=settings.mapping)
    estimate = force_from_preisach(
        calibration,
        displacement=channel_values(recording, "displacement"),
        displacement_uncertainty=settings.displacement_uncertainty,
    )
    # readings share the error of the calibration, so that averaging does not lower it
    force, error = estimate.applied_force, estimate.applied_force_uncertainty
    top = int(np.argmax(force))
    values = (
        sheet.quantity_value("applied_force", float(force.mean()), label="Mean force", uncertainty=float(error.mean())),
        sheet.Value("highest_force", "Highest force", float(force[top]), "N", uncertainty=float(error[top])),
    )
    figure = force_figure(channel_values(recording, "time"), estimate)
    section = sheet.Sheet(values=values, figures=(figure,))
    return sheet.joined([section], title=path.name, source=recording_source(recording))


def _branches(x: Floats, force: Floats, degree: int) -> sheet.Sheet:
    """Polynomials of loading and unloading with the deviations about them."""
    branches = fit_branches(displacement=x, applied_force=force, degree=degree)
    values = (
        sheet.field_value(branches, "loading_deviation", "Deviation about the polynomial of loading", "N"),
        sheet.field_value(branches, "unloading_deviation", "Deviation about the polynomial of unloading", "N"),
    )
    return sheet.Sheet(values=values, tables=(_coefficients(branches),))


def _coefficients(branches: BranchCalibration) -> sheet.Table:
    """Coefficients of the polynomials as a table."""
    columns = (
        sheet.Column("power", "Power of the displacement in m"),
        sheet.Column("loading", "Loading (N)"),
        sheet.Column("unloading", "Unloading (N)"),
    )
    pairs = zip(branches.loading.convert().coef, branches.unloading.convert().coef, strict=True)
    return sheet.Table(
        name="branches",
        title="Force as a polynomial of displacement",
        columns=columns,
        rows=tuple((float(power), float(up), float(down)) for power, (up, down) in enumerate(pairs)),
    )


_TURNS_SHOWN = 6
_TIME_AXIS = Axis("Time", "s")


@captioned("Speed turn by turn", "Each turn is timed from a magnet to the same magnet; the line is the mean.")
def speed_figure(rotation: DiscRotation) -> Chart:
    """Speed of the disc turn by turn, with the speed at the groove on the right."""
    speeds = rotation.rotation_speed
    begun = rotation.time[: speeds.size]
    parts = (
        Line(x=begun, y=speeds, weight=0.6),
        Points(x=begun, y=speeds, is_faint=True),
        Rule(value=float(rotation.mean_rotation_speed), along="y", label="mean", colour=1, dash=1),
    )
    per_turn = float(rotation.sliding_speed[0] / speeds[0])
    y = Axis("Rotation speed", "1/s", proportional=(per_turn, "Speed at the groove [m/s]"))
    return one_panel(_TIME_AXIS, y, parts, size=(6.4, 3.0))


@captioned("Pulses of the probe", "The first turns, with the pulses detected and those inserted where one was missing.")
def pulses_figure(t: Floats, flux_density: Floats, rotation: DiscRotation) -> Chart:
    """Reading of the probe over the first turns, with its pulses."""
    end = float(np.interp(_TURNS_SHOWN, rotation.revolutions, rotation.time))
    shown = t <= end + 0.02 * (end - t[0])
    time, reading = envelope(t[shown], flux_density[shown])
    parts: list[Part] = [Line(x=time, y=reading, label="reading", colour="0.5", weight=0.6)]
    early = rotation.time <= end
    for which, name, place in (
        (early & ~rotation.interpolated, "pulses", 0),
        (early & rotation.interpolated, "inserted", 1),
    ):
        if which.any():
            at = rotation.time[which]
            parts.append(Points(x=at, y=np.interp(at, t, flux_density), label=name, colour=place, marker=place))
    return one_panel(_TIME_AXIS, Axis("Magnetic flux density", "T"), parts, size=(6.4, 3.0), legend="top")


@dataclass(frozen=True, kw_only=True, slots=True)
class RotationSettings:
    """Geometry of the disc and detection of pulses of its Hall probe.

    Parameters
    ----------
    groove_diameter : float
        Diameter of the circle under the pin. [m]
    magnets : int
        Magnets at the rim.
    prominence : float
        Height of the weakest pulse that counts, as a share of the strongest.
    mapping : RecordingMapping or None
        What the columns mean.
    """

    groove_diameter: float
    magnets: int = 1
    prominence: float = 0.25
    mapping: RecordingMapping | None = None


def rotation_sheet(path: Path, *, settings: RotationSettings) -> sheet.Sheet:
    """Rotation speed of a disc, and speed of the pin on it, from the pulses of a Hall probe."""
    recording = read_recording(path, mapping=settings.mapping)
    rotation = analyse_rotation(
        recording, groove_diameter=settings.groove_diameter, magnets=settings.magnets, prominence=settings.prominence
    )
    circumference, revolutions = np.pi * settings.groove_diameter, float(rotation.revolutions[-1])
    speed, error = rotation.mean_rotation_speed, rotation.rotation_speed_uncertainty
    turns, interpolated = rotation.rotation_speed, int(rotation.interpolated.sum())
    values = [
        sheet.quantity_value("rotation_speed", speed, uncertainty=error),
        sheet.quantity_value("sliding_speed", circumference * speed, uncertainty=circumference * error),
        sheet.quantity_value("revolutions", revolutions),
        sheet.quantity_value("sliding_distance", circumference * revolutions),
        sheet.Value("pulses", "Pulses", float(rotation.time.size), ""),
        sheet.Value("repaired_pulses", "Missing pulses inserted", float(interpolated), ""),
    ]
    if turns.size > 1:
        label, spread = "Relative standard deviation of the speed of the turns", float(turns.std(ddof=1)) / speed
        values.append(sheet.Value("speed_variation", label, spread, ""))
    pictures = (
        speed_figure(rotation),
        pulses_figure(channel_values(recording, "time"), channel_values(recording, "magnetic_flux_density"), rotation),
    )
    caveat = f"{interpolated} of {rotation.time.size} pulses were missing; lower the prominence or move the probe"
    caveats = (caveat,) if interpolated > rotation.time.size / 10 else ()
    section = sheet.Sheet(values=tuple(values), figures=pictures, caveats=caveats)
    return sheet.joined([section], title=path.name, source=recording_source(recording))


@captioned(
    "Temperature after the step of the heat", "Rise of the samples in grey, with the fitted sum of exponentials."
)
def response_figure(t: Floats, temperature: Floats, found: TemperatureResponse) -> Chart:
    """Rise of a temperature over time with its fitted response."""
    known = np.isfinite(temperature)
    initial = found.final_temperature.value - found.temperature_change.value
    time, samples = envelope(t[known], temperature[known] - initial)
    rows = zip(found.time_constants, found.temperature_changes, strict=True)
    since = t - t[known][0]
    fitted = np.sum([change.value * -np.expm1(-since / tau.value) for tau, change in rows], axis=0)
    parts = Line(x=time, y=samples, label="samples", colour="0.6", weight=0.6), Line(x=t, y=fitted, label="fit")
    y = Axis("Temperature rise", "K")
    return one_panel(Axis("Time", "s"), y, parts, size=(6.4, 3.0), legend="top")


_EXPONENTIALS = (
    sheet.Column("time_constant", "Time constant", "s"),
    sheet.Column("time_constant_lower", "at least", "s"),
    sheet.Column("time_constant_upper", "at most", "s"),
    sheet.Column("final_temperature_rise", "Share of the final rise", "K"),
)


@dataclass(frozen=True, kw_only=True, slots=True)
class TemperatureSettings:
    """Span of a recorded temperature, form of its response, and reference.

    Parameters
    ----------
    start_time : float or None
        At which the heat steps; the first sample if None. [s]
    end_time : float or None
        At which the response ends; the last sample if None. [s]
    exponentials : int or None
        1 or 2; None for those of the lower information criterion.
    without_vibration : Path or None
        Recording of the test without vibration.
    mapping : RecordingMapping or None
        What the columns mean.
    """

    start_time: float | None = None
    end_time: float | None = None
    exponentials: int | None = None
    without_vibration: Path | None = None
    mapping: RecordingMapping | None = None


def temperature_sheet(path: Path, *, settings: TemperatureSettings) -> sheet.Sheet:
    """Final rise, time constants and scatter of a temperature after a step of the heat."""
    recording = read_recording(path, mapping=settings.mapping)
    time, temperature = channel_values(recording, "time"), channel_values(recording, "temperature")
    start = float(time[0]) if settings.start_time is None else settings.start_time
    end = float(time[-1]) if settings.end_time is None else settings.end_time
    inside = (time >= start) & (time <= end)
    if np.count_nonzero(inside & np.isfinite(temperature)) < 8:
        raise InvalidInput(f"{path.name}: {start:g} s to {end:g} s holds fewer than 8 temperatures")
    t, value = time[inside], temperature[inside]
    found = fit_temperature_response(time=t, temperature=value, exponentials=settings.exponentials)
    rise = found.temperature_change
    values = [
        sheet.quantity_value("final_temperature_rise", rise.value, interval=(rise.lower, rise.upper)),
        sheet.quantity_value("temperature_deviation", found.temperature_deviation),
    ]
    pictures = [response_figure(t, value, found)]
    if settings.without_vibration is not None:
        values.append(_rise_over_reference(t, value, settings.without_vibration, settings.mapping))
    terms = zip(found.time_constants, found.temperature_changes, strict=True)
    rows = tuple((tau.value, tau.lower, tau.upper, change.value) for tau, change in terms)
    table = sheet.Table("exponentials", "Exponentials of the response", _EXPONENTIALS, rows)
    section = sheet.Sheet(values=tuple(values), tables=(table,), figures=tuple(pictures), caveats=found.caveats)
    return sheet.joined([section], title=path.name, source=recording_source(recording))


def _rise_over_reference(t: Floats, value: Floats, path: Path, mapping: RecordingMapping | None) -> sheet.Value:
    """Mean temperature rise over a test without vibration, at the same times."""
    reference = read_recording(path, mapping=mapping)
    (over,) = temperature_rise_by_stage(
        time=t,
        temperature=value,
        reference_time=channel_values(reference, "time"),
        reference_temperature=channel_values(reference, "temperature"),
        stages=(t[0], t[-1]),
    )
    label, error = "Mean rise over the test without vibration", over.temperature_rise_uncertainty
    return sheet.quantity_value("temperature_rise", over.temperature_rise, label=label, uncertainty=error)
