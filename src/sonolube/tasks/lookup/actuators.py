"""Task `actuators`: actuators on the market with the numbers of their data sheets."""

from collections.abc import Sequence
from functools import partial
from typing import Annotated

from sonolube.models.actuator import CatalogueActuator, catalogue_actuator, catalogue_names
from sonolube.report.blocks import Block, Rows, Table
from sonolube.report.results import looked_up as results
from sonolube.report.results.facts_dataset import facts_dataset
from sonolube.tasks.lookup.listing import Listing
from sonolube.tasks.parameters import Parameter
from sonolube.tasks.task import task


@task
def actuators(
    name: Annotated[str | None, Parameter("One actuator; all of them by default.", kind="ACTUATOR")] = None,
) -> Listing:
    """Actuators one can buy, with the numbers of their data sheets and where these were read.

    Example: sonolube actuators sa050510
    """
    every = [catalogue_actuator(each) for each in (catalogue_names() if name is None else (name,))]
    return Listing(
        parts=_list(every) if name is None else _one(every[0]),
        content={each.name: results.actuator_object(each) for each in every}
        if name is None
        else results.actuator_object(every[0]),
        labelled=partial(
            facts_dataset,
            "actuator",
            {each.name: results.printed_quantities(each) for each in every},
            {each.name: each.title for each in every},
        ),
    )


def _list(every: Sequence[CatalogueActuator]) -> list[Block]:
    """Main quantities of all actuators, and their titles."""
    return [
        f"{len(every)} actuators on the market, by their data sheets",
        Table(results.ACTUATOR_HEADS, [results.actuator_row(each) for each in every]),
        "",
        Rows([(each.name, each.title) for each in every]),
    ]


def _one(shown: CatalogueActuator) -> list[Block]:
    """Name, title, kind, every quantity that the data sheet has, and its source."""
    return [
        f"{shown.name}: {shown.title}, {shown.kind}",
        Rows(results.actuator_rows(shown)),
        f"  source: {shown.source}",
        *([f"  note: {shown.note}"] if shown.note else []),
    ]
