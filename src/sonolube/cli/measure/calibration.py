"""Command `measure calibration`: a displacement sensor as a force gauge with hysteresis."""

from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from sonolube.cli.console.options import Json, TypedNumber, refuse_unused, si_option
from sonolube.cli.measure.measured_files import Files, Mapped, Report, Test, column_mapping, deliver_sheets, each_file
from sonolube.errors import InvalidInput
from sonolube.report.measured.calibration import (
    CalibrationSettings,
    calibrated_hysteresis,
    calibration_sheet,
    force_sheet,
)


def calibration(
    context: typer.Context,
    files: Files,
    applied: Annotated[
        list[Path] | None,
        typer.Option("--apply", metavar="FILE", help="A displacement to compute the force of; may come again."),
    ] = None,
    mapping: Mapped = None,
    degree: Annotated[int, typer.Option(help="Of the polynomials of loading and unloading.", min=1, max=7)] = 3,
    levels: Annotated[int, typer.Option(help="Of displacement in the Preisach model.", min=2, max=64)] = 16,
    uncertainty: Annotated[
        float, si_option("m", "Of a reading, standard.", "--displacement-uncertainty")
    ] = TypedNumber("0um", "m"),
    test: Test = None,
    report: Report = None,
    json: Json = False,
) -> None:
    """Calibration of a displacement sensor as a force gauge with hysteresis, and forces by it.

    Example: sonolube measure calibration loops.csv --apply test.csv --report gauge.html
    """
    if not applied:
        refuse_unused(context, "uncertainty", because="without --apply, whose forces it makes uncertain")
    settings = CalibrationSettings(
        mapping=column_mapping(mapping), degree=degree, levels=levels, displacement_uncertainty=uncertainty
    )
    sheets, refused = each_file(files, partial(calibration_sheet, settings=settings), title="calibrating")
    if applied:
        if len(files) != 1:
            raise InvalidInput("--apply needs one calibration; give one file before it")
        gauge = calibrated_hysteresis(files[0], settings=settings)
        measure = partial(force_sheet, calibration=gauge, settings=settings)
        forces, forces_refused = each_file(applied, measure, title="computing forces")
        sheets, refused = [*sheets, *forces], refused | forces_refused
    deliver_sheets(context, "calibration", sheets, refused, page=report, test=test, as_json=json)
