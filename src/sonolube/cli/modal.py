"""The command on natural modes of a part."""

from pathlib import Path
from typing import Annotated

import typer

from sonolube.cli.operate import Json


def modes(
    part: Annotated[
        str, typer.Argument(metavar="PART", help="A part such as block, a transducer such as stack, or a STEP file.")
    ],
    sizes: Annotated[
        list[str] | None, typer.Option("--set", metavar="SIZE=VALUE", help="A size of the part, such as length=127mm.")
    ] = None,
    material: Annotated[
        str, typer.Option(metavar="NAME", help="What it is made of; transducers have their own.")
    ] = "stainless_steel_304",
    count: Annotated[int, typer.Option(metavar="NUMBER", help="How many elastic modes.")] = 6,
    clamp: Annotated[list[str] | None, typer.Option(metavar="FACE", help="A face held still, such as -x.")] = None,
    axis: Annotated[
        str | None, typer.Option(metavar="x|y|z", help="The part's axis; its longest where absent.")
    ] = None,
    tolerance: Annotated[float, typer.Option(metavar="RATIO", help="Largest relative error of a frequency.")] = 0.005,
    points: Annotated[
        Path | None, typer.Option(metavar="POINTS.csv", help="Points x, y, z in mm at which to tell the shapes.")
    ] = None,
    toward: Annotated[
        str | None, typer.Option(metavar="x|y|z", help="Component told at the points; that of the axis where absent.")
    ] = None,
    vtu: Annotated[bool, typer.Option("--vtu", help="Write the modes for ParaView too.")] = False,
    animate: Annotated[bool, typer.Option("--animate", help="Draw each mode as an animated GIF too.")] = False,
    out: Annotated[Path, typer.Option(help="Folder for a picture of each mode.")] = Path("out"),
    json: Json = False,
) -> None:
    """Natural modes of a part: frequencies with their errors, names and pictures.

    Example: sonolube modes block --set length=127mm --set width=60.96mm --set thickness=25.4mm
    """
    import json as json_module

    from sonolube.cli.modal_files import write_animations, write_shapes, write_vtu
    from sonolube.cli.modal_output import modes_lines, modes_object, write_modes
    from sonolube.cli.modal_part import (
        ALL_TRANSDUCERS,
        longest_axis,
        named_media,
        named_part,
        points_of,
        require_axis,
        starting_size,
        transducer_of,
    )
    from sonolube.cli.progress import progress
    from sonolube.fem import Electrodes, FixedSupport, Model, converged_modes, generate_mesh, mode_names

    require_axis(axis=axis, toward=toward)
    geometry = named_part(part, sizes or [])
    media = named_media(part, sizes or [], material)
    electrodes = transducer_of(part, sizes or []).electrodes if part in ALL_TRANSDUCERS else Electrodes()
    fixed = tuple(FixedSupport(face=face) for face in clamp or ())
    scanned = None if points is None else points_of(points)

    def model_at(element_size: float) -> Model:
        mesh = generate_mesh(geometry, element_size=element_size)
        return Model(mesh=mesh, media=media, fixed=fixed, electrodes=electrodes)

    with progress("meshing and solving") as advance:
        found = converged_modes(
            model_at,
            count=count,
            element_size=starting_size(geometry),
            relative_tolerance=tolerance,
            advance=advance,
        )
        along = axis or longest_axis(found.model.mesh)
        names = mode_names(found.model, found.modes, axis=along)
        stem = Path(part).stem
        written = write_modes(found, names, folder=out, part=stem)
        if scanned is not None:
            written += write_shapes(found, names, scanned, toward=toward or along, folder=out, part=stem)
        if vtu:
            written += write_vtu(found, names, folder=out, part=stem)
        if animate:
            written += write_animations(found, names, folder=out, part=stem, advance=advance)
    made_of = "its own materials" if part in ALL_TRANSDUCERS else material
    if json:
        typer.echo(json_module.dumps(modes_object(part, made_of, found, names, written), indent=2))
    else:
        typer.echo("\n".join(modes_lines(part, made_of, found, names, written)))
