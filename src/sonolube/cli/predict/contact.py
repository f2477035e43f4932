"""Command `contact`: separation, real contact area and stiffness of a rig's contact at rest."""

from typing import Annotated

import typer

from sonolube.cli.console.answer import deliver
from sonolube.cli.console.options import Changes, Json, Load, RigPath, loaded_rig
from sonolube.cli.predict.rig_record import RigRecord
from sonolube.compilation import few_points
from sonolube.models.contact.tangential_stiffness import DEFAULT_TANGENTIAL_STIFFNESS, TANGENTIAL_STIFFNESSES
from sonolube.rig import contact_point

_MODEL_HELP = f"Model of the tangential stiffness: {', '.join(TANGENTIAL_STIFFNESSES)}."


@few_points()
def contact(
    rig: RigPath,
    load: Load = None,
    model: Annotated[str, typer.Option("--tangential-stiffness", metavar="MODEL", help=_MODEL_HELP)] = (
        DEFAULT_TANGENTIAL_STIFFNESS
    ),
    changes: Changes = None,
    json: Json = False,
) -> None:
    """Contact of the rig at rest: separation, real area, stiffness.

    Example: sonolube contact examples/rigs/poisson_al_steel.toml --load 40N
    """
    known = loaded_rig(rig, load=load, changes=changes)
    deliver(RigRecord(rig=known, result=contact_point(known, tangential_stiffness_model=model)), as_json=json)
