"""Columns of an export of a recording with what each is taken for, and the mapping that follows from statements."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sonolube.errors import InvalidInput
from sonolube.measurement.column_statements import FileColumn, mapping_of_statements, stated_file_columns
from sonolube.measurement.file_kind import file_kind
from sonolube.measurement.recordings.channels_and_parts import FRICTION
from sonolube.measurement.recordings.clocks import SEQUENCE, STATED, clock_of_rows, stated_clock
from sonolube.measurement.recordings.mapping import RecordingMapping
from sonolube.measurement.recordings.raw_table import column_of_label
from sonolube.measurement.recordings.reader import recording_format
from sonolube.measurement.recordings.text_recordings import DelimitedText, export_table, has_unit_of_time
from sonolube.measurement.run_headings import LEFT_OUT
from sonolube.text.units import format_si
from sonolube.vocabulary import quantities

if TYPE_CHECKING:
    import xarray as xr

_MAX_CELLS = 3  # that tell what a column holds


@dataclass(frozen=True, kw_only=True, slots=True)
class ExportColumns:
    """Columns of an export.

    Parameters
    ----------
    columns : tuple of FileColumn
        As their labels and units tell; the time may be a column of time stamps, which needs no statement.
    line : int
        Of the labels; 0 where the file is no text.
    has_times : bool
        Whether the file tells the times of its rows.
    """

    columns: tuple[FileColumn, ...]
    line: int = 0
    has_times: bool = True


def export_columns(path: Path, *, mapping: RecordingMapping | None = None) -> ExportColumns:
    """Columns of an export of a recording, of a text by its cells, else of what its reader finds."""
    reader = recording_format(path)
    if not isinstance(reader, DelimitedText):
        read = reader.read(path).columns
        cells = [[f"{each:.6g}" for each in column.values[:_MAX_CELLS]] for column in read]
        found = stated_file_columns([each.label for each in read], [each.unit or "" for each in read], cells, mapping)
        return ExportColumns(columns=tuple(found))
    table = export_table(path)
    units = [*table.units, *[""] * (len(table.labels) - len(table.units))]
    columns = [[row[place] for _, row in table.rows if place < len(row)] for place in range(len(table.labels))]
    found = stated_file_columns(table.labels, units, columns, mapping)
    clock = clock_of_rows(table)
    times = [at for at, label in enumerate(table.labels) if has_unit_of_time(label, units[at : at + 1])]
    is_stated = any(each.statement.startswith("time") for each in found)
    if mapping is None and clock is None and len(times) == 1 and not is_stated:
        (at,) = times
        found[at] = replace(found[at], statement=f"time {units[at]}".strip(), is_asked=False)
    if mapping is None and stated_clock(table) is not None:
        of_clock = [at for at, label in enumerate(table.labels) if label in STATED or units[at] in SEQUENCE]
        for at in of_clock:
            found[at] = replace(found[at], statement=LEFT_OUT, is_asked=False)
    has_times = is_stated or clock is not None or len(times) == 1 or stated_clock(table) is not None
    return ExportColumns(columns=tuple(found), line=table.line, has_times=has_times)


def export_with_times(path: Path) -> ExportColumns | None:
    """Columns of a file that holds a recording with the times of its rows; None for a table of runs or another file."""
    try:
        found = export_columns(path) if file_kind(path) == "recording" else None
    except InvalidInput:
        return None
    return found if found is not None and found.has_times else None


def export_mapping(path: Path, found: ExportColumns, statements: Mapping[str, str]) -> RecordingMapping:
    """Mapping of the columns of an export as stated, and else as they are taken for; others are left out.

    Raises
    ------
    InvalidInput
        If a label is none of the file, a statement cannot be read, or no column is friction; the label of the first
        column of unknown meaning is the key.
    """
    labels = {column.label: column for column in found.columns if column.label}
    for label in statements:
        column_of_label(labels, label, path)
    meant = {label: statements.get(label, column.statement) for label, column in labels.items()}
    known = mapping_of_statements({label: text for label, text in meant.items() if text != LEFT_OUT})
    unknown = [label for label, column in labels.items() if column.is_asked and meant[label] == LEFT_OUT]
    if unknown and not any(name in known.channels for name in FRICTION):
        raise InvalidInput(f"{path}: no column is known to be friction", key=unknown[0])
    return known


def recording_text(recording: "xr.Dataset") -> str:
    """What a recording was read as, in a line: its samples, and the mean of each channel."""
    axis = next(iter(recording.sizes))
    values = recording[axis].to_numpy()
    span = format_si(float(values[-1] - values[0]), quantities()[str(axis)].unit)
    means = ", ".join(
        f"{name} {format_si(float(np.nanmean(variable.to_numpy())), str(variable.attrs['units']).removeprefix('1'))}"
        for name, variable in recording.data_vars.items()
    )
    return f"{values.size} samples in {span}; on average {means}"
