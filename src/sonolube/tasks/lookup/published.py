"""Task `published`: tables of the dissertation as printed, with the corrections of single cells."""

from collections.abc import Sequence
from typing import Annotated

from sonolube.facts import published as data
from sonolube.facts.published import Table as PublishedTable
from sonolube.report.blocks import Block, Rows, Table
from sonolube.report.results import looked_up as results
from sonolube.tasks.lookup.listing import Listing
from sonolube.tasks.parameters import Parameter
from sonolube.tasks.task import task


@task
def published(
    table: Annotated[str | None, Parameter("One table, such as 2.5; the list by default.", kind="TABLE")] = None,
) -> Listing:
    """Published data of the dissertation, with the corrections of single cells.

    Example: sonolube published 2.5
    """
    if table is None:
        titles = {each: data.table(each).title for each in data.table_ids()}
        return Listing(parts=["Tables of the dissertation", Rows(list(titles.items()))], content=titles)
    shown = data.table(table)
    return Listing(parts=_one(shown), content=results.table_object(shown), labelled=shown.to_dataset)


def _one(shown: PublishedTable) -> Sequence[Block]:
    """Title, columns as printed, and corrections."""
    rows = list(zip(*[column.printed for column in shown.columns.values()], strict=True))
    return [
        f"Table {shown.id}: {shown.title}",
        Table(results.table_heads(shown), rows),
        *map(results.correction_line, shown.corrections),
    ]
