"""Parametric bodies: blocks, bars, rings, hexagons, horns, boosters and working ends, as solids of the CAD kernel."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from sonolube.checks import require_non_negative, require_positive
from sonolube.errors import InvalidInput
from sonolube.models.fem.mesh.geometry import MILLIMETRE, Geometry, cad_kernel, single_body


@dataclass(frozen=True, kw_only=True, slots=True)
class Slot:
    """Rectangular slot through the thickness of a block.

    Parameters
    ----------
    centre : tuple of two float
        Its centre in the x-y plane relative to that of the block, in m.
    length : float
        Extent along x. [m]
    width : float
        Extent along y. [m]

    Raises
    ------
    InvalidInput
        If a length or width is not positive.
    """

    centre: tuple[float, float] = (0.0, 0.0)
    length: float
    width: float

    def __post_init__(self) -> None:
        require_positive(length=self.length, width=self.width)


def block(
    *,
    length: float,
    width: float,
    thickness: float,
    end_width: float | None = None,
    edge_radius: float = 0.0,
    slots: Sequence[Slot] = (),
) -> Geometry:
    """Rectangular block centred on the origin, optionally tapered in width, slotted and with rounded edges.

    Parameters
    ----------
    length, width, thickness : float
        Extent along x, y and z. [m]
    end_width : float, optional
        Width at +x, to which the width at -x tapers linearly; no taper where absent. [m]
    edge_radius : float
        Radius of all outer edges. [m]
    slots : sequence of Slot
        Slots through the thickness.

    Returns
    -------
    Geometry

    Raises
    ------
    InvalidInput
        If a size is not positive, the radius too large, or the slots divide the block.
    """
    end = width if end_width is None else end_width
    require_positive(length=length, width=width, thickness=thickness, end_width=end)
    require_non_negative(edge_radius=edge_radius)
    if 2 * edge_radius >= min(length, width, end, thickness):
        raise InvalidInput(f"edge_radius must be below half the smallest size, got {edge_radius!r} m")
    x, half, end_half, z = (size / MILLIMETRE / 2 for size in (length, width, end, thickness))
    occ = cad_kernel()
    shape = extruded_polygon([(-x, -half), (x, -end_half), (x, end_half), (-x, half)], foot=-z, top=z)
    if edge_radius:
        shape = _filleted(shape, shape.edges, edge_radius)
    for slot in slots:
        a, b = (size / MILLIMETRE / 2 for size in (slot.length, slot.width))
        cx, cy = (coordinate / MILLIMETRE for coordinate in slot.centre)
        shape = shape - occ.Box((cx - a, cy - b, -2 * z), (cx + a, cy + b, 2 * z))
    return single_body(shape, "block")


def cylinder(*, radius: float, length: float) -> Geometry:
    """Circular cylinder along z from z = 0.

    Parameters
    ----------
    radius : float
        Radius. [m]
    length : float
        Extent along z. [m]

    Returns
    -------
    Geometry
    """
    require_positive(radius=radius, length=length)
    return body_of_revolution([(0.0, radius), (length, radius)], "cylinder")


def ring(*, outer_radius: float, inner_radius: float, length: float) -> Geometry:
    """Ring or tube along z from z = 0.

    Parameters
    ----------
    outer_radius, inner_radius : float
        Outer and inner radius. [m]
    length : float
        Extent along z. [m]

    Returns
    -------
    Geometry

    Raises
    ------
    InvalidInput
        If a size is not positive or the wall has no thickness.
    """
    require_positive(outer_radius=outer_radius, inner_radius=inner_radius, length=length)
    if inner_radius >= outer_radius:
        raise InvalidInput(f"the wall has no thickness: inner_radius {inner_radius!r} m, outer {outer_radius!r} m")
    solid = cylinder(radius=outer_radius, length=length).shape
    return single_body(solid - cylinder(radius=inner_radius, length=length).shape, "ring")


def hexagon(*, width: float, length: float, inner_radius: float = 0.0) -> Geometry:
    """Hexagonal bar along z from z = 0, optionally with a circular hole.

    Parameters
    ----------
    width : float
        Width across flats, one pair of which is normal to y. [m]
    length : float
        Extent along z. [m]
    inner_radius : float
        Radius of the hole; zero for none. [m]

    Returns
    -------
    Geometry

    Raises
    ------
    InvalidInput
        If a size is not positive or the hole meets the flats.
    """
    require_positive(width=width, length=length)
    require_non_negative(inner_radius=inner_radius)
    if 2 * inner_radius >= width:
        raise InvalidInput(
            f"the wall has no thickness: inner_radius {inner_radius!r} m, width {width!r} m across flats"
        )
    corner, angles = width / MILLIMETRE / np.sqrt(3), np.arange(6) * np.pi / 3
    corners = [(corner * np.cos(angle), corner * np.sin(angle)) for angle in angles]
    shape = extruded_polygon(corners, foot=0.0, top=length / MILLIMETRE)
    if inner_radius:
        shape = shape - cylinder(radius=inner_radius, length=length).shape
    return single_body(shape, "hexagon")


def stepped_horn(
    *, radius: float, end_radius: float, length: float, end_length: float, edge_radius: float = 0.0
) -> Geometry:
    """Stepped horn along z: two coaxial cylinders, the thick one from z = 0.

    Parameters
    ----------
    radius, end_radius : float
        Radii of the thick and the thin part. [m]
    length, end_length : float
        Lengths of the thick and the thin part. [m]
    edge_radius : float
        Radius of the fillet between them; zero for a sharp corner, at which the stress is singular. [m]

    Returns
    -------
    Geometry

    Raises
    ------
    InvalidInput
        If a size is not positive, the second part is not the thinner or the fillet does not fit.
    """
    require_positive(radius=radius, end_radius=end_radius, length=length, end_length=end_length)
    require_non_negative(edge_radius=edge_radius)
    if end_radius >= radius:
        raise InvalidInput(f"end_radius must be below radius {radius!r} m, got {end_radius!r} m")
    if edge_radius >= min(radius - end_radius, end_length):
        raise InvalidInput(f"edge_radius must be below the step and the thin part's length, got {edge_radius!r} m")
    total = length + end_length
    step = [(0.0, radius), (length, radius), (length, end_radius + edge_radius)]
    if not edge_radius:
        return body_of_revolution([*step, (total, end_radius)], "horn")
    angle = np.linspace(0.0, np.pi / 2, 9)[1:]
    fillet = zip(
        length + edge_radius * (1 - np.cos(angle)), end_radius + edge_radius * (1 - np.sin(angle)), strict=True
    )
    return body_of_revolution([*step, *fillet, (total, end_radius)], "horn", smooth=(3, 4 + angle.size))


def conical_horn(*, radius: float, end_radius: float, length: float) -> Geometry:
    """Conical horn along z from z = 0.

    Parameters
    ----------
    radius, end_radius : float
        Radii at z = 0 and at the end. [m]
    length : float
        Extent along z. [m]

    Returns
    -------
    Geometry
    """
    require_positive(radius=radius, end_radius=end_radius, length=length)
    return body_of_revolution([(0.0, radius), (length, end_radius)], "horn")


def exponential_horn(*, radius: float, end_radius: float, length: float) -> Geometry:
    """Exponential horn along z from z = 0, interpolated by a spline through 17 points.

    Parameters
    ----------
    radius, end_radius : float
        Radii at z = 0 and at the end. [m]
    length : float
        Extent along z. [m]

    Returns
    -------
    Geometry
    """
    require_positive(radius=radius, end_radius=end_radius, length=length)
    z = np.linspace(0.0, length, 17)
    radii = radius * (end_radius / radius) ** (z / length)
    return body_of_revolution(list(zip(z, radii, strict=True)), "horn", smooth=(1, 1 + z.size))


def booster(
    *, radius: float, end_radius: float, length: float, end_length: float, flange_radius: float, flange_thickness: float
) -> Geometry:
    """Booster along z: a stepped bar with a mounting flange at its step.

    Parameters
    ----------
    radius, end_radius : float
        Radii below and above the flange. [m]
    length, end_length : float
        Lengths below and above the flange. [m]
    flange_radius : float
        Radius of the flange. [m]
    flange_thickness : float
        Extent of the flange along z. [m]

    Returns
    -------
    Geometry

    Raises
    ------
    InvalidInput
        If a size is not positive or the flange is not the widest part.
    """
    require_positive(radius=radius, end_radius=end_radius, length=length, end_length=end_length)
    require_positive(flange_radius=flange_radius, flange_thickness=flange_thickness)
    if flange_radius <= max(radius, end_radius):
        raise InvalidInput(f"flange_radius must exceed both radii, got {flange_radius!r} m")
    top = length + flange_thickness
    outline = [(0.0, radius), (length, radius), (length, flange_radius), (top, flange_radius)]
    return body_of_revolution([*outline, (top, end_radius), (top + end_length, end_radius)], "booster")


PARTS: Mapping[str, Callable[..., Geometry]] = {
    body.__name__: body
    for body in (block, booster, conical_horn, cylinder, exponential_horn, hexagon, ring, stepped_horn)
}
"""The parametric bodies by name."""


def extruded_polygon(corners: Iterable[tuple[float, float]], *, foot: float, top: float) -> Any:
    """Prism along z in the CAD kernel.

    Parameters
    ----------
    corners : iterable of tuple of float
        Corners of its cross-section in the x-y plane, in mm.
    foot, top : float
        Ends along z, in mm.

    Returns
    -------
    shape of the CAD kernel
        Made a body by `single_body`.

    Raises
    ------
    MissingPackage
        If netgen is not installed.
    """
    occ = cad_kernel()
    first, *others = ((float(x), float(y)) for x, y in corners)
    outline = occ.WorkPlane(occ.Axes((0, 0, foot), n=occ.Z, h=occ.X)).MoveTo(*first)
    for corner in others:
        outline = outline.LineTo(*corner)
    return outline.Close().Face().Extrude(top - foot)


def body_of_revolution(outline: list[tuple[float, float]], name: str, smooth: tuple[int, int] = (0, 0)) -> Geometry:
    """Solid of revolution about z of an outline of straight segments and one spline."""
    occ = cad_kernel()
    points = [occ.Pnt(float(r) / MILLIMETRE, 0.0, float(z) / MILLIMETRE) for z, r in outline]
    corners = [occ.Pnt(0, 0, points[0].z), *points, occ.Pnt(0, 0, points[-1].z)]
    begin, end = smooth
    edges = [occ.Segment(one, other) for one, other in pairwise(corners[: begin + 1] if end else corners)]
    if end:
        edges += [occ.SplineInterpolation(corners[begin:end])]
        edges += [occ.Segment(one, other) for one, other in pairwise(corners[end - 1 :])]
    wire = occ.Wire([*edges, occ.Segment(corners[-1], corners[0])])
    return single_body(occ.Face(wire).Revolve(occ.Axis((0, 0, 0), occ.Z), 360), name)


def _filleted(shape: Any, edges: Any, radius: float) -> Any:
    """Shape with fillets of a radius in m on edges."""
    try:
        return shape.MakeFillet(list(edges), radius / MILLIMETRE)
    except Exception:  # the kernel raises no narrower class
        raise InvalidInput(f"edge_radius {radius!r} m does not fit this body") from None


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
