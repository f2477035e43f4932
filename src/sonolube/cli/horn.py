"""The commands that design horns."""

from pathlib import Path
from typing import Annotated

import typer

from sonolube.cli.operate import Json

horn = typer.Typer(no_args_is_help=True, help="Design horns and other resonators.")


@horn.callback()
def _horn() -> None:
    """Design horns and other resonators."""


@horn.command()
def design(
    target: Annotated[
        str, typer.Option("--frequency", metavar="FREQUENCY", help="At which it shall ring, such as 20kHz.")
    ],
    material: Annotated[str, typer.Option(metavar="NAME", help="What it is made of.")],
    shape: Annotated[
        str,
        typer.Option(metavar="SHAPE", help="block, booster, conical, cylinder, exponential, stepped, or a STEP file."),
    ] = "stepped",
    sizes: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="SIZE=VALUE", help="A size, such as radius=20mm; others are chosen."),
    ] = None,
    tune: Annotated[str, typer.Option(metavar="SIZE", help="The length to tune.")] = "length",
    mode: Annotated[str, typer.Option(metavar="NAME", help="The mode to tune.")] = "axial 1",
    axis: Annotated[
        str | None, typer.Option(metavar="x|y|z", help="Axis of a STEP file's part; its longest where absent.")
    ] = None,
    tool: Annotated[str, typer.Option("--tool-mass", metavar="MASS", help="Of a tool on the working face.")] = "10g",
    tolerance: Annotated[float, typer.Option(metavar="RATIO", help="Largest relative error of the frequency.")] = 0.003,
    out: Annotated[Path, typer.Option(help="Folder for the figures.")] = Path("out"),
    json: Json = False,
) -> None:
    """Tune a horn's length to a frequency, and tell its gain, node, stress, face and neighbouring modes.

    Example: sonolube horn design --frequency 20kHz --material titanium_6al4v --set end_radius=10mm
    """
    import json as json_module

    from sonolube.cli.horn_output import horn_lines, horn_object, write_horn
    from sonolube.cli.modal_part import horn_of
    from sonolube.cli.progress import progress
    from sonolube.design.horn import tuned_horn
    from sonolube.fem import medium_from_material
    from sonolube.materials import material as material_of
    from sonolube.units import to_si

    wanted = to_si(target, unit="Hz", name="--frequency")
    carried = to_si(tool, unit="kg", name="--tool-mass")
    made_of = material_of(material)
    body = horn_of(shape, sizes or [], frequency=wanted, material=made_of, tune=tune, axis=axis)
    with progress("tuning") as advance:
        found = tuned_horn(
            body,
            medium=medium_from_material(made_of),
            frequency=wanted,
            mode=mode,
            relative_tolerance=tolerance,
            advance=advance,
        )
        written = write_horn(found, folder=out, name=f"horn-{Path(shape).stem}")
    if json:
        typer.echo(json_module.dumps(horn_object(found, made_of, carried, written), indent=2, allow_nan=False))
    else:
        typer.echo("\n".join(horn_lines(found, made_of, carried, written)))
