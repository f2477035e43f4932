"""Text exports with one row a sample and cells between separators: CSV and what tribometers' software writes."""

import csv
import io
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from sonolube.errors import InvalidInput, suggestion
from sonolube.measurement.numeric_text import parse_number, parse_numbers
from sonolube.measurement.recordings.mapping import RecordingMapping, TextLayout
from sonolube.measurement.recordings.raw_table import RawColumn, RawTable, one_line

FORMAT = "delimited text"
_SEPARATORS = "\t;,|"
_LONGEST_CELL = 1 << 20

Row = tuple[int, list[str]]  # the line on which it begins, and its cells


def read_delimited(path: Path, *, mapping: RecordingMapping | None = None) -> RawTable:
    """Return the columns of numbers of a text export.

    Parameters
    ----------
    path : Path
        Of the file.
    mapping : RecordingMapping or None
        Which columns are wanted and how the text is written. Without it every column whose first cell is a number is
        taken, and separator and decimal sign are found out.

    Returns
    -------
    Table

    Raises
    ------
    InvalidInput
        Naming the file and the line, if the text cannot be decoded, a row has too few or too many cells, a cell is
        neither a number nor one of the texts for none, or a column or the rows asked for are not there.
    """
    layout = mapping.text if mapping else TextLayout()
    text = decoded(path, encoding=layout.encoding)
    separator = layout.separator or _separator(text, layout.lines_to_skip)
    rows = _rows(text, separator, path, layout.lines_to_skip)
    header_line, header = next(rows, (1, []))
    labels = [one_line(label) for label in header]
    if not any(labels):
        raise InvalidInput(f"{path}: line {header_line}: no column names")
    body = [
        row for row in _whole_rows(rows, len(labels), path) if mapping is None or _taken(row, labels, mapping, path)
    ]
    if not body:
        raise InvalidInput(
            f"{path}: holds no rows" + (f" with {dict(mapping.rows)}" if mapping and mapping.rows else "")
        )
    decimal_sign = layout.decimal_sign or _decimal_sign(body, separator)
    columns = _columns(body, labels, _wanted(labels, mapping), decimal_sign, frozenset(layout.missing), path)
    return RawTable(columns=columns, format=FORMAT, lines=np.array([line for line, _ in body]))


def decoded(path: Path, *, encoding: str) -> str:
    """Return the text of a file, with its line ends as they are.

    Raises
    ------
    InvalidInput
        Naming the file and the line, if the file is missing, empty, or not of this encoding.
    """
    try:
        content = path.read_bytes()
        text = content.decode(encoding)
    except OSError as failure:
        raise InvalidInput(f"{path}: cannot be read: {failure.strerror}") from None
    except UnicodeDecodeError as failure:
        line = content[: failure.start].count(b"\n") + 1
        raise InvalidInput(f"{path}: line {line}: not {encoding} text; give text.encoding in a mapping") from None
    except (LookupError, UnicodeError) as failure:
        raise InvalidInput(f"{path}: {failure}") from None
    if not text.strip():
        raise InvalidInput(f"{path}: is empty")
    return text


def _separator(text: str, lines_to_skip: int) -> str:
    lines = text.splitlines()[lines_to_skip : lines_to_skip + 1] or [""]
    return max(_SEPARATORS, key=lambda separator: (lines[0].count(separator), -_SEPARATORS.index(separator)))


def _rows(text: str, separator: str, path: Path, lines_to_skip: int) -> Iterator[Row]:
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


def _whole_rows(rows: Iterator[Row], width: int, path: Path) -> Iterator[Row]:
    for line, cells in rows:
        extra = [cell for cell in cells[width:] if cell.strip()]
        if len(cells) < width or extra:
            raise InvalidInput(f"{path}: line {line}: has {len(cells)} cells where {width} columns are named")
        yield line, cells


def _taken(row: Row, labels: list[str], mapping: RecordingMapping, path: Path) -> bool:
    return all(row[1][_index(labels, label, path)].strip() == wanted for label, wanted in mapping.rows.items())


def _index(labels: list[str], label: str, path: Path) -> int:
    try:
        return labels.index(label)
    except ValueError:
        hint = suggestion(label, labels) or "it has " + ", ".join(labels[:12])
        raise InvalidInput(f"{path}: has no column {label!r}; {hint}") from None


def _wanted(labels: list[str], mapping: RecordingMapping | None) -> list[str] | None:
    if mapping is None or not mapping.channels:
        return None
    wanted = [source.column for source in mapping.channels.values()]
    return list(dict.fromkeys([mapping.axis.column, *wanted] if mapping.axis else wanted))


def _decimal_sign(body: list[Row], separator: str) -> str:
    if separator == ",":
        return "."
    sample = [cell for _, cells in body[:20] for cell in cells]
    return "," if sum("," in cell for cell in sample) > sum("." in cell for cell in sample) else "."


def _columns(
    body: list[Row], labels: list[str], wanted: list[str] | None, decimal_sign: str, missing: frozenset[str], path: Path
) -> tuple[RawColumn, ...]:
    columns = []
    for label in wanted if wanted is not None else labels:
        index = _index(labels, label, path)
        cells = [row[index] for _, row in body]
        if wanted is None and (not label or _is_text(cells, decimal_sign, missing)):
            continue
        values, wrong = parse_numbers(cells, decimal_sign=decimal_sign, missing=missing)
        if wrong is not None:
            line = body[wrong][0]
            raise InvalidInput(f"{path}: line {line}: {label!r} is {cells[wrong][:40]!r}, which is not a number")
        columns.append(RawColumn(label=label, values=values))
    if not columns:
        raise InvalidInput(f"{path}: line {body[0][0]}: no column holds numbers")
    return tuple(columns)


def _is_text(cells: list[str], decimal_sign: str, missing: frozenset[str]) -> bool:
    for cell in cells:
        text = cell.strip()
        if text and text not in missing:
            return parse_number(text, decimal_sign=decimal_sign) is None
    return True
