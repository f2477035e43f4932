"""Command `wear`: wear of the softer body of a rig with and without vibration."""

from sonolube.cli.console.answer import deliver
from sonolube.cli.console.options import Amplitude, Changes, Json, Load, RigPath, loaded_rig
from sonolube.cli.predict.rig_record import RigRecord
from sonolube.compilation import few_points
from sonolube.rig import wear_point


@few_points()
def wear(
    rig: RigPath, load: Load = None, amplitude: Amplitude = None, changes: Changes = None, json: Json = False
) -> None:
    """Wear of the rig's softer body with and without vibration.

    Example: sonolube wear examples/rigs/tribometer.toml
    """
    known = loaded_rig(rig, load=load, changes=changes, amplitude=amplitude)
    deliver(RigRecord(rig=known, result=wear_point(known)), as_json=json)
