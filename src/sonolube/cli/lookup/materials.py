"""Command `materials`: properties of materials and piezo ceramics with their sources."""

from collections.abc import Sequence
from dataclasses import asdict
from math import exp
from typing import Annotated, Any

import typer

from sonolube.cli.console.answer import aligned, deliver, grid
from sonolube.cli.console.options import Json
from sonolube.cli.lookup.listing import Listing
from sonolube.facts.materials import (
    Material,
    SourcedValue,
    material,
    material_classes,
    material_families,
    material_names,
)
from sonolube.units import format_si

_HEADS = ("name", "Young's modulus", "hardness", "yield strength", "title")
_QUANTITIES = ("youngs_modulus", "hardness", "yield_strength")


def materials(
    name: Annotated[str | None, typer.Argument(help="One material; all of them by default.")] = None, json: Json = False
) -> None:
    """Materials, piezo ceramics and classes of materials, each property with its source.

    Example: sonolube materials aluminium_2024
    """
    if name is None:
        every = [material(each) for each in (*material_names(), *material_classes())]
        deliver(Listing(text=_by_family(every), content={each.name: _object(each) for each in every}), as_json=json)
    else:
        shown = material(name)
        deliver(Listing(text=_lines(shown), content=_object(shown)), as_json=json)


def _by_family(every: Sequence[Material]) -> list[str]:
    """Rows of the list under headings of the families, alphabetically, classes last in their family."""
    columns = grid([_HEADS, *map(_row, every)])
    rows = dict(zip((each.name for each in every), columns[1:], strict=True))
    lines = [columns[0]]
    for family in material_families():
        lines += ["", family.replace("_", " "), *(rows[each.name] for each in every if each.family == family)]
    return lines


def _row(shown: Material) -> list[str]:
    """Row of the list: name, main properties and title."""
    known = shown.properties
    cells = [format_si(known[key].value, known[key].unit) if key in known else "-" for key in _QUANTITIES]
    return [shown.name, *cells, shown.title]


def _lines(shown: Material) -> list[str]:
    """Name, title, and every property with its source."""
    rows = [(key, _property(known)) for key, known in shown.properties.items()]
    if shown.crystal_structure:
        rows.append(("crystal_structure", f"{shown.crystal_structure.text}, {shown.crystal_structure.source}"))
    also = [f"  also {', '.join(shown.aliases)}"] if shown.aliases else []
    return [f"{shown.name}: {shown.title}", *also, *aligned(rows)]


def _property(known: SourcedValue) -> str:
    """Value of a property with its source, condition and note."""
    spread = f"within a factor of {exp(known.deviation):.3g}" if known.deviation else ""
    remarks = (remark for remark in (spread, known.source, known.condition, known.note) if remark)
    return f"{format_si(known.value, known.unit, digits=4):<14}  {'; '.join(remarks)}"


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
