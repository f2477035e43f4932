"""Task `actuators`: actuators on the market with the numbers of their data sheets."""

from functools import partial
from typing import Annotated

from sonolube.models.actuator import catalogue_actuator, catalogue_names
from sonolube.report.results import looked_up as results
from sonolube.report.results.facts_dataset import facts_dataset
from sonolube.tasks.lookup.listing import Listing
from sonolube.tasks.parameters import Parameter
from sonolube.tasks.task import task


@task
def actuators(
    name: Annotated[str | None, Parameter("One actuator; all of them by default.", "ACTUATOR")] = None,
) -> Listing:
    """Actuators one can buy, with the numbers of their data sheets and where these were read.

    Example: sonolube actuators sa050510

    Examples
    --------
    >>> import sonolube as sl
    >>> from sonolube.text.units import format_si
    >>> format_si(sl.actuators("sa050510")["stroke"].item(), "m")
    '14 um'
    """
    every = [catalogue_actuator(each) for each in (catalogue_names() if name is None else (name,))]
    objects = {each.name: results.actuator_object(each) for each in every}
    return Listing(
        parts=results.actuator_list(every) if name is None else results.actuator_blocks(every[0]),
        content=objects if name is None else objects[every[0].name],
        labelled=partial(
            facts_dataset,
            "actuator",
            {each.name: results.printed_quantities(each) for each in every},
            {each.name: each.title for each in every},
        ),
    )
