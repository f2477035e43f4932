"""Actuator of the modified pin-on-disc tribometer, D 2.3.1: a bolted stack with an acorn nut as its pin.

Few of its sizes are printed. The assumed ones are those of common hardware about a rod of 1/4 in, chosen for the mass
and capacitance of D Table 3.5.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from sonolube.dong2015.sizes import sized
from sonolube.models.fem.mesh.geometry import Geometry
from sonolube.models.fem.parts.tips import acorn_nut
from sonolube.models.fem.parts.transducers import SourcedDimension, Transducer, stack_bodies, stack_from_bodies

_OF_STACK = ("outer_radius", "inner_radius", "length", "rod_radius", "back_length", "front_length", "washer_radius")
TRIBOMETER_ACTUATOR_DIMENSIONS = (
    SourcedDimension(name="outer_radius", value=9.5e-3, source="360 nF and 62 layers of D Table 3.5 with PIC255"),
    SourcedDimension(name="inner_radius", value=4e-3, source="bore that a rod of 1/4 in passes"),
    SourcedDimension(name="length", value=38.6e-3, source="70 g of D Table 3.5 with PIC255"),
    SourcedDimension(name="stack_layers", value=62.0, printed=True, source="D Table 3.5"),
    SourcedDimension(name="rod_radius", value=2.7e-3, source="root of a 1/4-20 thread; 3 in long in D A.1.3"),
    SourcedDimension(name="washer_radius", value=8e-3, source="washer for 1/4 in"),
    SourcedDimension(name="back_length", value=18e-3, source="washer, nuts and the end of the gimbal's arm"),
    SourcedDimension(name="front_length", value=7.2e-3, source="washer and nut of 1/4 in"),
    SourcedDimension(name="width", value=11.1e-3, source="acorn nut of 1/4 in, 7/16 in across flats"),
    SourcedDimension(name="nut_length", value=6.6e-3, source="hexagon of an acorn nut of 1/4 in"),
    SourcedDimension(name="tip_radius", value=5e-3, source="dome of an acorn nut of 1/4 in"),
    SourcedDimension(name="contact_radius", value=0.8e-3, source="worn flat of 2 mm2 in D 2.4.3"),
)
"""Dimensions of the tribometer's actuator (D 2.3.1, appendix A) and their sources; the text prints few of them."""


@sized(TRIBOMETER_ACTUATOR_DIMENSIONS)
def tribometer_actuator(
    sizes: Mapping[str, Any], *, ceramic: str = "pic255", metal: str = "stainless_steel_316"
) -> Transducer:
    """Actuator of the modified pin-on-disc tribometer, D 2.3.1: a bolted stack with an acorn nut as its pin.

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
    width : float
        Width of the acorn nut across flats. [m]
    nut_length : float
        Length of the hexagon of the nut. [m]
    tip_radius : float
        Radius of the dome of the nut. [m]
    contact_radius : float
        Radius of the flat on the dome. [m]
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
    `TRIBOMETER_ACTUATOR_DIMENSIONS` lists which sizes are printed. The gimbal's arm is neglected, except for the mass
    bolted to it.

    References
    ----------
    .. [1] D 2.3.1, Table 3.5, A.1.3.
    """
    nut = acorn_nut(
        width=sizes["width"],
        length=sizes["nut_length"],
        tip_radius=sizes["tip_radius"],
        contact_radius=sizes["contact_radius"],
    )
    made = stack_with_tip(nut, sizes, ceramic=ceramic, metal=metal)
    return replace(made, dimensions=TRIBOMETER_ACTUATOR_DIMENSIONS)


def stack_with_tip(tip: Geometry, sizes: Mapping[str, Any], *, ceramic: str, metal: str) -> Transducer:
    """Bolted stack between end masses of washer and nut in one, with a tip."""
    bodies = stack_bodies(**{name: sizes[name] for name in _OF_STACK}, tip=tip)
    return stack_from_bodies(bodies, stack_layers=sizes["stack_layers"], ceramic=ceramic, metal=metal)
