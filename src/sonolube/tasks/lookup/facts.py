"""Tasks `materials`, `actuators` and `published`: tables of facts with their sources."""

from functools import partial
from typing import Annotated

from sonolube.facts import published as data
from sonolube.facts.materials import material, material_classes, material_names
from sonolube.models.actuator import catalogue_actuator, catalogue_names
from sonolube.report.blocks import Rows
from sonolube.report.results import looked_up as results
from sonolube.report.results.record_object import facts_dataset
from sonolube.tasks.answer import Listing
from sonolube.tasks.parameters import Parameter
from sonolube.tasks.task import task


@task
def materials(
    name: Annotated[str | None, Parameter("One material; all of them by default.", "MATERIAL")] = None,
) -> Listing:
    """Materials, piezo ceramics and classes of materials, each property with its source.

    Example: sonolube materials aluminium_2024

    Examples
    --------
    >>> import sonolube as sl
    >>> from sonolube.text.units import format_si
    >>> format_si(sl.materials("aluminium_2024")["youngs_modulus"].item(), "Pa")
    '73 GPa'
    """
    every = [material(each) for each in ((*material_names(), *material_classes()) if name is None else (name,))]
    objects = {each.name: results.material_object(each) for each in every}
    return Listing(
        parts=results.material_list(every) if name is None else results.material_blocks(every[0]),
        content=objects if name is None else objects[every[0].name],
        labelled=partial(
            facts_dataset,
            "material",
            {each.name: {key: known.value for key, known in each.properties.items()} for each in every},
            {each.name: each.title for each in every},
        ),
    )


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
