"""Command `contact`: separation, real contact area and stiffness of a rig's contact at rest."""

from sonolube.cli.console.answer import deliver
from sonolube.cli.console.options import Changes, Json, Load, RigPath, loaded_rig
from sonolube.cli.predict.rig_record import RigRecord
from sonolube.compilation import few_points
from sonolube.rig import contact_point


@few_points()
def contact(rig: RigPath, load: Load = None, changes: Changes = None, json: Json = False) -> None:
    """Contact of the rig at rest: separation, real area, stiffness.

    Example: sonolube contact examples/rigs/poisson_al_steel.toml --load 40N
    """
    known = loaded_rig(rig, load=load, changes=changes)
    deliver(RigRecord(rig=known, result=contact_point(known)), as_json=json)
