"""Sheets of force gauges: calibration of a displacement sensor with hysteresis, and forces by it."""

from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

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
from sonolube.report.measured import calibration_figures as figures, sheet
from sonolube.report.measured.friction import recording_source

if TYPE_CHECKING:
    import xarray as xr


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
    loop = figures.loops_figure(x, force, hysteresis)
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
    figure = figures.force_figure(channel_values(recording, "time"), estimate)
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
