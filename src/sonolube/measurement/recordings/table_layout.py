"""Layout of a text table found in its cells: separator, labels, units, first row, and lines that are no rows.

Rows are told by the cells of the middle of a file; labels and units stand in the lines above the first row.
"""

import csv
import io
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import islice, pairwise
from pathlib import Path
from typing import Literal

from sonolube.errors import InvalidInput
from sonolube.measurement.recordings.raw_table import is_written_unit
from sonolube.measurement.recordings.text_tables import (
    NARROW,
    SEPARATORS,
    NumberedCells,
    TextTable,
    is_number,
    labels_of_cells,
    text_rows,
    unit_of_cell,
)

_SEPARATORS = (*SEPARATORS, NARROW)
_FEWEST_LINES = 8  # of a file whose layout is sought
_LONGEST_PREAMBLE = 400  # lines
_LOOKED_AT = 1 << 16  # characters of the beginning and of the middle of a file
_MIDDLE = 3  # rows by which the columns are told
_HEADING = 4  # lines of one: groups, labels, units, remarks
_WIDER = 2  # cells that a heading may have more than a row
_RULE = re.compile(r":?[-=]{2,}:?")  # below the headings of a table as text
_REMARK_COLUMNS = 3  # of a table in which a row of one text is a remark
_MAX_NAMED = 3  # lines in a caveat

_COMMENT_SIGNS = "#%"
_CLOCK = re.compile(r"[\d./:,+ TZ-]*\d:\d\d(?::\d\d)?[\d.,:+ TZ-]*(?:[AaPp]\.?[Mm]\.?)?", re.ASCII)
_DATE = re.compile(r"\d{1,4}([./-])\d{1,2}\1\d{1,4}", re.ASCII)
_THOUSANDS = re.compile(r"[-+]?\d{1,3}(?:([.,])\d{3})+(?:(?!\1)[.,]\d+)?", re.ASCII)
_IN_BRACKETS = re.compile(r"[^\s\[(]+(?:\s*(?:\[[^\]]*\]|\([^)]*\)))?")
_NO_UNITS = ("", "-", "1", "Sequence")
_SUMMARIES = frozenset(
    {
        *("mean", "mean value", "average", "avg", "median", "mittel", "mittelwert", "mw", "durchschnitt"),
        *("sd", "s.d", "std", "std dev", "stdev", "standard deviation", "stabw", "stdabw", "standardabweichung"),
        *("sem", "standard error", "cv", "variance", "varianz", "min", "minimum", "max", "maximum"),
        *("sum", "summe", "total", "gesamt", "ø", "⌀", "x̄", "σ"),
    }
)
_LONGEST_SUMMARY = 40  # characters of a cell that names one


@dataclass(frozen=True, kw_only=True, slots=True)
class FoundTable:
    """Table of a text whose layout was found in its cells.

    Parameters
    ----------
    table : TextTable
    has_labels : bool
    others : tuple of NoRow
        Lines between its rows that are none.
    """

    table: TextTable
    has_labels: bool
    others: tuple["NoRow", ...]


@dataclass(frozen=True, slots=True)
class NoRow:
    """Line of a table that is no row: why, and the words by which that is told."""

    line: int
    kind: Literal["heading", "summary", "remark"]
    words: str = ""


@dataclass(frozen=True, kw_only=True, slots=True)
class _Found:
    """Separator of a table, and the lines of its labels, units and first row, from 0; None for lines that it lacks."""

    separator: str
    labels: int | None
    units: int | None
    first_row: int


def is_summary(cell: str) -> bool:
    """Whether a cell marks its row as a summary of others, such as a mean."""
    return len(cell) <= _LONGEST_SUMMARY and cell.strip(" .:*()[]=\t").casefold() in _SUMMARIES


