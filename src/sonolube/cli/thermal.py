"""The command on how warm a rig's contact runs."""

from pathlib import Path
from typing import Annotated

import typer

from sonolube.cli.operate import Changes, Json, RigPath


def thermal(
    rig: RigPath,
    pin: Annotated[str, typer.Option(metavar="MATERIAL", help="The body that carries the contact with it.")],
    disc: Annotated[str, typer.Option(metavar="MATERIAL", help="The body that the contact passes over.")],
    lasting: Annotated[str, typer.Option("--duration", metavar="TIME", help="Length of the test.")] = "50s",
    capacity: Annotated[
        str, typer.Option("--heat-capacity", metavar="CAPACITY", help="Heat that warms the pin by a kelvin.")
    ] = "1.5J/K",
    conductance: Annotated[
        str, typer.Option("--conductance", metavar="CONDUCTANCE", help="Heat that leaves the pin per kelvin.")
    ] = "0.05W/K",
    vibration: Annotated[
        str, typer.Option("--vibration-heat", metavar="POWER", help="Heat of the vibration in the contact.")
    ] = "0W",
    changes: Changes = None,
    out: Annotated[Path, typer.Option(help="Folder for the figure.")] = Path("out"),
    json: Json = False,
) -> None:
    """Heat of friction and vibration: flash, bulk and their share in each body.

    Example: sonolube thermal examples/rigs/tribometer.toml --pin stainless_steel_316 --disc aluminium_2024
    """
    from sonolube.cli.output import show
    from sonolube.cli.thermal_output import write_heat
    from sonolube.rig import read_rig, temperature_point, thermal_solid
    from sonolube.rig.file.plausible import plausible_si

    known = read_rig(rig, changes=list(changes or ()))
    result = temperature_point(
        known,
        pin=thermal_solid(pin),
        disc=thermal_solid(disc),
        heat_capacity=plausible_si(capacity, unit="J/K", name="--heat-capacity"),
        thermal_conductance=plausible_si(conductance, unit="W/K", name="--conductance"),
        duration=plausible_si(lasting, unit="s", name="--duration"),
        vibration_heat_rate=plausible_si(vibration, unit="W", name="--vibration-heat"),
    )
    show(result, rig=known, as_json=json, written=write_heat(known, result, folder=out, name=f"{rig.stem}-thermal"))
