"""Delimited text with one row per sample: CSV, and exports of tribometer software."""

import csv
import io
from collections.abc import Iterator
from pathlib import Path
from typing import ClassVar, final

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput, suggestion
from sonolube.measurement.file_format import refuse_unreadable
from sonolube.measurement.numeric_text import parse_number, parse_numbers
from sonolube.measurement.recordings.mapping import RecordingMapping, TextLayout
from sonolube.measurement.recordings.raw_table import RawColumn, RawTable, one_line

_SEPARATORS = "\t;,|"
_UTF_16_MARKS = (b"\xff\xfe", b"\xfe\xff")

NumberedCells = tuple[int, list[str]]  # line on which a row begins, and its cells


@final
class DelimitedText:
    """Text with one row per sample and cells between separators, below a line of column labels.

    Notes
    -----
    Has no signature: the fallback for every file without null bytes.
    """

    name: ClassVar[str] = "delimited text"
    suffixes: ClassVar[tuple[str, ...]] = (".csv", ".tsv", ".txt")

    def recognises(self, head: bytes, path: Path) -> bool:
        """Return whether the first kilobyte has no null byte, or begins with a byte order mark of UTF-16."""
        return b"\0" not in head[:1024] or head.startswith(_UTF_16_MARKS)

    def read(self, path: Path, *, mapping: RecordingMapping | None = None) -> RawTable:
        """Return the numeric columns of a text export.

        Parameters
        ----------
        path : Path
            Of the file.
        mapping : RecordingMapping or None
            The columns to read and the layout of the text. Without it every column whose first cell is a number is
            read, and separator and decimal sign are detected.

        Returns
        -------
        RawTable

        Raises
        ------
        InvalidInput
            Naming the file and the line, if the text cannot be decoded, a row has too few or too many cells, a cell is
            neither a number nor a missing-value text, or a requested column or row is missing.
        """
        layout = mapping.text if mapping else TextLayout()
        text = decoded_text(path, encoding=layout.encoding)
        separator = layout.separator or _detected_separator(text, layout.lines_to_skip)
        rows = _rows(text, separator, path, layout.lines_to_skip)
        header_line, header = next(rows, (1, []))
        labels = [one_line(label) for label in header]
        if not any(labels):
            raise InvalidInput(f"{path}: line {header_line}: no column names")
        required = dict(mapping.rows) if mapping else {}
        body = [row for row in _rows_of_width(rows, len(labels), path) if _is_selected(row, labels, required, path)]
        if not body:
            raise InvalidInput(f"{path}: holds no rows" + (f" with {required}" if required else ""))
        decimal_sign = layout.decimal_sign or _detected_decimal_sign(body, separator)
        columns = _columns(body, labels, _requested_labels(mapping), decimal_sign, frozenset(layout.missing), path)
        return RawTable(columns=columns, format_name=self.name, lines=np.array([line for line, _ in body]))


def decoded_text(path: Path, *, encoding: str) -> str:
    """Return the text of a file, with its line ends as they are.

    Raises
    ------
    InvalidInput
        Naming the file and the line, if the file is missing, empty, or not of this encoding.
    """
    with refuse_unreadable(path):
        content = path.read_bytes()
    try:
        text = content.decode(encoding)
    except UnicodeDecodeError as failure:
        line = content[: failure.start].count(b"\n") + 1
        raise InvalidInput(f"{path}: line {line}: not {encoding} text; give text.encoding in a mapping") from None
    except (LookupError, UnicodeError) as failure:
        raise InvalidInput(f"{path}: {failure}") from None
    if not text.strip():
        raise InvalidInput(f"{path}: is empty")
    return text


def _detected_separator(text: str, lines_to_skip: int) -> str:
    """Return the separator that occurs most often in the line of labels."""
    lines = text.splitlines()[lines_to_skip : lines_to_skip + 1] or [""]
    return max(_SEPARATORS, key=lambda separator: (lines[0].count(separator), -_SEPARATORS.index(separator)))


