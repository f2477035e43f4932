"""What the catalogue commands say of materials and of published tables."""

from dataclasses import asdict
from typing import Any

from sonolube.materials import Material, material, material_names
from sonolube.published import Column, Table, table, table_ids
from sonolube.units import format_si


def material_object(name: str | None) -> dict[str, Any]:
    """Return one material, or all by name, as they go into JSON."""
    if name is not None:
        return _material_object(material(name))
    return {each: _material_object(material(each)) for each in material_names()}


def material_lines(name: str | None) -> list[str]:
    """Return one material with its sources, or the list of all, as lines."""
    if name is None:
        width = max(map(len, material_names()))
        return [f"{each:<{width}}  {material(each).title}" for each in material_names()]
    shown = material(name)
    width = max(map(len, shown.properties))
    return [
        f"{shown.name}: {shown.title}",
        *[
            f"  {key:<{width}}  {format_si(known.value, known.unit, digits=4):<14}  {known.source}"
            + "".join(f"; {remark}" for remark in (known.condition, known.note) if remark)
            for key, known in shown.properties.items()
        ],
        *(
            [f"  {'crystal_structure':<{width}}  {shown.crystal_structure.text}, {shown.crystal_structure.source}"]
            if shown.crystal_structure
            else []
        ),
    ]


def published_object(table_id: str | None) -> dict[str, Any]:
    """Return one table, or the titles of all by number, as they go into JSON."""
    if table_id is None:
        return {each: table(each).title for each in table_ids()}
    shown = table(table_id)
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


def published_lines(table_id: str | None) -> list[str]:
    """Return one table as printed with its corrections, or the list of all, as lines."""
    if table_id is None:
        return [f"{each:<5} {table(each).title}" for each in table_ids()]
    shown = table(table_id)
    return [
        f"Table {shown.id}: {shown.title}",
        *_grid(shown),
        *[
            f"  correction{f' ({correction.erratum})' if correction.erratum else ''}: {correction.column}"
            f"{f', row {correction.row + 1}' if correction.row is not None else ''}: {correction.printed}, "
            f"right: {correction.right}; {correction.reason}"
            for correction in shown.corrections
        ],
    ]


def _grid(shown: Table) -> list[str]:
    columns = list(shown.columns.values())
    heads = [f"{column.name} [{_printed_unit(column)}]" if column.unit else column.name for column in columns]
    widths = [max(map(len, [head, *column.printed])) for head, column in zip(heads, columns, strict=True)]
    rows = [heads, *zip(*[column.printed for column in columns], strict=True)]
    return [
        "  " + "  ".join(f"{text:<{width}}" for text, width in zip(row, widths, strict=True)).rstrip() for row in rows
    ]


def _printed_unit(column: Column) -> str:
    return column.unit if column.scale == 1 else f"{column.scale:g} {column.unit}".strip()


def _material_object(shown: Material) -> dict[str, Any]:
    return {
        "title": shown.title,
        "properties": {key: asdict(known) for key, known in shown.properties.items()},
        "crystal_structure": asdict(shown.crystal_structure) if shown.crystal_structure else None,
    }
