"""Coordinates in the field of a scan: Cartesian from its centre, and along a circular arc."""

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.models.surfaces.height_map import HeightMap, Mask


def centred_coordinates(surface: HeightMap) -> tuple[Floats, Floats]:
    """Positions of columns and rows relative to the centre of the field.

    `x`: Positions of the columns, in m. `y`: Positions of the rows, in m.
    """
    rows, columns = surface.height.shape
    x = surface.x - surface.spacing_x * (columns - 1) / 2
    y = surface.y - surface.spacing_y * (rows - 1) / 2
    return x[None, :], y[:, None]


def arc_coordinates(x: Floats, y: Floats, direction: float | Floats, curvature: float) -> tuple[Floats, Floats]:
    r"""Curvilinear coordinates of points with respect to a circle through the origin.

    `transverse`: Distance from the circle in m, positive to the left of its direction. `arc_length`: Length along the
    circle from the origin to the foot of the point, in m.

    With the coordinates :math:`a` ahead and :math:`l` to the left of the origin and the curvature :math:`\kappa`

    .. math:: s = \frac{2 l - \kappa (l^2 + a^2)}{1 + \sqrt{(1 - \kappa l)^2 + (\kappa a)^2}}, \qquad
        t = \frac1\kappa \operatorname{atan2}(\kappa a, 1 - \kappa l) ,

    which has the limit :math:`s = l`, :math:`t = a` of a line without cancellation.
    """
    cos, sin = np.cos(direction), np.sin(direction)
    ahead, left = x * cos + y * sin, y * cos - x * sin
    if curvature == 0:
        return left, ahead
    power = 2 * left - curvature * (np.square(left) + np.square(ahead))
    from_centre = np.sqrt(np.maximum(1 - curvature * power, 0.0))  # times the curvature
    return power / (1 + from_centre), np.arctan2(curvature * ahead, 1 - curvature * left) / curvature


def monomials(u: Floats, v: Floats, terms: int) -> list[Floats]:
    """First monomials 1, u, v, u^2, u v and v^2 of two coordinates."""
    return [np.ones_like(u + v), u + 0 * v, v + 0 * u, u**2 + 0 * v, u * v, v**2 + 0 * u][:terms]


def block_edges(surface: HeightMap, side: float) -> list[NDArray[np.intp]]:
    """First rows and first columns of the blocks of a side in m."""
    counts, spacings = surface.height.shape, (surface.spacing_y, surface.spacing_x)
    return [np.arange(0, count, max(1, round(side / spacing))) for count, spacing in zip(counts, spacings, strict=True)]


def block_means(fields: tuple[Floats, ...], mask: Mask, edges: list[NDArray[np.intp]]) -> Floats:
    """Mean of each field over the masked pixels of the blocks with any, and last their number."""

    def total(values: Floats) -> Floats:
        return np.asarray(np.add.reduceat(np.add.reduceat(values, edges[0], axis=0), edges[1], axis=1))

    count = total(mask.astype(np.float64))
    used = count > 0
    return np.array([*(total(np.where(mask, values, 0.0))[used] / count[used] for values in fields), count[used]])
