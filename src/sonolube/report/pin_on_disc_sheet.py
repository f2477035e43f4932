"""The test sheet: how a pin-on-disc test was made and what came of it, in the order in which ASTM G99 asks for it."""

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from sonolube.errors import InvalidInput, suggestion
from sonolube.report.measured.sheet import Sheet, Value
from sonolube.units import format_si, to_si
from sonolube.vocabulary import quantities

_ABSENT = "not stated"
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
_APPARATUS = {
    "machine": "Machine",
    "operator": "Operator",
    "date": "Date",
    "procedure": "Departures from procedure",
}
_SECTIONS = {"parameters": _PARAMETERS, "pin": _SPECIMEN, "disc": _SPECIMEN, "test": _APPARATUS}
_QUANTITIES = {"normal_load", "sliding_speed", "sliding_distance"}
_WEAR = ("wear_volume", "pile_up_volume", "groove_width", "groove_depth", "wear_rate", "specific_wear_rate")
_FRICTION = ("friction_force", "friction_coefficient", "steady_friction_force", "steady_distance", "friction_reduction")


@dataclass(frozen=True, kw_only=True, slots=True)
class TestSheet:
    """How a test was made.

    Parameters
    ----------
    entries : mapping of str to mapping of str to str
        By section (parameters, pin, disc, test) and key, as written.
    """

    __test__ = False  # a record of tests, not a test

    entries: Mapping[str, Mapping[str, str]]

    def quantity(self, name: str) -> float | None:
        """Return a parameter of the test in SI, such as normal_load; None where it is not stated."""
        text = self.entries.get("parameters", {}).get(name)
        return None if text is None else to_si(text, unit=quantities()[name].unit, name=f"parameters.{name}")


def read_test_sheet(path: Path) -> TestSheet:
    """Read how a test was made from a TOML file.

    Parameters
    ----------
    path : Path
        With the tables `parameters`, `pin`, `disc` and `test`; every key may be left out.

    Returns
    -------
    TestSheet

    Raises
    ------
    InvalidInput
        Naming the file and the key, if it cannot be read or a key or value is not understood.
    """
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except OSError as failure:
        raise InvalidInput(f"{path}: cannot be read: {failure.strerror}") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as failure:
        raise InvalidInput(f"{path}: {failure}") from None
    for section, entries in content.items():
        _refuse_unknown(path, section, _SECTIONS, "")
        if not isinstance(entries, dict):
            raise InvalidInput(f"{path}: {section} must be a table, got {entries!r}")
        for key in entries:
            _refuse_unknown(path, key, _SECTIONS[section], f"{section}.")
    sheet = TestSheet(
        entries={section: {key: str(value) for key, value in entries.items()} for section, entries in content.items()}
    )
    try:
        for name in _QUANTITIES:
            sheet.quantity(name)
    except InvalidInput as failure:
        raise InvalidInput(f"{path}: {failure}") from None
    return sheet


def test_sheet_table(test: TestSheet, sheets: Sequence[Sheet]) -> dict[str, list[tuple[str, str]]]:
    """Return the rows of the test sheet by part.

    Parameters
    ----------
    test : TestSheet
    sheets : sequence of Sheet
        What was measured, for the parts on wear and friction.

    Returns
    -------
    dict of str to list of (what, value)
        Test parameters, specimens, apparatus, wear and friction; "not stated" where nobody said.
    """

    def stated(section: str, prefix: str = "") -> list[tuple[str, str]]:
        entries = test.entries.get(section, {})
        return [(f"{prefix}{label}", entries.get(key, _ABSENT)) for key, label in _SECTIONS[section].items()]

    return {
        "Test parameters": stated("parameters"),
        "Materials and specimens": [*stated("pin", "Pin, "), *stated("disc", "Disc, ")],
        "Apparatus and procedure": stated("test"),
        "Wear": _measured(sheets, _WEAR) + _wear_rates(test, sheets),
        "Friction": _measured(sheets, _FRICTION) + _coefficients(test, sheets),
    }


test_sheet_table.__test__ = False  # type: ignore[attr-defined]


def _measured(sheets: Sequence[Sheet], names: Sequence[str]) -> list[tuple[str, str]]:
    return [
        (f"{value.label}, {sheet.title}", value.text)
        for sheet in sheets
        for value in sheet.values
        if value.name in names
    ] or [("Measured here", "no")]


def _coefficients(test: TestSheet, sheets: Sequence[Sheet]) -> list[tuple[str, str]]:
    load = test.quantity("normal_load")
    if not load:
        return []
    return [
        (f"Coefficient of friction at {format_si(load, 'N')}, {sheet.title}", _over(value, load, "").text)
        for sheet in sheets
        for value in sheet.values
        if value.name in ("friction_force", "steady_friction_force")
    ]


def _wear_rates(test: TestSheet, sheets: Sequence[Sheet]) -> list[tuple[str, str]]:
    load, distance = test.quantity("normal_load"), test.quantity("sliding_distance")
    if not load or not distance:
        return []
    return [
        (f"Wear volume per distance and load, {sheet.title}", _over(value, load * distance, "m2/N").text)
        for sheet in sheets
        for value in sheet.values
        if value.name == "ring_volume"
    ]


def _over(value: Value, divisor: float, unit: str) -> Value:
    error = None if value.uncertainty is None else value.uncertainty / divisor
    return Value(name=value.name, label=value.label, value=value.value / divisor, unit=unit, uncertainty=error)


def _refuse_unknown(path: Path, key: str, expected: Mapping[str, object], prefix: str) -> None:
    if key not in expected:
        advice = suggestion(key, expected) or f"known: {', '.join(expected)}"
        raise InvalidInput(f"{path}: {prefix}{key}: unknown key; {advice}")
