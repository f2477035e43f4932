"""Anisotropic geometric mesh grading towards re-entrant edges, at which the stress is singular.

Each edge between a node on a re-entrant edge and one off it is divided close to the former, repeatedly, so that
elements become thin across the re-entrant edge and stay long along it. Divided tetrahedra consist of tetrahedra and
prisms, and prisms are divided into tetrahedra along diagonals from their nodes of lowest number, which makes neighbours
conform.
"""

from dataclasses import dataclass

import numpy as np

from sonolube.checks import Floats, Integers
from sonolube.models.fem.mesh.element_order import change_order, mesh_from_elements
from sonolube.models.fem.mesh.mesh import EDGES, Mesh, lagrange_nodes, shape_functions

_REENTRANT_ANGLE = np.radians(200.0)  # dihedral angle of an edge that counts; above 180, as meshed curves have kinks
_INTERIOR_ANGLE = np.radians(350.0)  # dihedral angle from which an edge is interior
_RATIO = 0.15  # of an edge's length, at which it is divided, from its end on the re-entrant edge
_CORNERS = (0, 1, 2, 3)


def grade_reentrant_edges(mesh: Mesh, *, levels: int) -> Mesh:
    """Mesh of order two graded geometrically towards the re-entrant edges of its body.

    Parameters
    ----------
    mesh : Mesh
    levels : int
        Number of divisions of the elements next to the re-entrant edges.

    Returns
    -------
    Mesh
        The given mesh itself if there are no such edges, or no levels.

    Notes
    -----
    After n levels the elements next to a re-entrant edge have 0.15^n of their original width across it. An edge is
    re-entrant where the dihedral angles of its elements sum to between 200 and 350 degrees.

    References
    ----------
    .. [1] J. Dompierre, P. Labbé, M.-G. Vallet and R. Camarero, 8th International Meshing Roundtable, 195 (1999).
    .. [2] T. Apel, Anisotropic Finite Elements: Local Estimates and Applications, Teubner (1999).
    """
    singular = _reentrant_nodes(mesh)
    if not singular.size or not levels:
        return mesh
    subdivision = _Subdivision(
        corners=mesh.elements[:, :4],
        barycentric=np.broadcast_to(np.eye(4), (len(mesh.elements), 4, 4)),
        parents=np.arange(len(mesh.elements)),
        faces={name: triangles[:, :3] for name, triangles in mesh.faces.items()},
    )
    for _ in range(levels):
        subdivision = _divided(subdivision, singular)
    return _mesh_of_subdivision(mesh, subdivision)


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class _Subdivision:
    """Tetrahedra that subdivide those of a mesh.

    Parameters
    ----------
    corners : ndarray of int, shape (e, 4)
        Labels of their corners.
    barycentric : ndarray, shape (e, 4, 4)
        Barycentric coordinates of their corners in the parent element.
    parents : ndarray of int, shape (e,)
        Index of the parent element.
    faces : dict of str to ndarray of int, shape (k, 3)
        Corners of the triangles of each face.
    """

    corners: Integers
    barycentric: Floats
    parents: Integers
    faces: dict[str, Integers]


def _reentrant_nodes(mesh: Mesh) -> Integers:
    """Corners on re-entrant edges, from the sum of the dihedral angles of the curved elements at each edge's middle."""
    nodes = mesh.nodes[mesh.elements]
    angles = np.empty((len(nodes), len(EDGES)))
    for k, (a, b) in enumerate(EDGES):
        c, d = (corner for corner in _CORNERS if corner not in (a, b))
        middle = np.zeros((1, 4))
        middle[0, [a, b]] = 0.5
        _, gradients = shape_functions(mesh.order, middle)
        tangents = np.einsum("eax,ad->edx", nodes, gradients[:, :, 0])  # along coordinates 1, 2 and 3; zero along 0
        tangents = np.concatenate([np.zeros_like(tangents[:, :1]), tangents], axis=1)
        edge = tangents[:, b] - tangents[:, a]
        one, other = (np.cross(edge, tangents[:, corner] - tangents[:, a]) for corner in (c, d))
        cosine = np.einsum("ex,ex->e", one, other)
        angles[:, k] = np.arctan2(np.linalg.norm(np.cross(one, other), axis=1), cosine)
    ends = np.sort(mesh.elements[:, np.array(EDGES)], axis=2)
    edges, index = np.unique(ends.reshape(-1, 2), axis=0, return_inverse=True)
    dihedral = np.bincount(index.ravel(), weights=angles.ravel())
    return np.unique(edges[(dihedral > _REENTRANT_ANGLE) & (dihedral < _INTERIOR_ANGLE)])


