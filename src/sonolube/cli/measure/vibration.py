"""Command `measure vibration`: amplitudes, operating shape and modal assurance of vibrometer recordings."""

from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from sonolube.cli.console.number_table import number_table
from sonolube.cli.console.options import Json
from sonolube.cli.measure.measured_files import Files, Mapped, Report, Test, column_mapping, deliver_sheets, each_file
from sonolube.report.measured.vibration import VibrationSettings, has_voltage, proportion_sheet, vibration_sheet
from sonolube.units import to_si


def vibration(
    files: Files,
    drive: Annotated[str, typer.Option("--frequency", metavar="FREQUENCY", help="Of the drive, such as 22kHz.")],
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
        frequency=to_si(drive, unit="Hz", name="--frequency"),
        mapping=column_mapping(mapping),
        modes=None if modes is None else number_table(modes),
    )
    sheets, refused = each_file(files, partial(vibration_sheet, settings=settings), title="measuring")
    if sum(map(has_voltage, sheets)) > 1:
        sheets.append(proportion_sheet(sheets))
    options = {"frequency": drive, "modes": modes, "mapping": mapping}
    deliver_sheets("vibration", sheets, refused, settings=options, page=report, test=test, as_json=json)
