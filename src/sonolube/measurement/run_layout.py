"""Layout of a table of runs: its separator, headings in one row or several, units, runs as columns, and other lines.

A row is that of the headings whose cells name the most quantities. Two rows are read as one where headings of several
columns stand above those of each. A grid whose first column names more than any row has its runs as columns.
"""

import io
import re
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path
from typing import Final

from sonolube.errors import InvalidInput
from sonolube.measurement.measured_files import parse_number
from sonolube.measurement.recordings.mapping import TextLayout
from sonolube.measurement.recordings.raw_table import one_line
from sonolube.measurement.recordings.table_layout import NoRow, rows_and_others
from sonolube.measurement.recordings.text_tables import (
    NARROW,
    SEPARATORS,
    WIDE,
    NumberedCells,
    TextTable,
    labels_of_cells,
    text_rows,
)
from sonolube.measurement.run_columns import TEXT_NAMES
from sonolube.measurement.run_headings import fits, run_heading
from sonolube.measurement.run_numbers import cell_number

_PREAMBLE: Final = re.compile(r'"?\s*(?:[#%](?!\s*[;,\t|])|//)|[\s;,"|]*\Z')  # comments, and lines without any text
_SEPARATOR_LINE: Final = re.compile(r"sep=(.)", re.IGNORECASE)  # with which Excel tells its separator
_LOOKED_AT: Final = 60  # rows in which the headings are sought
_MAX_ROWS_OF_HEADS: Final = 2
_FEWEST_KNOWN: Final = 2  # headings that make a row other than the first that of the headings
_FEWEST_COUNTED: Final = 2  # rows that a column without heading numbers
_QUOTED: Final = 40  # characters of a cell in a caveat


@dataclass(frozen=True, kw_only=True, slots=True)
class LaidOut:
    """Table of a grid of cells.

    Parameters
    ----------
    table : TextTable
    left_out : tuple of str
        Lines and columns that are no part of it, one caveat each.
    is_turned : bool
        Whether the runs are columns of the file, whose numbers stand in place of those of lines.
    known : int
        Headings that name a quantity.
    """

    table: TextTable
    left_out: tuple[str, ...]
    is_turned: bool
    known: int


@dataclass(frozen=True, slots=True)
class _Heads:
    """Headings in rows of a grid: index of the first row, number of rows, labels, and how many are known."""

    first: int
    count: int
    labels: list[str]
    known: int


def laid_out_text(text: str, layout: TextLayout, path: Path) -> LaidOut:
    """Table of a text without sections, by the separator with which most of its headings are known."""
    lines = list(io.StringIO(text, newline=""))
    first = layout.lines_to_skip
    separator = layout.separator
    while first < len(lines) and (layout.lines_to_skip == 0 or not lines[first].strip()):
        if stated := _SEPARATOR_LINE.fullmatch(lines[first].strip("\r\n")):
            separator = separator or stated[1]
        elif not _PREAMBLE.match(lines[first]):
            break
        first += 1
    is_fixed = layout.lines_to_skip > 0
    if not is_fixed and first and first < len(lines) and _is_row_of_numbers(lines[first]):
        bare = lines[first - 1].lstrip("#%/ \t")  # as numpy.savetxt writes its headings
        if max(_count(re.split(each, bare)) for each in ("[;\t,|]", r"\s{2,}", r"\s+")) >= _FEWEST_KNOWN:
            first -= 1
            lines[first] = bare
    separator = separator or _separator(lines, first, path, is_fixed=is_fixed)
    rows = _rows(lines, first, separator, path)
    if not rows:
        raise InvalidInput(f"{path}: line {first + 1}: no column names")
    return laid_out(rows, path, separator=separator, is_fixed=is_fixed)


