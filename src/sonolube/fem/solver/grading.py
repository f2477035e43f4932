"""Elements drawn towards the edges at which a body re-enters, where stress has no bound.

Each edge between a node on such an edge and one off it is cut near the former, again and again, so that elements
become thin across and stay long along. Cut tetrahedra fall into tetrahedra and prisms, and prisms into tetrahedra along
diagonals from their nodes of lowest number, on which neighbours agree.
"""

from dataclasses import dataclass

import numpy as np

from sonolube.checks import Floats, Integers
from sonolube.fem.solver.element_order import change_order, mesh_from_elements
from sonolube.fem.solver.mesh import Mesh
from sonolube.fem.solver.simplex import EDGES, lagrange_nodes, shape_functions

_RE_ENTRANT = np.radians(200.0)  # angle inside the body from which an edge counts; curved sides are not quite smooth
_INSIDE = np.radians(350.0)  # from which it is inside
_CUT = 0.15  # where edges are cut, from the edge that re-enters
_CORNERS = (0, 1, 2, 3)


def grade_reentrant_edges(mesh: Mesh, *, levels: int) -> Mesh:
    """Return a mesh of order two with elements drawn towards the edges at which its body re-enters.

    Parameters
    ----------
    mesh : Mesh
    levels : int
        How often the elements next to them are cut.

    Returns
    -------
    Mesh
        The mesh itself if there are no such edges.
    """
    singular = _re_entrant_nodes(mesh)
    if not singular.size or not levels:
        return mesh
    pieces = _Pieces.of(mesh)
    for _ in range(levels):
        pieces = _cut(pieces, singular)
    return _meshed(mesh, pieces)


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class _Pieces:
    """Tetrahedra cut out of those of a mesh: corners, shape (e, 4), their places in the parents, (e, 4, 4), parents."""

    corners: Integers
    places: Floats
    parents: Integers
    faces: dict[str, Integers]

    @classmethod
    def of(cls, mesh: Mesh) -> "_Pieces":
        return cls(
            corners=mesh.elements[:, :4],
            places=np.broadcast_to(np.eye(4), (len(mesh.elements), 4, 4)),
            parents=np.arange(len(mesh.elements)),
            faces={name: triangles[:, :3] for name, triangles in mesh.faces.items()},
        )


def _re_entrant_nodes(mesh: Mesh) -> Integers:
    """Return the corners on edges where the curved elements around take up more than half a turn, and not a whole."""
    nodes = mesh.nodes[mesh.elements]
    angles = np.empty((len(nodes), len(EDGES)))
    for k, (a, b) in enumerate(EDGES):
        c, d = (corner for corner in _CORNERS if corner not in (a, b))
        middle = np.zeros((1, 4))
        middle[0, [a, b]] = 0.5
        _, slopes = shape_functions(mesh.order, middle)
        axes = np.einsum("eax,ad->edx", nodes, slopes[:, :, 0])  # along corners 1, 2 and 3; none along 0
        axes = np.concatenate([np.zeros_like(axes[:, :1]), axes], axis=1)
        along = axes[:, b] - axes[:, a]
        one, other = (np.cross(along, axes[:, corner] - axes[:, a]) for corner in (c, d))
        across = np.einsum("ex,ex->e", one, other)
        angles[:, k] = np.arctan2(np.linalg.norm(np.cross(one, other), axis=1), across)
    ends = np.sort(mesh.elements[:, np.array(EDGES)], axis=2)
    edges, which = np.unique(ends.reshape(-1, 2), axis=0, return_inverse=True)
    turn = np.bincount(which.ravel(), weights=angles.ravel())
    return np.unique(edges[(turn > _RE_ENTRANT) & (turn < _INSIDE)])


def _cut(pieces: _Pieces, singular: Integers) -> _Pieces:
    """Return the pieces with all edges between a singular node and another cut."""
    on = np.isin(pieces.corners, singular)
    order = np.argsort(~on, axis=1, kind="stable")  # singular corners first
    corners = np.take_along_axis(pieces.corners, order, axis=1)
    places = np.take_along_axis(pieces.places, order[:, :, np.newaxis], axis=1)
    cut = _Cuts.of(corners, on.sum(axis=1))
    points = np.column_stack([corners, *(cut.numbers(corners[:, edge]) for edge in EDGES)])
    between = np.stack([(1 - _CUT) * places[:, a] + _CUT * places[:, b] for a, b in EDGES], axis=1)
    where = np.concatenate([places, between], axis=1)
    parents, chosen = [], []
    for count in range(5):
        own = np.flatnonzero(on.sum(axis=1) == count)
        pieces_of = [np.broadcast_to(piece, (len(own), 1, 4)) for piece in _TETRAHEDRA[count]]
        pieces_of += [np.array(prism)[_split(points[own][:, prism])] for prism in _PRISMS[count]]
        local = np.concatenate(pieces_of, axis=1)
        parents.append(np.repeat(own, local.shape[1]))
        chosen.append(local.reshape(-1, 4))
    parent, local = np.concatenate(parents), np.concatenate(chosen)
    turned = np.linalg.det(where[parent[:, np.newaxis], local]) < 0  # the parents of the first level turn right
    local[turned] = local[turned][:, [0, 2, 1, 3]]
    return _Pieces(
        corners=points[parent[:, np.newaxis], local],
        places=where[parent[:, np.newaxis], local],
        parents=pieces.parents[parent],
        faces={name: _cut_face(face, singular, cut) for name, face in pieces.faces.items()},
    )


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class _Cuts:
    """The nodes on cut edges: keys of the edges in order, and the number of the first node."""

    keys: Integers
    first: int

    @classmethod
    def of(cls, corners: Integers, count: Integers) -> "_Cuts":
        """Return the cuts of tetrahedra whose first `count` corners are singular."""
        first = int(corners.max()) + 1
        ends = [corners[(count > a) & (count <= b)][:, [a, b]] for a, b in EDGES]
        return cls(keys=np.unique(_keys(np.concatenate(ends), first)), first=first)

    def numbers(self, ends: Integers) -> Integers:
        """Return the nodes on edges, of no meaning where the edge is not cut."""
        return self.first + np.searchsorted(self.keys, _keys(ends, self.first))


