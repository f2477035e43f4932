"""Table of own runs as one sees it: rows of texts under the usual headings, each with its source and a switch.

Rows are added, edited, switched off and removed; what results is a table that predictions and fits read.
"""

import csv
import io
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

from sonolube.errors import InvalidInput
from sonolube.measurement.recordings.mapping import RecordingMapping
from sonolube.measurement.run_columns import DIRECTION_COLUMN, RUN_COLUMNS, SOURCE, SWITCH, SWITCHED_OFF, TEXT_NAMES
from sonolube.measurement.run_numbers import OF_A_DIGIT
from sonolube.measurement.run_table import RunTable, run_table
from sonolube.text.units import convert, to_si
from sonolube.vocabulary import quantities

RunRow = Mapping[str, float | str]
"""Quantities of one run in SI, and texts, by name."""

_UNITS: Final = {column.name: column.unit for column in RUN_COLUMNS}
_ORDER: Final = {column.name: place for place, column in enumerate(RUN_COLUMNS)}
_MAX_TEXT: Final = 500  # characters of a cell
_SAME: Final = 1e-9  # of two numbers


@dataclass(frozen=True, kw_only=True, slots=True)
class RunSheet:
    """Table of own runs.

    Parameters
    ----------
    names : tuple of str
        Of the columns: quantities of the vocabulary, or texts.
    rows : tuple of tuple of str
        Cells of each run, numbers in the unit of their heading; empty where a run has no such quantity.
    """

    names: tuple[str, ...] = ()
    rows: tuple[tuple[str, ...], ...] = ()

    @property
    def headings(self) -> tuple[str, ...]:
        """Names with the units of the cells in brackets."""
        return tuple(f"{name} [{unit}]" if (unit := usual_unit(name)) else name for name in self.names)

    def cell(self, row: int, name: str) -> str:
        """Text of a run; empty where there is none."""
        return self.rows[row][self.names.index(name)] if name in self.names else ""

    def is_used(self, row: int) -> bool:
        """Whether a run is not switched off."""
        return self.cell(row, SWITCH).casefold() not in SWITCHED_OFF

    def csv(self) -> str:
        """Table as comma-separated values, as tables of runs are read; empty without a run."""
        if not self.rows:
            return ""
        out = io.StringIO()
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(self.headings)
        writer.writerows(self.rows)
        return out.getvalue()


def usual_unit(name: str) -> str:
    """Unit in which a column is usually written; empty for texts and pure numbers."""
    return "" if name in TEXT_NAMES else _UNITS.get(name, quantities()[name].unit)


def read_sheet(path: Path, *, mapping: RecordingMapping | None = None, source: str = "") -> RunSheet:
    """Table of own runs of a file.

    Parameters
    ----------
    path : Path
        Of a table of runs.
    mapping : RecordingMapping or None
        Meaning of columns whose headings do not tell it.
    source : str
        Source of the rows that state none.

    Returns
    -------
    RunSheet
        Numbers in usual units, with the digits that are written in the file.

    Raises
    ------
    InvalidInput
        If the table cannot be read.
    """
    table = run_table(path, mapping=mapping)
    columns = {name: _texts(table, name) for name in table.columns}
    words = table.texts.get(f"{DIRECTION_COLUMN}_word", ())
    if words:
        own = columns.get(DIRECTION_COLUMN, [""] * len(words))
        columns[DIRECTION_COLUMN] = [word or cell for word, cell in zip(words, own, strict=True)]
    columns |= {name: list(cells) for name, cells in table.texts.items() if name in TEXT_NAMES}
    if source:
        columns[SOURCE] = [cell or source for cell in columns.get(SOURCE, [""] * len(table.lines))]
    return _of_columns(columns)


def sheet_of_rows(rows: Sequence[RunRow], *, source: str = "") -> RunSheet:
    """Table of own runs of numbers in SI and texts by name, with the source of those that state none."""
    stated = [{SOURCE: source, **row} if source else row for row in rows]
    names = dict.fromkeys(name for row in stated for name in row)
    return _of_columns({name: [_text(row.get(name), name) for row in stated] for name in names})


def joined(sheet: RunSheet, more: RunSheet) -> tuple[RunSheet, int]:
    """Table with the rows of another that it lacks, and their number; equal rows of one table are repeats and stay."""
    known = [dict(zip(sheet.names, row, strict=True)) for row in sheet.rows]
    new = [dict(zip(more.names, row, strict=True)) for row in more.rows]
    added = [row for row in new if not any(_are_equal(row, each) for each in known)]
    return _of_rows([*known, *added]), len(added)


