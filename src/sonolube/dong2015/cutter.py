"""Cutter head of D 4.4: a disc on the bolted stack of the tribometer's actuator.

Its sizes are not printed. With the assumed ones the mode in which the rim of the disc moves against its centre is at
20 kHz.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Final

from sonolube.dong2015.sizes import sized
from sonolube.dong2015.tribometer import TRIBOMETER_ACTUATOR_DIMENSIONS, stack_with_tip
from sonolube.models.fem.mesh.cad import cad_kernel
from sonolube.models.fem.mesh.geometry import bond, single_body
from sonolube.models.fem.parts.tips import hub_disc
from sonolube.models.fem.parts.transducers import SourcedDimension, Transducer
from sonolube.models.fem.solver.model import FixedSupport

_FAR: Final = 1e3  # mm, beyond all bodies

CUTTER_HEAD_DIMENSIONS = (
    *TRIBOMETER_ACTUATOR_DIMENSIONS[:6],  # D 4.4.2: the stack is that of the tribometer
    TRIBOMETER_ACTUATOR_DIMENSIONS[7],
    SourcedDimension(name="back_length", value=32e-3, source="chosen for a resonance at 20 kHz, D Table 4.6"),
    SourcedDimension(name="hub_radius", value=4.5e-3, source="weld nut of 1/4 in"),
    SourcedDimension(name="hub_length", value=6e-3, source="weld nut of 1/4 in"),
    SourcedDimension(name="disc_radius", value=15e-3, source="its rim is to move against its centre, D 4.4.4"),
    SourcedDimension(name="thickness", value=0.8e-3, source="its rim is to move against its centre, D 4.4.4"),
)
"""Dimensions of the cutter head (D 4.4) and their sources; the text prints none but the number of layers."""


@sized((*CUTTER_HEAD_DIMENSIONS[:6], *CUTTER_HEAD_DIMENSIONS[7:5:-1], *CUTTER_HEAD_DIMENSIONS[8:]))  # the back first
def cutter_head(sizes: Mapping[str, Any], *, ceramic: str = "pic255", metal: str = "stainless_steel_304") -> Transducer:
    """Cutter head of D 4.4: a disc glued to the nut of the stack of the tribometer's actuator.

    Parameters
    ----------
    outer_radius, inner_radius : float
        Radii of the layers. [m]
    length : float
        Total length of the layers. [m]
    stack_layers : float
        Number of layers. []
    rod_radius : float
        Radius of the rod through the stack. [m]
    washer_radius : float
        Radius of the end masses, each of washer and nut in one. [m]
    back_length, front_length : float
        Lengths of the end masses. [m]
    hub_radius : float
        Radius of the weld nut. [m]
    hub_length : float
        Length of the weld nut. [m]
    disc_radius : float
        Radius of the cutter disc. [m]
    thickness : float
        Thickness of the cutter disc. [m]
    ceramic, metal : str
        Names of the materials.

    Returns
    -------
    Transducer

    Raises
    ------
    InvalidInput
        If a size does not fit.

    Notes
    -----
    `CUTTER_HEAD_DIMENSIONS` lists what the sizes are inferred from. The disc is plain: its cutting slots are neglected.

    References
    ----------
    .. [1] D 4.4.2 to 4.4.4.
    """
    disc = hub_disc(**{name: sizes[name] for name in ("hub_radius", "hub_length", "disc_radius", "thickness")})
    made = stack_with_tip(disc, sizes, ceramic=ceramic, metal=metal)
    return replace(made, dimensions=CUTTER_HEAD_DIMENSIONS)


def cutter_head_quarter() -> Transducer:
    """Quarter of the cutter head of default sizes, of positive x and y.

    Its modes are those of the head that are even about both planes, among them all axisymmetric ones, in a third of the
    time.
    """
    whole = cutter_head()
    quadrant = cad_kernel().Box((0, 0, -_FAR), (_FAR, _FAR, _FAR))
    solids = zip(whole.geometry.regions, whole.geometry.shape.solids, strict=True)
    return replace(
        whole,
        geometry=bond({name: single_body(solid * quadrant, name) for name, solid in solids}),
        fixed=tuple(
            FixedSupport(face=f"{region}.-{plane}", along=plane) for region in whole.geometry.regions for plane in "xy"
        ),
        copies=4,
    )
