"""Recordings as text: delimited, with one row per sample, and LabVIEW's (LVM).

Delimited text is CSV and the exports of tribometer software; an LVM file has a header of keys, then segments, each
with a header and columns of its own.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import ClassVar, final

import numpy as np

from sonolube.errors import InvalidInput
from sonolube.measurement.measured_files import detected_decimal_sign, first_lines, parse_number, require_channels
from sonolube.measurement.recordings.channels_and_parts import TIME_LABELS, begun_at, name_and_unit, time_shifts
from sonolube.measurement.recordings.clocks import STATED, clock_of_rows, stated_clock
from sonolube.measurement.recordings.large_text import ends_of_large_text, numbers_of_large_text
from sonolube.measurement.recordings.lvm_segments import Header, LvmSegment, joined_segments
from sonolube.measurement.recordings.mapping import RecordingMapping, TextLayout
from sonolube.measurement.recordings.raw_table import (
    RawColumn,
    RawTable,
    column_of_label,
    numbered_labels,
    si_conversion,
)
from sonolube.measurement.recordings.table_layout import found_table, left_out_lines
from sonolube.measurement.recordings.text_tables import (
    NARROW,
    TextTable,
    column_values,
    decoded_text,
    is_text,
    require_rows,
    text_tables,
)

_MAX_NAMED = 12  # columns in a caveat
UTF_16_MARKS = (b"\xff\xfe", b"\xfe\xff")
"""Byte order marks with which a text in UTF-16 begins."""


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
        """Whether the first kilobyte has no null byte, or begins with a byte order mark of UTF-16."""
        return b"\0" not in head[:1024] or head.startswith(UTF_16_MARKS)

    def read(self, path: Path, *, mapping: RecordingMapping | None = None) -> RawTable:
        """Numeric columns of a text export.

        Of several sections, the rows one after the other, with the times of later ones shifted by the differences of
        their stated starts where the times restart.
        """
        layout = mapping.text if mapping else TextLayout()
        if (large := _large_table(path, mapping)) is not None:
            return large
        text, caveats = decoded_text(path, encoding=layout.encoding)
        found = found_table(text, path) if layout == TextLayout() else None
        sections = mapping.selection.sections if mapping else ()
        tables = [found.table] if found and not sections else text_tables(text, layout, sections, path)
        sign = layout.decimal_sign or _detected_decimal_sign(tables)
        read = [_part(table, mapping, sign, frozenset(layout.missing), path) for table in tables]
        parts, unused = [columns for columns, _ in read], read[0][1]
        _require_same_columns(tables, parts, path)
        columns, assumed = _joined(tables, parts, mapping, path)
        caveats += (left_out_lines(found.others) if found else ()) + _left_out_caveat(unused)
        unread = sum(table.unread for table in tables)
        if unread:
            caveats += (f"{unread} lines after the end of a table are not read",)
        if assumed:
            caveats += ("the times restart in a later section without a stated start: each follows the one before",)
        return RawTable(
            columns=columns,
            format_name=self.name,
            lines=np.array([line for table in tables for line, _ in table.rows], dtype=np.int64),
            begun=tables[0].begun,
            caveats=caveats,
        )


def export_table(path: Path) -> TextTable:
    """First table of a text export as its reader finds it; of a large one its beginning."""
    text = ends_of_large_text(path) or decoded_text(path, encoding="")[0]
    found = found_table(text, path)
    return found.table if found else text_tables(text, TextLayout(), (), path)[0]


def _large_table(path: Path, mapping: RecordingMapping | None) -> RawTable | None:
    """Columns of a large text whose rows are all alike; None for any other."""
    layout = mapping.text if mapping else TextLayout()
    if layout != TextLayout() or (mapping and (mapping.rows or mapping.selection.sections)):
        return None
    ends = ends_of_large_text(path)
    if ends is None:
        return None
    try:
        found = found_table(ends, path)
    except InvalidInput:
        return None
    if found is None or found.others or not found.has_labels or found.table.separator == NARROW:
        return None
    table = found.table
    sign = _detected_decimal_sign([table])
    missing = frozenset(layout.missing)
    try:
        columns, unused = _part(table, mapping, sign, missing, path)
    except InvalidInput:
        return None
    places = {label: at for at, label in enumerate(numbered_labels(table.labels))}
    labels = numbered_labels([column.label for column in columns])
    if not all(label in places for label in labels):
        return None
    chosen = [places[label] for label in labels]
    numbers = numbers_of_large_text(path, table, chosen, decimal_sign=sign, missing=missing)
    if numbers is None:
        return None
    return RawTable(
        columns=tuple(replace(column, values=values) for column, values in zip(columns, numbers, strict=True)),
        format_name=DelimitedText.name,
        lines=table.rows[0][0] + np.arange(numbers[0].size),
        caveats=_left_out_caveat(unused),
    )


def _detected_decimal_sign(tables: Sequence[TextTable]) -> str:
    """Decimal sign of the numbers; a point where cells are separated by commas."""
    if tables[0].separator == ",":
        return "."
    return detected_decimal_sign(cell for table in tables for _, cells in table.rows for cell in cells)


def _part(
    table: TextTable, mapping: RecordingMapping | None, sign: str, missing: frozenset[str], path: Path
) -> tuple[list[RawColumn], list[str]]:
    """Columns of one table, those that the mapping requests or all numeric ones, with the times; labels of no use."""
    require_rows(table, mapping.rows if mapping else {}, path)
    read = partial(_numbers, table, sign=sign, missing=missing, path=path)
    requested = _requested_labels(mapping, table.labels)
    if requested is None:
        numeric = [at for at, label in enumerate(table.labels) if label and not is_text(table.rows, at, sign, missing)]
        columns = [read(at, label=table.labels[at]) for at in numeric]
    else:
        places = {label: at for at, label in enumerate(numbered_labels(table.labels))}
        columns = [read(column_of_label(places, label, path), label=label) for label in requested]
    used = {column.label for column in columns}
    if (mapping is None or (mapping.axis, mapping.sample_rate) == (None, None)) and not any(map(_is_time, used)):
        columns, labels = _with_times(table, columns, read)
        used.update(labels)
    if not columns:
        raise InvalidInput(f"{path}: line {table.rows[0][0]}: no column holds numbers")
    return columns, [] if requested is not None else [label for label in table.labels if label and label not in used]


def _numbers(table: TextTable, place: int, *, label: str, sign: str, missing: frozenset[str], path: Path) -> RawColumn:
    """Column of numbers with its unit."""
    unit = table.units[place] if place < len(table.units) else ""
    return RawColumn(
        label=label, values=column_values(table.rows, place, label, sign, missing, path), unit=unit or None
    )


def _with_times(
    table: TextTable, columns: list[RawColumn], read: Callable[..., RawColumn]
) -> tuple[list[RawColumn], Sequence[str]]:
    """Columns with the times of the rows: by time stamps, a label, a stated start and step, or the only unit of time.

    With the labels of the times.
    """
    if (clock := clock_of_rows(table)) is not None:
        return [clock.times, *columns], clock.labels
    if (labelled := next((at for at, label in enumerate(table.labels) if _is_time(label)), None)) is not None:
        return [read(labelled, label=table.labels[labelled]), *columns], ()
    if (stated := stated_clock(table)) is not None:
        channels = [column for column in columns if not np.all(np.diff(column.values) == 1.0)]  # but the sequence
        return [replace(column, start=stated[0], interval=stated[1]) for column in channels], STATED
    by_unit = [at for at, label in enumerate(table.labels) if has_unit_of_time(label, table.units[at : at + 1])]
    if len(by_unit) != 1:
        return columns, ()
    label = table.labels[by_unit[0]]
    time = read(by_unit[0], label="time")
    time = replace(time, unit=time.unit or name_and_unit(label)[1])
    return [time, *(column for column in columns if column.label != label)], ()


def _is_time(label: str) -> bool:
    """Whether a label is one of times."""
    return name_and_unit(label)[0] in TIME_LABELS


def has_unit_of_time(label: str, units: Sequence[str]) -> bool:
    """Whether the unit of a column is one of time."""
    unit = next(iter(units), "") or name_and_unit(label)[1] or ""
    try:
        return bool(unit) and si_conversion(unit, unit="s", name=label)[0] > 0
    except InvalidInput:
        return False


def _left_out_caveat(labels: Sequence[str]) -> tuple[str, ...]:
    """Caveat about columns that hold neither numbers nor times."""
    named = ", ".join(map(repr, labels[:_MAX_NAMED])) + (", ..." if len(labels) > _MAX_NAMED else "")
    return (f"{'column' if len(labels) == 1 else 'columns'} without numbers left out: {named}",) if labels else ()


def _requested_labels(mapping: RecordingMapping | None, labels: list[str]) -> list[str] | None:
    """Labels of the columns that the mapping names, None where it names no channels."""
    if mapping is None or not mapping.channels:
        return None
    named = mapping.for_labels(labels)
    columns = [source.column for source in named.channels.values()]
    return list(dict.fromkeys([named.axis.column, *columns] if named.axis else columns))


def _require_same_columns(tables: Sequence[TextTable], parts: Sequence[list[RawColumn]], path: Path) -> None:
    """Refuse sections whose columns or units differ from those of the first."""
    first = [(column.label, column.unit) for column in parts[0]]
    for table, columns in zip(tables[1:], parts[1:], strict=True):
        if [(column.label, column.unit) for column in columns] != first:
            raise InvalidInput(
                f"{path}: line {table.line}: section {table.section!r} has other columns or units than"
                f" {tables[0].section!r}; choose with --section"
            )


def _joined(
    tables: Sequence[TextTable], parts: Sequence[list[RawColumn]], mapping: RecordingMapping | None, path: Path
) -> tuple[tuple[RawColumn, ...], bool]:
    """Columns of all sections joined, the times shifted, and whether a distance was assumed."""
    if len(parts) == 1:
        return tuple(parts[0]), False
    shifts, assumed = [0.0] * len(parts), False
    at = _time_column(parts[0], mapping)
    if at is not None:
        scale = _seconds(parts[0][at], mapping, path)
        times = [part[at].values * scale for part in parts]
        if all(np.isfinite(time).all() for time in times):
            seconds, assumed = time_shifts(times, [begun_at(table.begun) for table in tables])
            shifts = [shift / scale for shift in seconds]
    joined = []
    for index, column in enumerate(parts[0]):
        added = shifts if index == at else [0.0] * len(parts)
        values = [part[index].values + shift for part, shift in zip(parts, added, strict=True)]
        joined.append(replace(column, values=np.concatenate(values)))
    return tuple(joined), assumed


def _time_column(columns: Sequence[RawColumn], mapping: RecordingMapping | None) -> int | None:
    """Index of the column that holds the time; None where there is none."""
    if mapping is not None and mapping.axis is not None:
        labels = mapping.axis.labels if mapping.axis_quantity == "time" else ()
        return next((index for index, column in enumerate(columns) if column.label in labels), None)
    return next((i for i, column in enumerate(columns) if name_and_unit(column.label)[0] in TIME_LABELS), None)


def _seconds(column: RawColumn, mapping: RecordingMapping | None, path: Path) -> float:
    """Seconds in one unit of the time column."""
    axis = mapping.axis if mapping is not None else None
    stated = axis.unit if axis is not None and axis.unit is not None else column.unit or name_and_unit(column.label)[1]
    gain = 1.0 if axis is None else axis.gain
    return gain * (si_conversion(stated, unit="s", name=f"{path}: {column.label!r}")[0] if stated else 1.0)


_SIGNATURE = "LabVIEW Measurement"
_END_OF_HEADER = "***End_of_Header***"
_START_SPECIAL = "***Start_Special***"
_END_SPECIAL = "***End_Special***"
_COMMENT = "Comment"
_SEGMENT_KEYS = frozenset(
    {"Channels", "Samples", "Date", "Time", "Notes", "X_Dimension", "X0", "Delta_X", "Y_Unit_Label", _END_OF_HEADER}
)
"""Keys with which the header of a segment can begin, beside others that only follow a blank line."""

NumberedLine = tuple[int, str]


@dataclass(slots=True)
class _Parser:
    """State of the reading of one file: the separator, decimal sign and header of the file, and the segments so far."""

    path: Path
    lines: list[NumberedLine]
    at: int = 0
    separator: str = "\t"
    decimal_sign: str = ""
    header: Header = field(default_factory=lambda: Header(keys={}, line=1))
    segments: list[LvmSegment] = field(default_factory=list)

    def parse(self) -> None:
        """Read all headers and segments; a header of the file may occur again where recordings were appended."""
        first = self.lines[0] if self.lines else (1, "")
        if not first[1].startswith(_SIGNATURE):
            raise InvalidInput(f"{self.path}: line 1: an LVM file begins with {_SIGNATURE!r}, got {first[1][:40]!r}")
        after_blank = True
        while self.at < len(self.lines):
            number, line = self.lines[self.at]
            if not line.strip(" \t,") and not self._is_row_of_missing_values(line):
                after_blank = True
                self.at += 1
            elif line.startswith(_SIGNATURE):
                self._file_header()
            elif self._continues(line, after_blank=after_blank) or not line.strip(" \t,"):
                segment, cells = self.segments[-1], self._cells(line)
                if segment.x_columns == "No" or any(cells[: len(segment.labels)]):  # else only a comment
                    segment.rows.append((number, cells))
                after_blank = False
                self.at += 1
            else:
                self._segment_header()
                after_blank = False

    def _is_row_of_missing_values(self, line: str) -> bool:
        """Whether a line of separators is a sample of a segment without times that has not ended."""
        if not self.segments or self.segments[-1].x_columns != "No" or self.separator not in line:
            return False
        return len(self.segments[-1].rows) < self.segments[-1].stated_samples

    def _cells(self, line: str) -> list[str]:
        """Cells of a line."""
        return [cell.strip() for cell in line.split(self.separator)]

    def _continues(self, line: str, *, after_blank: bool) -> bool:
        """Whether a line is a row of the segment before it, not the beginning of a header."""
        if not self.segments or line.startswith("***"):
            return False
        cells = self._cells(line)
        if not after_blank:
            return cells[0] not in _SEGMENT_KEYS
        value = next((cell for cell in cells if cell), "")
        return parse_number(value, decimal_sign=self.decimal_sign or ("," if "," in value else ".")) is not None

    def _file_header(self) -> None:
        """Read a header of the file; the first one gives separator, decimal sign and start."""
        begins = self.at
        self.at += 1
        header = self._header("the header")
        if header.text("Separator", "Tab").strip().lower() == "comma" or "," in self.lines[begins][1]:
            self.separator, self.at = ",", begins + 1  # the header is written with the same separator
            header = self._header("the header")
        sign = header.text("Decimal_Separator", "." if self.separator == "," else "")
        if sign not in (".", ",", "") or sign == self.separator:
            raise InvalidInput(f"{self.path}: line {header.line}: Decimal_Separator is {sign[:20]!r}")
        self.decimal_sign = sign
        if not self.header.keys:
            self.header = header

    def _header(self, kind: str) -> Header:
        """Keys up to the next end of a header."""
        keys: dict[str, list[str]] = {}
        begins = self.lines[min(self.at, len(self.lines)) - 1][0]
        while self.at < len(self.lines):
            number, line = self.lines[self.at]
            self.at += 1
            if line.startswith(_END_OF_HEADER):
                return Header(keys=keys, line=number)
            key, *cells = self._cells(line)
            if key:
                keys[key] = cells
        raise InvalidInput(f"{self.path}: line {begins}: {kind} has no {_END_OF_HEADER}")

    def _segment_header(self) -> None:
        """Read the header of a segment and its line of labels; begin a segment."""
        header = self._header("a header")
        while self.at < len(self.lines) and not self.lines[self.at][1].strip():
            self.at += 1
        if self.at == len(self.lines):
            raise InvalidInput(f"{self.path}: line {header.line}: no column names follow the header")
        number, line = self.lines[self.at]
        labels = self._cells(line)
        self.at += 1
        while labels and not labels[-1]:
            labels.pop()
        if labels and labels[-1] == _COMMENT:
            labels.pop()
        require_channels(len(labels), self.path, kind="columns")
        times = self.header.text("X_Columns", "One").capitalize()  # that the file holds: No, One or Multi
        self.segments.append(LvmSegment(header=header, labels=labels, line=number, x_columns=times))


@final
class LabviewText:
    """LabVIEW's text recordings (LVM) of any number of segments.

    References
    ----------
    .. [1] NI, Specification for the LabVIEW Measurement File (.lvm), tutorial 4139.
    """

    name: ClassVar[str] = "LabVIEW measurement text"
    suffixes: ClassVar[tuple[str, ...]] = (".lvm",)

    def recognises(self, head: bytes, path: Path) -> bool:
        """Whether the first line is that of an LVM file."""
        return first_lines(head)[0].startswith(_SIGNATURE)

    def read(self, path: Path, *, mapping: RecordingMapping | None = None) -> RawTable:
        """Channels of an LVM file; segments with the same channels are concatenated in order.

        Times are those written, with later segments shifted by the difference of the start times in their headers where
        they restart. Channels without any value are left out.
        """
        text, caveats = decoded_text(path, encoding=mapping.text.encoding if mapping else "")
        parser = _Parser(path=path, lines=list(_lines(text)))
        parser.parse()
        header = parser.header
        if not parser.segments:
            raise InvalidInput(f"{path}: line {header.line}: no segment follows the header")
        sign = parser.decimal_sign or detected_decimal_sign(
            cell for segment in parser.segments for _, cells in segment.rows for cell in cells[: len(segment.labels)]
        )
        columns, lines, own = joined_segments(parser.segments, path, decimal_sign=sign, mapping=mapping)
        return RawTable(
            columns=columns, format_name=self.name, lines=lines, begun=header.begun, caveats=(*caveats, *own)
        )


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
