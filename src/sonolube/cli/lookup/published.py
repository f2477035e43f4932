"""Command `published`: tables of the dissertation as printed, with the corrections of single cells."""

from dataclasses import asdict
from typing import Annotated, Any

import typer

from sonolube.cli.console.answer import deliver, grid
from sonolube.cli.console.options import Json
from sonolube.cli.lookup.listing import Listing
from sonolube.facts import published as data
from sonolube.facts.published import Column, Table


def published(
    table: Annotated[str | None, typer.Argument(help="One table, such as 2.5; the list by default.")] = None,
    json: Json = False,
) -> None:
    """Published data of the dissertation, with the corrections of single cells.

    Example: sonolube published 2.5
    """
    if table is None:
        titles = {each: data.table(each).title for each in data.table_ids()}
        deliver(Listing(text=[f"{each:<5} {title}" for each, title in titles.items()], content=titles), as_json=json)
    else:
        shown = data.table(table)
        deliver(Listing(text=_lines(shown), content=_object(shown)), as_json=json)


def _lines(shown: Table) -> list[str]:
    """Title, columns as printed, and corrections."""
    columns = list(shown.columns.values())
    heads = [f"{column.name} [{_printed_unit(column)}]" if column.unit else column.name for column in columns]
    rows = zip(*[column.printed for column in columns], strict=True)
    return [
        f"Table {shown.id}: {shown.title}",
        *[f"  {line}" for line in grid([heads, *rows])],
        *[
            f"  correction{f' ({correction.erratum})' if correction.erratum else ''}: {correction.column}"
            f"{f', row {correction.row + 1}' if correction.row is not None else ''}: {correction.printed}, "
            f"corrected: {correction.corrected}; {correction.evidence}"
            for correction in shown.corrections
        ],
    ]


def _object(shown: Table) -> dict[str, Any]:
    """Table for JSON."""
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
