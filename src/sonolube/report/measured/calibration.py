"""Sheets of force gauges: calibration of a displacement sensor with hysteresis, and forces by it."""

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
    Sheet,
    SheetColumn,
    SheetSection,
    SheetTable,
    SheetValue,
    attempted_section,
    quantity_value,
    sheet_from_sections,
)


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


def calibration_sheet(path: Path, *, settings: CalibrationSettings) -> Sheet:
    """Calibration of a force gauge by the Preisach model and by polynomials, from recorded loops.

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
        SheetValue("hysteresis_deviation", "Deviation about the Preisach model", hysteresis.force_deviation, "N"),
        SheetValue(
            "relative_deviation", "Relative deviation, over the range of force", hysteresis.force_deviation / span, ""
        ),
        SheetValue(
            "dissipated_energy", "Energy dissipated in the greatest loop", major_loop_dissipation(hysteresis), "J"
        ),
        SheetValue("mean_stiffness", "Mean stiffness over the whole range", span / float(np.ptp(x)), "N/m"),
    )
    loop = figures.loops(x, force, hysteresis)
    branches = attempted_section(partial(_branches, x, force, settings.degree), what="polynomials of the branches")
    return sheet_from_sections(
        [SheetSection(values=values, figures=(loop,)), branches], title=path.name, source=recording_source(recording)
    )


def calibrated_hysteresis(path: Path, *, settings: CalibrationSettings) -> PreisachCalibration:
    """Preisach model of a force gauge, fitted to recorded loops.

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
    """Force by a calibrated gauge from a recorded displacement, with its uncertainty.

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
    estimate = force_from_preisach(
        calibration,
        displacement=channel_values(recording, "displacement"),
        displacement_uncertainty=settings.displacement_uncertainty,
    )
    # readings share the error of the calibration, so that averaging does not lower it
    mean, error = float(estimate.applied_force.mean()), float(estimate.applied_force_uncertainty.mean())
    highest = int(np.argmax(estimate.applied_force))
    values = (
        quantity_value("applied_force", mean, label="Mean force", uncertainty=error),
        SheetValue(
            "highest_force",
            "Highest force",
            float(estimate.applied_force[highest]),
            "N",
            uncertainty=float(estimate.applied_force_uncertainty[highest]),
        ),
    )
    figure = figures.force(channel_values(recording, "time"), estimate)
    return sheet_from_sections(
        [SheetSection(values=values, figures=(figure,))], title=path.name, source=recording_source(recording)
    )


def _branches(x: Floats, force: Floats, degree: int) -> SheetSection:
    """Polynomials of loading and unloading with the deviations about them."""
    branches = fit_branches(displacement=x, applied_force=force, degree=degree)
    values = (
        SheetValue("loading_deviation", "Deviation about the polynomial of loading", branches.loading_deviation, "N"),
        SheetValue(
            "unloading_deviation", "Deviation about the polynomial of unloading", branches.unloading_deviation, "N"
        ),
    )
    return SheetSection(values=values, tables=(_coefficients(branches),))


def _coefficients(branches: BranchCalibration) -> SheetTable:
    """Coefficients of the polynomials as a table."""
    columns = (
        SheetColumn("power", "Power of the displacement in m"),
        SheetColumn("loading", "Loading (N)"),
        SheetColumn("unloading", "Unloading (N)"),
    )
    pairs = zip(branches.loading.convert().coef, branches.unloading.convert().coef, strict=True)
    return SheetTable(
        name="branches",
        title="Force as a polynomial of displacement",
        columns=columns,
        rows=tuple((float(power), float(up), float(down)) for power, (up, down) in enumerate(pairs)),
    )