def rows_and_others(
    rows: Iterable[NumberedCells], columns: int, heading_rows: Sequence[Sequence[str]], path: Path
) -> tuple[list[NumberedCells], list[NoRow]]:
    """Rows of a table, and the lines between them that are none: headings again, summaries, and remarks.

    Blank lines and rules are passed over. A line with one cell of text is a remark where the table has three columns.
    """
    body: list[NumberedCells] = []
    others: list[NoRow] = []
    heads = [_trimmed(each) for each in heading_rows]
    for row in rows:
        line, cells = row
        if len(cells) == columns and cells[0][:1].isdigit() and not any(cell[:1].isalpha() for cell in cells):
            body.append(row)  # as nearly all of a long table
            continue
        stripped = _trimmed(cells)
        filled = [cell for cell in stripped if cell]
        if not filled or all(_RULE.fullmatch(cell) for cell in filled):
            continue
        if stripped in heads:
            others.append(NoRow(line, "heading"))
        elif summary := next(filter(is_summary, filled), ""):
            others.append(NoRow(line, "summary", summary))
        elif len(filled) == 1 and columns >= _REMARK_COLUMNS and not is_value(filled[0]):
            others.append(NoRow(line, "remark", filled[0]))
        elif len(stripped) > columns:
            raise InvalidInput(f"{path}: line {line}: has {len(stripped)} cells where {columns} columns are named")
        else:
            body.append(row)
    return body, others


def _trimmed(cells: Sequence[str]) -> list[str]:
    """Cells without blanks around them, and without empty ones at the end."""
    trimmed = [cell.strip() for cell in cells]
    while trimmed and not trimmed[-1]:
        trimmed.pop()
    return trimmed


def found_table(text: str, path: Path) -> FoundTable | None:
    """Table of a text whose rows and labels are told by their cells; None where they are not."""
    found = _found(text)
    if found is None:
        return None
    lines = list(io.StringIO(text, newline=""))
    rows = text_rows(lines, found.first_row, found.separator, path, is_comment=_is_comment)
    first = next(rows)
    heads = [
        heading_cells(lines[at], found.separator, len(first[1])) if at is not None else []
        for at in (found.labels, found.units)
    ]
    labels = labels_of_cells(heads[0] or first[1], found.first_row, path, is_headless=found.labels is None)
    body, others = rows_and_others((first, *rows), len(labels), [each for each in heads if each], path)
    _require_whole(body, len(labels), path)
    table = TextTable(
        line=(found.first_row if found.labels is None else found.labels) + 1,
        labels=labels,
        units=[unit_of_cell(cell) for cell in heads[1]],
        rows=body,
        separator=found.separator,
    )
    return FoundTable(table=table, has_labels=found.labels is not None, others=tuple(others))


def _require_whole(rows: Sequence[NumberedCells], width: int, path: Path) -> None:
    """Refuse a row that lacks cells."""
    short = next((row for row in rows if len(row[1]) < width), None)
    if short is not None:
        raise InvalidInput(f"{path}: line {short[0]}: has {len(short[1])} cells where {width} columns are named")


def left_out_lines(others: Sequence[NoRow]) -> tuple[str, ...]:
    """Caveats on the lines of a recording that are no samples."""
    reasons = {"heading": "repeats the labels", "summary": "summarises the others", "remark": "is a remark"}
    caveats = []
    for kind, reason in reasons.items():
        if at := [each.line for each in others if each.kind == kind]:
            named = ", ".join(map(str, at[:_MAX_NAMED])) + (", ..." if len(at) > _MAX_NAMED else "")
            caveats.append(f"no row of samples, for it {reason}, and left out: line {named}")
    return tuple(caveats)


def _found(text: str) -> _Found | None:
    """Layout of the table of a text; None where its rows or its labels are not told by their cells."""
    lines = list(islice(io.StringIO(text[:_LOOKED_AT], newline=""), _LONGEST_PREAMBLE))
    if sum(map(bool, map(str.strip, lines))) < _FEWEST_LINES:
        return None
    half = len(text) // 2
    middle = [line for line in text[half : half + _LOOKED_AT].splitlines()[1:-1] if _is_filled(line)][:_MIDDLE]
    middle = middle or [line for line in lines if _is_filled(line)][-_MIDDLE:]
    ranked = [(rank, separator) for separator in _SEPARATORS if (rank := _rank(middle, separator))]
    if not ranked:
        return None
    separator = max(ranked, key=lambda each: each[0])[1]
    first = _first_row(lines, middle, separator)
    if first is None:
        return None
    labels, units = _labels_and_units(lines, first, middle, separator)
    if labels is None and (separator == "," and all(re.fullmatch(r"\s*-?\d+,\d+\s*", line) for line in middle)):
        return None  # one column of numbers with a decimal comma
    return _Found(separator=separator, labels=labels, units=units, first_row=first)


