"""Measured runs from a table: one row to a run, a quantity with its unit to a column."""

import csv
import re
from pathlib import Path
from typing import TYPE_CHECKING

from sonolube.errors import InvalidInput
from sonolube.units import to_si
from sonolube.vocabulary import quantities

if TYPE_CHECKING:
    import xarray as xr

_COLUMN = re.compile(r"(\w+)\s*(?:\[([^\]]*)\])?")


def read_runs(path: Path) -> "xr.Dataset":
    """Return runs from a CSV file whose head names quantities, such as `sliding_speed [mm/s]`.

    Raises
    ------
    InvalidInput
        In one line that names the file, the column and the cell.
    """
    import xarray as xr

    try:
        with path.open(newline="", encoding="utf-8") as stream:
            rows = [row for row in csv.reader(stream) if any(cell.strip() for cell in row)]
    except OSError as failure:
        raise InvalidInput(f"{path}: cannot be read: {failure.strerror}") from None
    except (UnicodeDecodeError, csv.Error):
        raise InvalidInput(f"{path}: not a table of comma-separated values") from None
    if len(rows) < 2:
        raise InvalidInput(f"{path}: needs a head and at least one run")
    columns = {}
    for place, head in enumerate(rows[0]):
        found = _COLUMN.fullmatch(head.strip())
        if not found or found[1] not in quantities():
            raise InvalidInput(f"{path}: column {head.strip()!r} must name a quantity, such as sliding_speed [mm/s]")
        columns[found[1]] = [
            _cell(path, line, row, place, found[1], found[2] or "") for line, row in enumerate(rows[1:], 2)
        ]
    if "friction_reduction" not in columns:
        raise InvalidInput(f"{path}: needs a column friction_reduction [%]")
    return xr.Dataset(
        {name: ("run", values) for name, values in columns.items()}, attrs={"title": f"{path.name}, in %"}
    )


def _cell(path: Path, line: int, row: list[str], place: int, name: str, unit: str) -> float:
    cell = row[place].strip() if place < len(row) else ""
    try:
        number = float(cell)
    except ValueError:
        raise InvalidInput(f"{path}: line {line}: {name} {cell!r} is no number") from None
    if unit == "%":
        return number / 100
    return to_si(f"{number!r} {unit}", unit=quantities()[name].unit, name=f"{path}: line {line}: {name}")
