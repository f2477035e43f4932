"""The command that measures vibration."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from sonolube.cli.measure_friction import Mapping
from sonolube.cli.measuring import Files, Report, Test, answer, each_file, quantity
from sonolube.cli.operate import Json

if TYPE_CHECKING:
    from sonolube.checks import Floats


def vibration(
    files: Files,
    drive: Annotated[str, typer.Option("--frequency", metavar="FREQUENCY", help="Of the drive, such as 22kHz.")],
    modes: Annotated[
        Path | None, typer.Option(metavar="MODES.csv", help="Computed shapes at the points, one a column.")
    ] = None,
    mapping: Mapping = None,
    test: Test = None,
    report: Report = None,
    json: Json = False,
) -> None:
    """Vibration at the drive frequency: amplitude, amplitude per volt, operating shape, likeness to computed modes.

    Example: sonolube measure vibration tip.csv --frequency 22kHz --report tip.html
    """
    from functools import partial

    from sonolube.measurement.recordings.mapping import read_mapping
    from sonolube.report.measured.vibration import VibrationSettings, proportion_sheet, vibration_sheet

    settings = VibrationSettings(
        frequency=quantity(drive, unit="Hz", option="--frequency") or 0.0,
        mapping=None if mapping is None else read_mapping(mapping),
        modes=None if modes is None else _shapes(modes),
    )
    sheets, refused = each_file(files, partial(vibration_sheet, settings=settings), what="measuring")
    if sum(any(value.name == "voltage_peak_to_peak" for value in sheet.values) for sheet in sheets) > 1:
        sheets.append(proportion_sheet(sheets))
    used = {"frequency": drive, "modes": modes, "mapping": mapping}
    answer("vibration", sheets, refused, settings=used, page=report, test=test, as_json=json)


def _shapes(path: Path) -> "Floats":
    import numpy as np

    from sonolube.errors import InvalidInput

    try:
        return np.loadtxt(path, delimiter=",", comments="#", ndmin=2, dtype=np.float64)
    except (OSError, ValueError) as failure:
        raise InvalidInput(f"{path}: is no table of numbers with commas between: {failure}") from None
