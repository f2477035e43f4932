"""The measurement report: sheets of measured files as a self-contained page, as JSON and as lines."""

import base64
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sonolube import __version__
from sonolube.figure import publication_style, render_figure
from sonolube.files import write_atomically
from sonolube.report.measured.sheet import Sheet, SheetFigure, SheetTable, Value
from sonolube.report.pin_on_disc_sheet import TestSheet, test_sheet_table

Advance = Callable[[str, int, int], None]


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class MeasurementReport:
    """What files were measured to say.

    Parameters
    ----------
    title : str
        What was measured.
    settings : mapping of str to str
        What the numbers depend on beside the files, as it was given.
    sheets : tuple of Sheet
        One a file that could be measured, in the order given; then what compares them.
    refused : mapping of str to str
        Files that could not be measured, each with its reason.
    test : TestSheet or None
        How the test was made, as its operator says.
    """

    title: str
    settings: Mapping[str, str]
    sheets: tuple[Sheet, ...]
    refused: Mapping[str, str]
    test: TestSheet | None = None


def write_measurement_report(
    report: MeasurementReport, *, path: Path, advance: Advance = lambda what, done, total: None
) -> Path:
    """Write the report as one HTML file that needs no other.

    Parameters
    ----------
    report : MeasurementReport
    path : Path
        Where to; the folder is made where it is missing.
    advance : callable
        Told after each figure what was done, how many are done, and of how many.

    Returns
    -------
    Path
        `path`.

    Raises
    ------
    InvalidInput
        If the place cannot be written to.
    """
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("sonolube.report"), autoescape=True, undefined=StrictUndefined, trim_blocks=True
    )
    total = sum(len(sheet.figures) for sheet in report.sheets)
    pictures: dict[tuple[int, str], str] = {}
    for place, sheet in enumerate(report.sheets):
        for figure in sheet.figures:
            pictures[place, figure.name] = base64.b64encode(_png(figure)).decode()
            advance(figure.title, len(pictures), total)
    page = environment.get_template("measurement.html").render(
        version=__version__,
        report=report,
        pictures=pictures,
        test=None if report.test is None else test_sheet_table(report.test, report.sheets),
    )
    return write_atomically(path, page)


def measurement_object(report: MeasurementReport) -> dict[str, Any]:
    """Return the report as one JSON object, all quantities in SI."""
    told: dict[str, Any] = {
        "measured": report.title,
        "version": __version__,
        "settings": dict(report.settings),
        "results": [_sheet_object(sheet) for sheet in report.sheets],
        "refused": [{"file": name, "reason": reason} for name, reason in report.refused.items()],
    }
    if report.test is not None:
        told["test_sheet"] = [
            {"part": part, "what": what, "value": value}
            for part, rows in test_sheet_table(report.test, report.sheets).items()
            for what, value in rows
        ]
    return told


def measurement_lines(report: MeasurementReport) -> list[str]:
    """Return what a person reads in the terminal."""
    return [line for sheet in report.sheets for line in _sheet_lines(sheet)]


def _png(figure: SheetFigure) -> bytes:
    import matplotlib.pyplot as plt

    with publication_style():
        drawn = figure.draw()
        try:
            return render_figure(drawn, "png")
        finally:
            plt.close(drawn)


def _sheet_object(sheet: Sheet) -> dict[str, Any]:
    return {
        "title": sheet.title,
        "source": dict(sheet.source),
        "values": {value.name: _value_object(value) for value in sheet.values},
        "tables": {table.name: _table_object(table) for table in sheet.tables},
        "caveats": list(sheet.caveats),
        "not_found": list(sheet.not_found),
    }


def _value_object(value: Value) -> dict[str, Any]:
    told: dict[str, Any] = {"value": _finite(value.value), "unit": value.unit}
    if value.uncertainty is not None:
        told["uncertainty"] = _finite(value.uncertainty)
    if value.interval is not None:
        told["lower"], told["upper"] = map(_finite, value.interval)
    return told


def _table_object(table: SheetTable) -> dict[str, Any]:
    return {
        "units": {column.name: column.unit for column in table.columns},
        "rows": [
            {column.name: _finite(cell) for column, cell in zip(table.columns, row, strict=True)} for row in table.rows
        ],
    }


def _finite(cell: float | str | None) -> float | str | None:
    """Return None for what JSON cannot say."""
    return None if isinstance(cell, float) and cell - cell != 0 else cell


def _sheet_lines(sheet: Sheet) -> list[str]:
    width = max((len(value.label) for value in sheet.values), default=0)
    lines = [sheet.title, *(f"  {value.label:<{width}}  {value.text}" for value in sheet.values)]
    for table in sheet.tables:
        lines += ["", f"  {table.title}", *_table_lines(table)]
    lines += [f"  caveat: {caveat}" for caveat in sheet.caveats]
    return [*lines, *(f"  not found: {reason}" for reason in sheet.not_found)]


def _table_lines(table: SheetTable) -> list[str]:
    cells = [[column.label for column in table.columns]]
    cells += [[column.text(cell) for column, cell in zip(table.columns, row, strict=True)] for row in table.rows]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    return ["    " + "  ".join(f"{cell:>{width}}" for cell, width in zip(row, widths, strict=True)) for row in cells]
