"""Recordings of a Hall probe as sheets: speed of the disc, and of the pin on it."""

from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from sonolube.measurement.analysis import analyse_rotation, channel
from sonolube.measurement.recordings.mapping import RecordingMapping
from sonolube.measurement.recordings.reader import read_recording
from sonolube.report.measured import rotation_figures as figures
from sonolube.report.measured.friction import recording_source
from sonolube.report.measured.sheet import (
    Sheet,
    SheetFigure,
    SheetSection,
    SheetValue,
    quantity_value,
    sheet_from_sections,
)


@dataclass(frozen=True, kw_only=True, slots=True)
class RotationSettings:
    """What the speed of a disc depends on.

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


def rotation_sheet(path: Path, *, settings: RotationSettings) -> Sheet:
    """Return how fast a disc turned.

    Parameters
    ----------
    path : Path
        A recording with `magnetic_flux_density`.
    settings : RotationSettings

    Returns
    -------
    Sheet

    Raises
    ------
    InvalidInput
        If the file cannot be read or shows fewer pulses than a turn needs.
    """
    recording = read_recording(path, mapping=settings.mapping)
    turning = analyse_rotation(
        recording,
        groove_diameter=settings.groove_diameter,
        magnets=settings.magnets,
        prominence=settings.prominence,
    )
    around, error = np.pi * settings.groove_diameter, turning.rotation_speed_uncertainty
    turns = turning.rotation_speed
    repaired = int(turning.repaired.sum())
    values = [
        quantity_value("rotation_speed", turning.mean_rotation_speed, uncertainty=error),
        quantity_value("sliding_speed", around * turning.mean_rotation_speed, uncertainty=around * error),
        quantity_value("revolutions", float(turning.revolutions[-1])),
        quantity_value("sliding_distance", around * float(turning.revolutions[-1])),
        SheetValue(name="pulses", label="Pulses", value=float(turning.time.size), unit=""),
        SheetValue(name="repaired_pulses", label="Missing pulses put in", value=float(repaired), unit=""),
    ]
    if turns.size > 1:
        spread = float(turns.std(ddof=1)) / turning.mean_rotation_speed
        values.append(
            SheetValue(
                name="speed_variation", label="Deviation of the turns' speed over its mean", value=spread, unit=""
            )
        )
    drawn = (
        SheetFigure(
            name="speed",
            title="Speed turn by turn",
            caption="Each turn is timed from a magnet to the same magnet; the line is the mean.",
            draw=partial(figures.speed, turning),
        ),
        SheetFigure(
            name="pulses",
            title="Pulses of the probe",
            caption="The first turns, with the pulses that count and those put in where one was missing.",
            draw=partial(
                figures.pulses, channel(recording, "time"), channel(recording, "magnetic_flux_density"), turning
            ),
        ),
    )
    caveats: tuple[str, ...] = ()
    if repaired > turning.time.size / 10:
        caveats = (f"{repaired} of {turning.time.size} pulses were missing; lower the prominence or move the probe",)
    return sheet_from_sections(
        [SheetSection(values=tuple(values), figures=drawn, caveats=caveats)],
        title=path.name,
        source=recording_source(recording),
    )
