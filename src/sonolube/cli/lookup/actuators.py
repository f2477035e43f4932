"""Command `actuators`: actuators on the market with the numbers of their data sheets."""

from dataclasses import fields
from typing import Annotated, Any

import typer

from sonolube.cli.console.answer import aligned, deliver, grid, si
from sonolube.cli.console.options import Json
from sonolube.cli.lookup.listing import Listing
from sonolube.models.actuator import CatalogueActuator, catalogue_actuator, catalogue_names
from sonolube.units import format_si
from sonolube.vocabulary import quantities

_HEADS = ("name", "stroke", "over", "blocked", "capacitance", "resonance", "title")
_QUANTITIES = ("stroke", "stroke_voltage", "blocked_force", "free_capacitance", "resonance_frequency")


def actuators(
    name: Annotated[str | None, typer.Argument(help="One actuator; all of them by default.")] = None, json: Json = False
) -> None:
    """Actuators one can buy, with the numbers of their data sheets and where these were read.

    Example: sonolube actuators sa050510
    """
    if name is None:
        every = [catalogue_actuator(each) for each in catalogue_names()]
        text = grid([_HEADS, *map(_row, every)])
        deliver(Listing(text=text, content={shown.name: _object(shown) for shown in every}), as_json=json)
    else:
        shown = catalogue_actuator(name)
        deliver(Listing(text=_lines(shown), content=_object(shown)), as_json=json)


def _lines(shown: CatalogueActuator) -> list[str]:
    """Name, title, kind, every quantity that the data sheet has, and its source."""
    known = quantities()
    rows = [(known[key].meaning, format_si(value, known[key].unit, digits=4)) for key, value in _printed(shown).items()]
    return [
        f"{shown.name}: {shown.title}, {shown.kind}",
        *aligned(rows),
        f"  source: {shown.source}",
        *([f"  note: {shown.note}"] if shown.note else []),
    ]


def _row(shown: CatalogueActuator) -> list[str]:
    """Row of the list: name, main quantities and title."""
    known = _printed(shown)
    cells = [format_si(known[key], quantities()[key].unit) if key in known else "not printed" for key in _QUANTITIES]
    return [shown.name, *cells, shown.title]


def _printed(shown: CatalogueActuator) -> dict[str, float]:
    """Quantities that the data sheet has, in SI."""
    values = {field.name: getattr(shown, field.name) for field in fields(shown) if field.name in quantities()}
    return {key: value for key, value in values.items() if value is not None}


def _object(shown: CatalogueActuator) -> dict[str, Any]:
    """Actuator for JSON."""
    return {"title": shown.title, "kind": shown.kind, **si(_printed(shown)), "source": shown.source, "note": shown.note}
