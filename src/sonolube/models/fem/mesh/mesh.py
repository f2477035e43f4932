"""Meshes of isoparametric (curved) tetrahedra of order two to eight, with named regions and faces.

Points of the reference triangle and tetrahedron are given in barycentric coordinates, one for each corner, which sum to
one. Nodes of order p are the points whose coordinates are multiples of 1/p: corners first, then those on edges, on
sides and in the interior. Meshes are edited without a CAD kernel: coordinates transformed, patches of faces named.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cache, reduce
from itertools import product
from math import comb

import numpy as np
from numpy.typing import NDArray
from scipy.special import roots_jacobi

from sonolube.checks import Floats, Integers, require_finite, require_positive
from sonolube.errors import InvalidInput, UnknownName

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


DIRECTIONS = "xyz"
"""Names of the coordinate directions, in the order of the components of a vector."""

HIGHEST_ORDER = 8
"""Highest element order; above it, shape functions on equidistant nodes are ill-conditioned."""

_ORDERS = {comb(order + 3, 3): order for order in range(2, HIGHEST_ORDER + 1)}  # by the number of nodes of an element


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Mesh:
    """Mesh of isoparametric Lagrange tetrahedra of one order, with named regions and named faces.

    Parameters
    ----------
    nodes : ndarray, shape (n, 3)
        Coordinates of the nodes in m.
    elements : ndarray of int, shape (m, a)
        Connectivity: four corners of positive volume, then the nodes on the edges 01, 12, 02, 03, 13 and 23, on the
        sides and in the interior. An element of order p has (p + 1)(p + 2)(p + 3)/6 nodes: 10 of order two, 20 of
        order three, 35, 56 and 84 up to order six.
    region_of_element : ndarray of int, shape (m,)
        Index of the region of each element in `regions`.
    regions : tuple of str
        Names of the regions.
    faces : mapping of str to ndarray of int, shape (k, b)
        Triangles of each named face: three corners, then the nodes on the edges 01, 12 and 02, then interior ones.
        Faces between two regions are named "one|other".
    curved_nodes : callable, optional
        Geometry of the exact body: from an element order to the coordinates of the nodes of each element in m, shape
        (m, a, 3); None where only the given nodes are known.

    Raises
    ------
    InvalidInput
        If there is no element, a node is not finite, or an element has negative or zero volume.
    """

    nodes: Floats
    elements: Integers
    region_of_element: Integers
    regions: tuple[str, ...]
    faces: Mapping[str, Integers]
    curved_nodes: Callable[[int], Floats] | None = None

    def __post_init__(self) -> None:
        require_finite(nodes=self.nodes)
        if self.elements.ndim != 2 or self.elements.shape[1] not in _ORDERS or not len(self.elements):
            raise InvalidInput(
                f"elements must have shape (m, a) with m > 0 and a one of {', '.join(map(str, _ORDERS))}, "
                f"got {self.elements.shape}"
            )
        if self.elements.min() < 0 or self.elements.max() >= len(self.nodes):
            raise InvalidInput("elements name nodes that do not exist")
        corner = self.nodes[self.elements[:, :4]]
        volume = np.linalg.det(corner[:, 1:] - corner[:, :1]) / 6
        if not np.all(volume > 1e-13 * np.abs(volume).max()):
            raise InvalidInput(
                f"{int(np.sum(~(volume > 0)))} elements are flat or turned inside out; mesh the body again with "
                "another element size"
            )

    @property
    def node_count(self) -> int:
        """Number of nodes n of the mesh."""
        return len(self.nodes)

    @property
    def order(self) -> int:
        """Polynomial degree of the elements."""
        return _ORDERS[self.elements.shape[1]]

    def face_nodes(self, name: str) -> Integers:
        """Nodes of a named face, in increasing order.

        Raises
        ------
        UnknownName
            If no face has this name.
        """
        try:
            return np.unique(self.faces[name])
        except KeyError:
            raise UnknownName.among(self.faces, kind="face", name=name) from None

    def region_nodes(self, name: str) -> Integers:
        """Nodes of a named region, in increasing order.

        Raises
        ------
        UnknownName
            If no region has this name.
        """
        if name not in self.regions:
            raise UnknownName.among(self.regions, kind="region", name=name)
        return np.unique(self.elements[self.region_of_element == self.regions.index(name)])


def face_triangulation(mesh: Mesh, *, face: str) -> Integers:
    """Triangulation of a named face by flat triangles between its nodes, as figures and facet files need it.

    Parameters
    ----------
    mesh : Mesh
    face : str
        Name of the face.

    Returns
    -------
    ndarray of int, shape (t, 3)
        Node numbers of each triangle; p squared triangles for each side of an element of order p.

    Raises
    ------
    UnknownName
        If no face has this name.
    """
    mesh.face_nodes(face)
    return mesh.faces[face][:, _subdivided_triangle(mesh.order)].reshape(-1, 3)


def box_mesh(*, length: float, width: float, thickness: float, divisions: tuple[int, int, int]) -> Mesh:
    """Structured mesh of a block centred on the origin: six ten-node tetrahedra (Kuhn) per cell, without a CAD kernel.

    Parameters
    ----------
    length, width, thickness : float
        Extent along x, y and z. [m]
    divisions : tuple of three int
        Number of cells along x, y and z.

    Returns
    -------
    Mesh
        Of order two, with one region, "block", and the faces "-x", "+x", "-y", "+y", "-z" and "+z".

    Raises
    ------
    InvalidInput
        If an extent is not positive or a number of cells below one.

    References
    ----------
    .. [1] H. W. Kuhn, IBM J. Res. Dev. 4, 518 (1960). doi:10.1147/rd.45.0518
    """
    require_positive(length=length, width=width, thickness=thickness)
    if min(divisions) < 1:
        raise InvalidInput(f"divisions must be at least 1, got {divisions}")
    points = np.array([2 * count + 1 for count in divisions])
    axes = [np.linspace(-size / 2, size / 2, n) for size, n in zip((length, width, thickness), points, strict=True)]
    nodes = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    cells = 2 * np.stack(np.meshgrid(*map(np.arange, divisions), indexing="ij"), axis=-1).reshape(-1, 1, 3)
    corners = (cells[:, np.newaxis] + 2 * _KUHN[np.newaxis]).reshape(-1, 4, 3)
    midpoints = np.stack([(corners[:, a] + corners[:, b]) // 2 for a, b in EDGES], axis=1)
    elements = np.ravel_multi_index(
        tuple(np.moveaxis(np.concatenate([corners, midpoints], axis=1), -1, 0)), tuple(points)
    )
    faces = {
        f"{sign}{'xyz'[axis]}": _sides(elements, nodes[:, axis], side * size / 2)
        for axis, size in enumerate((length, width, thickness))
        for sign, side in (("-", -1), ("+", 1))
    }
    return Mesh(
        nodes=nodes,
        elements=elements,
        region_of_element=np.zeros(len(elements), dtype=np.int64),
        regions=("block",),
        faces=faces,
    )


def _subdivided_triangle(order: int) -> Integers:
    """Flat triangles between neighbouring nodes of a triangle of an order, of the same orientation."""
    index = {tuple(node): k for k, node in enumerate(lagrange_nodes(order, corners=3).tolist())}
    triangles = []
    for _, i, j in lagrange_nodes(order, corners=3).tolist():
        upright, inverted = ((i, j), (i + 1, j), (i, j + 1)), ((i + 1, j), (i + 1, j + 1), (i, j + 1))
        for triangle, extent in ((upright, 1), (inverted, 2)):
            if i + j + extent <= order:
                triangles.append([index[order - a - b, a, b] for a, b in triangle])
    return np.array(triangles)


def _kuhn_tetrahedra() -> Integers:
    """Corners of the six tetrahedra of Kuhn's subdivision of the unit cube, shape (6, 4, 3), of positive volume."""
    unit = np.eye(3, dtype=np.int64)
    tetrahedra = []
    for first, second, third in ((0, 1, 2), (1, 2, 0), (2, 0, 1), (0, 2, 1), (2, 1, 0), (1, 0, 2)):
        path = np.cumsum([np.zeros(3, dtype=np.int64), unit[first], unit[second], unit[third]], axis=0)
        inverted = np.linalg.det(path[1:] - path[0]) < 0
        tetrahedra.append(path[[0, 2, 1, 3]] if inverted else path)
    return np.array(tetrahedra)


