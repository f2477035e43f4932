"""Task `materials`: properties of materials and piezo ceramics with their sources."""

from collections.abc import Sequence
from dataclasses import asdict
from functools import partial
from math import exp
from typing import Annotated, Any

from sonolube.facts.materials import (
    Material,
    SourcedValue,
    material,
    material_classes,
    material_families,
    material_names,
)
from sonolube.report.results.facts_dataset import facts_dataset
from sonolube.tasks.blocks import Block, Table
from sonolube.tasks.lookup.listing import Listing
from sonolube.tasks.parameters import Parameter
from sonolube.tasks.task import task
from sonolube.units import format_si

_HEADS = ("Young's modulus", "hardness", "yield strength", "title")
_QUANTITIES = ("youngs_modulus", "hardness", "yield_strength")


@task
def materials(
    name: Annotated[str | None, Parameter(help="One material; all of them by default.", kind="MATERIAL")] = None,
) -> Listing:
    """Materials, piezo ceramics and classes of materials, each property with its source.

    Example: sonolube materials aluminium_2024
    """
    every = [material(each) for each in ((*material_names(), *material_classes()) if name is None else (name,))]
    return Listing(
        parts=_list(every) if name is None else _one(every[0]),
        content={each.name: _object(each) for each in every} if name is None else _object(every[0]),
        labelled=partial(
            facts_dataset,
            "material",
            {each.name: {key: known.value for key, known in each.properties.items()} for each in every},
            {each.name: each.title for each in every},
        ),
    )


def _list(every: Sequence[Material]) -> list[Block]:
    """Table of main properties of each family, alphabetically, classes last in their family."""
    blocks: list[Block] = [f"{len(every)} materials, piezo ceramics and classes of materials, by family"]
    for family in material_families():
        rows = [_row(each) for each in every if each.family == family]
        blocks += ["", Table((family.replace("_", " "), *_HEADS), rows)]
    return blocks


def _row(shown: Material) -> list[str]:
    """Row of the list: name, main properties and title."""
    known = shown.properties
    cells = [format_si(known[key].value, known[key].unit) if key in known else "-" for key in _QUANTITIES]
    return [shown.name, *cells, shown.title]


def _one(shown: Material) -> list[Block]:
    """Name, title, and every property with its source."""
    rows = [
        (key, format_si(known.value, known.unit, digits=4), _source(known)) for key, known in shown.properties.items()
    ]
    if shown.crystal_structure:
        rows.append(("crystal_structure", shown.crystal_structure.text, shown.crystal_structure.source))
    also = [f"  also {', '.join(shown.aliases)}"] if shown.aliases else []
    return [f"{shown.name}: {shown.title}", *also, Table(("property", "value", "source"), rows)]


def _source(known: SourcedValue) -> str:
    """Source of a property with its spread, condition and note."""
    spread = f"within a factor of {exp(known.deviation):.3g}" if known.deviation else ""
    return "; ".join(remark for remark in (spread, known.source, known.condition, known.note) if remark)


def _object(shown: Material) -> dict[str, Any]:
    """Material for JSON."""
    return {
        "title": shown.title,
        "family": shown.family,
        "is_class": shown.is_class,
        "aliases": list(shown.aliases),
        "properties": {key: asdict(known) for key, known in shown.properties.items()},
        "crystal_structure": asdict(shown.crystal_structure) if shown.crystal_structure else None,
    }
