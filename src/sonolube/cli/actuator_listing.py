"""What the command `actuators` says of the catalogue."""

from dataclasses import fields
from typing import Any

from sonolube.actuator import CatalogueActuator, catalogue_actuator, catalogue_names
from sonolube.units import format_si
from sonolube.vocabulary import quantities

_TOLD = ("stroke", "stroke_voltage", "blocked_force", "free_capacitance", "resonance_frequency")


def actuator_object(name: str | None) -> dict[str, Any]:
    """Return one actuator, or all by name, as they go into JSON."""
    if name is not None:
        return _object(catalogue_actuator(name))
    return {each: _object(catalogue_actuator(each)) for each in catalogue_names()}


def actuator_lines(name: str | None) -> list[str]:
    """Return one actuator with its source, or the list of all, as lines."""
    if name is None:
        rows = [["name", "stroke", "over", "blocked", "capacitance", "resonance", "title"]]
        rows += [_row(catalogue_actuator(each)) for each in catalogue_names()]
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        return ["  ".join(f"{cell:<{width}}" for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows]
    shown = catalogue_actuator(name)
    known = _quantities(shown)
    width = max(len(quantities()[key].meaning) for key in known)
    return [
        f"{shown.name}: {shown.title}, {shown.kind}",
        *[
            f"  {quantities()[key].meaning:<{width}}  {format_si(value, quantities()[key].unit, digits=4)}"
            for key, value in known.items()
        ],
        f"  source: {shown.source}",
        *([f"  note: {shown.note}"] if shown.note else []),
    ]


def _row(shown: CatalogueActuator) -> list[str]:
    known = _quantities(shown)
    cells = [format_si(known[key], quantities()[key].unit) if key in known else "not printed" for key in _TOLD]
    return [shown.name, *cells, shown.title]


def _quantities(shown: CatalogueActuator) -> dict[str, float]:
    found = {field.name: getattr(shown, field.name) for field in fields(shown) if field.name in quantities()}
    return {key: value for key, value in found.items() if value is not None}


def _object(shown: CatalogueActuator) -> dict[str, Any]:
    return {
        "title": shown.title,
        "kind": shown.kind,
        **{key: {"value": value, "unit": quantities()[key].unit} for key, value in _quantities(shown).items()},
        "source": shown.source,
        "note": shown.note,
    }
