"""Sheets of measured files: values, tables, figures and caveats with their origin; as text and as a dataset."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial, wraps
from math import nan
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ParamSpec

from sonolube.charts import Chart
from sonolube.errors import InvalidInput
from sonolube.report.blocks import Block, Rows, Table as TextTable
from sonolube.report.page import Drawing
from sonolube.text.intervals import interval_texts
from sonolube.text.units import format_like, format_quantity, format_si
from sonolube.vocabulary import quantities, unit_of

if TYPE_CHECKING:
    import xarray as xr

Cell = float | str | None
Drawn = ParamSpec("Drawn")

_EXACT = 15  # significant digits of a number whose unit is sought
_SIZE = ("field", "length", "lateral unit", "setting class")  # origins


@dataclass(frozen=True, slots=True)
class Value:
    """One measured number with its unit, uncertainty and interval.

    Parameters
    ----------
    name : str
        In JSON; a word of the vocabulary where it has one.
    label : str
        As printed.
    value : float
        In SI.
    unit : str
        Its SI unit; empty for a pure number.
    uncertainty : float or None
        Standard uncertainty, in the same unit.
    interval : tuple of two float, or None
        Ends of a confidence interval.
    """

    name: str
    label: str
    value: float
    unit: str
    uncertainty: float | None = None
    interval: tuple[float, float] | None = None

    @property
    def text(self) -> str:
        """Value with the precision that its uncertainty allows, and the uncertainty or interval."""
        if not math.isfinite(self.value):
            return "not known"
        rounded = self._rounded(self._digits)
        exact, _, unit = self._rounded(_EXACT).partition(" ")
        scale = self.value / float(exact) if float(exact) else 1.0  # SI value of the unit
        if self.uncertainty is not None:
            number = rounded.partition(" ")[0]
            rounded = f"{self.uncertainty / scale:.2g}"
            plain = f"{float(rounded):.0f}" if "e+" in rounded else rounded
            return f"{number} ± {plain} {unit}".rstrip()
        if self.interval is not None:
            number, lower, upper = interval_texts(*(each / scale for each in (self.value, *self.interval)))
            return f"{number} {unit}".rstrip() + f" ({lower} to {upper})"
        return rounded

    def _rounded(self, digits: int) -> str:
        """Value with its digits; in the unit usual for it where it is a quantity of the vocabulary."""
        if unit_of(self.name) == self.unit:
            return format_quantity(self.value, self.name, digits=digits)
        return format_si(self.value, self.unit, digits=digits)

    @property
    def _digits(self) -> int:
        """Significant digits that the uncertainty leaves a meaning, three to eight; four without uncertainty."""
        if not self.uncertainty or not self.value:
            return 4
        return min(8, max(3, math.floor(math.log10(abs(self.value))) - math.floor(math.log10(self.uncertainty)) + 2))


@dataclass(frozen=True, slots=True)
class Column:
    """Column of a table: its name in JSON, its heading, and its SI unit."""

    name: str
    label: str
    unit: str = ""

    def texts(self, cells: Sequence[Cell]) -> list[str]:
        """Cells as text with the unit and one prefix; empty for None and what is not finite."""
        numbers = [cell for cell in cells if isinstance(cell, float | int) and math.isfinite(cell)]
        formatted = iter(format_like(numbers, self.unit, digits=4))
        return [
            cell if isinstance(cell, str) else "" if cell is None or not math.isfinite(cell) else next(formatted)
            for cell in cells
        ]


@dataclass(frozen=True, slots=True)
class Table:
    """Table of a sheet; cells are numbers in SI, text, or None."""

    name: str
    title: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[Cell, ...], ...]

    def texts(self) -> tuple[list[str], list[list[str]]]:
        """Heads and rows as text, the quantities of a column with one prefix, without columns that are empty."""
        columns = [column.texts([row[place] for row in self.rows]) for place, column in enumerate(self.columns)]
        kept = [(column.label, cells) for column, cells in zip(self.columns, columns, strict=True) if any(cells)]
        return [label for label, _ in kept], [list(row) for row in zip(*(cells for _, cells in kept), strict=True)]


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Figure:
    """Figure of a sheet; no two of a sheet have the same title."""

    title: str
    drawing: Drawing


def captioned(title: str, caption: str) -> Callable[[Callable[Drawn, Chart]], Callable[Drawn, Figure]]:
    """Decorator of a function that returns a chart: it then returns a figure with this title and caption."""

    def decorated(chart: Callable[Drawn, Chart]) -> Callable[Drawn, Figure]:
        @wraps(chart)
        def figure(*args: Drawn.args, **kwargs: Drawn.kwargs) -> Figure:
            return Figure(
                title=title, drawing=Drawing(chart=partial(chart, *args, **kwargs), caption=caption, forms=())
            )

        return figure

    return decorated


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Sheet:
    """Values, tables, figures and caveats of one measured file, or of one analysis of it.

    Parameters
    ----------
    title : str
        The file's name, or what was compared; empty for one analysis.
    source : mapping of str to str
        Where it came from: file, format, digest and what the instrument says of itself.
    values : tuple of Value
        The numbers, those that matter most first.
    tables : tuple of Table
        What comes in rows.
    figures : tuple of Figure
        What is drawn.
    caveats : tuple of str
        What speaks against the numbers, one line each.
    not_found : tuple of str
        What was looked for and not found, with the reason.
    rig_entries : mapping of str to str
        What a rig file takes of the values, as text by dotted key.
    """

    title: str = ""
    source: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    values: tuple[Value, ...] = ()
    tables: tuple[Table, ...] = ()
    figures: tuple[Figure, ...] = ()
    caveats: tuple[str, ...] = ()
    not_found: tuple[str, ...] = ()
    rig_entries: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))

    def size(self) -> dict[str, str]:
        """Origins that text gives as well as the page: those that say how large a scan is."""
        return {name: text for name, text in self.source.items() if name in _SIZE}


def joined(parts: Sequence[Sheet], *, title: str, source: Mapping[str, str]) -> Sheet:
    """Sheet of a file from those of several analyses, in their order; origins without text are left out."""
    return Sheet(
        title=title,
        source={key: text for key, text in source.items() if text},
        values=tuple(value for part in parts for value in part.values),
        tables=tuple(table for part in parts for table in part.tables),
        figures=tuple(figure for part in parts for figure in part.figures),
        caveats=tuple(caveat for part in parts for caveat in part.caveats),
        not_found=tuple(reason for part in parts for reason in part.not_found),
        rig_entries={key: text for part in parts for key, text in part.rig_entries.items()},
    )


def attempted(analysis: Callable[[], Sheet], *, what: str) -> Sheet:
    """Sheet by an analysis, or the reason for which it is not possible on this file."""
    try:
        return analysis()
    except InvalidInput as refusal:
        return Sheet(not_found=(f"{what}: {refusal}",))


def quantity_value(
    name: str,
    value: float,
    *,
    label: str = "",
    uncertainty: float | None = None,
    interval: tuple[float, float] | None = None,
) -> Value:
    """Value of a quantity of the vocabulary, which gives its unit and its default label."""
    word = quantities()[name]
    return Value(name, label or word.meaning, value, word.unit, uncertainty=uncertainty, interval=interval)


def field_value(record: object, name: str, label: str = "", unit: str | None = None) -> Value:
    """Value of a field of a record, with the uncertainty and the interval that the record has by the field's name."""
    word = quantities().get(name)
    return Value(
        name,
        label or (word.meaning if word else ""),
        getattr(record, name),
        word.unit if word and unit is None else unit or "",
        uncertainty=getattr(record, f"{name}_uncertainty", None),
        interval=getattr(record, f"{name}_interval", None),
    )