def _divided(subdivision: _Subdivision, singular: Integers) -> _Subdivision:
    """Subdivision in which every edge between a singular node and another node is divided once more."""
    is_singular = np.isin(subdivision.corners, singular)
    singular_count = is_singular.sum(axis=1)
    order = np.argsort(~is_singular, axis=1, kind="stable")  # singular corners first
    corners = np.take_along_axis(subdivision.corners, order, axis=1)
    barycentric = np.take_along_axis(subdivision.barycentric, order[:, :, np.newaxis], axis=1)
    division = _EdgeDivision(corners, singular_count)
    labels = np.column_stack([corners, *(division.labels(corners[:, edge]) for edge in EDGES)])
    on_edges = np.stack([(1 - _RATIO) * barycentric[:, a] + _RATIO * barycentric[:, b] for a, b in EDGES], axis=1)
    points = np.concatenate([barycentric, on_edges], axis=1)
    parents, children = [], []
    for count in range(5):
        own = np.flatnonzero(singular_count == count)
        tetrahedra = [np.broadcast_to(child, (len(own), 1, 4)) for child in _TETRAHEDRA[count]]
        tetrahedra += [np.array(prism)[_split_prisms(labels[own][:, prism])] for prism in _PRISMS[count]]
        local = np.concatenate(tetrahedra, axis=1)
        parents.append(np.repeat(own, local.shape[1]))
        children.append(local.reshape(-1, 4))
    parent, local = np.concatenate(parents), np.concatenate(children)
    inverted = np.linalg.det(points[parent[:, np.newaxis], local]) < 0  # elements of the mesh have positive volume
    local[inverted] = local[inverted][:, [0, 2, 1, 3]]
    return _Subdivision(
        corners=labels[parent[:, np.newaxis], local],
        barycentric=points[parent[:, np.newaxis], local],
        parents=subdivision.parents[parent],
        faces={name: _divided_face(face, singular, division) for name, face in subdivision.faces.items()},
    )


class _EdgeDivision:
    """Labels of the new nodes on the divided edges of tetrahedra whose first `count` corners are singular."""

    def __init__(self, corners: Integers, count: Integers) -> None:
        self.first = int(corners.max()) + 1
        ends = [corners[(count > a) & (count <= b)][:, [a, b]] for a, b in EDGES]
        self.keys = np.unique(_edge_keys(np.concatenate(ends), self.first))

    def labels(self, ends: Integers) -> Integers:
        """Labels of the new nodes on edges given by their ends; meaningless for edges that are not divided."""
        return self.first + np.searchsorted(self.keys, _edge_keys(ends, self.first))


def _edge_keys(ends: Integers, base: int) -> Integers:
    """Unique integer of each edge, whatever the sequence of its ends."""
    return np.asarray(ends.min(axis=1) * base + ends.max(axis=1))


def _split_prisms(prisms: Integers) -> Integers:
    """Corners of the three tetrahedra of each prism (Dompierre 1999) by position in the prism, shape (p, 3, 4)."""
    permutations = _PERMUTATIONS[np.argmin(prisms, axis=1)]
    permuted = np.take_along_axis(prisms, permutations, axis=1)
    first_diagonal = np.minimum(permuted[:, 1], permuted[:, 5]) < np.minimum(permuted[:, 2], permuted[:, 4])
    tetrahedra = np.where(first_diagonal[:, np.newaxis, np.newaxis], _SPLIT_BY_15, _SPLIT_BY_24)
    return np.take_along_axis(permutations, tetrahedra.reshape(-1, 12), axis=1).reshape(-1, 3, 4)


