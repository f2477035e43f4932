"""Measurement report: sheets of measured files as a self-contained page and as JSON."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from sonolube import __version__
from sonolube.report.measured.sheet import Sheet, Table, Value
from sonolube.report.page import Advance, drawn, embedded, html
from sonolube.report.pin_on_disc_sheet import PinOnDiscSheet, pin_on_disc_rows


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class MeasurementReport:
    """Sheets of measured files, with the settings that their numbers depend on.

    Parameters
    ----------
    title : str
        What was measured.
    settings : mapping of str to str
        Settings that the numbers depend on beside the files, as given.
    sheets : tuple of Sheet
        One a file that could be measured, in the order given, then those that compare them.
    refused : mapping of str to str
        Files that could not be measured, each with its reason.
    test : PinOnDiscSheet or None
        Conditions of the test as its operator states them.
    """

    title: str
    settings: Mapping[str, str]
    sheets: tuple[Sheet, ...]
    refused: Mapping[str, str]
    test: PinOnDiscSheet | None = None


def measurement_page(report: MeasurementReport, *, advance: Advance = lambda name, done, total: None) -> str:
    """HTML of a measurement report, self-contained, with all figures of its sheets.

    Parameters
    ----------
    report : MeasurementReport
    advance : callable
        Called after each figure with its title, the number done and their total.

    Returns
    -------
    str
    """
    total = sum(len(sheet.figures) for sheet in report.sheets)
    pictures: dict[tuple[int, str], str] = {}
    for place, sheet in enumerate(report.sheets):
        for figure in sheet.figures:
            pictures[place, figure.title] = embedded(drawn(figure.drawing, forms=("png",))["png"])
            advance(figure.title, len(pictures), total)
    return html(
        "measurement.html",
        version=__version__,
        report=report,
        pictures=pictures,
        test=None if report.test is None else pin_on_disc_rows(report.test, report.sheets),
    )


def measurement_object(report: MeasurementReport) -> dict[str, Any]:
    """Measurement report for JSON, all quantities in SI."""
    content: dict[str, Any] = {
        "measured": report.title,
        "version": __version__,
        "settings": dict(report.settings),
        "results": [_sheet_object(sheet) for sheet in report.sheets],
        "refused": [{"file": name, "reason": reason} for name, reason in report.refused.items()],
    }
    if report.test is not None:
        content["test_sheet"] = [
            {"part": part, "what": name, "value": value}
            for part, rows in pin_on_disc_rows(report.test, report.sheets).items()
            for name, value in rows
        ]
    return content


def measurement_caveats(report: MeasurementReport) -> list[str]:
    """Caveats of all sheets, each preceded by the title of its sheet where there are several."""
    several = len(report.sheets) > 1
    return [f"{sheet.title}: {caveat}" if several else caveat for sheet in report.sheets for caveat in sheet.caveats]


def _sheet_object(sheet: Sheet) -> dict[str, Any]:
    """Sheet for JSON, figures left out."""
    return {
        "title": sheet.title,
        "source": dict(sheet.source),
        "values": {value.name: _value_object(value) for value in sheet.values},
        "tables": {table.name: _table_object(table) for table in sheet.tables},
        "caveats": list(sheet.caveats),
        "not_found": list(sheet.not_found),
    }


def _value_object(value: Value) -> dict[str, Any]:
    """Value for JSON with its unit, uncertainty and interval."""
    content: dict[str, Any] = {"value": _finite(value.value), "unit": value.unit}
    if value.uncertainty is not None:
        content["uncertainty"] = _finite(value.uncertainty)
    if value.interval is not None:
        content["lower"], content["upper"] = map(_finite, value.interval)
    return content


def _table_object(table: Table) -> dict[str, Any]:
    """Table for JSON: units by column, and rows by column."""
    return {
        "units": {column.name: column.unit for column in table.columns},
        "rows": [
            {column.name: _finite(cell) for column, cell in zip(table.columns, row, strict=True)} for row in table.rows
        ],
    }


def _finite(cell: float | str | None) -> float | str | None:
    """Cell, or None for a number that JSON has no notation for."""
    return None if isinstance(cell, float) and cell - cell != 0 else cell
