"""Tables within a text export: found by the line of labels, in sections such as the steps of a test.

The encoding is detected, and columns of numbers are made of rows of text cells.
"""

import codecs
import csv
import io
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from functools import partial
from pathlib import Path

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.measured_files import (
    parse_grouped,
    parse_number,
    parse_numbers,
    refuse_unreadable,
    require_channels,
)
from sonolube.measurement.recordings.mapping import TextLayout
from sonolube.measurement.recordings.raw_table import column_of_label, numbered_labels, one_line
from sonolube.storage.user_files import input_bytes

_MARKS = ((codecs.BOM_UTF8, "utf-8-sig"), (codecs.BOM_UTF16_LE, "utf-16"), (codecs.BOM_UTF16_BE, "utf-16"))
_FALLBACK = "cp1252"


def decoded_text(path: Path, *, encoding: str) -> tuple[str, tuple[str, ...]]:
    """Text of a file, with its line ends as they are.

    `caveats`: One where Windows-1252 was assumed.
    """
    with refuse_unreadable(path):
        content = input_bytes(path)
    return decoded_content(content, path, encoding=encoding)


def decoded_content(content: bytes, path: Path, *, encoding: str = "") -> tuple[str, tuple[str, ...]]:
    """Text of the bytes of a file as `decoded_text` decodes them."""
    marked = next((name for mark, name in _MARKS if content.startswith(mark)), "utf-8")
    text = _decoded(content, encoding or marked, path, refuse=bool(encoding) or marked != "utf-8")
    caveats: tuple[str, ...] = ()
    if text is None:
        text = _decoded(content, _FALLBACK, path, refuse=True) or ""
        caveats = (
            "the text is not UTF-8 and was read as Windows-1252; if units or labels look wrong, give text.encoding",
        )
    if not text.strip():
        raise InvalidInput(f"{path}: is empty")
    return text, caveats


def _decoded(content: bytes, encoding: str, path: Path, *, refuse: bool) -> str | None:
    """Decoded text; where the bytes are not of the encoding, refuse them or return None."""
    try:
        return content.decode(encoding)
    except UnicodeDecodeError as failure:
        if not refuse:
            return None
        line = content[: failure.start].count(b"\n") + 1
        raise InvalidInput(f"{path}: line {line}: not {encoding} text; give text.encoding in a mapping") from None
    except (LookupError, UnicodeError) as failure:
        raise InvalidInput(f"{path}: {failure}") from None


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
            return all(parse(text, decimal_sign=decimal_sign) is None for parse in (parse_number, parse_grouped))
    return True


SEPARATORS = "\t;,|"
"""Between the cells of a row; the first ones are preferred."""

WIDE, NARROW = r"\s{2,}|\t", r"\s+"
"""Separators that are two blanks or more, and one or more, as regular expressions; one blank alone is as it is."""

_BLANKS = {pattern: re.compile(pattern) for pattern in (WIDE, NARROW)}


def text_rows(
    lines: Sequence[str], first: int, separator: str, path: Path, *, is_comment: Callable[[str], bool]
) -> Iterator[NumberedCells]:
    """Yield the rows from a line on, blank ones too, without comments; quoted cells may span lines."""
    if separator in _BLANKS:
        for at, line in enumerate(lines[first:], first):
            if not is_comment(line):
                yield at + 1, _BLANKS[separator].split(line.strip())
        return
    reader = csv.reader(lines[first:], delimiter=separator, strict=True)
    begins = first
    try:
        for cells in reader:
            if not is_comment(lines[begins]):
                yield begins + 1, _within_bars(cells) if separator == "|" else cells
            begins = first + reader.line_num
    except csv.Error as failure:
        raise InvalidInput(f"{path}: line {begins + 1}: {failure}") from None


def _within_bars(cells: list[str]) -> list[str]:
    """Cells of a line that begins and ends with a bar."""
    begins = 1 if len(cells) > 1 and not cells[0].strip() else 0
    return cells[begins:-1] if begins and not cells[-1].strip() else cells


def is_number(cell: str) -> bool:
    """Whether a cell holds a plain number, whatever its decimal sign."""
    return any(parse_number(cell, decimal_sign=sign) is not None for sign in ".,")


