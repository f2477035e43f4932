"""The command on how to lubricate a rig's contact."""

from pathlib import Path
from typing import Annotated

import typer

from sonolube.cli.operate import Changes, Json, RigPath


def regime(
    rig: RigPath,
    film: Annotated[float, typer.Option("--film-coefficient", help="Coefficient of friction of the lubricant's film.")],
    pressure: Annotated[
        str, typer.Option("--asperity-pressure", metavar="PRESSURE", help="Pressure at which asperities carry all.")
    ],
    gain: Annotated[
        float, typer.Option("--smallest-gain", help="Share of a lubricant's friction worth the power of vibration.")
    ] = 0.0,
    pin: Annotated[str | None, typer.Option(metavar="MATERIAL", help="Material of the pin, for its wear.")] = None,
    disc: Annotated[str | None, typer.Option(metavar="MATERIAL", help="Material of the disc, for its wear.")] = None,
    changes: Changes = None,
    out: Annotated[Path, typer.Option(help="Folder for the figure.")] = Path("out"),
    json: Json = False,
) -> None:
    """Lubrication regime: dry, vibrated, lubricated or both, and the kind of wear to expect.

    Example: sonolube regime examples/rigs/tribometer.toml --film-coefficient 0.25 --asperity-pressure 10MPa
    """
    import json as json_module

    from sonolube.cli.regime_output import regime_lines, regime_object, write_regimes
    from sonolube.errors import InvalidInput
    from sonolube.friction import BoundaryLubricant
    from sonolube.materials import material
    from sonolube.rig import lubrication_map, lubrication_point, read_rig, wear_of_materials
    from sonolube.rig.file.plausible import plausible_si, require_plausible

    if (pin is None) != (disc is None):
        raise InvalidInput("--pin and --disc belong together: give both or neither")
    known = read_rig(rig, changes=list(changes or ()))
    full = plausible_si(pressure, unit="Pa", name="--asperity-pressure")
    require_plausible(film, unit="", text=f"--film-coefficient {film:g}")
    lubricant = BoundaryLubricant(film_coefficient=film, full_asperity_pressure=full)
    result = lubrication_point(known, lubricant=lubricant, smallest_gain=gain)
    wear = wear_of_materials(material(pin), material(disc)) if pin is not None and disc is not None else None
    about = lubrication_map(known, lubricant=lubricant, smallest_gain=gain)
    written = write_regimes(known, result, about, folder=out, name=f"{rig.stem}-regime")
    if json:
        typer.echo(json_module.dumps(regime_object(known, result, wear, written), indent=2, allow_nan=False))
    else:
        typer.echo("\n".join(regime_lines(known, result, wear, written)))
