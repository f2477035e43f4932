"""Reference triangle and tetrahedron: Lagrange nodes, shape functions and quadrature of any order.

Points are given in barycentric coordinates, one for each corner, which sum to one. Nodes of order p are the points
whose coordinates are multiples of 1/p: corners first, then those on edges, on sides and in the interior.
"""

from functools import cache, reduce
from itertools import product

import numpy as np
from scipy.special import roots_jacobi

from sonolube.checks import Floats, Integers

EDGES = ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))
"""Corners at the ends of each edge of a tetrahedron, in the order of the edge nodes; those of a triangle come first."""


@cache
def lagrange_nodes(order: int, *, corners: int) -> Integers:
    """Nodes of a Lagrange element on a simplex: barycentric coordinates times the order; shape (a, corners)."""
    rows = [row for row in product(range(order + 1), repeat=corners) if sum(row) == order]

    def sort_key(row: tuple[int, ...]) -> tuple[int, int, tuple[int, ...]]:
        support = tuple(corner for corner, index in enumerate(row) if index)
        edge = EDGES.index((support[0], support[1])) if len(support) == 2 else 0
        return len(support), edge, tuple(-index for index in row)

    return np.array(sorted(rows, key=sort_key))


def shape_functions(order: int, points: Floats) -> tuple[Floats, Floats]:
    r"""Lagrange shape functions of a simplex and their gradients, as products of Silvester's polynomials.

    `points` has shape (q, corners).

    `values` has shape (a, q). `gradients`: Derivatives with respect to the barycentric coordinates of all corners but
    the first, which are the Cartesian coordinates of the reference simplex.

    The function of the node with barycentric coordinates :math:`m_k/p` is

    .. math::

        N(\xi) = \prod_k R_{m_k}(\xi_k), \qquad R_m(\xi) = \prod_{n=0}^{m-1} \frac{p\,\xi - n}{n + 1}

    Source: P. Silvester, Int. J. Eng. Sci. 7, 849 (1969). doi:10.1016/0020-7225(69)90065-2
    """
    polynomials, derivatives = [np.ones_like(points)], [np.zeros_like(points)]
    for n in range(order):
        step = (order * points - n) / (n + 1)
        derivatives.append(derivatives[-1] * step + polynomials[-1] * order / (n + 1))
        polynomials.append(polynomials[-1] * step)
    corners = np.arange(points.shape[1])
    nodes = lagrange_nodes(order, corners=len(corners))
    factor, slope = (np.array(table)[nodes, :, corners] for table in (polynomials, derivatives))  # (a, corners, q)
    others = [reduce(np.multiply, (factor[:, k] for k in corners if k != corner)) for corner in corners]
    partial = slope * np.stack(others, axis=1)
    return factor[:, 0] * others[0], partial[:, 1:] - partial[:, :1]


@cache
def simplex_quadrature(degree: int, *, corners: int) -> tuple[Floats, Floats]:
    r"""Quadrature rule of a simplex, exact for polynomials up to a degree: conical product of Gauss-Jacobi rules.

    `points`: Barycentric coordinates. `weights`: Positive; they sum to 1/2 for a triangle and 1/6 for a tetrahedron.

    The product rule of the square or cube, collapsed onto the simplex by Duffy's transformation. For the tetrahedron

    .. math::

        \xi_1 = s, \quad \xi_2 = (1 - s) t, \quad \xi_3 = (1 - s)(1 - t) u, \qquad
        dV = (1 - s)^2 (1 - t)\, ds\, dt\, du

    whose factors are the weight functions of the Gauss-Jacobi rules.

    Source: A. H. Stroud, Approximate Calculation of Multiple Integrals, Prentice-Hall (1971).
    """
    rules = [roots_jacobi(degree // 2 + 1, power, 0.0) for power in reversed(range(corners - 1))]
    axes = np.meshgrid(*((1 + points) / 2 for points, _ in rules), indexing="ij")
    remainder, coordinates = np.ones_like(axes[0]), []
    for axis in axes:
        coordinates.append(remainder * axis)
        remainder = remainder * (1 - axis)
    weights = np.ones(())
    for power, (_, weight) in zip(reversed(range(corners - 1)), rules, strict=True):
        weights = np.multiply.outer(weights, weight / 2 ** (power + 1))
    return np.stack([remainder.ravel(), *(c.ravel() for c in coordinates)], axis=1), weights.ravel()
