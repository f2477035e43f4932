"""LabVIEW's text recordings (LVM): a file header of keys, then segments, each with a header and columns of its own."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import datetime, timedelta
from pathlib import Path
from typing import ClassVar, final

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.file_format import first_lines
from sonolube.measurement.numeric_text import parse_numbers
from sonolube.measurement.recordings.delimited import column_values, decoded_text
from sonolube.measurement.recordings.mapping import RecordingMapping
from sonolube.measurement.recordings.raw_table import RawColumn, RawTable

_SIGNATURE = "LabVIEW Measurement"
_END_OF_HEADER = "***End_of_Header***"
_START_SPECIAL = "***Start_Special***"
_END_SPECIAL = "***End_Special***"
_X_LABEL = "X_Value"
_TIMESTAMP = re.compile(r"(\d{4})/(\d{1,2})/(\d{1,2}) (\d{1,2}):(\d{1,2}):(\d{1,2})(?:[.,](\d{1,30}))?", re.ASCII)
_MISSING = frozenset({"NaN", "-NaN", "nan"})

NumberedLine = tuple[int, str]


@dataclass(frozen=True, kw_only=True, slots=True)
class _Header:
    """The keys of a header, each with its cells, and the line on which the header ends."""

    keys: dict[str, list[str]]
    line: int

    def text(self, key: str, default: str) -> str:
        """Return the first cell of a key that is not empty."""
        return next((cell for cell in self.keys.get(key, []) if cell), default)


@dataclass(frozen=True, kw_only=True, slots=True)
class _NumberStyle:
    """Separator of cells and decimal sign of a file."""

    separator: str
    decimal_sign: str


@final
class LabviewText:
    """LabVIEW's text recordings (LVM) of any number of segments."""

    name: ClassVar[str] = "LabVIEW measurement text"
    suffixes: ClassVar[tuple[str, ...]] = (".lvm",)

    def recognises(self, head: bytes, path: Path) -> bool:
        """Return whether the first line is that of an LVM file."""
        return first_lines(head)[0].startswith(_SIGNATURE)

    def read(self, path: Path, *, mapping: RecordingMapping | None = None) -> RawTable:
        """Return the channels of an LVM file; segments with the same channels are concatenated in order.

        Parameters
        ----------
        path : Path
            Of the file.
        mapping : RecordingMapping or None
            Only its `text.encoding` is used here.

        Returns
        -------
        RawTable
            Times are those written, with later segments shifted by the difference of the start times in their headers.
            Where every channel has times of its own they must agree.

        Raises
        ------
        InvalidInput
            Naming the file and the line, if the first line is not that of an LVM file, a header has no end, counts
            contradict the columns, a cell is no number, segments have different channels, or channels different times.
        """
        text = decoded_text(path, encoding=mapping.text.encoding if mapping else "utf-8-sig")
        lines = _lines(text)
        first = next(lines, (1, ""))
        if not first[1].startswith(_SIGNATURE):
            raise InvalidInput(f"{path}: line 1: an LVM file begins with {_SIGNATURE!r}, got {first[1][:40]!r}")
        header = _header(lines, path, first[0], "\t", may_end=False)
        if header is None:
            raise InvalidInput(f"{path}: line {first[0]}: the header has no {_END_OF_HEADER}")
        separator = "," if header.text("Separator", "Tab").strip().lower() == "comma" else "\t"
        if separator == ",":  # the header is written with the same separator
            lines = _lines(text)
            header = _header(lines, path, next(lines)[0], separator, may_end=False) or header
        style = _NumberStyle(separator=separator, decimal_sign=_decimal_sign(header, path))
        segments = list(_segments(lines, header, style, path))
        if not segments:
            raise InvalidInput(f"{path}: line {header.line}: no segment follows the header")
        return _concatenated(segments, path, begun=f"{header.text('Date', '')} {header.text('Time', '')}".strip())


def _lines(text: str) -> Iterator[NumberedLine]:
    """Yield the numbered lines outside special sections."""
    special = False
    for at, line in enumerate(text.splitlines(), start=1):
        if line.startswith(_START_SPECIAL):
            special = True
        if not special:
            yield at, line
        if line.startswith(_END_SPECIAL):
            special = False


def _decimal_sign(header: _Header, path: Path) -> str:
    """Return the decimal sign stated in the header of the file."""
    sign = header.text("Decimal_Separator", ".")
    if sign not in (".", ","):
        raise InvalidInput(f"{path}: line {header.line}: Decimal_Separator is {sign[:20]!r}")
    return sign


def _header(lines: Iterator[NumberedLine], path: Path, at: int, separator: str, *, may_end: bool) -> _Header | None:
    """Return the next header; None at the end of the file where it may end."""
    keys: dict[str, list[str]] = {}
    for at, line in lines:
        if line.startswith(_END_OF_HEADER):
            return _Header(keys=keys, line=at)
        key, *cells = line.split(separator)
        if key.strip():
            keys[key.strip()] = [cell.strip() for cell in cells]
    if keys or not may_end:
        raise InvalidInput(f"{path}: line {at}: a header has no {_END_OF_HEADER}")
    return None


def _segments(lines: Iterator[NumberedLine], header: _Header, style: _NumberStyle, path: Path) -> Iterator[RawTable]:
    """Yield the segments after the header of the file."""
    at = header.line
    while (segment := _header(lines, path, at, style.separator, may_end=True)) is not None:
        count = _channel_count(segment, path)
        at, labels = _labels(lines, segment, path, style)
        rows, ended_by_blank_line = [], False
        for at, line in lines:
            if not line.strip():
                ended_by_blank_line = True
                break
            rows.append((at, [cell.strip() for cell in line.split(style.separator)]))
        yield _segment(rows, labels, segment, count, style, path)
        if not ended_by_blank_line:
            return


