"""Layout of a text table found in its cells: separator, labels, units, first row, and lines that are no rows.

Rows are told by the cells of the middle of a file; labels and units stand in the lines above the first row.
"""

import csv
import io
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import islice, pairwise

from sonolube.measurement.measured_files import parse_number
from sonolube.measurement.recordings.mapping import TextLayout
from sonolube.measurement.recordings.raw_table import is_written_unit

_SEPARATORS = "\t;,| "  # the last one any number of blanks
_FEWEST_LINES = 8  # of a file whose layout is sought
_LONGEST_PREAMBLE = 400  # lines
_LOOKED_AT = 1 << 16  # characters of the beginning and of the middle of a file
_MIDDLE = 3  # rows by which the columns are told
_HEADING = 4  # lines of one: groups, labels, units, remarks
_WIDER = 2  # cells that a heading may have more than a row
_MOST_WORDS = 1000  # lines below the labels that begin with a letter, among which headings and summaries are sought
_MOST_NAMED = 3  # lines in a caveat

_COMMENT_SIGNS = "#%"
_CLOCK = re.compile(r"[\d./:,+ TZ-]*\d:\d\d(?::\d\d)?[\d.,:+ TZ-]*(?:[AaPp]\.?[Mm]\.?)?", re.ASCII)
_DATE = re.compile(r"\d{1,4}([./-])\d{1,2}\1\d{1,4}", re.ASCII)
_THOUSANDS = re.compile(r"[-+]?\d{1,3}(?:([.,])\d{3})+(?:(?!\1)[.,]\d+)?", re.ASCII)
_WORD_FIRST = re.compile(r'(?m)^[ "\']*(?!(?:nan|inf|NaN|NA|N/A|null)\b)[^\W\d_][^\r\n]*')
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
class _Found:
    """Separator of a table, and the lines of its labels, units and first row, from 0; None for lines that it lacks."""

    separator: str
    labels: int | None
    units: int | None
    first_row: int


def is_summary(cell: str) -> bool:
    """Whether a cell marks its row as a summary of others, such as a mean."""
    return len(cell) <= _LONGEST_SUMMARY and cell.strip(" .:*()[]=\t").casefold() in _SUMMARIES


def with_found_layout(text: str, layout: TextLayout) -> tuple[str, TextLayout, tuple[str, ...]]:
    """Text of a table with its layout, where none is stated, and caveats; lines that are no rows are blank in it.

    A text keeps its number of lines. Where nothing is found it stays as it is.
    """
    if layout != TextLayout():
        return text, layout, ()
    found = _found(text)
    if found is None:
        return text, layout, ()
    first = found.first_row if found.labels is None else found.labels
    layout = replace(
        layout,
        separator="\t" if found.separator == " " else found.separator,
        lines_to_skip=first,
        units_row=found.units is not None,
        has_labels=found.labels is not None,
    )
    changes = _headings(text, found)
    others, caveats = _no_rows(text, found)
    changes |= others
    if not changes and found.separator != " ":
        return text, layout, caveats
    lines = list(io.StringIO(text, newline=""))
    if found.separator == " ":
        for at in range(found.first_row, len(lines)):
            lines[at] = "\t".join(lines[at].split()) + "\n"
    for at, line in changes.items():
        lines[at] = line
    return "".join(lines), layout, caveats


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
    text = line.strip()
    return bool(text) and text[0] not in _COMMENT_SIGNS


def _cells(line: str, separator: str) -> list[str]:
    """Cells of a line."""
    line = line.rstrip("\r\n")
    if separator == " ":
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
    values = sum(all(map(_is_value, column)) for column in filled)
    return (values == len(filled), values) if values else None


def _is_value(cell: str) -> bool:
    """Whether a cell is a number, whatever its decimal sign, a date or a time of a clock."""
    text = cell.strip()
    numeric = any(parse_number(text, decimal_sign=sign) is not None for sign in ".,")
    return numeric or any(form.fullmatch(text) for form in (_CLOCK, _DATE, _THOUSANDS))