def _is_filled(line: str) -> bool:
    """Whether a line is neither blank nor a comment."""
    return bool(line.strip()) and not _is_comment(line)


def _is_comment(line: str) -> bool:
    """Whether a line is a comment."""
    return line.lstrip()[:1] in tuple(_COMMENT_SIGNS)


def _cells(line: str, separator: str) -> list[str]:
    """Cells of a line."""
    line = line.rstrip("\r\n")
    if separator == NARROW:
        return line.split()
    if '"' in line:
        return next(csv.reader([line], delimiter=separator), [])
    return line.split(separator)


def _rank(rows: Sequence[str], separator: str) -> tuple[bool, int] | None:
    """Whether all filled cells of rows are values, and the number of their columns; None where that is no separator."""
    split = [_cells(row, separator) for row in rows]
    width = len(split[0])
    if width < 2 or any(len(cells) != width for cells in split):
        return None
    columns = [[cells[place].strip() for cells in split] for place in range(width)]
    filled = [column for column in columns if any(column)]
    values = sum(all(map(is_value, column)) for column in filled)
    return (values == len(filled), values) if values else None


def is_value(cell: str) -> bool:
    """Whether a cell is a number, whatever its decimal sign, a date or a time of a clock."""
    text = cell.strip()
    return is_number(text) or any(form.fullmatch(text) for form in (_CLOCK, _DATE, _THOUSANDS))


def _first_row(lines: Sequence[str], middle: Sequence[str], separator: str) -> int | None:
    """Index of the first of two lines with values where the rows of the middle have them."""
    rows = [_cells(row, separator) for row in middle]
    valued = [place for place in range(len(rows[0])) if all(is_value(cells[place]) for cells in rows)]
    filled = [(at, _cells(line, separator)) for at, line in enumerate(lines) if _is_filled(line)]
    fits = [
        len(cells) == len(rows[0])
        and any(is_value(cells[place]) for place in valued)
        and all(not cells[place].strip() or is_value(cells[place]) for place in valued)
        for _, cells in filled
    ]
    pairs = zip(filled, fits, [*fits[1:], False], strict=True)
    return next((at for (at, _), this, following in pairs if this and following), None)


def _labels_and_units(
    lines: Sequence[str], first: int, middle: Sequence[str], separator: str
) -> tuple[int | None, int | None]:
    """Indices of the lines of labels and of units above the first row."""
    row = _cells(middle[0], separator)
    width = len(row)
    while row and not row[-1].strip():
        row.pop()
    above: list[int] = []
    for at in range(first - 1, -1, -1):
        if not lines[at].strip(" \t\r\n,;"):
            continue
        cells = heading_cells(lines[at], separator, width)
        while cells and not cells[-1].strip():
            cells.pop()
        is_heading = len(row) <= len(cells) <= width + _WIDER and not all(map(is_value, filter(None, cells)))
        if not is_heading or len(above) == _HEADING:
            break
        above.append(at)
    for near, over in pairwise(above):
        if _are_units(heading_cells(lines[near], separator, width)):
            return over, near
    return (above[0] if above else None), None


def heading_cells(line: str, separator: str, columns: int) -> list[str]:
    """Cells of a line above the rows, without the sign of a comment; labels of several words between blanks."""
    text = line.strip("\r\n").lstrip().lstrip(_COMMENT_SIGNS) if _is_comment(line) else line
    if separator != NARROW:
        return _cells(text, separator)
    wide = re.split(r"\t|\s{2,}", text.strip())
    return wide if len(wide) == columns else _IN_BRACKETS.findall(text)


def _are_units(cells: Sequence[str]) -> bool:
    """Whether cells are units, some of them, and numbers otherwise."""
    texts = [cell.strip().strip("[]()").strip() for cell in cells]
    units = [text for text in texts if is_written_unit(text)]
    return bool(units) and all(text in _NO_UNITS or text in units or is_value(text) for text in texts)