def _labels(lines: Iterator[NumberedLine], segment: _Header, path: Path, style: _NumberStyle) -> tuple[int, list[str]]:
    """Return the column labels of a segment, and the line on which they stand."""
    for at, line in lines:
        if line.strip():
            return at, [cell.strip() for cell in line.split(style.separator)]
    raise InvalidInput(f"{path}: line {segment.line}: no column names follow the header")


def _channel_count(segment: _Header, path: Path) -> int:
    """Return the number of channels stated in the header of a segment."""
    text = segment.text("Channels", "")
    if not (text.isascii() and text.isdigit() and 0 < len(text) < 7 and int(text) > 0):
        raise InvalidInput(f"{path}: line {segment.line}: Channels is {text[:40]!r}, not a count")
    return int(text)


def _segment(
    rows: list[tuple[int, list[str]]], labels: list[str], segment: _Header, count: int, style: _NumberStyle, path: Path
) -> RawTable:
    """Return the columns of one segment: its time and its channels."""
    named = [(index, label) for index, label in enumerate(labels) if label and label != "Comment"]
    channels = [(index, label) for index, label in named if label != _X_LABEL]
    if len(channels) != count:
        at = segment.line + 1
        raise InvalidInput(f"{path}: line {at}: names {len(channels)} channels where the header has {count}")
    lines = np.array([line for line, _ in rows], dtype=np.int64)
    table = {index: column_values(rows, index, label, style.decimal_sign, _MISSING, path) for index, label in named}
    time = _time(table, named, segment, len(rows), style, path, lines)
    units = segment.keys.get("Y_Unit_Label", [])
    columns = [RawColumn(label=_X_LABEL, values=time, unit="s")]
    for channel, (index, label) in enumerate(channels):
        unit = units[channel] if channel < len(units) and units[channel] else None
        columns.append(RawColumn(label=label, values=table[index], unit=unit))
    begun = f"{segment.text('Date', '')} {segment.text('Time', '')}".strip()
    return RawTable(columns=tuple(columns), format_name=LabviewText.name, lines=lines, begun=begun)


def _time(
    table: dict[int, Floats],
    named: list[tuple[int, str]],
    segment: _Header,
    rows: int,
    style: _NumberStyle,
    path: Path,
    lines: NDArray[np.int64],
) -> Floats:
    """Return the time of a segment: that of its time columns, which must agree, else that of X0 and Delta_X."""
    written = [table[index] for index, label in named if label == _X_LABEL and np.isfinite(table[index]).any()]
    if not written:
        starts, steps = (_header_numbers(segment, key, style, path) for key in ("X0", "Delta_X"))
        if len(set(starts)) > 1 or len(set(steps)) != 1:
            raise InvalidInput(f"{path}: line {segment.line}: X0 and Delta_X must give all channels one time")
        return (starts[0] if starts else 0.0) + steps[0] * np.arange(rows, dtype=np.float64)
    for other in written[1:]:
        differs = ~((other == written[0]) | np.isnan(other))
        if differs.any():
            line = lines[int(np.argmax(differs))]
            raise InvalidInput(f"{path}: line {line}: channels have different times; export them separately")
    return np.asarray(written[0])


def _header_numbers(segment: _Header, key: str, style: _NumberStyle, path: Path) -> list[float]:
    """Return the finite numbers of a key in the header of a segment."""
    cells = [cell for cell in segment.keys.get(key, []) if cell]
    values, invalid_row = parse_numbers(cells, decimal_sign=style.decimal_sign, missing=frozenset())
    if invalid_row is not None or not np.isfinite(values).all():
        cell = cells[invalid_row or 0][:40]
        raise InvalidInput(f"{path}: line {segment.line}: {key} is {cell!r}, which is not a number")
    return [float(value) for value in values]


def _timestamp(text: str) -> datetime | None:
    """Return the date and time of a header; None for text that is none."""
    match = _TIMESTAMP.match(text)
    if match is None:
        return None
    try:
        year, month, day, hour, minute, second = (int(part) for part in match.groups()[:6])
        return datetime(year, month, day, hour, minute, second) + timedelta(seconds=float(f"0.{match[7] or 0}"))
    except (ValueError, OverflowError):
        return None


def _concatenated(segments: list[RawTable], path: Path, *, begun: str) -> RawTable:
    """Return all segments as one table, their times shifted to the start of the first."""
    first = segments[0]
    labels = [column.label for column in first.columns]
    for segment in segments[1:]:
        if [column.label for column in segment.columns] != labels:
            line = "" if segment.lines is None or not segment.lines.size else f"line {segment.lines[0]}: "
            raise InvalidInput(f"{path}: {line}this segment has other channels than the first")
    starts = [_timestamp(segment.begun) for segment in segments]
    shifts = [0.0 if at is None or starts[0] is None else (at - starts[0]).total_seconds() for at in starts]
    columns = tuple(
        RawColumn(
            label=column.label,
            values=np.concatenate(
                [
                    segment.columns[index].values + (0.0 if index else shift)
                    for segment, shift in zip(segments, shifts, strict=True)
                ]
            ),
            unit=column.unit,
        )
        for index, column in enumerate(first.columns)
    )
    lines = np.concatenate([segment.lines for segment in segments if segment.lines is not None])
    return RawTable(columns=columns, format_name=LabviewText.name, lines=lines, begun=begun)
