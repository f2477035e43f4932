"""The command on natural modes of a part."""

from pathlib import Path
from typing import Annotated

import typer

from sonolube.cli.operate import Json


def modes(
    part: Annotated[str, typer.Argument(metavar="PART", help="A part such as block or stepped_horn, or a STEP file.")],
    sizes: Annotated[
        list[str] | None, typer.Option("--set", metavar="SIZE=VALUE", help="A size of the part, such as length=127mm.")
    ] = None,
    material: Annotated[str, typer.Option(metavar="NAME", help="What it is made of.")] = "stainless_steel_304",
    count: Annotated[int, typer.Option(metavar="NUMBER", help="How many elastic modes.")] = 6,
    clamp: Annotated[list[str] | None, typer.Option(metavar="FACE", help="A face held still, such as -x.")] = None,
    axis: Annotated[
        str | None, typer.Option(metavar="x|y|z", help="The part's axis; its longest where absent.")
    ] = None,
    tolerance: Annotated[float, typer.Option(metavar="RATIO", help="Largest relative error of a frequency.")] = 0.005,
    out: Annotated[Path, typer.Option(help="Folder for a picture of each mode.")] = Path("out"),
    json: Json = False,
) -> None:
    """Natural modes of a part: frequencies with their errors, names and pictures.

    Example: sonolube modes block --set length=127mm --set width=60.96mm --set thickness=25.4mm
    """
    import json as json_module

    from sonolube.cli.modal_output import modes_lines, modes_object, write_modes
    from sonolube.cli.modal_part import longest_axis, named_part, starting_size
    from sonolube.cli.progress import progress
    from sonolube.fem import Fixed, Model, converged_modes, medium_of, mesh_of, mode_names
    from sonolube.materials import material as material_of

    geometry = named_part(part, sizes or [])
    medium = medium_of(material_of(material))
    fixed = tuple(Fixed(face=face) for face in clamp or ())

    def model_at(element_size: float) -> Model:
        mesh = mesh_of(geometry, element_size=element_size)
        return Model(mesh=mesh, media=dict.fromkeys(geometry.regions, medium), fixed=fixed)

    with progress("meshing and solving") as advance:
        found = converged_modes(
            model_at,
            count=count,
            element_size=starting_size(geometry),
            relative_tolerance=tolerance,
            advance=advance,
        )
        names = mode_names(found.model, found.modes, axis=axis or longest_axis(found.model.mesh))
        written = write_modes(found, names, folder=out, part=Path(part).stem)
    if json:
        typer.echo(json_module.dumps(modes_object(part, material, found, names, written), indent=2))
    else:
        typer.echo("\n".join(modes_lines(part, material, found, names, written)))