def with_cell(sheet: RunSheet, *, row: int, name: str, text: str) -> RunSheet:
    """Table with another text in a cell.

    Parameters
    ----------
    sheet : RunSheet
    row : int
        From 0; one behind the last row is added.
    name : str
        Of a column, or of one that is added.
    text : str
        Number in the unit of the heading, or with another unit of its kind; empty for none.

    Returns
    -------
    RunSheet

    Raises
    ------
    InvalidInput
        If there is no such row, no such quantity, or the text is no number with a unit of its kind.
    """
    if row != len(sheet.rows):
        _require_row(sheet, row)
    text = " ".join(text.split())
    if len(text) > _MAX_TEXT:
        raise InvalidInput(f"{name}: a cell has at most {_MAX_TEXT} characters", key=name)
    if name not in TEXT_NAMES and name not in quantities():
        raise InvalidInput(f"{name[:60]!r} is no column of a table of runs", key=name)
    rows = [*(dict(zip(sheet.names, each, strict=True)) for each in sheet.rows), {}]
    rows[row][name] = text if name in TEXT_NAMES or not text else _typed(text, name)
    return _of_rows([each for each in rows if any(each.values())])


def with_switch(sheet: RunSheet, *, row: int, is_used: bool) -> RunSheet:
    """Table in which a run is used, or left out of predictions and fits without being removed."""
    return with_cell(sheet, row=row, name=SWITCH, text="" if is_used else SWITCHED_OFF[0])


def without_row(sheet: RunSheet, *, row: int) -> RunSheet:
    """Table without a run."""
    _require_row(sheet, row)
    return _of_rows([dict(zip(sheet.names, each, strict=True)) for at, each in enumerate(sheet.rows) if at != row])


def _require_row(sheet: RunSheet, row: int) -> None:
    """Refuse a row that is none."""
    if not 0 <= row < len(sheet.rows):
        raise InvalidInput(
            f"row must be one of the {len(sheet.rows)} of the table, counted from 0, got {row}", key="row"
        )


def _texts(table: RunTable, name: str) -> list[str]:
    """Cells of a quantity in its usual unit, with the digits that the file has."""
    digits = table.digits.get(name)
    worth = [0.0] * len(table.lines) if digits is None else [float(each) / OF_A_DIGIT for each in digits]
    return [_text(float(value), name, digit=digit) for value, digit in zip(table.columns[name], worth, strict=True)]


def _text(value: float | str | None, name: str, *, digit: float = 0.0) -> str:
    """Cell of a value in SI in its usual unit; to the worth of its last digit in SI, where that is known."""
    if value is None or isinstance(value, str):
        return value or ""
    if not math.isfinite(value):
        return ""
    unit, si = usual_unit(name), quantities()[name].unit
    number, one = (convert(each, from_unit=si, to_unit=unit) if unit != si else each for each in (value, value + digit))
    step = abs(one - number)
    if not (math.isfinite(step) and step > 0):
        return f"{number:.10g}"
    decimals = -round(math.log10(step))
    return f"{number:.{decimals}f}" if 0 <= decimals <= 15 else f"{number:.10g}"


def _typed(text: str, name: str) -> str:
    """Number in its usual unit of a text as it is typed, without a unit or with one."""
    unit = usual_unit(name)
    try:
        float(text)
    except ValueError:
        return _text(to_si(text, unit=quantities()[name].unit, name=name.replace("_", " ")), name)
    to_si(f"{text} {unit}", unit=quantities()[name].unit, name=name.replace("_", " "))  # finite
    return text


def _are_equal(row: Mapping[str, str], other: Mapping[str, str]) -> bool:
    """Whether two rows have one source and the same texts and numbers, whatever switches them."""
    names = {*row, *other} - {SWITCH}
    return all(_is_same(row.get(name, ""), other.get(name, "")) for name in names)


def _is_same(text: str, other: str) -> bool:
    """Whether two cells are the same text or number."""
    if text == other:
        return True
    try:
        return math.isclose(float(text), float(other), rel_tol=_SAME)
    except ValueError:
        return False


def _of_columns(columns: Mapping[str, Sequence[str]]) -> RunSheet:
    """Table of columns by name, those without any text left out."""
    count = max(map(len, columns.values()), default=0)
    return _of_rows([{name: cells[row] for name, cells in columns.items()} for row in range(count)])


def _of_rows(rows: Sequence[Mapping[str, str]]) -> RunSheet:
    """Table of rows of texts by name, in the usual order of the columns."""
    filled = dict.fromkeys(name for row in rows for name, cell in row.items() if cell)
    names = tuple(sorted(filled, key=lambda name: _ORDER.get(name, len(_ORDER))))
    return replace(RunSheet(), names=names, rows=tuple(tuple(row.get(name, "") for name in names) for row in rows))
