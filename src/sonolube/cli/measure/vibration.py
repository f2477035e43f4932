"""Command `measure vibration`: amplitudes, operating shape and modal assurance of vibrometer recordings."""

from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from sonolube.cli.console.number_table import number_table
from sonolube.cli.console.options import Json, si_option
from sonolube.cli.measure.measured_files import Files, Mapped, Report, Test, column_mapping, deliver_sheets, each_file
from sonolube.report.measured.vibration import VibrationSettings, has_voltage, proportion_sheet, vibration_sheet


def vibration(
    context: typer.Context,
    files: Files,
    drive: Annotated[float, si_option("Hz", "Of the drive, such as 22kHz.", "--frequency")],
    modes: Annotated[
        Path | None, typer.Option(metavar="MODES.csv", help="Computed shapes at the points, one a column.")
    ] = None,
    mapping: Mapped = None,
    test: Test = None,
    report: Report = None,
    json: Json = False,
) -> None:
    """Vibration at the drive frequency: amplitude, amplitude per volt, operating shape, likeness to computed modes.

    Example: sonolube measure vibration tip.csv --frequency 22kHz --report tip.html
    """
    settings = VibrationSettings(
        frequency=drive, mapping=column_mapping(mapping), modes=None if modes is None else number_table(modes)
    )
    sheets, refused = each_file(files, partial(vibration_sheet, settings=settings), title="measuring")
    if sum(map(has_voltage, sheets)) > 1:
        sheets.append(proportion_sheet(sheets))
    deliver_sheets(context, "vibration", sheets, refused, page=report, test=test, as_json=json)
