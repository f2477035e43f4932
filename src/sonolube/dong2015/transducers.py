"""The actuators of D whose finite elements go beyond a stack: the tribometer's with its acorn nut, and the cutter head.

Few of their sizes are printed. Each default is listed with what it was read or assumed from; the assumed ones stand for
common hardware about a rod of 1/4 in and for the mass and capacitance of D Table 3.5.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from sonolube.checks import require_positive
from sonolube.errors import InvalidInput
from sonolube.fem.parts.bodies import body_of_revolution, hexagon
from sonolube.fem.parts.transducers import SourcedDimension, Transducer, stack_bodies, stack_from_bodies
from sonolube.fem.solver.cad import MILLIMETRE
from sonolube.fem.solver.geometry import Geometry, single_body

_ELEMENT_WIDTH = 2.5  # of a disc's thickness

TRIBOMETER_ACTUATOR_DIMENSIONS = (
    SourcedDimension(
        name="outer_radius", value=9.5e-3, printed=False, source="360 nF and 62 layers of D Table 3.5 with PIC255"
    ),
    SourcedDimension(name="inner_radius", value=4e-3, printed=False, source="bore that a rod of 1/4 in passes"),
    SourcedDimension(name="length", value=38.6e-3, printed=False, source="70 g of D Table 3.5 with PIC255"),
    SourcedDimension(name="stack_layers", value=62.0, printed=True, source="D Table 3.5"),
    SourcedDimension(
        name="rod_radius", value=2.7e-3, printed=False, source="root of a 1/4-20 thread; 3 in long in D A.1.3"
    ),
    SourcedDimension(name="washer_radius", value=8e-3, printed=False, source="washer for 1/4 in"),
    SourcedDimension(
        name="back_length", value=18e-3, printed=False, source="washer, nuts and the end of the gimbal's arm"
    ),
    SourcedDimension(name="front_length", value=7.2e-3, printed=False, source="washer and nut of 1/4 in"),
    SourcedDimension(name="width", value=11.1e-3, printed=False, source="acorn nut of 1/4 in, 7/16 in across flats"),
    SourcedDimension(name="nut_length", value=6.6e-3, printed=False, source="hexagon of an acorn nut of 1/4 in"),
    SourcedDimension(name="tip_radius", value=5e-3, printed=False, source="dome of an acorn nut of 1/4 in"),
    SourcedDimension(name="contact_radius", value=0.8e-3, printed=False, source="worn flat of 2 mm2 in D 2.4.3"),
)
"""Sizes of the tribometer's actuator, D 2.3.1 and appendix A, of which the text prints few."""


def tribometer_actuator(
    *,
    outer_radius: float = 9.5e-3,
    inner_radius: float = 4e-3,
    length: float = 38.6e-3,
    stack_layers: float = 62.0,
    rod_radius: float = 2.7e-3,
    washer_radius: float = 8e-3,
    back_length: float = 18e-3,
    front_length: float = 7.2e-3,
    width: float = 11.1e-3,
    nut_length: float = 6.6e-3,
    tip_radius: float = 5e-3,
    contact_radius: float = 0.8e-3,
    ceramic: str = "pic255",
    metal: str = "stainless_steel_316",
) -> Transducer:
    """Return the actuator of the modified pin-on-disc tribometer: a bolted stack with an acorn nut as its pin.

    Parameters
    ----------
    outer_radius, inner_radius : float
        Radii of the layers. [m]
    length : float
        Length of the stack. [m]
    stack_layers : float
        Number of layers. []
    rod_radius : float
        Radius of the rod through the stack. [m]
    washer_radius : float
        Radius of the end masses, washer and nut in one. [m]
    back_length, front_length : float
        Lengths of the end masses. [m]
    width : float
        Width of the acorn nut across flats. [m]
    nut_length : float
        Length of its hexagon. [m]
    tip_radius : float
        Radius of its dome. [m]
    contact_radius : float
        Radius of the flat on its dome. [m]
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
    `TRIBOMETER_ACTUATOR_DIMENSIONS` lists which sizes are printed. The gimbal's arm is left out, but for the mass bolted
    to it.

    References
    ----------
    .. [1] D 2.3.1, Table 3.5, A.1.3.
    """
    nut = acorn_nut(width=width, length=nut_length, tip_radius=tip_radius, contact_radius=contact_radius)
    parts = stack_bodies(
        outer_radius=outer_radius,
        inner_radius=inner_radius,
        length=length,
        rod_radius=rod_radius,
        back_length=back_length,
        front_length=front_length,
        washer_radius=washer_radius,
        tip=nut,
    )
    made = stack_from_bodies(parts, stack_layers=stack_layers, ceramic=ceramic, metal=metal)
    return replace(made, dimensions=TRIBOMETER_ACTUATOR_DIMENSIONS)


