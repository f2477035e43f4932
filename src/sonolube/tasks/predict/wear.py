"""Task `wear`: wear of the softer body of a rig with and without vibration."""

from sonolube.rig import wear_point
from sonolube.tasks.parameters import RigFile, rig_of
from sonolube.tasks.predict.rig_record import RigRecord
from sonolube.tasks.task import task


@task
def wear(rig: RigFile) -> RigRecord:
    """Wear of the rig's softer body with and without vibration.

    Example: sonolube wear examples/rigs/tribometer.toml

    Examples
    --------
    >>> import sonolube as sl
    >>> answer = sl.wear("examples/rigs/tribometer.toml")
    >>> round(float(answer["wear_reduction"]), 2)
    0.47
    """
    known = rig_of(rig)
    return RigRecord(rig=known, result=wear_point(known))