def labels_of_cells(cells: Sequence[str], line: int, path: Path, *, is_headless: bool = False) -> list[str]:
    """Labels of the columns of a row, without empty ones at its end; "column 1" and so on where it has numbers."""
    labels = [f"column {place}" if is_headless else one_line(label) for place, label in enumerate(cells, start=1)]
    while labels and not labels[-1]:
        labels.pop()
    if not labels:
        raise InvalidInput(f"{path}: line {line}: no column names")
    require_channels(len(labels), path, kind="columns")
    return labels


_MAX_LISTED = 12


@dataclass(frozen=True, kw_only=True, slots=True)
class TextTable:
    """One table of a text export.

    Parameters
    ----------
    line : int
        Of the labels.
    labels : list of str
        Of the columns, without empty ones at the end.
    rows : list of (int, list of str)
        Line and cells of each row.
    separator : str
        Between cells.
    units : list of str
        Of the columns; empty where the layout has no row of units.
    section : str
        Name of the section that holds it; empty where the file has none.
    begun : str
        Date and time at which the section began, in ISO 8601; empty where not stated.
    unread : int
        Number of lines with text after the end of the table.
    """

    line: int
    labels: list[str]
    rows: list[NumberedCells]
    separator: str
    units: list[str] = field(default_factory=list)
    section: str = ""
    begun: str = ""
    unread: int = 0


def text_tables(
    text: str, layout: TextLayout, sections: tuple[str, ...], path: Path, *, allows_short_rows: bool = False
) -> list[TextTable]:
    """Tables of a text export in order: one, or one per section; at least one, with rows."""
    lines = list(io.StringIO(text, newline=""))
    parts = _sections(lines, layout)
    if not layout.section and sections:
        raise InvalidInput(
            f"{path}: has no sections, so that none is {sections[0]!r}; text.section of a mapping tells them"
        )
    if layout.section and not parts:
        raise InvalidInput(f"{path}: has no section, a line with {layout.section!r}")
    chosen = [parts[index] for index in _chosen([name for name, _, _ in parts], sections, path)]
    tables = [_table(name, lines, first, end, layout, path, allows_short_rows) for name, first, end in chosen]
    if sections and (empty := next((table for table in tables if not table.rows), None)):
        raise InvalidInput(f"{path}: line {empty.line}: section {empty.section!r} holds no rows")
    return [table for table in tables if table.rows] or tables[:1]


def require_rows(table: TextTable, required: Mapping[str, str], path: Path) -> None:
    """Keep only the rows of a table that have required cells."""
    indices = {label: index for index, label in enumerate(numbered_labels(table.labels))}
    for label, cell in required.items():
        index = column_of_label(indices, label, path)
        table.rows[:] = [row for row in table.rows if "".join(row[1][index : index + 1]).strip() == cell]
    if not table.rows:
        raise InvalidInput(f"{path}: holds no rows" + (f" with {dict(required)}" if required else ""))


def _sections(lines: list[str], layout: TextLayout) -> list[tuple[str, int, int]]:
    """Name, first line and end of each section, as indices of lines; one without name where there are none."""
    if not layout.section:
        return [("", layout.lines_to_skip, len(lines))]
    pattern = re.compile(layout.section)
    begins = [(index, match) for index, line in enumerate(lines) if (match := pattern.search(line))]
    ends = [index for index, _ in begins[1:]] + [len(lines)]
    return [
        (one_line(match[1] if match.re.groups and match[1] else match[0]), index + 1, end)
        for (index, match), end in zip(begins, ends, strict=True)
    ]


def _chosen(names: list[str], sections: tuple[str, ...], path: Path) -> list[int]:
    """Indices of the requested sections, in the order of the file."""
    if not sections:
        return list(range(len(names)))
    indices = set()
    for section in sections:
        found = [index for index, name in enumerate(names) if name.casefold() == section.strip().casefold()]
        if not found and section.strip().isdecimal() and 0 < int(section) <= len(names):
            found = [int(section) - 1]
        if not found:
            known = ", ".join(names[:_MAX_LISTED]) + (", ..." if len(names) > _MAX_LISTED else "")
            raise InvalidInput(f"{path}: has no section {section!r}; its {len(names)} are {known}")
        indices.update(found)
    return sorted(indices)


