"""Sheets of Hall-probe recordings: rotation speed of the disc and sliding speed of the pin."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sonolube.measurement.friction_analysis import analyse_rotation, channel_values
from sonolube.measurement.recordings.mapping import RecordingMapping
from sonolube.measurement.recordings.reader import read_recording
from sonolube.report.measured import rotation_figures as figures, sheet
from sonolube.report.measured.friction import recording_source


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
        figures.speed_figure(rotation),
        figures.pulses_figure(
            channel_values(recording, "time"), channel_values(recording, "magnetic_flux_density"), rotation
        ),
    )
    caveat = f"{interpolated} of {rotation.time.size} pulses were missing; lower the prominence or move the probe"
    caveats = (caveat,) if interpolated > rotation.time.size / 10 else ()
    section = sheet.Sheet(values=tuple(values), figures=pictures, caveats=caveats)
    return sheet.joined([section], title=path.name, source=recording_source(recording))
