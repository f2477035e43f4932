"""Measurement report as a page and as JSON, with the conditions of a pin-on-disc test in the order of ASTM G99."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sonolube import __version__
from sonolube.errors import InvalidInput, suggestion
from sonolube.report.measured.sheet import Sheet, Table, Value
from sonolube.report.page import Advance, drawn, embedded, html
from sonolube.text.toml_text import read_toml
from sonolube.text.units import format_si, to_si
from sonolube.vocabulary import quantities

_NOT_STATED = "not stated"
_PARAMETERS = {
    "normal_load": "Load",
    "sliding_speed": "Sliding speed",
    "sliding_distance": "Sliding distance",
    "temperature": "Temperature",
    "atmosphere": "Atmosphere",
    "lubricant": "Lubricant",
    "track_diameter": "Diameter of the wear track",
    "vibration": "Vibration",
}
_SPECIMEN = {
    "material": "material",
    "form": "form and dimensions",
    "processing": "processing and heat treatment",
    "hardness": "hardness",
    "roughness": "roughness before the test",
    "cleaning": "cleaning",
}
_APPARATUS = {"machine": "Machine", "operator": "Operator", "date": "Date", "procedure": "Departures from procedure"}
_SECTIONS = {"parameters": _PARAMETERS, "pin": _SPECIMEN, "disc": _SPECIMEN, "test": _APPARATUS}
_QUANTITIES = {"normal_load", "sliding_speed", "sliding_distance"}
_WEAR = ("wear_volume", "pile_up_volume", "groove_width", "groove_depth", "wear_rate", "specific_wear_rate")
_FRICTION = ("friction_force", "friction_coefficient", "steady_friction_force", "steady_distance", "friction_reduction")


@dataclass(frozen=True, kw_only=True, slots=True)
class PinOnDiscSheet:
    """Conditions of a pin-on-disc test as its operator states them.

    Parameters
    ----------
    entries : mapping of str to mapping of str to str
        By section (parameters, pin, disc, test) and key, as written.
    """

    entries: Mapping[str, Mapping[str, str]]

    def quantity(self, name: str) -> float | None:
        """Value of a parameter of the test in SI, such as normal_load; None where it is not stated."""
        text = self.entries.get("parameters", {}).get(name)
        return None if text is None else to_si(text, unit=quantities()[name].unit, name=f"parameters.{name}")


def read_pin_on_disc_sheet(path: Path) -> PinOnDiscSheet:
    """Conditions of a test from a TOML file.

    Parameters
    ----------
    path : Path
        With the tables `parameters`, `pin`, `disc` and `test`, whose keys are all optional.

    Returns
    -------
    PinOnDiscSheet

    Raises
    ------
    InvalidInput
        Naming the file and the key, if the file cannot be read or a key or value is not valid.
    """
    try:
        content = read_toml(path, kind="a sheet of conditions")
    except InvalidInput as failure:
        raise InvalidInput(f"{path}: {failure}") from None
    for section, entries in content.items():
        _require_known(path, section, _SECTIONS, "")
        if not isinstance(entries, dict):
            raise InvalidInput(f"{path}: {section} must be a table, got {entries!r}")
        for key in entries:
            _require_known(path, key, _SECTIONS[section], f"{section}.")
    sheet = PinOnDiscSheet(
        entries={section: {key: str(value) for key, value in entries.items()} for section, entries in content.items()}
    )
    try:
        for name in _QUANTITIES:
            sheet.quantity(name)
    except InvalidInput as failure:
        raise InvalidInput(f"{path}: {failure}") from None
    return sheet


def pin_on_disc_rows(test: PinOnDiscSheet, sheets: Sequence[Sheet]) -> dict[str, list[tuple[str, str]]]:
    """Conditions, wear and friction of a test in the order of ASTM G99.

    Parameters
    ----------
    test : PinOnDiscSheet
    sheets : sequence of Sheet
        Measurements, for the parts on wear and friction.

    Returns
    -------
    dict of str to list of (str, str)
        Names and values of test parameters, specimens, apparatus, wear and friction; "not stated" where absent.
    """

    def stated(section: str, prefix: str = "") -> list[tuple[str, str]]:
        """Entries of a section with their labels."""
        entries = test.entries.get(section, {})
        return [(f"{prefix}{label}", entries.get(key, _NOT_STATED)) for key, label in _SECTIONS[section].items()]

    return {
        "Test parameters": stated("parameters"),
        "Materials and specimens": [*stated("pin", "Pin, "), *stated("disc", "Disc, ")],
        "Apparatus and procedure": stated("test"),
        "Wear": _measured(sheets, _WEAR) + _specific_wear(test, sheets),
        "Friction": _measured(sheets, _FRICTION) + _friction_coefficients(test, sheets),
    }


def pin_on_disc_checklist(known: Mapping[str, Mapping[str, str]]) -> list[tuple[str, str, str]]:
    """Items that the report of a pin-on-disc test states, in the order of ASTM G99, with what is known before it.

    Part of the report, item, and its value; empty where it is still to be stated.

    The public scope of ASTM G99-17 (1.3) asks to state all test parameters, and to say that its procedure was followed
    with parameters of one's own where they are not those of its interlaboratory study [1]_. The items of bodies,
    apparatus, wear and friction are those of `PinOnDiscSheet` and of D 2.3.2 [2]_; the clause on the report itself is
    not public.

    References
    ----------
    .. [1] ASTM G99-17, scope as published at https://www.astm.org/g0099-17.html
    .. [2] D 2.3.2, steps (a) to (i), and appendix A
    """
    parts = {"parameters": "Test parameters", "pin": "Pin", "disc": "Disc", "test": "Apparatus and procedure"}
    stated = [
        (part, label, known.get(section, {}).get(key, ""))
        for section, part in parts.items()
        for key, label in _SECTIONS[section].items()
    ]
    names = (("Wear", _WEAR), ("Friction", _FRICTION))
    results = [
        (part, quantities()[name].meaning, "") for part, group in names for name in group if name in quantities()
    ]
    return [*stated, *results, ("Statement", "Procedure of ASTM G99 followed, with the parameters above", "")]


def _measured(sheets: Sequence[Sheet], names: Sequence[str]) -> list[tuple[str, str]]:
    """Values of these names from all sheets."""
    return [
        (f"{value.label}, {sheet.title}", value.text)
        for sheet in sheets
        for value in sheet.values
        if value.name in names
    ] or [("Measured here", "no")]


def _friction_coefficients(test: PinOnDiscSheet, sheets: Sequence[Sheet]) -> list[tuple[str, str]]:
    """Measured friction forces over the stated load."""
    load = test.quantity("normal_load")
    if not load:
        return []
    return [
        (
            f"Coefficient of friction at {format_si(load, 'N')}, {sheet.title}",
            _divided(value, load, "friction_coefficient").text,
        )
        for sheet in sheets
        for value in sheet.values
        if value.name in ("friction_force", "steady_friction_force")
    ]


def _specific_wear(test: PinOnDiscSheet, sheets: Sequence[Sheet]) -> list[tuple[str, str]]:
    """Measured wear volumes over the stated load and sliding distance."""
    load, distance = test.quantity("normal_load"), test.quantity("sliding_distance")
    if not load or not distance:
        return []
    return [
        (
            f"Wear volume per distance and load, {sheet.title}",
            _divided(value, load * distance, "specific_wear_rate").text,
        )
        for sheet in sheets
        for value in sheet.values
        if value.name == "ring_volume"
    ]


def _divided(value: Value, divisor: float, name: str) -> Value:
    """Value and uncertainty over an exact divisor, as a quantity of the vocabulary."""
    error = None if value.uncertainty is None else value.uncertainty / divisor
    return Value(name, value.label, value.value / divisor, quantities()[name].unit, uncertainty=error)


def _require_known(path: Path, key: str, expected: Mapping[str, object], prefix: str) -> None:
    """Raise for a key that the file format does not have, with the nearest one that it has."""
    if key not in expected:
        advice = suggestion(key, expected) or f"known: {', '.join(expected)}"
        raise InvalidInput(f"{path}: {prefix}{key}: unknown key; {advice}")


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
        **({"rig_entries": dict(sheet.rig_entries)} if sheet.rig_entries else {}),
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
