"""Task `published`: tables of the dissertation as printed, with the corrections of single cells."""

from typing import Annotated

from sonolube.facts import published as data
from sonolube.report.blocks import Rows
from sonolube.report.results import looked_up as results
from sonolube.tasks.lookup.listing import Listing
from sonolube.tasks.parameters import Parameter
from sonolube.tasks.task import task


@task
def published(
    table: Annotated[str | None, Parameter("One table, such as 2.5; the list by default.", "TABLE")] = None,
) -> Listing:
    """Published data of the dissertation, with the corrections of single cells.

    Example: sonolube published 2.5

    Examples
    --------
    >>> import sonolube as sl
    >>> sl.published("2.5")["wear_reduction"].values.tolist()  # at three speeds
    [0.4576, 0.4818, 0.4863]
    """
    if table is None:
        titles = {each: data.table(each).title for each in data.table_ids()}
        return Listing(parts=["Tables of the dissertation", Rows(list(titles.items()))], content=titles)
    shown = data.table(table)
    return Listing(parts=results.table_blocks(shown), content=results.table_object(shown), labelled=shown.to_dataset)
