"""Adjustment of the length of a body of any shape at its far end, as in trimming a horn."""

from typing import Any

from sonolube.errors import InvalidInput
from sonolube.models.fem.mesh.geometry import MILLIMETRE, Geometry, cad_kernel, single_body
from sonolube.models.fem.mesh.mesh import DIRECTIONS

_NO_CHANGE = 1e-6  # mm


def adjust_length(geometry: Geometry, *, axis: str, length: float) -> Geometry:
    """Body cut off at its far end, or with its far face extruded, to a given length along an axis.

    Parameters
    ----------
    geometry : Geometry
        One body with a flat far end.
    axis : str
        "x", "y" or "z"; the far end is that of the greatest coordinate.
    length : float
        Required extent along the axis. [m]

    Returns
    -------
    Geometry

    Raises
    ------
    InvalidInput
        If the geometry is not one body, has no flat far end, or the length is not positive.
    """
    if len(geometry.regions) != 1:
        raise InvalidInput(f"the length of a single body can be adjusted, got {', '.join(geometry.regions)}")
    direction = DIRECTIONS.index(axis)
    low, high = extent_along(geometry, axis=axis)
    change = (length - (high - low)) / MILLIMETRE
    if length <= 0:
        raise InvalidInput(f"length must be positive, got {length!r} m")
    occ, shape = cad_kernel(), geometry.shape.solids[0]
    name = geometry.regions[0]
    if abs(change) < _NO_CHANGE:
        return geometry
    if change > 0:
        ends = [face for face in shape.faces if face.name == f"+{axis}"]
        if not ends:
            raise InvalidInput(f"{name} has no flat end face at its greatest {axis} to be extended; shorten it instead")
        along = occ.gp_Vec(*(change if k == direction else 0.0 for k in range(3)))  # not by the face's own normal
        for face in ends:
            shape = shape + face.Extrude(along)
        return single_body(shape, name)
    corner, opposite = ([_coordinate(bound, k) for k in range(3)] for bound in shape.bounding_box)
    corner, opposite = [value - 1.0 for value in corner], [value + 1.0 for value in opposite]
    corner[direction] = (low + length) / MILLIMETRE
    return single_body(shape - occ.Box(tuple(corner), tuple(opposite)), name)


def extent_along(geometry: Geometry, *, axis: str) -> tuple[float, float]:
    """Least and greatest coordinate of a body along an axis, in m.

    From its flat end faces where it has them, else from its bounding box.
    """
    direction = DIRECTIONS.index(axis)
    ends = {
        sign: [_coordinate(face.center, direction) for face in geometry.shape.faces if face.name == f"{sign}{axis}"]
        for sign in "-+"
    }
    low, high = (_coordinate(bound, direction) for bound in geometry.shape.bounding_box)  # enlarged by the kernel
    return min(ends["-"], default=low) * MILLIMETRE, max(ends["+"], default=high) * MILLIMETRE


def _coordinate(point: Any, direction: int) -> float:
    """Component of a point of the CAD kernel."""
    return float((point.x, point.y, point.z)[direction])
