"""A body of any shape made shorter or longer at one end."""

from typing import Any

from sonolube.errors import InvalidInput
from sonolube.fem.solver.cad import MILLIMETRE, cad_kernel
from sonolube.fem.solver.geometry import Geometry, single_body
from sonolube.fem.solver.model import DIRECTIONS

_ALIKE = 1e-6  # mm


def adjust_length(geometry: Geometry, *, axis: str, length: float) -> Geometry:
    """Return one body cut at its far end, or its far face drawn out, until it has a length along an axis.

    Parameters
    ----------
    geometry : Geometry
        One body with a flat far end.
    axis : str
        "x", "y" or "z"; the far end is the one of the greatest coordinate.
    length : float
        Extent wanted along the axis. [m]

    Returns
    -------
    Geometry

    Raises
    ------
    InvalidInput
        If the body is not one, has no flat far end, or would be cut away.
    """
    if len(geometry.regions) != 1:
        raise InvalidInput(f"only one body can be trimmed, got {', '.join(geometry.regions)}")
    direction = DIRECTIONS.index(axis)
    low, high = extent_along(geometry, axis=axis)
    change = (length - (high - low)) / MILLIMETRE
    if length <= 0:
        raise InvalidInput(f"length must be positive, got {length!r} m")
    occ, shape = cad_kernel(), geometry.shape.solids[0]
    name = geometry.regions[0]
    if abs(change) < _ALIKE:
        return geometry
    if change > 0:
        ends = [face for face in shape.faces if face.name == f"+{axis}"]
        if not ends:
            raise InvalidInput(f"{name} has no flat end at its greatest {axis}; there is nothing to draw out")
        for face in ends:
            shape = shape + face.Extrude(change)
        return single_body(shape, name)
    corner, opposite = ([_coordinate(bound, k) for k in range(3)] for bound in shape.bounding_box)
    corner, opposite = [value - 1.0 for value in corner], [value + 1.0 for value in opposite]
    corner[direction] = (low + length) / MILLIMETRE
    return single_body(shape - occ.Box(tuple(corner), tuple(opposite)), name)


def extent_along(geometry: Geometry, *, axis: str) -> tuple[float, float]:
    """Return the least and the greatest coordinate in m of a body's corners and flat ends along an axis.

    Parameters
    ----------
    geometry : Geometry
    axis : str
        "x", "y" or "z".

    Returns
    -------
    tuple of two float
    """
    direction = DIRECTIONS.index(axis)
    ends = {
        sign: [_coordinate(face.center, direction) for face in geometry.shape.faces if face.name == f"{sign}{axis}"]
        for sign in "-+"
    }
    low, high = (_coordinate(bound, direction) for bound in geometry.shape.bounding_box)  # padded by the kernel
    return min(ends["-"], default=low) * MILLIMETRE, max(ends["+"], default=high) * MILLIMETRE


def _coordinate(point: Any, direction: int) -> float:
    return float((point.x, point.y, point.z)[direction])
