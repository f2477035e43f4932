"""Triangles and tetrahedra of any order: their nodes, their shape functions, and points that integrate over them.

Places in them are barycentric: one coordinate for each corner, which sum to one. Nodes of order p stand where all
coordinates are multiples of 1/p: corners first, then those on edges, on sides and inside.
"""

from functools import cache, reduce
from itertools import product

import numpy as np
from scipy.special import roots_jacobi

from sonolube.checks import Floats, Integers

EDGES = ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))
"""Corners between which the edges of a tetrahedron run, in the order of their nodes; of a triangle the first three."""


@cache
def lagrange_nodes(order: int, *, corners: int) -> Integers:
    """Return the nodes of a simplex, as barycentric coordinates times the order.

    Parameters
    ----------
    order : int
        Degree of the polynomials, at least one.
    corners : int
        Three for a triangle, four for a tetrahedron.

    Returns
    -------
    ndarray of int, shape (a, corners)
    """
    rows = [row for row in product(range(order + 1), repeat=corners) if sum(row) == order]

    def place(row: tuple[int, ...]) -> tuple[int, int, tuple[int, ...]]:
        on = tuple(corner for corner, index in enumerate(row) if index)
        edge = EDGES.index((on[0], on[1])) if len(on) == 2 else 0
        return len(on), edge, tuple(-index for index in row)

    return np.array(sorted(rows, key=place))


def shape_functions(order: int, places: Floats) -> tuple[Floats, Floats]:
    """Return the polynomials that are one at their own node and zero at all others, and their slopes.

    Parameters
    ----------
    order : int
    places : ndarray, shape (q, corners)
        Barycentric coordinates.

    Returns
    -------
    tuple of ndarray, shapes (a, q) and (a, corners - 1, q)
        The slopes are those along the coordinates of all corners but the first.

    References
    ----------
    .. [1] P. Silvester, Int. J. Eng. Sci. 7, 849 (1969). doi:10.1016/0020-7225(69)90065-2
    """
    factors, slopes = [np.ones_like(places)], [np.zeros_like(places)]
    for n in range(order):  # R_m(x) = prod_n (p x - n)/(n + 1), n below m
        step = (order * places - n) / (n + 1)
        slopes.append(slopes[-1] * step + factors[-1] * order / (n + 1))
        factors.append(factors[-1] * step)
    corners = np.arange(places.shape[1])
    nodes = lagrange_nodes(order, corners=len(corners))
    factor, slope = (np.array(table)[nodes, :, corners] for table in (factors, slopes))  # (a, corners, q)
    others = [reduce(np.multiply, (factor[:, k] for k in corners if k != corner)) for corner in corners]
    along = slope * np.stack(others, axis=1)
    return factor[:, 0] * others[0], along[:, 1:] - along[:, :1]


@cache
def simplex_quadrature(degree: int, *, corners: int) -> tuple[Floats, Floats]:
    """Return places and weights that integrate polynomials up to a degree exactly.

    Parameters
    ----------
    degree : int
    corners : int
        Three for a triangle, four for a tetrahedron.

    Returns
    -------
    tuple of ndarray, shapes (q, corners) and (q,)
        Barycentric coordinates, and positive weights that sum to 1/2 for a triangle and 1/6 for a tetrahedron.

    Notes
    -----
    Gauss and Jacobi's rule of the cube, collapsed onto the simplex.
    """
    rules = [roots_jacobi(degree // 2 + 1, power, 0.0) for power in reversed(range(corners - 1))]
    axes = np.meshgrid(*((1 + points) / 2 for points, _ in rules), indexing="ij")
    left, coordinates = np.ones_like(axes[0]), []
    for axis in axes:
        coordinates.append(left * axis)
        left = left * (1 - axis)
    weights = np.ones(())
    for power, (_, weight) in zip(reversed(range(corners - 1)), rules, strict=True):
        weights = np.multiply.outer(weights, weight / 2 ** (power + 1))
    return np.stack([left.ravel(), *(c.ravel() for c in coordinates)], axis=1), weights.ravel()
