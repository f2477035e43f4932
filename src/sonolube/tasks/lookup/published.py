"""Task `published`: tables of the dissertation as printed, with the corrections of single cells."""

from collections.abc import Sequence
from dataclasses import asdict
from typing import Annotated, Any

from sonolube.facts import published as data
from sonolube.facts.published import Column, Correction, Table as PublishedTable
from sonolube.tasks.blocks import Block, Rows, Table
from sonolube.tasks.lookup.listing import Listing
from sonolube.tasks.parameters import Parameter
from sonolube.tasks.task import task


@task
def published(
    table: Annotated[str | None, Parameter(help="One table, such as 2.5; the list by default.", kind="TABLE")] = None,
) -> Listing:
    """Published data of the dissertation, with the corrections of single cells.

    Example: sonolube published 2.5
    """
    if table is None:
        titles = {each: data.table(each).title for each in data.table_ids()}
        return Listing(parts=["Tables of the dissertation", Rows(list(titles.items()))], content=titles)
    shown = data.table(table)
    return Listing(parts=_one(shown), content=_object(shown), labelled=shown.to_dataset)


def _one(shown: PublishedTable) -> Sequence[Block]:
    """Title, columns as printed, and corrections."""
    columns = list(shown.columns.values())
    heads = [f"{column.name} [{_printed_unit(column)}]" if column.unit else column.name for column in columns]
    rows = list(zip(*[column.printed for column in columns], strict=True))
    return [f"Table {shown.id}: {shown.title}", Table(heads, rows), *map(_correction, shown.corrections)]


def _correction(correction: Correction) -> str:
    """Correction of a cell or a column, with its evidence."""
    erratum = f" ({correction.erratum})" if correction.erratum else ""
    row = "" if correction.row is None else f", row {correction.row + 1}"
    return (
        f"  correction{erratum}: {correction.column}{row}: {correction.printed}, corrected: {correction.corrected};"
        f" {correction.evidence}"
    )


def _object(shown: PublishedTable) -> dict[str, Any]:
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
