"""Command `friction`: friction of a rig with and without vibration, by its own or another friction model."""

from typing import Annotated

import typer

from sonolube.cli.console.answer import deliver
from sonolube.cli.console.options import Changes, Json, Load, RigPath, loaded_rig
from sonolube.cli.predict.rig_record import RigRecord
from sonolube.rig import friction_point


def friction(
    rig: RigPath,
    load: Load = None,
    model: Annotated[str | None, typer.Option(metavar="NAME", help="Friction model instead of the rig's own.")] = None,
    changes: Changes = None,
    json: Json = False,
) -> None:
    """Friction of the rig with and without vibration.

    Example: sonolube friction examples/rigs/collar.toml --set drive.voltage_peak_to_peak=14V
    """
    known = loaded_rig(rig, load=load, changes=changes)
    deliver(RigRecord(rig=known, result=friction_point(known, model=model)), as_json=json)