def rig_entries(table: str, values: Mapping[str, float]) -> dict[str, str]:
    """Entries of a table of a rig file by dotted key, each with its unit, from quantities of the vocabulary."""
    return {f"{table}.{name}": format_quantity(value, name, digits=4) for name, value in values.items()}


def quantity_columns(labels: Mapping[str, str]) -> tuple[Column, ...]:
    """Columns of quantities of the vocabulary, by name with their headings."""
    return tuple(Column(name, label, quantities()[name].unit) for name, label in labels.items())


def sheet_blocks(sheet: Sheet) -> list[Block]:
    """Title, size, values and tables of a sheet, and what was not found; caveats apart."""
    blocks: list[Block] = [sheet.title, *(f"  {name}: {text}" for name, text in sheet.size().items())]
    blocks.append(Rows([(value.label, value.text) for value in sheet.values]))
    for table in sheet.tables:
        blocks += ["", f"  {table.title}", TextTable(*table.texts())]
    return [*blocks, *(f"  not found: {reason}" for reason in sheet.not_found)]


def sheets_dataset(sheets: Sequence[Sheet]) -> "xr.Dataset":
    """Labelled dataset of sheets in SI.

    Values by their names over the dimension `sheet`, scalars where there is one sheet; standard uncertainties and
    intervals as `NAME_uncertainty`, `NAME_lower` and `NAME_upper`; NaN for what a sheet does not have. Columns of
    tables over a dimension of the table's name, with the titles of their sheets as `TABLE_sheet`; origins, such as
    digests, as coordinates `source_NAME`.
    """
    import xarray as xr

    variables: dict[str, Any] = {}
    values = [(place, each) for place, sheet in enumerate(sheets) for each in sheet.values]
    for place, value in values:
        for name, (number, label) in _numbers(value).items():
            about = {"units": value.unit or "1", "long_name": label}
            variables.setdefault(name, ("sheet", [nan] * len(sheets), about))[1][place] = number
    origins = dict.fromkeys(name for sheet in sheets for name in sheet.source)
    coordinates = {
        f"source_{name.replace(' ', '_')}": ("sheet", [sheet.source.get(name, "") for sheet in sheets])
        for name in origins
    }
    data = xr.Dataset(variables, coords={"sheet": [sheet.title for sheet in sheets], **coordinates})
    missing = [f"{sheet.title}: {reason}" for sheet in sheets for reason in sheet.not_found]
    data = data.assign(_columns(sheets)).assign_attrs(not_found="\n".join(missing))
    return data.isel(sheet=0) if len(sheets) == 1 else data


