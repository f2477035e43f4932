"""Calibrations of a displacement sensor as a force gauge, and forces told by it, as sheets."""

from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from sonolube.checks import Floats
from sonolube.measurement.friction_analysis import channel_values
from sonolube.measurement.gauge.calibration import (
    BranchCalibration,
    PreisachCalibration,
    fit_branches,
    fit_preisach,
    force_from_preisach,
    major_loop_dissipation,
)
from sonolube.measurement.recordings.mapping import RecordingMapping
from sonolube.measurement.recordings.reader import read_recording
from sonolube.report.measured import calibration_figures as figures
from sonolube.report.measured.friction import recording_source
from sonolube.report.measured.sheet import (
    Column,
    Part,
    Sheet,
    SheetFigure,
    SheetTable,
    Value,
    attempted,
    known,
    sheet_of,
)


@dataclass(frozen=True, kw_only=True, slots=True)
class CalibrationSettings:
    """What a calibration depends on.

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


def calibration_sheet(path: Path, *, settings: CalibrationSettings) -> Sheet:
    """Return the calibration that a recording of displacement and force bears out.

    Parameters
    ----------
    path : Path
        A recording with `displacement` and `applied_force`.
    settings : CalibrationSettings

    Returns
    -------
    Sheet

    Raises
    ------
    InvalidInput
        If the file cannot be read or its displacement does not vary.
    """
    recording = read_recording(path, mapping=settings.mapping)
    x, force = channel_values(recording, "displacement"), channel_values(recording, "applied_force")
    hysteresis = fit_preisach(displacement=x, applied_force=force, levels=settings.levels)
    span = float(np.ptp(force))
    values = (
        Value(
            name="hysteresis_deviation",
            label="Deviation about Preisach's model",
            value=hysteresis.force_deviation,
            unit="N",
        ),
        Value(
            name="relative_deviation",
            label="The same over the range of force",
            value=hysteresis.force_deviation / span,
            unit="",
        ),
        Value(
            name="dissipated_energy",
            label="Energy lost in the greatest loop",
            value=major_loop_dissipation(hysteresis),
            unit="J",
        ),
        Value(
            name="mean_stiffness",
            label="Force over displacement of the whole range",
            value=span / float(np.ptp(x)),
            unit="N/m",
        ),
    )
    loop = SheetFigure(
        name="loops",
        title="Force over displacement",
        caption="Measured loops and those of Preisach's model; below, what is left.",
        draw=partial(figures.loops, x, force, hysteresis),
    )
    branches = attempted(partial(_branches, x, force, settings.degree), what="polynomials of the branches")
    return sheet_of(
        [Part(values=values, figures=(loop,)), branches], title=path.name, source=recording_source(recording)
    )


def calibrated_hysteresis(path: Path, *, settings: CalibrationSettings) -> PreisachCalibration:
    """Return the calibration of a recording, to tell forces by.

    Parameters
    ----------
    path : Path
        A recording with `displacement` and `applied_force`.
    settings : CalibrationSettings

    Returns
    -------
    PreisachCalibration

    Raises
    ------
    InvalidInput
        As `calibration_sheet`.
    """
    recording = read_recording(path, mapping=settings.mapping)
    return fit_preisach(
        displacement=channel_values(recording, "displacement"),
        applied_force=channel_values(recording, "applied_force"),
        levels=settings.levels,
    )


def force_sheet(path: Path, *, calibration: PreisachCalibration, settings: CalibrationSettings) -> Sheet:
    """Return the force that a recorded displacement tells.

    Parameters
    ----------
    path : Path
        A recording with `displacement`, from the unloaded state on.
    calibration : PreisachCalibration
    settings : CalibrationSettings

    Returns
    -------
    Sheet

    Raises
    ------
    InvalidInput
        If the file cannot be read.
    OutsideRange
        If the displacement leaves the range that was calibrated.
    """
    recording = read_recording(path, mapping=settings.mapping)
    told = force_from_preisach(
        calibration,
        displacement=channel_values(recording, "displacement"),
        displacement_uncertainty=settings.displacement_uncertainty,
    )
    # readings share the error of the calibration, so that averaging does not lower it
    mean, error = float(told.applied_force.mean()), float(told.applied_force_uncertainty.mean())
    highest = int(np.argmax(told.applied_force))
    values = (
        known("applied_force", mean, label="Mean force", uncertainty=error),
        Value(
            name="highest_force",
            label="Highest force",
            value=float(told.applied_force[highest]),
            unit="N",
            uncertainty=float(told.applied_force_uncertainty[highest]),
        ),
    )
    drawn = SheetFigure(
        name="force",
        title="Force told by the displacement",
        caption="With its standard uncertainty as a band.",
        draw=partial(figures.force, channel_values(recording, "time"), told),
    )
    return sheet_of([Part(values=values, figures=(drawn,))], title=path.name, source=recording_source(recording))


def _branches(x: Floats, force: Floats, degree: int) -> Part:
    found = fit_branches(displacement=x, applied_force=force, degree=degree)
    values = (
        Value(
            name="loading_deviation",
            label="Deviation about the polynomial of loading",
            value=found.loading_deviation,
            unit="N",
        ),
        Value(
            name="unloading_deviation",
            label="Deviation about the polynomial of unloading",
            value=found.unloading_deviation,
            unit="N",
        ),
    )
    return Part(values=values, tables=(_coefficients(found),))


def _coefficients(found: BranchCalibration) -> SheetTable:
    columns = (
        Column(name="power", label="Power of the displacement in m"),
        Column(name="loading", label="Loading (N)"),
        Column(name="unloading", label="Unloading (N)"),
    )
    pairs = zip(found.loading.convert().coef, found.unloading.convert().coef, strict=True)
    return SheetTable(
        name="branches",
        title="Force as a polynomial of displacement",
        columns=columns,
        rows=tuple((float(power), float(up), float(down)) for power, (up, down) in enumerate(pairs)),
    )
