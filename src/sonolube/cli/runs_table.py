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
_BEYOND_ANY_RUN = 1e30  # in any unit; keeps squares of quantities within what a float can hold
_TOLD = 40  # characters of a cell in a complaint


def read_runs(path: Path) -> "xr.Dataset":
    """Return runs from a CSV file whose head names quantities, such as `sliding_speed [mm/s]`.

    Raises
    ------
    InvalidInput
        In one line that names the file, the column and the cell.
    """
    import xarray as xr

    try:
        with path.open(newline="", encoding="utf-8-sig") as stream:
            rows = [row for row in csv.reader(stream) if any(cell.strip() for cell in row)]
    except OSError as failure:
        raise InvalidInput(f"{path}: cannot be read: {failure.strerror}") from None
    except (UnicodeDecodeError, csv.Error):
        raise InvalidInput(f"{path}: not a table of comma-separated values") from None
    if len(rows) < 2:
        raise InvalidInput(f"{path}: needs a head and at least one run")
    for line, row in enumerate(rows[1:], 2):
        if len(row) > len(rows[0]):
            raise InvalidInput(f"{path}: line {line}: has {len(row)} cells where {len(rows[0])} columns are named")
    columns: dict[str, list[float]] = {}
    for place, head in enumerate(rows[0]):
        found = _COLUMN.fullmatch(head.strip())
        if not found or found[1] not in quantities():
            told = "separate columns by commas" if ";" in head or "\t" in head else "such as sliding_speed [mm/s]"
            raise InvalidInput(f"{path}: column {_brief(head)} must name a quantity; {told}")
        if found[1] in columns:
            raise InvalidInput(f"{path}: two columns are named {found[1]}")
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
        raise InvalidInput(f"{path}: line {line}: {name} {_brief(cell)} is no number") from None
    if abs(number) > _BEYOND_ANY_RUN:
        raise InvalidInput(f"{path}: line {line}: {name} {_brief(cell)} lies beyond any run")
    return to_si(f"{number!r} {unit}", unit=quantities()[name].unit, name=f"{path}: line {line}: {name}")


def _brief(cell: str) -> str:
    """Return a cell as a complaint quotes it."""
    told = cell.strip()
    return repr(told if len(told) <= _TOLD else told[:_TOLD] + "...")
