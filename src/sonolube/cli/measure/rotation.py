"""Command `measure rotation`: speed of a disc and of the pin on it from a Hall probe."""

from functools import partial
from typing import Annotated

import typer

from sonolube.cli.console.options import Json, si_option
from sonolube.cli.measure.measured_files import Files, Mapped, Report, Test, column_mapping, deliver_sheets, each_file
from sonolube.report.measured.rotation import RotationSettings, rotation_sheet


def rotation(
    context: typer.Context,
    files: Files,
    diameter: Annotated[float, si_option("m", "Of the circle under the pin.", "--groove-diameter")],
    magnets: Annotated[int, typer.Option(help="Magnets at the rim.", min=1)] = 1,
    prominence: Annotated[
        float, typer.Option(help="Weakest pulse that counts over the strongest.", min=0.01, max=1.0)
    ] = 0.25,
    mapping: Mapped = None,
    test: Test = None,
    report: Report = None,
    json: Json = False,
) -> None:
    """Rotation from a Hall probe: speed of the disc and of the pin on it, missing pulses repaired.

    Example: sonolube measure rotation hall.csv --groove-diameter 50mm --magnets 2 --report hall.html
    """
    settings = RotationSettings(
        groove_diameter=diameter, magnets=magnets, prominence=prominence, mapping=column_mapping(mapping)
    )
    sheets, refused = each_file(files, partial(rotation_sheet, settings=settings), title="measuring")
    deliver_sheets(context, "rotation", sheets, refused, page=report, test=test, as_json=json)
