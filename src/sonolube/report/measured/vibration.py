"""Sheets of vibrometer recordings with their charts: amplitudes at the drive frequency and operating shapes."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sonolube.charts import Axis, Band, Bars, Chart, Line, Panel, Points, Rule, one_panel
from sonolube.checks import Complexes, Floats, require_positive
from sonolube.errors import InvalidInput
from sonolube.measurement.friction_analysis import channel_values
from sonolube.measurement.recordings.mapping import RecordingMapping
from sonolube.measurement.recordings.raw_table import convert_to_si
from sonolube.measurement.recordings.reader import read_recording
from sonolube.measurement.vibration import (
    AmplitudePerVolt,
    OperatingDeflectionShape,
    amplitude_per_volt,
    complex_amplitudes,
    modal_assurance_criterion,
    operating_deflection_shape,
)
from sonolube.report.measured import sheet
from sonolube.report.measured.friction import recording_caveats, recording_source
from sonolube.report.measured.sheet import captioned

if TYPE_CHECKING:
    import xarray as xr

_MAX_NUMBERED = 12  # points


@captioned("Operating shape", "Motion in phase with the whole, scaled to 1, and the phase of each point.")
def shape_figure(points: Sequence[str], operating: OperatingDeflectionShape) -> Chart:
    """Operating shape and phase, point by point."""
    place = np.arange(1.0, len(points) + 1)
    across = Axis("Point", ticks=tuple(place) if place.size <= _MAX_NUMBERED else ())
    phase = (np.degrees(operating.phase) + 90) % 360 - 90
    motion = (
        Line(x=place, y=operating.shape),
        Points(x=place, y=operating.shape, sources=tuple(points)),
        Rule(value=0.0, along="y", colour="0.5", dash=0),
    )
    panels = (
        Panel(x=across, y=Axis("Shape, greatest 1", lowest=-1.1, highest=1.1), parts=motion),
        Panel(
            x=across,
            y=Axis("Phase", "deg", lowest=-100.0, highest=280.0, ticks=(0, 180)),
            parts=(Points(x=place, y=phase, colour=1, marker=1, sources=tuple(points)),),
        ),
    )
    return Chart(panels=panels, size=(6.0, 3.8), heights=(2, 1), shares_x=True)


@captioned(
    "Modal assurance with computed modes",
    "Modal assurance criterion of the operating shape with each mode: 1 in proportion, 0 orthogonal.",
)
def assurance_figure(assurance_values: Floats) -> Chart:
    """Modal assurance criterion with each mode."""
    place = np.arange(1.0, assurance_values.size + 1)
    bars = Bars(places=place, lengths=assurance_values, along="y")
    return one_panel(
        Axis("Mode", ticks=tuple(place)), Axis("Modal assurance", lowest=0.0, highest=1.02), (bars,), size=(4.2, 2.8)
    )


@captioned("Amplitude over voltage", "Each recording, and the line through the origin with its 95 % interval.")
def proportion_figure(files: Sequence[str], volts: Floats, amplitudes: Floats, fit: AmplitudePerVolt) -> Chart:
    """Amplitude over voltage, a file each, with the line through the origin and its interval."""
    line = np.array([0.0, 1.05 * volts.max()])
    low, middle, high = (1e6 * slope * line for slope in (fit.lower, fit.amplitude_per_volt, fit.upper))
    parts = (
        Band(x=line, low=low, high=high, label="95 %", colour=5, opacity=0.5),
        Line(x=line, y=middle, label="in proportion", weight=0.85),
        Points(x=volts, y=1e6 * amplitudes, label="recordings", colour=1, marker=1, sources=tuple(files)),
    )
    return one_panel(
        Axis("Voltage, peak to peak", "V", lowest=0.0), Axis("Amplitude", "µm", lowest=0.0), parts, size=(4.4, 3.2)
    )


_STRETCHES = 8  # of a recording, whose scatter tells how well an amplitude is known
_MIN_PERIODS = 2.0  # in each


@dataclass(frozen=True, kw_only=True, slots=True)
class VibrationSettings:
    """Settings of the evaluation of a vibrometer recording.

    Parameters
    ----------
    frequency : float
        Of the drive. [Hz]
    mapping : RecordingMapping or None
        What the columns mean.
    modes : ndarray of shape (points, modes), or None
        Computed shapes at the points recorded, one a column, to compare with.

    Raises
    ------
    InvalidInput
        If the frequency is not positive.
    """

    frequency: float
    mapping: RecordingMapping | None = None
    modes: Floats | None = None

    def __post_init__(self) -> None:
        require_positive(frequency=self.frequency)


def vibration_sheet(path: Path, *, settings: VibrationSettings) -> sheet.Sheet:
    """Amplitude and phase of every recorded point at the drive frequency, and the operating shape."""
    recording = read_recording(path, mapping=settings.mapping)
    points, signals, velocities = _points(recording, path)
    time, f = channel_values(recording, "time"), settings.frequency
    per_rate = np.where(velocities, 1 / (2j * np.pi * f), 1.0)
    motion = complex_amplitudes(time=time, signals=signals, frequency=f) * per_rate
    errors = _errors(time, signals, f) * np.abs(per_rate)
    largest = int(np.argmax(np.abs(motion)))
    amplitude, error = float(abs(motion[largest])), _or_none(errors[largest])
    values = [sheet.quantity_value("vibration_amplitude", amplitude, uncertainty=error)]
    drive = _drive_voltage(recording, time, f)
    if drive is not None:
        swing = 2 * abs(drive)
        values += [
            sheet.quantity_value("voltage_peak_to_peak", swing),
            sheet.quantity_value(
                "amplitude_per_volt", amplitude / swing, uncertainty=None if error is None else error / swing
            ),
        ]
        motion = motion * np.exp(-1j * np.angle(drive))
    shape = operating_deflection_shape(motion)
    sections = [sheet.Sheet(values=tuple(values), tables=(_table(points, motion, errors),))]
    if len(points) > 1:
        sections.append(_shape(points, shape))
        if settings.modes is not None:
            sections.append(sheet.attempted(partial(_assurance, motion, settings.modes), what="modal assurance"))
    sections.append(sheet.Sheet(caveats=recording_caveats(recording)))
    return sheet.joined(sections, title=path.name, source=recording_source(recording))


def has_voltage(each: sheet.Sheet) -> bool:
    """Whether a sheet of vibration has the voltage of the drive."""
    return any(value.name == "voltage_peak_to_peak" for value in each.values)


def proportion_sheet(sheets: Sequence[sheet.Sheet]) -> sheet.Sheet:
    """Linearity of amplitude over voltage, from recordings at several voltages."""
    found_in = [
        (each.title, found["voltage_peak_to_peak"], found["vibration_amplitude"])
        for each in sheets
        if "voltage_peak_to_peak" in (found := {value.name: value.value for value in each.values})
    ]
    return sheet.joined(
        [sheet.attempted(partial(_proportion, found_in), what="proportion")],
        title=f"amplitude over voltage, {len(found_in)} recordings",
        source={},
    )


def _points(recording: "xr.Dataset", path: Path) -> tuple[list[str], Floats, Floats]:
    """Names and signals of the recorded points, and whether each is a velocity."""
    names, signals, velocities = [], [], []
    for name in map(str, recording):
        unit = str(recording[name].attrs.get("units", ""))
        for si, is_velocity in (("m", False), ("m/s", True)):
            try:
                values = convert_to_si(channel_values(recording, name), written_unit=unit, unit=si, name=name)
            except InvalidInput:
                continue
            names.append(name)
            signals.append(values)
            velocities.append(is_velocity)
    if not names:
        raise InvalidInput(f"{path}: no channel is a displacement or a velocity; give units, or a mapping")
    return names, np.stack(signals), np.array(velocities)


def _drive_voltage(recording: "xr.Dataset", time: Floats, frequency: float) -> complex | None:
    """Complex amplitude of the drive voltage; None where it was not recorded."""
    for name in map(str, recording):
        if str(recording[name].attrs.get("units", "")) == "V":
            return complex(
                complex_amplitudes(time=time, signals=channel_values(recording, name), frequency=frequency)[0]
            )
    return None


def _errors(time: Floats, signals: Floats, frequency: float) -> Floats:
    """Standard errors of the amplitudes by their scatter over eight stretches; NaN for short recordings."""
    edges = np.linspace(0, time.size, _STRETCHES + 1).astype(int)
    if np.diff(edges).min() < 2 or (time[edges[1] - 1] - time[0]) * frequency < _MIN_PERIODS:
        return np.full(signals.shape[0], np.nan)
    each = np.stack(
        [
            complex_amplitudes(time=time[first:last], signals=signals[:, first:last], frequency=frequency)
            for first, last in pairwise(edges.tolist())
        ]
    )
    return np.asarray(np.abs(each).std(axis=0, ddof=1) / np.sqrt(_STRETCHES))


def _or_none(error: float) -> float | None:
    """Error, or None for NaN."""
    return None if np.isnan(error) else float(error)


def _table(points: Sequence[str], motion: Complexes, errors: Floats) -> sheet.Table:
    """Amplitude, uncertainty and phase of each point."""
    columns = (
        sheet.Column("point", "Point"),
        *sheet.quantity_columns({"vibration_amplitude": "Amplitude"}),
        sheet.Column("vibration_amplitude_uncertainty", "Uncertainty", "m"),
        sheet.Column("phase", "Phase", "rad"),
    )
    rows = tuple(
        (name, float(abs(x)), _or_none(error), float(np.angle(x)))
        for name, x, error in zip(points, motion, errors, strict=True)
    )
    return sheet.Table(name="points", title="Points", columns=columns, rows=rows)


def _shape(points: Sequence[str], shape: OperatingDeflectionShape) -> sheet.Sheet:
    """Operating shape, and the fraction of the motion that is in phase."""
    value = sheet.Value("standing_wave_fraction", "Fraction of the motion in phase", shape.standing_wave_fraction, "")
    figure = shape_figure(points, shape)
    return sheet.Sheet(values=(value,), figures=(figure,))


def _assurance(motion: Complexes, modes: Floats) -> sheet.Sheet:
    """Modal assurance criterion of the operating shape with each computed mode."""
    assurance = modal_assurance_criterion(motion, modes)[0]
    columns = (sheet.Column("mode", "Mode"), sheet.Column("assurance", "Modal assurance"))
    rows = tuple((f"{place}", float(value)) for place, value in enumerate(assurance, start=1))
    figure = assurance_figure(assurance)
    table = sheet.Table(name="modes", title="Modal assurance with computed modes", columns=columns, rows=rows)
    return sheet.Sheet(tables=(table,), figures=(figure,))


def _proportion(found_in: Sequence[tuple[str, float, float]]) -> sheet.Sheet:
    """Line through the origin with its interval, and the significance of a curvature."""
    volts, amplitudes = (np.array([each[which] for each in found_in]) for which in (1, 2))
    fit = amplitude_per_volt(voltage_peak_to_peak=volts, vibration_amplitude=amplitudes)
    values = (
        sheet.quantity_value("amplitude_per_volt", fit.amplitude_per_volt, interval=(fit.lower, fit.upper)),
        sheet.field_value(fit, "amplitude_deviation"),
        sheet.field_value(fit, "curvature_p_value", "p value of the curvature"),
    )
    caveat = f"amplitude is not in proportion to voltage: the slope changes by {fit.curvature:+.0%}"
    caveats = () if fit.proportional else (caveat,)
    figure = proportion_figure([name for name, *_ in found_in], volts, amplitudes, fit)
    return sheet.Sheet(values=values, figures=(figure,), caveats=caveats)
