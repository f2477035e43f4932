"""The command that calibrates a displacement sensor as a force gauge."""

from pathlib import Path
from typing import Annotated

import typer

from sonolube.cli.measure_friction import Mapping
from sonolube.cli.measuring import Files, Report, Test, answer, each_file, quantity
from sonolube.cli.operate import Json


def calibration(
    files: Files,
    applied: Annotated[
        list[Path] | None,
        typer.Option("--apply", metavar="FILE", help="A displacement to tell the force of; may come again."),
    ] = None,
    mapping: Mapping = None,
    degree: Annotated[int, typer.Option(help="Of the polynomials of loading and unloading.", min=1, max=7)] = 3,
    levels: Annotated[int, typer.Option(help="Of displacement in Preisach's model.", min=2, max=64)] = 16,
    uncertainty: Annotated[
        str, typer.Option("--displacement-uncertainty", metavar="LENGTH", help="Of a reading, standard.")
    ] = "0um",
    test: Test = None,
    report: Report = None,
    json: Json = False,
) -> None:
    """Calibration of a displacement sensor as a force gauge with hysteresis, and forces told by it.

    Example: sonolube measure calibration loops.csv --apply test.csv --report gauge.html
    """
    from functools import partial

    from sonolube.errors import InvalidInput
    from sonolube.measurement.recordings.mapping import read_mapping
    from sonolube.report.measured.calibration import (
        CalibrationSettings,
        calibrated_hysteresis,
        calibration_sheet,
        force_sheet,
    )

    settings = CalibrationSettings(
        mapping=None if mapping is None else read_mapping(mapping),
        degree=degree,
        levels=levels,
        displacement_uncertainty=quantity(uncertainty, unit="m", option="--displacement-uncertainty") or 0.0,
    )
    sheets, refused = each_file(files, partial(calibration_sheet, settings=settings), what="calibrating")
    if applied:
        if len(files) != 1:
            raise InvalidInput("--apply needs one calibration; give one file before it")
        tell = partial(force_sheet, calibration=calibrated_hysteresis(files[0], settings=settings), settings=settings)
        told, told_refused = each_file(applied, tell, what="telling forces")
        sheets, refused = [*sheets, *told], refused | told_refused
    used = {
        "applied to": ", ".join(path.name for path in applied or ()) or None,
        "mapping": mapping,
        "degree": degree,
        "levels": levels,
        "displacement uncertainty": uncertainty,
    }
    answer("calibration", sheets, refused, settings=used, page=report, test=test, as_json=json)
