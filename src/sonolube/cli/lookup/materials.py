"""Command `materials`: properties of materials and piezo ceramics with their sources."""

from dataclasses import asdict
from typing import Annotated, Any

import typer

from sonolube.cli.console.answer import aligned, deliver
from sonolube.cli.console.options import Json
from sonolube.cli.lookup.listing import Listing
from sonolube.materials import Material, SourcedValue, material, material_names
from sonolube.units import format_si


def materials(
    name: Annotated[str | None, typer.Argument(help="One material; all of them by default.")] = None, json: Json = False
) -> None:
    """Materials and piezo ceramics, each property with its source.

    Example: sonolube materials aluminium_2024
    """
    if name is None:
        every = {each: material(each) for each in material_names()}
        width = max(map(len, every))
        text = [f"{each:<{width}}  {shown.title}" for each, shown in every.items()]
        deliver(Listing(text=text, content={each: _object(shown) for each, shown in every.items()}), as_json=json)
    else:
        shown = material(name)
        deliver(Listing(text=_lines(shown), content=_object(shown)), as_json=json)


def _lines(shown: Material) -> list[str]:
    """Name, title, and every property with its source."""
    rows = [(key, _property(known)) for key, known in shown.properties.items()]
    if shown.crystal_structure:
        rows.append(("crystal_structure", f"{shown.crystal_structure.text}, {shown.crystal_structure.source}"))
    return [f"{shown.name}: {shown.title}", *aligned(rows)]


def _property(known: SourcedValue) -> str:
    """Value of a property with its source, condition and note."""
    remarks = (remark for remark in (known.source, known.condition, known.note) if remark)
    return f"{format_si(known.value, known.unit, digits=4):<14}  {'; '.join(remarks)}"


def _object(shown: Material) -> dict[str, Any]:
    """Material for JSON."""
    return {
        "title": shown.title,
        "properties": {key: asdict(known) for key, known in shown.properties.items()},
        "crystal_structure": asdict(shown.crystal_structure) if shown.crystal_structure else None,
    }
