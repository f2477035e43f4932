"""Delimited text with one row per sample: CSV, and exports of tribometer software."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import ClassVar, final

import numpy as np

from sonolube.errors import InvalidInput
from sonolube.measurement.numeric_text import detected_decimal_sign
from sonolube.measurement.recordings.channel_choice import TIME_LABELS, name_and_unit
from sonolube.measurement.recordings.joining import begun_at, time_shifts
from sonolube.measurement.recordings.mapping import RecordingMapping, TextLayout
from sonolube.measurement.recordings.raw_table import RawColumn, RawTable
from sonolube.measurement.recordings.repeated_labels import column_of_label, numbered_labels
from sonolube.measurement.recordings.text_columns import column_values, is_text
from sonolube.measurement.recordings.text_file import decoded_text
from sonolube.measurement.recordings.text_tables import TextTable, require_rows, text_tables
from sonolube.measurement.recordings.written_units import si_conversion

_UTF_16_MARKS = (b"\xff\xfe", b"\xfe\xff")


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
        return b"\0" not in head[:1024] or head.startswith(_UTF_16_MARKS)

    def read(self, path: Path, *, mapping: RecordingMapping | None = None) -> RawTable:
        """Numeric columns of a text export.

        Of several sections, the rows one after the other, with the times of later ones shifted by the differences of
        their stated starts where the times restart.
        """
        layout = mapping.text if mapping else TextLayout()
        text, caveats = decoded_text(path, encoding=layout.encoding)
        tables = text_tables(text, layout, mapping.selection.sections if mapping else (), path)
        sign = layout.decimal_sign or _detected_decimal_sign(tables)
        parts = [_part(table, mapping, sign, frozenset(layout.missing), path) for table in tables]
        _require_same_columns(tables, parts, path)
        columns, assumed = _joined(tables, parts, mapping, path)
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


def _detected_decimal_sign(tables: Sequence[TextTable]) -> str:
    """Decimal sign of the numbers; a point where cells are separated by commas."""
    if tables[0].separator == ",":
        return "."
    return detected_decimal_sign(cell for table in tables for _, cells in table.rows for cell in cells)


def _part(
    table: TextTable, mapping: RecordingMapping | None, sign: str, missing: frozenset[str], path: Path
) -> list[RawColumn]:
    """Columns of one table: those that the mapping requests, or all numeric ones."""
    require_rows(table, mapping.rows if mapping else {}, path)
    indices = {label: index for index, label in enumerate(numbered_labels(table.labels))}
    requested = _requested_labels(mapping, table.labels)
    columns = []
    for place, label in enumerate(table.labels if requested is None else requested):
        index = place if requested is None else column_of_label(indices, label, path)
        if requested is None and (not label or is_text(table.rows, index, sign, missing)):
            continue
        values = column_values(table.rows, index, label, sign, missing, path)
        unit = table.units[index] if index < len(table.units) else ""
        columns.append(RawColumn(label=label, values=values, unit=unit or None))
    if not columns:
        raise InvalidInput(f"{path}: line {table.rows[0][0]}: no column holds numbers")
    return columns


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
