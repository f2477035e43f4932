"""Columns of numbers from rows of text cells."""

from collections.abc import Sequence
from pathlib import Path

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.numeric_text import parse_number, parse_numbers

NumberedCells = tuple[int, list[str]]
"""Line on which a row begins, and its cells."""


def column_values(
    rows: Sequence[NumberedCells], index: int, label: str, decimal_sign: str, missing: frozenset[str], path: Path
) -> Floats:
    """Numbers of one column; cells beyond the end of a row are missing values."""
    cells = [row[index] if index < len(row) else "" for _, row in rows]
    values, invalid_row = parse_numbers(cells, decimal_sign=decimal_sign, missing=missing)
    if invalid_row is not None:
        line = rows[invalid_row][0]
        raise InvalidInput(f"{path}: line {line}: {label!r} is {cells[invalid_row][:40]!r}, which is not a number")
    return values


def is_text(rows: Sequence[NumberedCells], index: int, decimal_sign: str, missing: frozenset[str]) -> bool:
    """Whether the first cell of a column that is not missing is no number."""
    for _, row in rows:
        text = row[index].strip() if index < len(row) else ""
        if text and text not in missing:
            return parse_number(text, decimal_sign=decimal_sign) is None
    return True
