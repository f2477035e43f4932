"""Sheets of measured files as one labelled dataset."""

from collections.abc import Sequence
from math import nan
from typing import TYPE_CHECKING, Any

from sonolube.report.measured.sheet import Cell, Column, Sheet, Value

if TYPE_CHECKING:
    import xarray as xr


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
