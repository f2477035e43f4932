"""Task `materials`: properties of materials and piezo ceramics with their sources."""

from functools import partial
from typing import Annotated

from sonolube.facts.materials import material, material_classes, material_names
from sonolube.report.results import looked_up as results
from sonolube.report.results.facts_dataset import facts_dataset
from sonolube.tasks.lookup.listing import Listing
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
