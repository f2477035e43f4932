"""Calibrations of a displacement sensor as a force gauge, and forces told by it, as sheets."""

from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from sonolube.checks import Floats
from sonolube.measurement.analysis import channel
from sonolube.measurement.gauge.calibration import (
    BranchCalibration,
    HysteresisCalibration,
    fit_branches,
    fit_hysteresis,
    force_with_hysteresis,
    model_energy,
)
from sonolube.measurement.recordings.mapping import RecordingMapping
from sonolube.measurement.recordings.reader import read_recording
from sonolube.report.measured import calibration_figures as figures
from sonolube.report.measured.friction import recording_source
from sonolube.report.measured.sheet import (
    Sheet,
    SheetColumn,
    SheetFigure,
    SheetSection,
    SheetTable,
    SheetValue,
    attempted_section,
    quantity_value,
    sheet_from_sections,
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
    x, force = channel(recording, "displacement"), channel(recording, "applied_force")
    hysteresis = fit_hysteresis(displacement=x, applied_force=force, levels=settings.levels)
    span = float(np.ptp(force))
    values = (
        SheetValue(
            name="hysteresis_deviation",
            label="Deviation about Preisach's model",
            value=hysteresis.force_deviation,
            unit="N",
        ),
        SheetValue(
            name="relative_deviation",
            label="The same over the range of force",
            value=hysteresis.force_deviation / span,
            unit="",
        ),
        SheetValue(
            name="dissipated_energy",
            label="Energy lost in the greatest loop",
            value=model_energy(hysteresis),
            unit="J",
        ),
        SheetValue(
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
    branches = attempted_section(partial(_branches, x, force, settings.degree), what="polynomials of the branches")
    return sheet_from_sections(
        [SheetSection(values=values, figures=(loop,)), branches], title=path.name, source=recording_source(recording)
    )


def calibrated_hysteresis(path: Path, *, settings: CalibrationSettings) -> HysteresisCalibration:
    """Return the calibration of a recording, to tell forces by.

    Parameters
    ----------
    path : Path
        A recording with `displacement` and `applied_force`.
    settings : CalibrationSettings

    Returns
    -------
    HysteresisCalibration

    Raises
    ------
    InvalidInput
        As `calibration_sheet`.
    """
    recording = read_recording(path, mapping=settings.mapping)
    return fit_hysteresis(
        displacement=channel(recording, "displacement"),
        applied_force=channel(recording, "applied_force"),
        levels=settings.levels,
    )


def force_sheet(path: Path, *, calibration: HysteresisCalibration, settings: CalibrationSettings) -> Sheet:
    """Return the force that a recorded displacement tells.

    Parameters
    ----------
    path : Path
        A recording with `displacement`, from the unloaded state on.
    calibration : HysteresisCalibration
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
    told = force_with_hysteresis(
        calibration,
        displacement=channel(recording, "displacement"),
        displacement_uncertainty=settings.displacement_uncertainty,
    )
    # readings share the error of the calibration, so that averaging does not lower it
    mean, error = float(told.applied_force.mean()), float(told.applied_force_uncertainty.mean())
    highest = int(np.argmax(told.applied_force))
    values = (
        quantity_value("applied_force", mean, label="Mean force", uncertainty=error),
        SheetValue(
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
        draw=partial(figures.force, channel(recording, "time"), told),
    )
    return sheet_from_sections(
        [SheetSection(values=values, figures=(drawn,))], title=path.name, source=recording_source(recording)
    )


def _branches(x: Floats, force: Floats, degree: int) -> SheetSection:
    found = fit_branches(displacement=x, applied_force=force, degree=degree)
    values = (
        SheetValue(
            name="loading_deviation",
            label="Deviation about the polynomial of loading",
            value=found.loading_deviation,
            unit="N",
        ),
        SheetValue(
            name="unloading_deviation",
            label="Deviation about the polynomial of unloading",
            value=found.unloading_deviation,
            unit="N",
        ),
    )
    return SheetSection(values=values, tables=(_coefficients(found),))


def _coefficients(found: BranchCalibration) -> SheetTable:
    columns = (
        SheetColumn(name="power", label="Power of the displacement in m"),
        SheetColumn(name="loading", label="Loading (N)"),
        SheetColumn(name="unloading", label="Unloading (N)"),
    )
    pairs = zip(found.loading.convert().coef, found.unloading.convert().coef, strict=True)
    return SheetTable(
        name="branches",
        title="Force as a polynomial of displacement",
        columns=columns,
        rows=tuple((float(power), float(up), float(down)) for power, (up, down) in enumerate(pairs)),
    )