_KUHN = _kuhn_tetrahedra()
_SIDES = np.array([[0, 1, 2, 4, 5, 6], [0, 1, 3, 4, 8, 7], [1, 2, 3, 5, 9, 8], [0, 2, 3, 6, 9, 7]])


def _sides(elements: Integers, coordinate: Floats, level: float) -> Integers:
    """Sides of elements of order two with all their nodes at one value `level` of a coordinate."""
    sides = elements[:, _SIDES].reshape(-1, 6)
    return np.asarray(sides[np.all(np.isclose(coordinate[sides], level, atol=1e-12), axis=1)])


def transform_nodes(mesh: Mesh, mapping: Callable[[Floats], Floats]) -> Mesh:
    """Mesh with its nodes moved by a mapping of coordinates, such as from a block to a wedge or a tapered bar.

    Parameters
    ----------
    mesh : Mesh
    mapping : callable
        From coordinates in m, shape (n, 3), to the transformed ones. Element boundaries should follow its kinks.

    Returns
    -------
    Mesh
    """
    return replace(mesh, nodes=mapping(mesh.nodes))


def add_face_patch(mesh: Mesh, name: str, *, of: str, where: Callable[[Floats], NDArray[np.bool_]]) -> Mesh:
    """Mesh with an additional named face: a patch of an existing one.

    Parameters
    ----------
    mesh : Mesh
    name : str
        Name of the patch.
    of : str
        Name of the existing face, which is kept as a whole.
    where : callable
        From the centroids of triangles in m, shape (t, 3), to whether they belong to the patch, shape (t,).

    Returns
    -------
    Mesh

    Raises
    ------
    InvalidInput
        If no triangle belongs to the patch.
    """
    mesh.face_nodes(of)
    triangles = mesh.faces[of]
    chosen = triangles[where(mesh.nodes[triangles[:, :3]].mean(axis=1))]
    if not len(chosen):
        raise InvalidInput(f"no triangle of face {of} belongs to {name}; mesh it finer, or make the patch larger")
    return replace(mesh, faces={**mesh.faces, name: chosen})


def edge_nodes(mesh: Mesh, one: str, other: str, *, along: str) -> Integers:
    """Nodes on the common edge of two faces, sorted by a coordinate.

    Parameters
    ----------
    mesh : Mesh
    one, other : str
        Names of the faces.
    along : str
        Coordinate to sort by: "x", "y" or "z".

    Returns
    -------
    ndarray of int, shape (k,)

    Raises
    ------
    InvalidInput
        If the faces have no common node.
    UnknownName
        If there is no such face or direction.
    """
    if along not in DIRECTIONS:
        raise UnknownName.among(DIRECTIONS, kind="direction", name=along)
    shared = np.intersect1d(mesh.face_nodes(one), mesh.face_nodes(other))
    if not shared.size:
        raise InvalidInput(f"the faces {one} and {other} have no common edge; name two faces that meet")
    return np.asarray(shared[np.argsort(mesh.nodes[shared, DIRECTIONS.index(along)])])