def _keys(ends: Integers, base: int) -> Integers:
    return np.asarray(ends.min(axis=1) * base + ends.max(axis=1))


def _split(prisms: Integers) -> Integers:
    """Return the corners of three tetrahedra of each prism, shape (p, 3, 4), by their place in the prism.

    After J. Dompierre, P. Labbé, M.-G. Vallet and R. Camarero, 8th International Meshing Roundtable, 195 (1999).
    """
    turns = _TURNS[np.argmin(prisms, axis=1)]
    turned = np.take_along_axis(prisms, turns, axis=1)
    rising = np.minimum(turned[:, 1], turned[:, 5]) < np.minimum(turned[:, 2], turned[:, 4])
    tetrahedra = np.where(rising[:, np.newaxis, np.newaxis], _RISING, _FALLING)
    return np.take_along_axis(turns, tetrahedra.reshape(-1, 12), axis=1).reshape(-1, 3, 4)


def _cut_face(triangles: Integers, singular: Integers, cut: _Cuts) -> Integers:
    """Return what triangles fall into, turning as they do."""
    on = np.isin(triangles, singular)
    count = on.sum(axis=1)
    one, two = triangles[count == 1], triangles[count == 2]
    one = np.take_along_axis(one, (np.argmax(on[count == 1], axis=1)[:, np.newaxis] + np.arange(3)) % 3, axis=1)
    two = np.take_along_axis(two, (np.argmin(on[count == 2], axis=1)[:, np.newaxis] + np.arange(1, 4)) % 3, axis=1)
    near, far = cut.numbers(one[:, [0, 1]]), cut.numbers(one[:, [0, 2]])
    left, right = cut.numbers(two[:, [0, 2]]), cut.numbers(two[:, [1, 2]])
    return np.concatenate(
        [
            triangles[(count == 0) | (count == 3)],
            np.column_stack([one[:, 0], near, far]),
            _halves(np.column_stack([near, one[:, 1], one[:, 2], far])),
            np.column_stack([left, right, two[:, 2]]),
            _halves(np.column_stack([two[:, 0], two[:, 1], right, left])),
        ]
    )


def _halves(squares: Integers) -> Integers:
    """Return two triangles of each four-sided figure, cut from its node of lowest number."""
    turned = np.take_along_axis(squares, (np.argmin(squares, axis=1)[:, np.newaxis] + np.arange(4)) % 4, axis=1)
    return np.concatenate([turned[:, [0, 1, 2]], turned[:, [0, 2, 3]]])


def _meshed(mesh: Mesh, pieces: _Pieces) -> Mesh:
    def curves(order: int) -> Floats:
        parent = change_order(mesh, order=order)
        inside = np.einsum("ac,ecd->ead", lagrange_nodes(order, corners=4) / order, pieces.places)
        weights, _ = shape_functions(order, inside.reshape(-1, 4))
        weights = weights.reshape(len(weights), *inside.shape[:2])
        return np.asarray(np.einsum("bea,ebx->eax", weights, parent.nodes[parent.elements][pieces.parents]))

    return mesh_from_elements(
        pieces.corners,
        places=curves(2),
        faces=pieces.faces,
        order=2,
        region_of_element=mesh.region_of_element[pieces.parents],
        regions=mesh.regions,
        curves=curves,
    )


_C = {edge: 4 + k for k, edge in enumerate(EDGES)}  # cut edges of a tetrahedron, numbered after its corners
_TETRAHEDRA: tuple[tuple[tuple[int, ...], ...], ...] = (
    (_CORNERS,),
    ((0, _C[0, 1], _C[0, 2], _C[0, 3]),),
    (),
    ((_C[0, 3], _C[1, 3], _C[2, 3], 3),),
    (_CORNERS,),
)
"""Tetrahedra that one falls into, by the number of its singular corners, which come first."""

_PRISMS: tuple[tuple[tuple[int, ...], ...], ...] = (
    (),
    ((_C[0, 1], _C[0, 2], _C[0, 3], 1, 2, 3),),
    ((0, _C[0, 2], _C[0, 3], 1, _C[1, 2], _C[1, 3]), (_C[0, 2], _C[1, 2], 2, _C[0, 3], _C[1, 3], 3)),
    ((0, 1, 2, _C[0, 3], _C[1, 3], _C[2, 3]),),
    (),
)
"""And prisms: one triangle, then the other."""

_TURNS = np.array(
    [
        [0, 1, 2, 3, 4, 5],
        [1, 2, 0, 4, 5, 3],
        [2, 0, 1, 5, 3, 4],
        [3, 5, 4, 0, 2, 1],
        [4, 3, 5, 1, 0, 2],
        [5, 4, 3, 2, 1, 0],
    ]
)
"""Turns of a prism that bring each of its corners to the first place."""

_RISING = np.array([[0, 1, 2, 5], [0, 1, 5, 4], [0, 4, 5, 3]])
_FALLING = np.array([[0, 1, 2, 4], [0, 4, 2, 5], [0, 4, 5, 3]])