def laid_out(rows: Sequence[NumberedCells], path: Path, *, separator: str, is_fixed: bool = False) -> LaidOut:
    """Table of the rows of a grid, whose first row is that of the headings where that is fixed."""
    heads, turned = _heads(rows, is_fixed=is_fixed), _turned(rows)
    is_turned = turned is not None and turned[0] > heads.known
    if turned is not None and is_turned:
        rows = turned[1]
        heads = _Heads(0, 1, [one_line(cell) for cell in rows[0][1]], turned[0])
    line, cells = rows[heads.first]
    is_headless = not heads.known and len(cells) > 1 and all(_is_number(cell) or not cell.strip() for cell in cells)
    start = heads.first + (0 if is_headless else heads.count)
    labels = labels_of_cells(cells if is_headless else heads.labels, line, path, is_headless=is_headless)
    heading_rows = [each for _, each in rows[heads.first : start]]
    units = _units(labels, rows[start][1]) if start < len(rows) else None
    if units is not None:
        heading_rows.append(rows[start][1])
        labels, start = units, start + 1
    body, others = rows_and_others(rows[start:], len(labels), heading_rows, path)
    notes = [_note(each) for each in others]
    labels, body, of_columns = _without_empty(labels, body)
    table = TextTable(line=1 if is_turned else line, labels=labels, rows=body, separator=separator)
    left_out = (*notes, *of_columns)
    if is_turned:
        left_out = tuple(each.replace("line ", "column ", 1) for each in left_out)
    return LaidOut(table=table, left_out=left_out, is_turned=is_turned, known=heads.known)


def _separator(lines: Sequence[str], first: int, path: Path, *, is_fixed: bool) -> str:
    """Separator with which most headings are known; blanks only where no other stands in the line of the headings."""
    usual = {each: _rank(lines, first, each, path, is_fixed=is_fixed) for each in SEPARATORS}
    best = max(usual, key=usual.__getitem__)
    if usual[best][0] >= _FEWEST_KNOWN:
        return best
    for blank in (WIDE, NARROW):
        rows = _first_rows(lines, first, blank, path)
        heads = _heads(rows, is_fixed=is_fixed) if rows else None
        if heads is not None and heads.known > usual[best][0]:
            line = lines[rows[heads.first][0] - 1]
            return best if any(each in line for each in SEPARATORS) else blank
    return best


def _rank(lines: Sequence[str], first: int, separator: str, path: Path, *, is_fixed: bool) -> tuple[int, int]:
    """How well a separator divides a text: by its known headings, then by the cells of the first line."""
    rows = _first_rows(lines, first, separator, path)
    turned = _turned(rows)
    known = max(_heads(rows, is_fixed=is_fixed).known if rows else 0, 0 if turned is None else turned[0])
    return known, lines[first].count(separator) if first < len(lines) else 0


def _rows(lines: Sequence[str], first: int, separator: str, path: Path) -> list[NumberedCells]:
    """Rows of a text that have a cell with text, with the line on which each begins."""
    rows = text_rows(lines, first, separator, path, is_comment=_is_comment)
    return [row for row in rows if any(cell.strip() for cell in row[1])]


def _first_rows(lines: Sequence[str], first: int, separator: str, path: Path) -> list[NumberedCells]:
    """Rows among which the headings are sought, up to one that cannot be divided so."""
    rows: list[NumberedCells] = []
    with suppress(InvalidInput):
        for row in text_rows(lines[: first + _LOOKED_AT], first, separator, path, is_comment=_is_comment):
            rows += [row] if any(cell.strip() for cell in row[1]) else []
    return rows


def _is_row_of_numbers(line: str) -> bool:
    """Whether a line has nothing but numbers."""
    cells = re.split(r"[;\t|\s]+|,(?!\d)|(?<=\d),(?=\d)", line.strip())
    return all(_is_number(cell) for cell in cells)


def _is_comment(line: str) -> bool:
    """Whether a line is a comment."""
    return bool(line.strip()) and _PREAMBLE.match(line) is not None


def _is_number(cell: str) -> bool:
    """Whether a cell holds a number, whatever its decimal sign."""
    return any(cell_number(cell, sign=sign) is not None for sign in ".,")


def _known(label: str) -> str:
    """Quantity or text of a heading; empty where it is not known."""
    found = run_heading(label)
    return "" if found is None else found.name


def _count(labels: Sequence[str]) -> int:
    """Different quantities and texts that headings name."""
    return len({_known(label) for label in labels if label and not _is_number(label)} - {""})


