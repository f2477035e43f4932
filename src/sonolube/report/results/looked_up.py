"""Materials, actuators and published tables: heads, rows, lines, and objects for JSON."""

from dataclasses import asdict, fields
from math import exp
from typing import Any, Final

from sonolube.facts.materials import Material, SourcedValue
from sonolube.facts.published import Column, Correction, Table
from sonolube.models.actuator import CatalogueActuator
from sonolube.units import format_si
from sonolube.vocabulary import quantities, si

MATERIAL_HEADS: Final = ("Young's modulus", "hardness", "yield strength", "title")
"""Heads of the list of materials, behind the family."""

_OF_MATERIALS: Final = ("youngs_modulus", "hardness", "yield_strength")

ACTUATOR_HEADS: Final = ("name", "stroke", "over", "blocked", "capacitance", "resonance")
"""Heads of the list of actuators."""

_OF_ACTUATORS: Final = ("stroke", "stroke_voltage", "blocked_force", "free_capacitance", "resonance_frequency")


def material_row(shown: Material) -> list[str]:
    """Row of the list: name, main properties and title."""
    known = shown.properties
    cells = [format_si(known[key].value, known[key].unit) if key in known else "-" for key in _OF_MATERIALS]
    return [shown.name, *cells, shown.title]


def property_rows(shown: Material) -> list[tuple[str, str, str]]:
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
        "title": shown.title,
        "family": shown.family,
        "is_class": shown.is_class,
        "aliases": list(shown.aliases),
        "properties": {key: asdict(known) for key, known in shown.properties.items()},
        "crystal_structure": asdict(shown.crystal_structure) if shown.crystal_structure else None,
    }


def actuator_row(shown: CatalogueActuator) -> list[str]:
    """Row of the list: name and main quantities."""
    known = printed_quantities(shown)
    cells = [format_si(known[key], quantities()[key].unit) if key in known else "not printed" for key in _OF_ACTUATORS]
    return [shown.name, *cells]


def actuator_rows(shown: CatalogueActuator) -> list[tuple[str, str]]:
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
    return {
        "title": shown.title,
        "kind": shown.kind,
        **si(printed_quantities(shown)),
        "source": shown.source,
        "note": shown.note,
    }


def table_heads(shown: Table) -> list[str]:
    """Names of the columns with their units as printed."""
    columns = list(shown.columns.values())
    return [f"{column.name} [{_printed_unit(column)}]" if column.unit else column.name for column in columns]


def correction_line(correction: Correction) -> str:
    """Correction of a cell or a column, with its evidence."""
    erratum = f" ({correction.erratum})" if correction.erratum else ""
    row = "" if correction.row is None else f", row {correction.row + 1}"
    return (
        f"  correction{erratum}: {correction.column}{row}: {correction.printed}, corrected: {correction.corrected};"
        f" {correction.evidence}"
    )


def table_object(shown: Table) -> dict[str, Any]:
    """Table with its columns as printed and its corrections."""
    return {
        "id": shown.id,
        "title": shown.title,
        "section": shown.section,
        "columns": {
            name: {
                "quantity": column.quantity,
                "unit": _printed_unit(column),
                "role": column.role,
                "meaning": column.meaning,
                "printed": list(column.printed),
            }
            for name, column in shown.columns.items()
        },
        "corrections": [asdict(correction) for correction in shown.corrections],
    }


def _printed_unit(column: Column) -> str:
    """Unit in which a column is printed."""
    return column.unit if column.scale == 1 else f"{column.scale:g} {column.unit}".strip()
