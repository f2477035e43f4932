"""Sheets of recorded temperatures: response to a step of the heat, and rise over a test without vibration."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.friction_analysis import channel_values
from sonolube.measurement.recordings.mapping import RecordingMapping
from sonolube.measurement.recordings.reader import read_recording
from sonolube.measurement.temperature import fit_temperature_response, temperature_rise_by_stage
from sonolube.report.measured import sheet, temperature_figures as figures
from sonolube.report.measured.friction import recording_source

_COLUMNS = (
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
    pictures = [figures.response_figure(t, value, found)]
    if settings.without_vibration is not None:
        values.append(_rise_over_reference(t, value, settings.without_vibration, settings.mapping))
    terms = zip(found.time_constants, found.temperature_changes, strict=True)
    rows = tuple((tau.value, tau.lower, tau.upper, change.value) for tau, change in terms)
    table = sheet.Table("exponentials", "Exponentials of the response", _COLUMNS, rows)
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
