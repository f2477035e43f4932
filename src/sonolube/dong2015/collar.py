"""The collar with variable friction, D 4.5: an inner ring on one or two piezoelectric stacks in an outer ring.

The stacks lie along y, the rod that slides through the inner ring along z. Drawings of the parts (D, appendix C) came
along as captions only, so that each dimension is either printed in the text or assumed: `COLLAR_ORIGINS` says which.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from enum import StrEnum
from typing import Any

import numpy as np

from sonolube.checks import require_positive
from sonolube.errors import InvalidInput
from sonolube.fem.solver.cad import MILLIMETRE, cad_kernel
from sonolube.fem.solver.geometry import Geometry, bond, single_body

_FAR = 1e3  # in mm, beyond any collar
_NUMBERS = ("float", float)


class Outline(StrEnum):
    """Outside of an inner ring: a hexagon with two flats on the stacks, or a circle with two flats cut for them."""

    HEXAGON = "hexagon"
    ROUND = "round"


@dataclass(frozen=True, kw_only=True, slots=True)
class Collar:
    """Dimensions of a collar.

    Parameters
    ----------
    outline : Outline
        Outside of the inner ring.
    hole_sides : int
        Sides of the hole: 6, or 0 for a round one.
    stacks : int
        1, or 2 for one on either side of the inner ring.
    frame_length, frame_width, frame_thickness : float
        Outer ring: extent along the stacks, across them, and along the rod. [m]
    base_thickness : float
        Wall of the outer ring that the stack stands on; of a collar with two stacks both are what the length leaves.
        [m]
    top_thickness : float
        The opposite wall, which can be taken off. [m]
    pillar_width : float
        The two walls beside the inner ring. [m]
    ring_width : float
        Inner ring across the flats on which the stacks stand. [m]
    ring_thickness : float
        Inner ring along the rod. [m]
    bore_diameter : float
        Hole of the inner ring, across flats where it has sides. [m]
    bolt_diameter : float
        Bolt through the stack, which stands for the stiffness of the whole bolt between its ends. [m]
    stack_length, stack_outer_diameter, stack_inner_diameter : float
        The ring-shaped stack. [m]
    frame_material, ring_material : str
        Names of metals; the bolts are of the frame's.

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
        if self.frame_width - 2 * self.pillar_width <= 2 * self.ring_reach:
            raise InvalidInput("the inner ring does not fit between the pillars")

    @property
    def seat_width(self) -> float:
        """Width of the flat a stack stands on, in m."""
        if self.outline is Outline.HEXAGON:
            return self.ring_width / float(np.sqrt(3.0))
        return 2 * float(np.sqrt(self.ring_reach**2 - self.ring_width**2 / 4))

    @property
    def ring_reach(self) -> float:
        """Largest distance of the inner ring's outside from its middle, in m; flats of round rings are 11 mm wide."""
        if self.outline is Outline.HEXAGON:
            return self.ring_width / float(np.sqrt(3.0))
        return float(np.hypot(self.ring_width / 2, 5.5e-3))

    @property
    def base(self) -> float:
        """Thickness of the wall under the stack, in m."""
        if self.stacks == 1:
            return self.base_thickness
        return (self.frame_length - 2 * self.stack_length - self.ring_width) / 2

    @property
    def top(self) -> float:
        """Thickness of the opposite wall, in m."""
        return self.top_thickness if self.stacks == 1 else self.base

    @property
    def clearance(self) -> float:
        """Distance between inner ring and top, in m; zero where a stack fills it."""
        if self.stacks == 2:
            return 0.0
        return self.frame_length - self.base - self.top - self.stack_length - self.ring_width

    @property
    def middle(self) -> float:
        """Height of the bore's axis above the base's lower face, in m."""
        return self.base + self.stack_length + self.ring_width / 2


def dimension_names() -> tuple[str, ...]:
    """Return the names of a collar's lengths."""
    return tuple(field.name for field in fields(Collar) if field.type in _NUMBERS)


