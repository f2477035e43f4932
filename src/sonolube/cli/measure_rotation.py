"""The command that measures how fast a disc turns."""

from typing import Annotated

import typer

from sonolube.cli.measure_friction import Mapping
from sonolube.cli.measuring import Files, Report, Test, answer, each_file, quantity
from sonolube.cli.operate import Json


def rotation(
    files: Files,
    diameter: Annotated[str, typer.Option("--groove-diameter", metavar="LENGTH", help="Of the circle under the pin.")],
    magnets: Annotated[int, typer.Option(help="Magnets at the rim.", min=1)] = 1,
    prominence: Annotated[
        float, typer.Option(help="Weakest pulse that counts over the strongest.", min=0.01, max=1.0)
    ] = 0.25,
    mapping: Mapping = None,
    test: Test = None,
    report: Report = None,
    json: Json = False,
) -> None:
    """Rotation from a Hall probe: speed of the disc and of the pin on it, missing pulses repaired.

    Example: sonolube measure rotation hall.csv --groove-diameter 50mm --magnets 2 --report hall.html
    """
    from functools import partial

    from sonolube.measurement.recordings.mapping import read_mapping
    from sonolube.report.measured.rotation import RotationSettings, rotation_sheet

    settings = RotationSettings(
        groove_diameter=quantity(diameter, unit="m", option="--groove-diameter") or 0.0,
        magnets=magnets,
        prominence=prominence,
        mapping=None if mapping is None else read_mapping(mapping),
    )
    sheets, refused = each_file(files, partial(rotation_sheet, settings=settings), what="measuring")
    used = {
        "groove diameter": diameter,
        "magnets": magnets,
        "prominence": prominence,
        "mapping": mapping,
    }
    answer("rotation", sheets, refused, settings=used, page=report, test=test, as_json=json)