def _table(
    name: str, lines: list[str], first: int, end: int, layout: TextLayout, path: Path, allows_short_rows: bool
) -> TextTable:
    """Table between two lines."""
    header = _header_line(lines, first, end, layout, path)
    separator = layout.separator or _detected_separator(lines[header : header + 1])
    is_comment = partial(_is_comment, comment=layout.comment)
    rows = _until_blank(text_rows(lines[:end], header, separator, path, is_comment=is_comment), layout)
    line, cells = _next_row(rows, header + 1)
    is_headless = not layout.has_labels or (len(cells) > 1 and all(map(is_number, cells)))
    labels = labels_of_cells(cells, line, path, is_headless=is_headless)
    units = [unit_of_cell(cell) for cell in _next_row(rows, line + 1)[1]] if layout.units_row else []
    body, unread = _body(rows, len(labels), path, allows_short_rows)
    if is_headless:
        body.insert(0, (line, cells))
    return TextTable(
        section=name,
        begun=_begun("".join(lines[first - 1 if layout.section else 0 : header]), layout, path),
        line=line,
        labels=labels,
        units=units,
        rows=body,
        unread=unread,
        separator=separator,
    )


def _header_line(lines: list[str], first: int, end: int, layout: TextLayout, path: Path) -> int:
    """Index of the line of labels: the first one, or the first that has the pattern of the layout."""
    if not layout.header:
        return next((index for index in range(first, end) if _is_row(lines[index], layout)), first)
    pattern = re.compile(layout.header)
    found = next((index for index in range(first, end) if pattern.search(lines[index])), None)
    if found is None:
        raise InvalidInput(f"{path}: line {first + 1}: no line of labels, with {layout.header!r}, follows")
    return found


def _is_row(line: str, layout: TextLayout) -> bool:
    """Whether a line is neither blank nor a comment."""
    return bool(line.strip()) and not _is_comment(line, comment=layout.comment)


def _is_comment(line: str, *, comment: str) -> bool:
    """Whether a line begins with the sign of a comment."""
    return bool(comment) and line.lstrip().startswith(comment)


def _until_blank(rows: Iterator[NumberedCells], layout: TextLayout) -> Iterator[NumberedCells | None]:
    """Yield the rows that have a filled cell; None for a blank one after the first where it ends a table."""
    seen = False
    for row in rows:
        if any(cell.strip() for cell in row[1]):
            seen = True
            yield row
        elif seen and layout.ends_at_blank_line:
            yield None


def unit_of_cell(cell: str) -> str:
    """Unit of a cell, without brackets around all of it."""
    text = one_line(cell)
    return text[1:-1].strip() if text[:1] + text[-1:] in ("[]", "()") else text


def _next_row(rows: Iterator[NumberedCells | None], line: int) -> NumberedCells:
    """Next row; one without cells, on the line given, where there is none."""
    return next((row for row in rows if row is not None), (line, []))


def _detected_separator(lines: list[str]) -> str:
    """Separator that occurs most often in the line of labels."""
    line = lines[0] if lines else ""
    return max(SEPARATORS, key=lambda separator: (line.count(separator), -SEPARATORS.index(separator)))


def _body(
    rows: Iterator[NumberedCells | None], width: int, path: Path, allows_short_rows: bool
) -> tuple[list[NumberedCells], int]:
    """Rows of a table up to its end, and the number of rows that follow it."""
    body: list[NumberedCells] = []
    for row in rows:
        if row is None:
            if body:
                break
            continue
        line, cells = row
        if (len(cells) < width and not allows_short_rows) or any(cell.strip() for cell in cells[width:]):
            raise InvalidInput(f"{path}: line {line}: has {len(cells)} cells where {width} columns are named")
        body.append(row)
    return body, sum(row is not None for row in rows)


def _begun(preamble: str, layout: TextLayout, path: Path) -> str:
    """Start that the lines before a table state, in ISO 8601; empty where they do not."""
    match = re.search(layout.section_start, preamble) if layout.section_start else None
    if match is None or not match.re.groups or not match[1]:
        return ""
    try:
        return datetime.strptime(match[1].strip(), layout.section_start_format).isoformat(" ")
    except ValueError:
        raise InvalidInput(
            f"{path}: the start {match[1].strip()[:40]!r} does not have the format {layout.section_start_format!r}"
        ) from None
