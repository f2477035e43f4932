"""Cells of spreadsheets (XLSX, ODS) as texts, by python-calamine."""

import io
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final

from sonolube.errors import InvalidInput
from sonolube.extras import missing_package
from sonolube.measurement.measured_files import most_values, refuse_unreadable
from sonolube.measurement.recordings.raw_table import refuse_library_errors
from sonolube.measurement.recordings.text_tables import NumberedCells
from sonolube.storage.user_files import input_bytes

_MAX_DECIMALS: Final = 12  # of a number that is computed, whose further digits are those of its binary form
_PARTS: Final = ("xl/workbook.xml", "opendocument.spreadsheet")  # of an archive that is a spreadsheet


def is_spreadsheet(path: Path) -> bool:
    """Whether an archive is a spreadsheet: by the names that it holds, or by its suffix."""
    with refuse_unreadable(path):
        content = input_bytes(path)
    return path.suffix.lower() in (".xlsx", ".xlsm", ".ods") or any(part.encode() in content for part in _PARTS)


def spreadsheet_rows(path: Path) -> Mapping[str, list[NumberedCells]]:
    """Rows with a filled cell by the sheet that has them, each with its number.

    Parameters
    ----------
    path : Path
        XLSX or ODS.

    Returns
    -------
    mapping of str to list of (int, list of str)
        Numbers have as many decimals as the one of their column that needs the most, since a spreadsheet does not keep
        those that were typed.

    Raises
    ------
    MissingPackage
        If python-calamine is not installed.
    InvalidInput
        If the file cannot be read.
    """
    try:
        from python_calamine import CalamineWorkbook
    except ImportError:
        raise missing_package("spreadsheets", context=str(path), remedy="save the table as CSV") from None
    with refuse_unreadable(path):
        content = input_bytes(path)
    limit = most_values(path)
    found: dict[str, list[NumberedCells]] = {}
    with refuse_library_errors(path, format_name="a spreadsheet"):
        workbook = CalamineWorkbook.from_filelike(io.BytesIO(content))
        for name in workbook.sheet_names:
            sheet = workbook.get_sheet_by_name(name)
            if sheet.total_height * sheet.total_width > limit:
                raise InvalidInput(f"{path}: sheet {name!r} states more than {limit} cells; save the runs as CSV")
            found[name] = _rows(sheet.to_python(skip_empty_area=False))
    return {name: rows for name, rows in found.items() if rows}


def _rows(cells: Sequence[Sequence[object]]) -> list[NumberedCells]:
    """Rows that are not empty, as texts."""
    width = max(map(len, cells), default=0)
    columns = [[row[place] for row in cells if place < len(row)] for place in range(width)]
    decimals = [max((_decimals(cell) for cell in column), default=0) for column in columns]
    rows = [[_text(cell, count) for cell, count in zip(row, decimals, strict=False)] for row in cells]
    return [(number, row) for number, row in enumerate(rows, 1) if any(cell.strip() for cell in row)]


def _decimals(cell: object) -> int:
    """Decimals that a number needs, at most `_MAX_DECIMALS`."""
    if not isinstance(cell, float):
        return 0
    text = f"{cell:.{_MAX_DECIMALS}f}".rstrip("0")
    return len(text.partition(".")[2])


def _text(cell: object, decimals: int) -> str:
    """Text of a cell."""
    if isinstance(cell, float):
        return f"{cell:.{decimals}f}" if abs(cell) >= 10.0**-_MAX_DECIMALS or not cell else repr(cell)
    return str(cell)