CUTTER_HEAD_DIMENSIONS = (
    *TRIBOMETER_ACTUATOR_DIMENSIONS[:6],  # D 4.4.2: the stack is that of the tribometer
    TRIBOMETER_ACTUATOR_DIMENSIONS[7],
    SourcedDimension(
        name="back_length", value=32e-3, printed=False, source="puts the resonance at 20 kHz, D Table 4.6"
    ),
    SourcedDimension(name="hub_radius", value=4.5e-3, printed=False, source="weld nut of 1/4 in"),
    SourcedDimension(name="hub_length", value=6e-3, printed=False, source="weld nut of 1/4 in"),
    SourcedDimension(
        name="disc_radius", value=15e-3, printed=False, source="its rim moves against its centre, D 4.4.4"
    ),
    SourcedDimension(name="thickness", value=0.8e-3, printed=False, source="its rim moves against its centre, D 4.4.4"),
)
"""Sizes of the cutter head, D 4.4, of which the text prints none."""


def cutter_head(
    *,
    outer_radius: float = 9.5e-3,
    inner_radius: float = 4e-3,
    length: float = 38.6e-3,
    stack_layers: float = 62.0,
    rod_radius: float = 2.7e-3,
    washer_radius: float = 8e-3,
    back_length: float = 32e-3,
    front_length: float = 7.2e-3,
    hub_radius: float = 4.5e-3,
    hub_length: float = 6e-3,
    disc_radius: float = 15e-3,
    thickness: float = 0.8e-3,
    ceramic: str = "pic255",
    metal: str = "stainless_steel_304",
) -> Transducer:
    """Return the cutter head of D 4.4: a disc glued to the nut of the tribometer's stack.

    Parameters
    ----------
    outer_radius, inner_radius : float
        Radii of the layers. [m]
    length : float
        Length of the stack. [m]
    stack_layers : float
        Number of layers. []
    rod_radius : float
        Radius of the rod through the stack. [m]
    washer_radius : float
        Radius of the end masses, washer and nut in one. [m]
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
    `CUTTER_HEAD_DIMENSIONS` says that no size is printed. The disc is plain: the slots that cut are left out.

    References
    ----------
    .. [1] D 4.4.2 to 4.4.4.
    """
    head = hub_disc(hub_radius=hub_radius, hub_length=hub_length, disc_radius=disc_radius, thickness=thickness)
    parts = stack_bodies(
        outer_radius=outer_radius,
        inner_radius=inner_radius,
        length=length,
        rod_radius=rod_radius,
        back_length=back_length,
        front_length=front_length,
        washer_radius=washer_radius,
        tip=head,
    )
    made = stack_from_bodies(parts, stack_layers=stack_layers, ceramic=ceramic, metal=metal)
    return replace(made, dimensions=CUTTER_HEAD_DIMENSIONS)


def acorn_nut(*, width: float, length: float, tip_radius: float, contact_radius: float) -> Geometry:
    """Return a solid acorn nut along z: a hexagon from z = 0 and a dome with a small flat on top.

    Parameters
    ----------
    width : float
        Width across flats. [m]
    length : float
        Length of the hexagon. [m]
    tip_radius : float
        Radius of the dome. [m]
    contact_radius : float
        Radius of the flat on the dome. [m]

    Returns
    -------
    Geometry

    Raises
    ------
    InvalidInput
        If a size is not positive, the dome wider than the hexagon or the flat wider than the dome.
    """
    require_positive(width=width, length=length, tip_radius=tip_radius, contact_radius=contact_radius)
    if not contact_radius < tip_radius <= width / 2:
        raise InvalidInput(
            f"contact_radius, tip_radius and half the width must rise, got {contact_radius!r}, {tip_radius!r} and "
            f"{width / 2!r} m"
        )
    angle = np.linspace(np.arcsin(contact_radius / tip_radius), np.pi / 2, 9)[::-1]
    sphere = [(length + tip_radius * float(np.cos(a)), tip_radius * float(np.sin(a))) for a in angle]
    dome = body_of_revolution([(0.0, tip_radius), *sphere], "dome", smooth=(2, 2 + angle.size))
    return single_body(hexagon(width=width, length=length).shape + dome.shape, "nut")


def hub_disc(*, hub_radius: float, hub_length: float, disc_radius: float, thickness: float) -> Geometry:
    """Return a disc on a hub along z, from the foot of the hub at z = 0.

    Parameters
    ----------
    hub_radius : float
        Radius of the hub. [m]
    hub_length : float
        Length of the hub. [m]
    disc_radius : float
        Radius of the disc. [m]
    thickness : float
        Thickness of the disc. [m]

    Returns
    -------
    Geometry

    Raises
    ------
    InvalidInput
        If a size is not positive or the hub is not the thinner.
    """
    require_positive(hub_radius=hub_radius, hub_length=hub_length, disc_radius=disc_radius, thickness=thickness)
    if hub_radius >= disc_radius:
        raise InvalidInput(f"hub_radius must be below disc_radius {disc_radius!r} m, got {hub_radius!r} m")
    top = hub_length + thickness
    outline = [(0.0, hub_radius), (hub_length, hub_radius), (hub_length, disc_radius), (top, disc_radius)]
    head = body_of_revolution(outline, "head")
    for part in (*head.shape.solids, *head.shape.faces):  # it bends, which wide elements would resist
        part.maxh = _ELEMENT_WIDTH * thickness / MILLIMETRE
    return head


DONG_2015_TRANSDUCERS: Mapping[str, Callable[..., Transducer]] = {
    "cutter_head": cutter_head,
    "tribometer_actuator": tribometer_actuator,
}
"""The dissertation's transducers by name; `sonolube.fem.TRANSDUCERS` has the general ones."""