def _divided_face(triangles: Integers, singular: Integers, division: _EdgeDivision) -> Integers:
    """Triangles that subdivide those of a face, of the same orientation."""
    is_singular = np.isin(triangles, singular)
    count = is_singular.sum(axis=1)
    one, two = triangles[count == 1], triangles[count == 2]
    first = np.argmax(is_singular[count == 1], axis=1)[:, np.newaxis]
    regular = np.argmin(is_singular[count == 2], axis=1)[:, np.newaxis]
    one = np.take_along_axis(one, (first + np.arange(3)) % 3, axis=1)  # singular corner first
    two = np.take_along_axis(two, (regular + np.arange(1, 4)) % 3, axis=1)  # singular corners first
    one_01, one_02 = division.labels(one[:, [0, 1]]), division.labels(one[:, [0, 2]])
    two_02, two_12 = division.labels(two[:, [0, 2]]), division.labels(two[:, [1, 2]])
    return np.concatenate(
        [
            triangles[(count == 0) | (count == 3)],
            np.column_stack([one[:, 0], one_01, one_02]),
            _split_quadrilaterals(np.column_stack([one_01, one[:, 1], one[:, 2], one_02])),
            np.column_stack([two_02, two_12, two[:, 2]]),
            _split_quadrilaterals(np.column_stack([two[:, 0], two[:, 1], two_12, two_02])),
        ]
    )


def _split_quadrilaterals(quadrilaterals: Integers) -> Integers:
    """Two triangles of each quadrilateral, along the diagonal from its node of lowest number."""
    shift = np.argmin(quadrilaterals, axis=1)[:, np.newaxis]
    rotated = np.take_along_axis(quadrilaterals, (shift + np.arange(4)) % 4, axis=1)
    return np.concatenate([rotated[:, [0, 1, 2]], rotated[:, [0, 2, 3]]])


def _mesh_of_subdivision(mesh: Mesh, subdivision: _Subdivision) -> Mesh:
    """Mesh of order two of the subdivided tetrahedra, with nodes on the curved geometry of their parents."""

    def curved_nodes(order: int) -> Floats:
        parent = change_order(mesh, order=order)
        points = np.einsum("ac,ecd->ead", lagrange_nodes(order, corners=4) / order, subdivision.barycentric)
        weights, _ = shape_functions(order, points.reshape(-1, 4))
        weights = weights.reshape(len(weights), *points.shape[:2])
        return weights.transpose(1, 2, 0) @ parent.nodes[parent.elements][subdivision.parents]

    return mesh_from_elements(
        subdivision.corners,
        coordinates=curved_nodes(2),
        faces=subdivision.faces,
        order=2,
        region_of_element=mesh.region_of_element[subdivision.parents],
        regions=mesh.regions,
        curved_nodes=curved_nodes,
    )


_C = {edge: 4 + k for k, edge in enumerate(EDGES)}  # points on divided edges of a tetrahedron, after its corners
_TETRAHEDRA: tuple[tuple[tuple[int, ...], ...], ...] = (
    (_CORNERS,),
    ((0, _C[0, 1], _C[0, 2], _C[0, 3]),),
    (),
    ((_C[0, 3], _C[1, 3], _C[2, 3], 3),),
    (_CORNERS,),
)
"""Tetrahedra in the subdivision of one, by the number of its singular corners, which come first."""

_PRISMS: tuple[tuple[tuple[int, ...], ...], ...] = (
    (),
    ((_C[0, 1], _C[0, 2], _C[0, 3], 1, 2, 3),),
    ((0, _C[0, 2], _C[0, 3], 1, _C[1, 2], _C[1, 3]), (_C[0, 2], _C[1, 2], 2, _C[0, 3], _C[1, 3], 3)),
    ((0, 1, 2, _C[0, 3], _C[1, 3], _C[2, 3]),),
    (),
)
"""Prisms in the subdivision of a tetrahedron, likewise: the corners of one triangle, then those of the other."""

_PERMUTATIONS = np.array(
    [
        [0, 1, 2, 3, 4, 5],
        [1, 2, 0, 4, 5, 3],
        [2, 0, 1, 5, 3, 4],
        [3, 5, 4, 0, 2, 1],
        [4, 3, 5, 1, 0, 2],
        [5, 4, 3, 2, 1, 0],
    ]
)
"""Rotations of a prism that bring each of its corners to the first position."""

_SPLIT_BY_15 = np.array([[0, 1, 2, 5], [0, 1, 5, 4], [0, 4, 5, 3]])
_SPLIT_BY_24 = np.array([[0, 1, 2, 4], [0, 4, 2, 5], [0, 4, 5, 3]])
