"""Materials, actuators and published tables: heads, rows, lines, and objects for JSON."""

from collections.abc import Sequence
from dataclasses import asdict, fields
from math import exp
from typing import Any, Final

from sonolube.facts.materials import Material, SourcedValue, material_families
from sonolube.facts.published import Column, Correction, Table as PublishedTable
from sonolube.models.actuator import CatalogueActuator
from sonolube.report.blocks import Block, Rows, Table
from sonolube.report.results.record_object import picked
from sonolube.text.units import format_si
from sonolube.vocabulary import quantities, si

_MATERIAL_HEADS: Final = ("Young's modulus", "hardness", "yield strength", "title")
_OF_MATERIALS: Final = ("youngs_modulus", "hardness", "yield_strength")

_ACTUATOR_HEADS: Final = ("name", "stroke", "over", "blocked", "capacitance", "resonance")
_OF_ACTUATORS: Final = ("stroke", "stroke_voltage", "blocked_force", "free_capacitance", "resonance_frequency")


def _material_row(shown: Material) -> list[str]:
    """Row of the list: name, main properties and title."""
    known = shown.properties
    cells = [format_si(known[key].value, known[key].unit) if key in known else "-" for key in _OF_MATERIALS]
    return [shown.name, *cells, shown.title]


def _property_rows(shown: Material) -> list[tuple[str, str, str]]:
    """Every property with its source."""
    rows = [
        (key, format_si(known.value, known.unit, digits=4), _source(known)) for key, known in shown.properties.items()
    ]
    if shown.crystal_structure:
        rows.append(("crystal_structure", shown.crystal_structure.text, shown.crystal_structure.source))
    return rows


def _source(known: SourcedValue) -> str:
    """Source of a property with its spread, condition and note."""
    spread = f"within a factor of {exp(known.deviation):.3g}" if known.deviation else ""
    return "; ".join(remark for remark in (spread, known.source, known.condition, known.note) if remark)


def material_object(shown: Material) -> dict[str, Any]:
    """Material with its properties and their sources."""
    return {
        **picked(shown, "title", "family", "is_class"),
        "aliases": list(shown.aliases),
        "properties": {key: asdict(known) for key, known in shown.properties.items()},
        "crystal_structure": asdict(shown.crystal_structure) if shown.crystal_structure else None,
    }


def _actuator_row(shown: CatalogueActuator) -> list[str]:
    """Row of the list: name and main quantities."""
    known = printed_quantities(shown)
    cells = [format_si(known[key], quantities()[key].unit) if key in known else "not printed" for key in _OF_ACTUATORS]
    return [shown.name, *cells]


def _actuator_rows(shown: CatalogueActuator) -> list[tuple[str, str]]:
    """Every quantity that the data sheet has, by its meaning."""
    known = quantities()
    printed = printed_quantities(shown).items()
    return [(known[key].meaning, format_si(value, known[key].unit, digits=4)) for key, value in printed]


def printed_quantities(shown: CatalogueActuator) -> dict[str, float]:
    """Quantities that the data sheet has, in SI."""
    values = {field.name: getattr(shown, field.name) for field in fields(shown) if field.name in quantities()}
    return {key: value for key, value in values.items() if value is not None}


def actuator_object(shown: CatalogueActuator) -> dict[str, Any]:
    """Actuator with the quantities of its data sheet."""
    return picked(shown, "title", "kind") | si(printed_quantities(shown)) | picked(shown, "source", "note")


def _correction_line(correction: Correction) -> str:
    """Correction of a cell or a column, with its evidence."""
    erratum = f" ({correction.erratum})" if correction.erratum else ""
    row = "" if correction.row is None else f", row {correction.row + 1}"
    return (
        f"  correction{erratum}: {correction.column}{row}: {correction.printed}, corrected: {correction.corrected};"
        f" {correction.evidence}"
    )


def table_object(shown: PublishedTable) -> dict[str, Any]:
    """Table with its columns as printed and its corrections."""
    return {
        **picked(shown, "id", "title", "section"),
        "columns": {
            name: {"quantity": column.quantity, "unit": _printed_unit(column)}
            | picked(column, "role", "meaning")
            | {"printed": list(column.printed)}
            for name, column in shown.columns.items()
        },
        "corrections": [asdict(correction) for correction in shown.corrections],
    }


def _printed_unit(column: Column) -> str:
    """Unit in which a column is printed."""
    return column.unit if column.scale == 1 else f"{column.scale:g} {column.unit}".strip()


def actuator_list(every: Sequence[CatalogueActuator]) -> list[Block]:
    """Main quantities of all actuators, and their titles."""
    return [
        f"{len(every)} actuators on the market, by their data sheets",
        Table(_ACTUATOR_HEADS, [_actuator_row(each) for each in every]),
        "",
        Rows([(each.name, each.title) for each in every]),
    ]


def actuator_blocks(shown: CatalogueActuator) -> list[Block]:
    """Name, title, kind, every quantity that the data sheet has, and its source."""
    return [
        f"{shown.name}: {shown.title}, {shown.kind}",
        Rows(_actuator_rows(shown)),
        f"  source: {shown.source}",
        *([f"  note: {shown.note}"] if shown.note else []),
    ]


def material_list(every: Sequence[Material]) -> list[Block]:
    """Table of main properties of each family, alphabetically, classes last in their family."""
    blocks: list[Block] = [f"{len(every)} materials, piezo ceramics and classes of materials, by family"]
    for family in material_families():
        rows = [_material_row(each) for each in every if each.family == family]
        blocks += ["", Table((family.replace("_", " "), *_MATERIAL_HEADS), rows)]
    return blocks


def material_blocks(shown: Material) -> list[Block]:
    """Name, title, and every property with its source."""
    also = [f"  also {', '.join(shown.aliases)}"] if shown.aliases else []
    return [f"{shown.name}: {shown.title}", *also, Table(("property", "value", "source"), _property_rows(shown))]


def table_blocks(shown: PublishedTable) -> list[Block]:
    """Title, columns as printed, and corrections."""
    columns = list(shown.columns.values())
    heads = [f"{column.name} [{_printed_unit(column)}]" if column.unit else column.name for column in columns]
    table = Table(heads, list(zip(*[column.printed for column in columns], strict=True)))
    return [f"Table {shown.id}: {shown.title}", table, *map(_correction_line, shown.corrections)]
