"""Reader of measured runs from CSV: one row a run, one column a quantity with its unit."""

import csv
import re
from pathlib import Path
from typing import TYPE_CHECKING

from sonolube.errors import InvalidInput
from sonolube.measurement.file_format import refuse_unreadable
from sonolube.units import to_si
from sonolube.vocabulary import quantities

if TYPE_CHECKING:
    import xarray as xr

_COLUMN = re.compile(r"(\w+)\s*(?:\[([^\]]*)\])?")
_LARGEST = 1e30  # in any unit; keeps squares of quantities within the range of floats
_MOST_RUNS = 100_000
_QUOTED = 40  # characters of a cell in an error message


def read_runs(path: Path) -> "xr.Dataset":
    """Measured runs from a CSV file whose header names quantities, such as `sliding_speed [mm/s]`.

    Parameters
    ----------
    path : Path
        With columns of the vocabulary, among them `friction_reduction`, `friction_ratio`, or `friction_force` and
        `intrinsic_friction_force`.

    Returns
    -------
    xarray.Dataset
        Over `run`, in SI, with a friction reduction.

    Raises
    ------
    InvalidInput
        Naming the file, the column and the cell, if the table cannot be read.
    """
    import xarray as xr

    header, *rows = _rows(path)
    columns: dict[str, list[float]] = {}
    for place, head in enumerate(header):
        found = _COLUMN.fullmatch(head.strip())
        if not found or found[1] not in quantities():
            remedy = "separate columns by commas" if ";" in head or "\t" in head else "such as sliding_speed [mm/s]"
            raise InvalidInput(f"{path}: column {_quoted(head)} must name a quantity; {remedy}")
        name, unit = found[1], found[2] or ""
        if name in columns:
            raise InvalidInput(f"{path}: two columns are named {name}")
        place_of_unit = f"{path}: line 2: {name}"
        numbers = [_number(path, line, row, place, name) for line, row in enumerate(rows, 2)]
        known = (numbers[0], 0, 1)  # a wrong unit is told with the first value
        _, zero, one = (to_si(f"{at} {unit}", unit=quantities()[name].unit, name=place_of_unit) for at in known)
        columns[name] = [zero + (one - zero) * number for number in numbers]
    columns.setdefault("friction_reduction", _friction_reductions(path, columns))
    data = {name: ("run", values) for name, values in columns.items()}
    return xr.Dataset(data, attrs={"title": f"{path.name}, in %"})


def _friction_reductions(path: Path, columns: dict[str, list[float]]) -> list[float]:
    """Friction reduction of each run, by the columns that give it."""
    if "friction_reduction" in columns:
        return columns["friction_reduction"]
    if "friction_ratio" in columns:
        return [1 - ratio for ratio in columns["friction_ratio"]]
    if "friction_force" in columns and "intrinsic_friction_force" in columns:
        without = columns["intrinsic_friction_force"]
        for line, force in enumerate(without, 2):
            if not force > 0:
                raise InvalidInput(f"{path}: line {line}: intrinsic_friction_force must be positive, got {force:g} N")
        return [1 - force / other for force, other in zip(columns["friction_force"], without, strict=True)]
    raise InvalidInput(
        f"{path}: needs a column friction_reduction [%], or friction_ratio, or friction_force [N] and"
        " intrinsic_friction_force [N]"
    )


def _rows(path: Path) -> list[list[str]]:
    """Header and rows of a CSV file, empty rows left out, no row longer than the header."""
    try:
        with refuse_unreadable(path), path.open(newline="", encoding="utf-8-sig") as stream:
            rows = [row for row in csv.reader(stream) if any(cell.strip() for cell in row)]
    except (UnicodeDecodeError, csv.Error):
        raise InvalidInput(f"{path}: not a table of comma-separated values") from None
    if len(rows) > _MOST_RUNS:
        raise InvalidInput(f"{path}: has {len(rows)} rows, but at most {_MOST_RUNS} runs are read")
    if len(rows) < 2:
        raise InvalidInput(f"{path}: needs a head and at least one run")
    for line, row in enumerate(rows[1:], 2):
        if len(row) > len(rows[0]):
            raise InvalidInput(f"{path}: line {line}: has {len(row)} cells where {len(rows[0])} columns are named")
    return rows


def _number(path: Path, line: int, row: list[str], place: int, name: str) -> float:
    """Number in a cell of a row, in the unit of its column."""
    cell = row[place].strip() if place < len(row) else ""
    try:
        number = float(cell)
    except ValueError:
        raise InvalidInput(f"{path}: line {line}: {name} {_quoted(cell)} is no number") from None
    if not abs(number) <= _LARGEST:
        raise InvalidInput(f"{path}: line {line}: {name} {_quoted(cell)} lies beyond any run")
    return number


def _quoted(cell: str) -> str:
    """Cell in quotation marks, shortened where it is long."""
    text = cell.strip()
    return repr(text if len(text) <= _QUOTED else text[:_QUOTED] + "...")
