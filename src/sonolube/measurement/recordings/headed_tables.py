"""Tables of spectra in texts: the first line whose headings are complete, units below it, and finite numbers."""

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.measured_files import detected_decimal_sign, parse_number, require_channels
from sonolube.measurement.recordings.mapping import TextLayout
from sonolube.measurement.recordings.table_layout import heading_cells
from sonolube.measurement.recordings.text_tables import (
    NARROW,
    SEPARATORS,
    NumberedCells,
    TextTable,
    is_number,
    text_tables,
)

_LARGEST = 1e30  # in any unit
_COMMENTS = "#!%"
_END = re.compile(r"\s*END\b.*", re.IGNORECASE)
_LONGEST_PREAMBLE = 400  # lines
_LOOKED_AT = 1 << 16  # characters of lines that may be headings
_BEGINS_WITH_NUMBER = re.compile(r"[\s\"]*[-+]?[.,]?\d")
_DECIMALS = re.compile(r"\d+[.,]\d+")
_QUOTED = 40  # characters of a cell in a message


@dataclass(frozen=True, kw_only=True, slots=True)
class HeadedTable:
    """Table of a spectrum.

    Parameters
    ----------
    table : TextTable
        Its labels have the units of a row of units behind them.
    decimal_sign : str
    preamble : tuple of str
        Lines before the headings.
    """

    table: TextTable
    decimal_sign: str
    preamble: tuple[str, ...] = ()


def headed_table(
    lines: Sequence[str], path: Path, *, is_complete: Callable[[Sequence[str]], bool], is_unit: Callable[[str], bool]
) -> HeadedTable | None:
    """Table below the first line whose headings are complete, alone or with the units of the next; None without one.

    Headings may be a comment where no other line has them. Blanks separate cells where nothing else does.
    """
    found = _headed(lines, path, is_complete, is_unit)
    if found is None and (tabbed := _tabbed(lines)):
        found = _headed(tabbed, path, is_complete, is_unit)
    return found if found is None else replace(found, preamble=tuple(lines[: found.table.line - 1]))


def _tabbed(lines: Sequence[str]) -> list[str]:
    """Lines of a table of numbers between blanks with tabs in their place; none of another text."""
    rows = (cells for line in lines if len(cells := line.split()) > 1 and all(map(is_number, cells)))
    width = len(next(rows, ()))
    if not width:
        return []
    tabbed = []
    for line in lines:
        cells = line.split()
        if not (cells and is_number(cells[0])):
            cells = heading_cells(line, NARROW, width)
        tabbed.append("\t".join(cells) if len(cells) == width else line)
    return tabbed


def _headed(
    lines: Sequence[str], path: Path, is_complete: Callable[[Sequence[str]], bool], is_unit: Callable[[str], bool]
) -> HeadedTable | None:
    """Table between usual separators, as `headed_table`."""
    kept = without_comments(lines)
    for candidates in (kept, [line.lstrip(_COMMENTS) for line in lines[: len(kept)]]):
        for at, separator, labels in possible_headings(candidates, path):
            units = _unit_cells(kept[at + 1 :], separator, is_unit)
            has_units = bool(units) and is_complete(_with_units(labels, units))
            if has_units or is_complete(labels):
                body = [*kept[:at], candidates[at], *kept[at + 1 :]]
                return _cut_table(body, at, separator, path, has_units=has_units)
    return None


def _cut_table(lines: Sequence[str], at: int, separator: str, path: Path, *, has_units: bool) -> HeadedTable:
    """Table whose headings are a line of a text."""
    layout = TextLayout(lines_to_skip=at, separator=separator, units_row=has_units)
    (table,) = text_tables("\n".join(lines), layout, (), path, allows_short_rows=True)
    numbers = (number for _, cells in table.rows for cell in cells for number in _DECIMALS.findall(cell))
    return HeadedTable(
        table=replace(table, labels=_with_units(table.labels, table.units)),
        decimal_sign="." if separator == "," else detected_decimal_sign(numbers),
    )


def without_comments(lines: Sequence[str]) -> list[str]:
    """Lines up to one that ends the data, comments emptied so that the others keep their numbers."""
    end = next((at for at, line in enumerate(lines) if _END.fullmatch(line)), len(lines))
    return ["" if line.startswith(tuple(_COMMENTS)) else line for line in lines[:end]]


def possible_headings(lines: Sequence[str], path: Path) -> Iterator[tuple[int, str, list[str]]]:
    """Yield place, separator and labels of the first lines that are not blank and do not begin with a number."""
    characters = 0
    for at, line in enumerate(lines[:_LONGEST_PREAMBLE]):
        if line.strip() and not _BEGINS_WITH_NUMBER.match(line):
            for separator in (sign for sign in SEPARATORS if sign in line):
                require_channels(line.count(separator) + 1, path, kind="columns")
                yield at, separator, _cells(line, separator)
            characters += len(line)
            if characters > _LOOKED_AT:
                return


def _cells(line: str, separator: str) -> list[str]:
    """Cells of a line of headings, without quotation marks."""
    return [cell.strip().strip('"').strip() for cell in line.split(separator)]


def _unit_cells(following: Sequence[str], separator: str, is_unit: Callable[[str], bool]) -> list[str]:
    """Cells of the next line that is not blank, where they are units and nothing else; empty where they are not."""
    row = next((line for line in following[:3] if line.strip()), "")
    cells = _cells(row, separator)
    filled = [cell for cell in cells if cell]
    return cells if len(filled) > 1 and all(map(is_unit, filled)) else []


def _with_units(labels: Sequence[str], units: Sequence[str]) -> list[str]:
    """Headings with the units of the row below them."""
    known = [*units, *[""] * len(labels)]
    return [
        f"{label} ({unit.strip(' ()[]')})" if unit.strip() else label
        for label, unit in zip(labels, known, strict=False)
    ]


def finite_numbers(rows: Sequence[NumberedCells], place: int, *, decimal_sign: str, path: Path) -> Floats:
    """Numbers of a column; refuse a missing cell and what is no finite number."""
    return np.array([_finite_number(row, place, decimal_sign, path) for row in rows])


def _finite_number(row: NumberedCells, place: int, decimal_sign: str, path: Path) -> float:
    """Number in one cell of a row."""
    line, cell = cell_of_row(row, place, path)
    value = parse_number(cell, decimal_sign=decimal_sign)
    if value is None or not np.isfinite(value):
        raise InvalidInput(f"{path}: line {line}: {cell.strip()[:_QUOTED]!r} is not a finite number")
    if abs(value) > _LARGEST:
        raise InvalidInput(f"{path}: line {line}: {cell.strip()[:_QUOTED]!r} lies beyond any instrument")
    return value


def cell_of_row(row: NumberedCells, place: int, path: Path) -> tuple[int, str]:
    """Line and text of one cell of a row; refuse a row that ends before it."""
    line, cells = row
    if place >= len(cells):
        raise InvalidInput(f"{path}: line {line}: has {len(cells)} cells where column {place + 1} is required")
    return line, cells[place]