def _rows(text: str, separator: str, path: Path, lines_to_skip: int) -> Iterator[NumberedCells]:
    """Yield the rows that are not blank, with quoted cells that may span lines."""
    stream = io.StringIO(text, newline="")
    for _ in range(lines_to_skip):
        stream.readline()
    reader = csv.reader(stream, delimiter=separator, strict=True)
    begins = lines_to_skip + 1
    try:
        for cells in reader:
            if any(cell.strip() for cell in cells):
                yield begins, cells
            begins = lines_to_skip + reader.line_num + 1
    except csv.Error as failure:
        raise InvalidInput(f"{path}: line {begins}: {failure}") from None


def _rows_of_width(rows: Iterator[NumberedCells], width: int, path: Path) -> Iterator[NumberedCells]:
    """Yield rows; refuse one with fewer cells than columns or with surplus cells that are not blank."""
    for line, cells in rows:
        surplus = [cell for cell in cells[width:] if cell.strip()]
        if len(cells) < width or surplus:
            raise InvalidInput(f"{path}: line {line}: has {len(cells)} cells where {width} columns are named")
        yield line, cells


def _is_selected(row: NumberedCells, labels: list[str], required: dict[str, str], path: Path) -> bool:
    """Return whether a row has the required cell in each of the columns given by label."""
    return all(row[1][_index(labels, label, path)].strip() == cell for label, cell in required.items())


def _index(labels: list[str], label: str, path: Path) -> int:
    """Return the place of a label among the columns; refuse one that is not there, with the closest."""
    try:
        return labels.index(label)
    except ValueError:
        hint = suggestion(label, labels) or "it has " + ", ".join(labels[:12])
        raise InvalidInput(f"{path}: has no column {label!r}; {hint}") from None


def _requested_labels(mapping: RecordingMapping | None) -> list[str] | None:
    """Return the labels of the columns that the mapping names, None where it names no channels."""
    if mapping is None or not mapping.channels:
        return None
    labels = [source.column for source in mapping.channels.values()]
    return list(dict.fromkeys([mapping.axis.column, *labels] if mapping.axis else labels))


def _detected_decimal_sign(body: list[NumberedCells], separator: str) -> str:
    """Return the decimal sign that occurs more often in the first twenty rows."""
    if separator == ",":
        return "."
    sample = [cell for _, cells in body[:20] for cell in cells]
    return "," if sum("," in cell for cell in sample) > sum("." in cell for cell in sample) else "."


def _columns(
    body: list[NumberedCells],
    labels: list[str],
    requested: list[str] | None,
    decimal_sign: str,
    missing: frozenset[str],
    path: Path,
) -> tuple[RawColumn, ...]:
    """Return the requested columns, or all numeric ones."""
    columns = []
    for label in requested if requested is not None else labels:
        index = _index(labels, label, path)
        cells = [row[index] for _, row in body]
        if requested is None and (not label or _is_text(cells, decimal_sign, missing)):
            continue
        columns.append(RawColumn(label=label, values=column_values(body, index, label, decimal_sign, missing, path)))
    if not columns:
        raise InvalidInput(f"{path}: line {body[0][0]}: no column holds numbers")
    return tuple(columns)


def column_values(
    rows: list[NumberedCells], index: int, label: str, decimal_sign: str, missing: frozenset[str], path: Path
) -> Floats:
    """Return the numbers of one column; cells beyond the end of a row are missing values."""
    cells = [row[index] if index < len(row) else "" for _, row in rows]
    values, invalid_row = parse_numbers(cells, decimal_sign=decimal_sign, missing=missing)
    if invalid_row is not None:
        line = rows[invalid_row][0]
        raise InvalidInput(f"{path}: line {line}: {label!r} is {cells[invalid_row][:40]!r}, which is not a number")
    return values


def _is_text(cells: list[str], decimal_sign: str, missing: frozenset[str]) -> bool:
    """Return whether the first cell that is not missing is no number."""
    for cell in cells:
        text = cell.strip()
        if text and text not in missing:
            return parse_number(text, decimal_sign=decimal_sign) is None
    return True