def _numbers(value: Value) -> dict[str, tuple[float, str]]:
    """Value, standard uncertainty and ends of the interval by name, each with its label."""
    numbers = {value.name: (value.value, value.label)}
    if value.uncertainty is not None:
        numbers[f"{value.name}_uncertainty"] = value.uncertainty, f"Standard uncertainty: {value.label}"
    if value.interval is not None:
        lower, upper = value.interval
        numbers[f"{value.name}_lower"] = lower, f"Lower end of the interval: {value.label}"
        numbers[f"{value.name}_upper"] = upper, f"Upper end of the interval: {value.label}"
    return numbers


def _columns(sheets: Sequence[Sheet]) -> dict[str, Any]:
    """Columns of the tables of all sheets, those of one name one below the other, with the titles of their sheets."""
    columns: dict[str, dict[str, Column]] = {}
    rows: dict[str, list[dict[str, Cell]]] = {}
    for sheet in sheets:
        for table in sheet.tables:
            columns.setdefault(table.name, {"sheet": Column("sheet", "Sheet")}).update(
                {column.name: column for column in table.columns}
            )
            for row in table.rows:
                named: dict[str, Cell] = {"sheet": sheet.title}
                named.update(zip((column.name for column in table.columns), row, strict=True))
                rows.setdefault(table.name, []).append(named)
    return {
        f"{table}_{name}": (
            table,
            _cells([row.get(name) for row in rows.get(table, [])]),
            {"units": column.unit or "1", "long_name": column.label},
        )
        for table, known in columns.items()
        for name, column in known.items()
    }


def _cells(column: Sequence[Cell]) -> list[float] | list[str]:
    """Cells of a column: texts, empty where there is none, or numbers, NaN where there is none."""
    if any(isinstance(cell, str) for cell in column):
        return ["" if cell is None else str(cell) for cell in column]
    return [nan if cell is None else float(cell) for cell in column]
