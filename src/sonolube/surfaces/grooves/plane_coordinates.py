"""Positions in the field of a scan: from its middle, and from circles through it."""

import math

import numpy as np

from sonolube.checks import Floats
from sonolube.surfaces.height_map import HeightMap


def centred_coordinates(surface: HeightMap) -> tuple[Floats, Floats]:
    """Return the positions of columns and rows from the middle of the field.

    Parameters
    ----------
    surface : HeightMap

    Returns
    -------
    x : ndarray, shape (1, columns)
        In m.
    y : ndarray, shape (rows, 1)
        In m.
    """
    rows, columns = surface.height.shape
    x = surface.x - surface.spacing_x * (columns - 1) / 2
    y = surface.y - surface.spacing_y * (rows - 1) / 2
    return x[None, :], y[:, None]


def arc_coordinates(x: Floats, y: Floats, direction: float, curvature: float) -> tuple[Floats, Floats]:
    """Return distance to the left of a circle through the origin, and arc length along it, for points of the plane.

    Parameters
    ----------
    x, y : ndarray
        Points, that broadcast against each other, in m.
    direction : float
        Of the circle at the origin, in rad.
    curvature : float
        Of the circle, in 1/m, positive where it bends to the left; zero for a line.

    Returns
    -------
    left : ndarray, shape of the broadcast points
    along : ndarray, shape of the broadcast points
    """
    cos, sin = math.cos(direction), math.sin(direction)
    ahead, left = x * cos + y * sin, y * cos - x * sin
    if curvature == 0:
        return left, ahead
    shrunk = np.sqrt(np.square(1 - curvature * left) + np.square(curvature * ahead))  # distance to the centre, times k
    across = (2 * left - curvature * (np.square(left) + np.square(ahead))) / (1 + shrunk)
    return across, np.arctan2(curvature * ahead, 1 - curvature * left) / curvature


def monomials(u: Floats, v: Floats, terms: int) -> list[Floats]:
    """Return 1, u, v, u^2, u v and v^2, the first few of them.

    Parameters
    ----------
    u, v : ndarray
        Of shapes that broadcast.
    terms : int
        6 at the most.

    Returns
    -------
    list of ndarray
    """
    return [np.ones_like(u + v), u + 0 * v, v + 0 * u, u**2 + 0 * v, u * v, v**2 + 0 * u][:terms]
