"""Bodies for the working end of a transducer: an acorn nut and a disc on a hub."""

import numpy as np

from sonolube.checks import require_positive
from sonolube.errors import InvalidInput
from sonolube.models.fem.mesh.cad import MILLIMETRE
from sonolube.models.fem.mesh.geometry import Geometry, single_body
from sonolube.models.fem.parts.bodies import body_of_revolution, hexagon

_ELEMENT_WIDTH = 2.5  # of the largest element in a disc, over its thickness


def acorn_nut(*, width: float, length: float, tip_radius: float, contact_radius: float) -> Geometry:
    """Solid acorn nut along z: a hexagonal prism from z = 0 and a spherical dome with a small flat on top.

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
    """Disc on a cylindrical hub along z, the foot of the hub at z = 0, meshed finely enough to bend.

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
        If a size is not positive or the hub not narrower than the disc.
    """
    require_positive(hub_radius=hub_radius, hub_length=hub_length, disc_radius=disc_radius, thickness=thickness)
    if hub_radius >= disc_radius:
        raise InvalidInput(f"hub_radius must be below disc_radius {disc_radius!r} m, got {hub_radius!r} m")
    top = hub_length + thickness
    outline = [(0.0, hub_radius), (hub_length, hub_radius), (hub_length, disc_radius), (top, disc_radius)]
    disc = body_of_revolution(outline, "head")
    for part in (*disc.shape.solids, *disc.shape.faces):  # wide elements would be too stiff in bending
        part.maxh = _ELEMENT_WIDTH * thickness / MILLIMETRE
    return disc
