"""Task `materials`: properties of materials and piezo ceramics with their sources."""

from collections.abc import Sequence
from functools import partial
from typing import Annotated

from sonolube.facts.materials import Material, material, material_classes, material_families, material_names
from sonolube.report.blocks import Block, Table
from sonolube.report.results import looked_up as results
from sonolube.report.results.facts_dataset import facts_dataset
from sonolube.tasks.lookup.listing import Listing
from sonolube.tasks.parameters import Parameter
from sonolube.tasks.task import task


@task
def materials(
    name: Annotated[str | None, Parameter("One material; all of them by default.", kind="MATERIAL")] = None,
) -> Listing:
    """Materials, piezo ceramics and classes of materials, each property with its source.

    Example: sonolube materials aluminium_2024
    """
    every = [material(each) for each in ((*material_names(), *material_classes()) if name is None else (name,))]
    return Listing(
        parts=_list(every) if name is None else _one(every[0]),
        content={each.name: results.material_object(each) for each in every}
        if name is None
        else results.material_object(every[0]),
        labelled=partial(
            facts_dataset,
            "material",
            {each.name: {key: known.value for key, known in each.properties.items()} for each in every},
            {each.name: each.title for each in every},
        ),
    )


def _list(every: Sequence[Material]) -> list[Block]:
    """Table of main properties of each family, alphabetically, classes last in their family."""
    blocks: list[Block] = [f"{len(every)} materials, piezo ceramics and classes of materials, by family"]
    for family in material_families():
        rows = [results.material_row(each) for each in every if each.family == family]
        blocks += ["", Table((family.replace("_", " "), *results.MATERIAL_HEADS), rows)]
    return blocks


def _one(shown: Material) -> list[Block]:
    """Name, title, and every property with its source."""
    also = [f"  also {', '.join(shown.aliases)}"] if shown.aliases else []
    return [f"{shown.name}: {shown.title}", *also, Table(("property", "value", "source"), results.property_rows(shown))]
