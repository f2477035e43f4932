"""Task `contact`: separation, real contact area and stiffness of a rig's contact at rest."""

from typing import Annotated

from sonolube.models.contact.tangential_stiffness import DEFAULT_TANGENTIAL_STIFFNESS, TANGENTIAL_STIFFNESSES
from sonolube.rig import contact_point
from sonolube.tasks.parameters import Parameter, RestingRig, rig_of
from sonolube.tasks.predict.rig_record import RigRecord
from sonolube.tasks.task import task

_STIFFNESS = Parameter(f"Model of the tangential stiffness: {', '.join(TANGENTIAL_STIFFNESSES)}.", "MODEL")


@task
def contact(
    rig: RestingRig, *, tangential_stiffness: Annotated[str, _STIFFNESS] = DEFAULT_TANGENTIAL_STIFFNESS
) -> RigRecord:
    """Contact of the rig at rest: separation, real area, stiffness.

    Example: sonolube contact examples/rigs/poisson_al_steel.toml --load 40N

    Examples
    --------
    >>> import sonolube as sl
    >>> from sonolube.text.units import format_si
    >>> answer = sl.contact("examples/rigs/tribometer.toml")
    >>> format_si(float(answer["normal_stiffness"]), "N/m")  # 3 N over a decay length of 2 um
    '1.5 MN/m'
    """
    known = rig_of(rig)
    return RigRecord(rig=known, result=contact_point(known, tangential_stiffness_model=tangential_stiffness))