def _heads(rows: Sequence[NumberedCells], *, is_fixed: bool) -> _Heads:
    """Headings of a grid, in the first row where that is fixed or no row has more that are known."""
    labels = [one_line(cell) for cell in rows[0][1]]
    best = _Heads(0, 1, labels, _count(labels))
    for first in range(1 if is_fixed else min(len(rows), _LOOKED_AT)):
        for count in range(1, _MAX_ROWS_OF_HEADS + 1):
            over = [list(map(one_line, cells)) for _, cells in rows[first : first + count]]
            is_title = count > 1 and not any(over[0][1:])
            if len(over) < count or is_title or (count > 1 and any(map(_is_number, over[-1]))):
                break
            labels = over[0] if count == 1 else _joined(over[0], over[1])
            known = _count(labels)
            if known > best.known and (known >= _FEWEST_KNOWN or first == 0):
                best = _Heads(first, count, labels, known)
    return best if best.known else _Heads(*_widest(rows, is_fixed=is_fixed))


def _widest(rows: Sequence[NumberedCells], *, is_fixed: bool) -> tuple[int, int, list[str], int]:
    """First row as wide as the last ones, of a grid without known headings."""
    width = max(len(cells) for _, cells in rows[-3:])
    place = next((at for at, (_, cells) in enumerate(rows[:_LOOKED_AT]) if len(cells) >= width), 0)
    first = 0 if is_fixed else place
    return first, 1, [one_line(cell) for cell in rows[first][1]], 0


def _joined(over: Sequence[str], under: Sequence[str]) -> list[str]:
    """Headings of two rows: those below where they are known alone, else behind the one over them."""
    labels, group = [], ""
    for upper, lower in zip_longest(over, under, fillvalue=""):
        group = upper or group
        if not lower:
            labels.append(upper)
        elif _known(lower) or not group:
            labels.append(lower)
        else:
            labels.append(f"{group} {lower}")
    return labels


def _turned(rows: Sequence[NumberedCells]) -> tuple[int, list[NumberedCells]] | None:
    """Known names of the first column, and the grid with its columns as rows; None where it has fewer than two."""
    width = max((len(cells) for _, cells in rows), default=0)
    if len(rows) > _LOOKED_AT or width < 2:
        return None
    labels = [one_line(cells[0]) if cells else "" for _, cells in rows]
    known = _count(labels)
    if known < _FEWEST_KNOWN:
        return None
    columns = [[cells[place] if place < len(cells) else "" for _, cells in rows] for place in range(width)]
    return known, list(enumerate(columns, 1))


def _units(labels: Sequence[str], row: Sequence[str]) -> list[str] | None:
    """Labels with the units of the row below them; None where that holds anything else."""
    cells = [cell.strip(" []()") for cell in row]
    meant = [(run_heading(f"{label} [{cell}]"), cell) for label, cell in zip(labels, cells, strict=False)]
    stated = [found for found, cell in meant if cell and found is not None and found.name not in TEXT_NAMES]
    if len(stated) < 2 or not all(map(fits, stated)) or any(parse_number(cell, decimal_sign=".") for cell in cells):
        return None
    named = [f"{label} [{cell}]" if cell else label for label, cell in zip(labels, cells, strict=False)]
    return named + list(labels[len(named) :])


def _note(other: NoRow) -> str:
    """Caveat on a line that is no run."""
    if other.kind == "heading":
        return f"line {other.line} repeats the headings and is left out"
    return f"line {other.line} is no run and left out: {other.words[:_QUOTED]!r}"


def _without_empty(
    labels: Sequence[str], body: Sequence[NumberedCells]
) -> tuple[list[str], list[NumberedCells], list[str]]:
    """Table without columns that have no heading and either no cells or the numbers of the rows."""
    kept, notes = [], []
    for place, label in enumerate(labels):
        cells = [row[place].strip() if place < len(row) else "" for _, row in body]
        counted = [[f"{start + at}" for at in range(len(cells))] for start in (0, 1)]
        if label or (any(cells) and (len(cells) < _FEWEST_COUNTED or cells not in counted)):
            kept.append(place)
        elif any(cells):
            notes.append(f"column {place + 1} has no heading, numbers the rows and is left out")
    if len(kept) == len(labels):
        return list(labels), list(body), notes
    rows = [(line, [row[place] for place in kept if place < len(row)]) for line, row in body]
    return [labels[place] for place in kept], rows, notes
