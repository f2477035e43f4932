"""Task `actuators`: actuators on the market with the numbers of their data sheets."""

from collections.abc import Sequence
from dataclasses import fields
from functools import partial
from typing import Annotated, Any

from sonolube.models.actuator import CatalogueActuator, catalogue_actuator, catalogue_names
from sonolube.report.results.facts_dataset import facts_dataset
from sonolube.tasks.answer import si
from sonolube.tasks.blocks import Block, Rows, Table
from sonolube.tasks.lookup.listing import Listing
from sonolube.tasks.parameters import Parameter
from sonolube.tasks.task import task
from sonolube.units import format_si
from sonolube.vocabulary import quantities

_HEADS = ("name", "stroke", "over", "blocked", "capacitance", "resonance")
_QUANTITIES = ("stroke", "stroke_voltage", "blocked_force", "free_capacitance", "resonance_frequency")


@task
def actuators(
    name: Annotated[str | None, Parameter(help="One actuator; all of them by default.", kind="ACTUATOR")] = None,
) -> Listing:
    """Actuators one can buy, with the numbers of their data sheets and where these were read.

    Example: sonolube actuators sa050510
    """
    every = [catalogue_actuator(each) for each in (catalogue_names() if name is None else (name,))]
    return Listing(
        parts=_list(every) if name is None else _one(every[0]),
        content={each.name: _object(each) for each in every} if name is None else _object(every[0]),
        labelled=partial(
            facts_dataset,
            "actuator",
            {each.name: _printed(each) for each in every},
            {each.name: each.title for each in every},
        ),
    )


def _list(every: Sequence[CatalogueActuator]) -> list[Block]:
    """Main quantities of all actuators, and their titles."""
    return [
        f"{len(every)} actuators on the market, by their data sheets",
        Table(_HEADS, [_row(each) for each in every]),
        "",
        Rows([(each.name, each.title) for each in every]),
    ]


def _one(shown: CatalogueActuator) -> list[Block]:
    """Name, title, kind, every quantity that the data sheet has, and its source."""
    known = quantities()
    rows = [(known[key].meaning, format_si(value, known[key].unit, digits=4)) for key, value in _printed(shown).items()]
    return [
        f"{shown.name}: {shown.title}, {shown.kind}",
        Rows(rows),
        f"  source: {shown.source}",
        *([f"  note: {shown.note}"] if shown.note else []),
    ]


def _row(shown: CatalogueActuator) -> list[str]:
    """Row of the list: name and main quantities."""
    known = _printed(shown)
    cells = [format_si(known[key], quantities()[key].unit) if key in known else "not printed" for key in _QUANTITIES]
    return [shown.name, *cells]


def _printed(shown: CatalogueActuator) -> dict[str, float]:
    """Quantities that the data sheet has, in SI."""
    values = {field.name: getattr(shown, field.name) for field in fields(shown) if field.name in quantities()}
    return {key: value for key, value in values.items() if value is not None}


def _object(shown: CatalogueActuator) -> dict[str, Any]:
    """Actuator for JSON."""
    return {"title": shown.title, "kind": shown.kind, **si(_printed(shown)), "source": shown.source, "note": shown.note}
