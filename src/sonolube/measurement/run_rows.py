"""Rows of a table of measured runs: of one that was read, and written as text with the usual headings and units."""

import csv
import io
import math
from collections.abc import Mapping, Sequence
from pathlib import Path

from sonolube.measurement.recordings.mapping import RecordingMapping
from sonolube.measurement.run_columns import RUN_COLUMNS, TEXT_NAMES
from sonolube.measurement.run_table import run_table
from sonolube.text.units import convert
from sonolube.vocabulary import quantities

RunRow = Mapping[str, float | str]
"""Quantities of one run in SI, and texts, by name."""


def rows_of_table(path: Path, *, mapping: RecordingMapping | None = None) -> list[dict[str, float | str]]:
    """Rows of a table of runs in a text file, without its empty cells.

    Parameters
    ----------
    path : Path
        As `run_table` reads it.
    mapping : RecordingMapping or None

    Returns
    -------
    list of dict

    Raises
    ------
    InvalidInput
        If the table cannot be read.
    """
    table = run_table(path, mapping=mapping)
    rows: list[dict[str, float | str]] = []
    for place in range(len(table.lines)):
        numbers = {name: float(values[place]) for name, values in table.columns.items() if math.isfinite(values[place])}
        rows.append(numbers | {name: cells[place] for name, cells in table.texts.items() if cells[place]})
    return rows


def run_rows_csv(rows: Sequence[RunRow]) -> str:
    """Table of runs as comma-separated values, in the order and the units of `RUN_COLUMNS`.

    Parameters
    ----------
    rows : sequence of mapping
        Names are those of `RUN_COLUMNS` or of the vocabulary.

    Returns
    -------
    str
        With a line of headings; cells are empty where a run has no such quantity.
    """
    usual = {column.name: column.unit for column in RUN_COLUMNS}
    named = dict.fromkeys(name for row in rows for name in row)
    names = [*(name for name in usual if name in named), *(name for name in named if name not in usual)]
    units = {name: usual.get(name, "" if name in TEXT_NAMES else quantities()[name].unit) for name in names}
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow([f"{name} [{units[name]}]" if units[name] else name for name in names])
    writer.writerows([[_cell(row.get(name), name, units[name]) for name in names] for row in rows])
    return out.getvalue()


def _cell(value: float | str | None, name: str, unit: str) -> str:
    """Cell of a quantity in the unit of its column, or of a text."""
    if value is None or isinstance(value, str):
        return value or ""
    si = quantities()[name].unit
    number = convert(value, from_unit=si, to_unit=unit) if unit and unit != si else value
    return f"{number:.10g}"