def collar_geometry(collar: Collar, *, open_top: bool = False, whole: bool = False) -> Geometry:
    """Return the bonded parts of a collar, the lower face of its base at y = 0.

    Parameters
    ----------
    collar : Collar
    open_top : bool
        Without its top.
    whole : bool
        All of it; else the quarter of positive x and z.

    Returns
    -------
    Geometry
        Regions "frame", "top", "saddle", the quarter of the inner ring under the rod, "ring", its rest, "stack" and
        "bolt", of a second stack "stack2" and "bolt2". Faces of the bore are "saddle.bore" and "ring.bore".
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
        shapes["stack2"], shapes["bolt2"] = _stack(collar, foot=collar.middle + collar.ring_width / 2)
    bodies = {name: single_body(shape * kept, name) for name, shape in shapes.items()}
    for name in ("saddle", "ring"):
        bodies[name].shape.maxh = (collar.ring_width - collar.bore_diameter) / 2 / MILLIMETRE  # elements like the wall
        _name_bore(bodies[name], collar)
    return bond(bodies)


def _outer_ring(collar: Collar) -> tuple[Any, Any]:
    occ = cad_kernel()
    x, z, wall = (
        size / MILLIMETRE for size in (collar.frame_width / 2, collar.frame_thickness / 2, collar.pillar_width)
    )
    base, shelf, end = (y / MILLIMETRE for y in (collar.base, collar.frame_length - collar.top, collar.frame_length))
    opening = occ.Box((wall - x, base, -_FAR), (x - wall, _FAR, _FAR))
    return occ.Box((-x, 0, -z), (x, shelf, z)) - opening, occ.Box((-x, shelf, -z), (x, end, z))


def _inner_ring(collar: Collar) -> tuple[Any, Any]:
    """Return the quarter of the inner ring that faces the base, and the rest."""
    occ = cad_kernel()
    middle, flat, depth = (size / MILLIMETRE for size in (collar.middle, collar.ring_width / 2, collar.ring_thickness))
    if collar.outline is Outline.HEXAGON:
        outside = _hexagon(2 * flat, middle, depth)
    else:
        outside = _bar(collar.ring_reach / MILLIMETRE, middle, depth)
        outside = outside * occ.Box((-_FAR, middle - flat, -_FAR), (_FAR, middle + flat, _FAR))
    bore = collar.bore_diameter / MILLIMETRE
    body = outside - (_hexagon(bore, middle, 2 * depth) if collar.hole_sides else _bar(bore / 2, middle, 2 * depth))
    reach = 2 * flat
    wedge = _extruded([(0.0, middle), (-reach, middle - reach), (reach, middle - reach)], 2 * depth)
    return body * wedge, body - wedge


def _stack(collar: Collar, *, foot: float) -> tuple[Any, Any]:
    occ = cad_kernel()
    outer, inner, bolt, length, y = (
        size / MILLIMETRE
        for size in (
            collar.stack_outer_diameter / 2,
            collar.stack_inner_diameter / 2,
            collar.bolt_diameter / 2,
            collar.stack_length,
            foot,
        )
    )
    whole, hole, core = (occ.Cylinder(occ.Pnt(0, y, 0), occ.Y, radius, length) for radius in (outer, inner, bolt))
    return whole - hole, core


def _hexagon(width: float, middle: float, depth: float) -> Any:
    corner, angles = width / np.sqrt(3.0), np.arange(6) * np.pi / 3
    return _extruded([(corner * np.cos(a), middle + corner * np.sin(a)) for a in angles], depth)


def _bar(radius: float, middle: float, depth: float) -> Any:
    occ = cad_kernel()
    return occ.Cylinder(occ.Pnt(0, middle, -depth / 2), occ.Z, radius, depth)


def _extruded(corners: Sequence[tuple[float, float]], depth: float) -> Any:
    occ = cad_kernel()
    first, *others = ((float(x), float(y)) for x, y in corners)
    outline = occ.WorkPlane(occ.Axes((0, 0, -depth / 2), n=occ.Z, h=occ.X)).MoveTo(*first)
    for corner in others:
        outline = outline.LineTo(*corner)
    return outline.Close().Face().Extrude(depth)


def _name_bore(body: Geometry, collar: Collar) -> None:
    """Call the faces of the hole "bore": those which reach no further than halfway into the wall."""
    limit = (collar.bore_diameter + collar.ring_width) / 4 / MILLIMETRE
    middle = collar.middle / MILLIMETRE
    for face in body.shape.faces:
        low, high = face.bounding_box
        if max(high.x, -low.x, high.y - middle, middle - low.y) < limit:
            face.name = "bore"