def _first_row(lines: Sequence[str], middle: Sequence[str], separator: str) -> int | None:
    """Index of the first of two lines with values where the rows of the middle have them."""
    rows = [_cells(row, separator) for row in middle]
    valued = [place for place in range(len(rows[0])) if all(_is_value(cells[place]) for cells in rows)]
    filled = [(at, _cells(line, separator)) for at, line in enumerate(lines) if _is_filled(line)]
    fits = [
        len(cells) == len(rows[0])
        and any(_is_value(cells[place]) for place in valued)
        and all(not cells[place].strip() or _is_value(cells[place]) for place in valued)
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
        cells = _heading_cells(lines[at], separator, width)
        while cells and not cells[-1].strip():
            cells.pop()
        is_heading = len(row) <= len(cells) <= width + _WIDER and not all(map(_is_value, filter(None, cells)))
        if not is_heading or len(above) == _HEADING:
            break
        above.append(at)
    for near, over in pairwise(above):
        if _are_units(_heading_cells(lines[near], separator, width)):
            return over, near
    return (above[0] if above else None), None


def _heading_cells(line: str, separator: str, width: int) -> list[str]:
    """Cells of a line above the rows, without the sign of a comment; labels of several words between blanks."""
    text = line.strip("\r\n").lstrip(_COMMENT_SIGNS) if line.strip()[:1] in tuple(_COMMENT_SIGNS) else line
    if separator != " ":
        return _cells(text, separator)
    wide = re.split(r"\t|\s{2,}", text.strip())
    return wide if len(wide) == width else _IN_BRACKETS.findall(text)


def _are_units(cells: Sequence[str]) -> bool:
    """Whether cells are units, some of them, and numbers otherwise."""
    texts = [cell.strip().strip("[]()").strip() for cell in cells]
    units = [text for text in texts if is_written_unit(text)]
    return bool(units) and all(text in _NO_UNITS or text in units or _is_value(text) for text in texts)


def _headings(text: str, found: _Found) -> dict[int, str]:
    """New lines of the heading by index: labels between tabs and without the sign of a comment, remarks blank."""
    if found.labels is None:
        return {}
    lines = list(islice(io.StringIO(text, newline=""), found.first_row))
    changes = dict.fromkeys(range(found.labels, found.first_row), "\n")
    rows = filter(_is_filled, text[len("".join(lines)) :][:_LOOKED_AT].splitlines())
    width = len(_cells(next(rows), found.separator))
    for at in (found.labels, *([] if found.units is None else [found.units])):
        if found.separator == " ":
            changes[at] = "\t".join(_heading_cells(lines[at], found.separator, width)) + "\n"
        else:
            is_comment = lines[at].lstrip()[:1] in tuple(_COMMENT_SIGNS)
            changes[at] = lines[at].lstrip().lstrip(_COMMENT_SIGNS) if is_comment else lines[at]
    return {at: line for at, line in changes.items() if line != lines[at]}


def _no_rows(text: str, found: _Found) -> tuple[dict[int, str], tuple[str, ...]]:
    """Blank lines in place of repeated headings and of summaries, by index, and caveats about them."""
    lines = io.StringIO(text, newline="")
    head = [next(lines) for _ in range(found.first_row)]
    repeated = {head[at].strip() for at in (found.labels, found.units) if at is not None}
    words = list(islice(_WORD_FIRST.finditer(text, pos=len("".join(head))), _MOST_WORDS + 1))
    if len(words) > _MOST_WORDS:
        return {}, ()
    headings, summaries = [], []
    for match in words:
        cells = _cells(match[0], found.separator)
        if match[0].strip() in repeated:
            headings.append(match.start())
        elif any(map(is_summary, cells)):
            summaries.append(match.start())
    at = {place: text.count("\n", 0, place) for place in (*headings, *summaries)}
    caveats = []
    for places, what in ((headings, "repeats the labels"), (summaries, "summarises the others")):
        if places:
            named = ", ".join(str(at[place] + 1) for place in places[:_MOST_NAMED])
            more = ", ..." if len(places) > _MOST_NAMED else ""
            caveats.append(f"no row of samples, for it {what}, and left out: line {named}{more}")
    return dict.fromkeys(at.values(), "\n"), tuple(caveats)
