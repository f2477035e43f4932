"""Collar element of D 4.5: geometry of an inner ring on stacks in an outer ring, and its designs with their sources.

The stacks lie along y, the rod that slides through the inner ring along z. Of the drawings of the parts (D, appendix C)
only the captions are available, so that each dimension is either printed in the text or assumed;
`COLLAR_DIMENSION_SOURCES` lists which.

The first design and its two revisions have stacks above and below the inner ring; the final design has one stack and an
inner ring that is free at the top.
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from enum import StrEnum
from types import MappingProxyType
from typing import Any

import numpy as np

from dong2015.hardware.sizes import SIZES
from sonolube.checks import require_positive
from sonolube.errors import InvalidInput
from sonolube.models.fem import MILLIMETRE, Geometry, bond, cad_kernel, extruded_polygon, single_body

_FAR = 1e3  # in mm, beyond any collar
_FLAT_HALF_WIDTH = 5.5e-3  # of the flats of a round inner ring, in m, assumed
_NUMBERS = ("float", float)


class Outline(StrEnum):
    """Outer contour of the inner ring: a hexagon with two flats on the stacks, or a circle with two such flats."""

    HEXAGON = "hexagon"
    ROUND = "round"


@dataclass(frozen=True, kw_only=True, slots=True)
class Collar:
    """Dimensions of a collar element.

    Parameters
    ----------
    outline : Outline
        Outer contour of the inner ring.
    hole_sides : int
        Number of sides of the bore: 6, or 0 for a circular one.
    stacks : int
        Number of stacks: 1, or 2 on opposite sides of the inner ring.
    frame_length, frame_width, frame_thickness : float
        Extent of the outer ring along the stacks, across them, and along the rod. [m]
    base_thickness : float
        Wall of the outer ring under the stack; with two stacks both walls follow from the other lengths instead. [m]
    top_thickness : float
        Opposite wall of the outer ring, which is removable. [m]
    pillar_width : float
        Width of the two walls beside the inner ring. [m]
    ring_width : float
        Width of the inner ring across the flats on which the stacks stand. [m]
    ring_thickness : float
        Thickness of the inner ring along the rod. [m]
    bore_diameter : float
        Diameter of the bore of the inner ring, across flats where it is a hexagon. [m]
    bolt_diameter : float
        Diameter of the bolt through the stack that has the stiffness of the whole bolt between its ends. [m]
    stack_length, stack_outer_diameter, stack_inner_diameter : float
        Length and diameters of the annular stack. [m]
    frame_material, ring_material : str
        Names of the metals; the bolts are of the metal of the outer ring.

    Raises
    ------
    InvalidInput
        If a dimension is not positive, or parts do not fit into each other.
    """

    outline: Outline
    hole_sides: int
    stacks: int
    frame_length: float
    frame_width: float
    frame_thickness: float
    base_thickness: float
    top_thickness: float
    pillar_width: float
    ring_width: float
    ring_thickness: float
    bore_diameter: float
    bolt_diameter: float
    stack_length: float = 12e-3
    stack_outer_diameter: float = 10e-3
    stack_inner_diameter: float = 5e-3
    frame_material: str = "stainless_steel_304"
    ring_material: str = "stainless_steel_304"

    def __post_init__(self) -> None:
        require_positive(**{name: getattr(self, name) for name in dimension_names()})
        if self.stacks not in (1, 2):
            raise InvalidInput(f"a collar has one or two stacks, got {self.stacks}")
        if self.hole_sides not in (0, 6):
            raise InvalidInput(f"hole_sides must be 6, or 0 for a round hole, got {self.hole_sides}")
        for smaller, larger in (
            ("bolt_diameter", "stack_inner_diameter"),
            ("stack_inner_diameter", "stack_outer_diameter"),
            ("stack_outer_diameter", "seat_width"),
            ("bore_diameter", "ring_width"),
            ("ring_thickness", "frame_thickness"),
            ("stack_outer_diameter", "ring_thickness"),
        ):
            value, limit = getattr(self, smaller), getattr(self, larger)
            if value > limit:
                raise InvalidInput(f"{smaller} must not exceed {larger}, {limit:.4g} m, got {value!r} m")
        if self.base <= 0 or self.clearance < 0:
            raise InvalidInput("stacks and inner ring do not fit into the outer ring's length")
        if self.frame_width - 2 * self.pillar_width <= 2 * self.ring_circumradius:
            raise InvalidInput("the inner ring does not fit between the pillars")

    @property
    def seat_width(self) -> float:
        """Width of the flat on which a stack stands, in m."""
        if self.outline is Outline.HEXAGON:
            return self.ring_width / float(np.sqrt(3.0))
        return 2 * float(np.sqrt(self.ring_circumradius**2 - self.ring_width**2 / 4))

    @property
    def ring_circumradius(self) -> float:
        """Largest distance of the outer contour of the inner ring from its axis, in m."""
        if self.outline is Outline.HEXAGON:
            return self.ring_width / float(np.sqrt(3.0))
        return float(np.hypot(self.ring_width / 2, _FLAT_HALF_WIDTH))

    @property
    def base(self) -> float:
        """Thickness of the wall of the outer ring under the stack, in m."""
        if self.stacks == 1:
            return self.base_thickness
        return (self.frame_length - 2 * self.stack_length - self.ring_width) / 2

    @property
    def top(self) -> float:
        """Thickness of the opposite wall, in m."""
        return self.top_thickness if self.stacks == 1 else self.base

    @property
    def clearance(self) -> float:
        """Gap between the inner ring and the top, in m; zero where a second stack fills it."""
        if self.stacks == 2:
            return 0.0
        return self.frame_length - self.base - self.top - self.stack_length - self.ring_width

    @property
    def bore_height(self) -> float:
        """Height of the axis of the bore above the lower face of the base, in m."""
        return self.base + self.stack_length + self.ring_width / 2


def dimension_names() -> tuple[str, ...]:
    """Names of the lengths among the dimensions of a collar.

    Returns
    -------
    tuple of str
    """
    return tuple(field.name for field in fields(Collar) if field.type in _NUMBERS)


def collar_geometry(collar: Collar, *, open_top: bool = False, whole: bool = False) -> Geometry:
    """Bonded bodies of a collar, with the lower face of its base at y = 0.

    Parameters
    ----------
    collar : Collar
    open_top : bool
        Without the removable top.
    whole : bool
        The whole collar instead of the quarter of positive x and z.

    Returns
    -------
    Geometry
        Regions "frame", "top", "saddle" (the sector of the inner ring under the rod), "ring" (the rest of it), "stack"
        and "bolt", and of a second stack "stack2" and "bolt2". The faces of the bore are "saddle.bore" and "ring.bore".
    """
    occ = cad_kernel()
    kept = occ.Box((-_FAR, -_FAR, -_FAR) if whole else (0, -_FAR, 0), (_FAR, _FAR, _FAR))
    frame, top = _outer_ring(collar)
    saddle, ring = _inner_ring(collar)
    shapes = {"frame": frame, "top": top, "saddle": saddle, "ring": ring}
    if open_top:
        del shapes["top"]
    shapes["stack"], shapes["bolt"] = _stack(collar, foot=collar.base)
    if collar.stacks == 2:
        shapes["stack2"], shapes["bolt2"] = _stack(collar, foot=collar.bore_height + collar.ring_width / 2)
    bodies = {name: single_body(shape * kept, name) for name, shape in shapes.items()}
    for name in ("saddle", "ring"):
        bodies[name].shape.maxh = (collar.ring_width - collar.bore_diameter) / 2 / MILLIMETRE  # of the wall of the ring
        _name_bore(bodies[name], collar)
    return bond(bodies)


def _outer_ring(collar: Collar) -> tuple[Any, Any]:
    """Outer ring without its top, and the top."""
    occ = cad_kernel()
    x, z, wall = (
        size / MILLIMETRE for size in (collar.frame_width / 2, collar.frame_thickness / 2, collar.pillar_width)
    )
    base, shelf, end = (y / MILLIMETRE for y in (collar.base, collar.frame_length - collar.top, collar.frame_length))
    opening = occ.Box((wall - x, base, -_FAR), (x - wall, _FAR, _FAR))
    return occ.Box((-x, 0, -z), (x, shelf, z)) - opening, occ.Box((-x, shelf, -z), (x, end, z))


def _inner_ring(collar: Collar) -> tuple[Any, Any]:
    """Sector of the inner ring that faces the base, and the rest of it."""
    occ = cad_kernel()
    axis, flat, depth = (
        size / MILLIMETRE for size in (collar.bore_height, collar.ring_width / 2, collar.ring_thickness)
    )
    if collar.outline is Outline.HEXAGON:
        outside = _hexagonal_prism(2 * flat, axis, depth)
    else:
        outside = _circular_cylinder(collar.ring_circumradius / MILLIMETRE, axis, depth)
        outside = outside * occ.Box((-_FAR, axis - flat, -_FAR), (_FAR, axis + flat, _FAR))
    bore = collar.bore_diameter / MILLIMETRE
    if collar.hole_sides:
        hole = _hexagonal_prism(bore, axis, 2 * depth)
    else:
        hole = _circular_cylinder(bore / 2, axis, 2 * depth)
    body = outside - hole
    reach = 2 * flat
    corners = [(0.0, axis), (-reach, axis - reach), (reach, axis - reach)]
    wedge = extruded_polygon(corners, foot=-depth, top=depth)
    return body * wedge, body - wedge


def _stack(collar: Collar, *, foot: float) -> tuple[Any, Any]:
    """Annular stack and its bolt, from a height of the foot."""
    occ = cad_kernel()
    y, length = foot / MILLIMETRE, collar.stack_length / MILLIMETRE
    diameters = collar.stack_outer_diameter, collar.stack_inner_diameter, collar.bolt_diameter
    whole, hole, core = (occ.Cylinder(occ.Pnt(0, y, 0), occ.Y, d / 2 / MILLIMETRE, length) for d in diameters)
    return whole - hole, core


def _hexagonal_prism(width: float, axis: float, depth: float) -> Any:
    """Hexagonal prism along z of a width across flats, with its axis at a height y; all in mm."""
    corner, angles = width / np.sqrt(3.0), np.arange(6) * np.pi / 3
    corners = [(corner * np.cos(a), axis + corner * np.sin(a)) for a in angles]
    return extruded_polygon(corners, foot=-depth / 2, top=depth / 2)


def _circular_cylinder(radius: float, axis: float, depth: float) -> Any:
    """Circular cylinder along z with its axis at a height y; all in mm."""
    occ = cad_kernel()
    return occ.Cylinder(occ.Pnt(0, axis, -depth / 2), occ.Z, radius, depth)


def _name_bore(body: Geometry, collar: Collar) -> None:
    """Name the faces of the hole "bore": those within half the wall of the ring."""
    limit = (collar.bore_diameter + collar.ring_width) / 4 / MILLIMETRE
    axis = collar.bore_height / MILLIMETRE
    for face in body.shape.faces:
        low, high = face.bounding_box
        if max(high.x, -low.x, high.y - axis, axis - low.y) < limit:
            face.name = "bore"


_INCH = 0.0254

COLLAR_DIMENSION_SOURCES: Mapping[str, str] = MappingProxyType(SIZES["collar_sources"])
"""Source of each dimension of the designs: `printed` with its place in D, or `assumed`."""

FIRST_COLLAR = Collar(
    outline=Outline.HEXAGON,
    hole_sides=6,
    stacks=2,
    frame_length=3.9 * _INCH,
    frame_width=3.7 * _INCH,
    frame_thickness=_INCH,
    base_thickness=_INCH,
    top_thickness=_INCH,
    pillar_width=0.5 * _INCH,
    ring_width=_INCH,
    ring_thickness=_INCH,
    bore_diameter=0.5 * _INCH,
    bolt_diameter=4e-3,
)
"""First design: two stacks on a hexagonal inner ring with a hexagonal bore."""

THIN_HEXAGON_COLLAR = replace(FIRST_COLLAR, hole_sides=0, bore_diameter=0.75 * _INCH)
"""Revision of the first design: the same ring with a circular bore for the rod of the tests."""

THIN_RING_COLLAR = replace(THIN_HEXAGON_COLLAR, outline=Outline.ROUND)
"""Other revision: a round inner ring with flats for the stacks, of the same wall."""

NOMINAL_COLLAR = replace(THIN_HEXAGON_COLLAR, stacks=1, ring_thickness=0.5 * _INCH)
"""Final design with nominal dimensions: one stack, and round inches for what D does not print."""

ASSUMED_RANGES: Mapping[str, tuple[float, float]] = MappingProxyType(
    {name: (low, high) for name, (low, high) in SIZES["assumed_ranges"].items()}
)
"""Bounds of the assumed dimensions of the final design in m, which leave room for stack, rod and bolt."""

FINAL_COLLAR = replace(
    NOMINAL_COLLAR,
    ring_width=25.49e-3,
    ring_thickness=12.82e-3,
    bolt_diameter=4.11e-3,
    base_thickness=26.01e-3,
    top_thickness=25.11e-3,
    pillar_width=13.76e-3,
)
"""Final design: result of `tuned_collar` from the nominal one within these bounds, for 25 kHz closed, 24.4 kHz open."""
