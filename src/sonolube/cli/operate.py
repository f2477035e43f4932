"""Commands on a rig: its contact, its friction, its wear."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from sonolube.rig import Rig

RigPath = Annotated[Path, typer.Argument(metavar="RIG.toml", help="The rig, as a TOML file.")]
Load = Annotated[str | None, typer.Option(metavar="FORCE", help="Normal load instead of the rig's, such as 40N.")]
Changes = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Replace an entry, such as sliding.sliding_speed=87mm/s."),
]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object, all quantities in SI.")]


def contact(rig: RigPath, load: Load = None, changes: Changes = None, json: Json = False) -> None:
    """Contact of the rig at rest: separation, real area, stiffness.

    Example: sonolube contact examples/rigs/poisson_al_steel.toml --load 40N
    """
    from sonolube.rig import contact_point

    _operate(contact_point, rig, load, changes, json)


def friction(
    rig: RigPath,
    load: Load = None,
    model: Annotated[
        str | None, typer.Option(metavar="NAME", help="Friction model instead of the rig's, such as kinematic.")
    ] = None,
    changes: Changes = None,
    json: Json = False,
) -> None:
    """Friction of the rig with and without vibration.

    Example: sonolube friction examples/rigs/collar.toml --set drive.voltage_peak_to_peak=14V
    """
    from functools import partial

    from sonolube.rig import friction_point

    _operate(partial(friction_point, model=model), rig, load, changes, json)


def wear(rig: RigPath, load: Load = None, changes: Changes = None, json: Json = False) -> None:
    """Wear of the rig's softer body with and without vibration.

    Example: sonolube wear examples/rigs/tribometer.toml
    """
    from sonolube.rig import wear_point

    _operate(wear_point, rig, load, changes, json)


def simulate(
    rig: RigPath,
    load: Load = None,
    changes: Changes = None,
    out: Annotated[Path, typer.Option(help="Folder for the figure and the netCDF file.")] = Path("out"),
    json: Json = False,
) -> None:
    """Multi-scale model: drive, structure and contact in one steady vibration, and the friction and wear under it.

    Example: sonolube simulate examples/rigs/tribometer.toml --set drive.voltage_peak_to_peak=25.9V
    """
    from sonolube.cli.output import show
    from sonolube.cli.progress import progress
    from sonolube.cli.simulation_output import write_simulation
    from sonolube.rig import simulate as simulated

    known = _rig(rig, load, changes)
    with progress("simulating"):
        result = simulated(known)
        written = write_simulation(known, result, folder=out, name=f"{rig.stem}-simulation")
    show(result, rig=known, as_json=json, written=written)


def _operate(model: Callable[..., Any], path: Path, load: str | None, changes: list[str] | None, as_json: bool) -> None:
    from sonolube.cli.output import show

    rig = _rig(path, load, changes)
    show(model(rig), rig=rig, as_json=as_json)


def _rig(path: Path, load: str | None, changes: list[str] | None) -> "Rig":
    from sonolube.rig import read_rig
    from sonolube.units import to_si

    replaced = list(changes or ())
    if load is not None:
        to_si(load, unit="N", name="--load")
        replaced.append(f"contact.normal_load={load}")
    return read_rig(path, changes=replaced)
