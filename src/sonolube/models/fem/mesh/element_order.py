"""Meshes of geometry by netgen, and p-refinement: another element order, transfer of nodal fields, untangling.

In the Jacobian matrices of the isoparametric mapping, their determinants and adjugates the two indices of a matrix come
first, so that each component is an array over elements and points. That is many times as fast as the routines of numpy
for stacks of small matrices.
"""

from collections import defaultdict
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from sonolube.checks import Floats, Integers, require_positive
from sonolube.errors import InvalidInput
from sonolube.models.fem.mesh.geometry import MILLIMETRE, Geometry, cad_kernel, captured_output
from sonolube.models.fem.mesh.mesh import HIGHEST_ORDER, Mesh, lagrange_nodes, shape_functions, simplex_quadrature

_CYCLES = ((1, 2), (2, 0), (0, 1))  # the two indices that follow each index


def jacobian_matrices(nodes: Floats, gradient: Floats) -> Floats:
    r"""Jacobian matrices :math:`\partial x_k/\partial \xi_d` of elements at points.

    `nodes` has shape (e, a, 3). `gradient` has shape (a, d, q). Shape (d, 3, e, q).
    """
    by_direction = np.ascontiguousarray(np.moveaxis(nodes, -1, 0)) @ gradient.reshape(len(gradient), -1)
    return by_direction.reshape(3, len(nodes), *gradient.shape[1:]).transpose(2, 0, 1, 3)


def determinant(matrix: Floats) -> Floats:
    """Determinants of matrices of three rows and columns.

    `matrix` has shape (3, 3, ...). Shape (...).
    """
    return np.asarray(sum(matrix[0, k] * _cofactor(matrix, 0, k) for k in range(3)))


def adjugate(matrix: Floats) -> Floats:
    """Adjugates of matrices of three rows and columns: their inverses times their determinants.

    `matrix` has shape (3, 3, ...).
    """
    return np.array([[_cofactor(matrix, column, row) for column in range(3)] for row in range(3)])


def _cofactor(matrix: Floats, row: int, column: int) -> Floats:
    """Cofactors of one entry."""
    (a, b), (c, d) = _CYCLES[row], _CYCLES[column]
    return np.asarray(matrix[a, c] * matrix[b, d] - matrix[a, d] * matrix[b, c])


_MIN_JACOBIAN = 1e-3  # smallest over mean Jacobian determinant in an element, below which it counts as tangled
_CURVATURE_KEPT = 0.8  # of the offset of curved nodes from the straight element, in each step of untangling
_MAX_STEPS = 400  # straightening one element can tangle its neighbour, but offsets only ever shrink


def change_order(mesh: Mesh, *, order: int) -> Mesh:
    """Mesh of the same tetrahedra with another element order.

    Parameters
    ----------
    mesh : Mesh
    order : int
        Polynomial degree of the elements, from 2 to 8.

    Returns
    -------
    Mesh
        Its nodes lie on the exact geometry where the mesh has `curved_nodes`, else on the given curved elements.

    Raises
    ------
    InvalidInput
        If the order is out of range.
    """
    if not 2 <= order <= HIGHEST_ORDER:
        raise InvalidInput(f"order must be from 2 to {HIGHEST_ORDER}, got {order}")
    if order == mesh.order:
        return mesh
    return mesh_from_elements(
        mesh.elements[:, :4],
        coordinates=_node_coordinates(mesh, order),
        faces={name: triangles[:, :3] for name, triangles in mesh.faces.items()},
        order=order,
        region_of_element=mesh.region_of_element,
        regions=mesh.regions,
        curved_nodes=mesh.curved_nodes,
    )


def mesh_from_elements(
    corners: Integers,
    *,
    coordinates: Floats,
    faces: Mapping[str, Integers],
    order: int,
    region_of_element: Integers,
    regions: tuple[str, ...],
    curved_nodes: Callable[[int], Floats] | None,
) -> Mesh:
    """Mesh from the corner labels and node coordinates of each element, with nodes numbered and elements untangled.

    `corners` has shape (m, 4). `coordinates` has shape (m, a, 3). `faces` has shape (k, 3).
    """
    # A node is identified by its corners and its barycentric coordinates: their products with a random number of each
    # corner sum to a key, modulo 2^64, which two nodes share with negligible probability.
    weights = np.random.default_rng(order).integers(1, 2**62, size=int(corners.max()) + 1)
    keys = weights[corners] @ lagrange_nodes(order, corners=4).T
    distinct, first, numbers = np.unique(keys, return_index=True, return_inverse=True)
    rank = np.argsort(np.argsort(first))
    elements = rank[numbers].reshape(keys.shape)
    nodes = np.empty((len(distinct), 3))
    nodes[elements] = coordinates
    side_keys = {name: weights[triangles] @ lagrange_nodes(order, corners=3).T for name, triangles in faces.items()}
    return Mesh(
        nodes=untangle_nodes(nodes, elements, order=order),
        elements=elements,
        region_of_element=region_of_element,
        regions=regions,
        faces={name: rank[np.searchsorted(distinct, key)] for name, key in side_keys.items()},
        curved_nodes=curved_nodes,
    )


def transfer_field(field: Floats, *, source: Mesh, target: Mesh) -> Floats:
    """Nodal field interpolated from a mesh to the same mesh of another element order.

    Parameters
    ----------
    field : ndarray, shape (..., n, c)
        Values at the nodes of the source.
    source, target : Mesh
        Meshes of the same tetrahedra, in the same sequence.

    Returns
    -------
    ndarray, shape (..., m, c)
        Values at the nodes of the target.

    Raises
    ------
    InvalidInput
        If the meshes differ in their number of elements.
    """
    if len(source.elements) != len(target.elements):
        raise InvalidInput(
            "a field can be transferred only to a mesh of the same tetrahedra; make the target from the source by "
            "change_order"
        )
    weights, _ = shape_functions(source.order, lagrange_nodes(target.order, corners=4) / target.order)
    values = np.einsum("...eai,ab->...ebi", field[..., source.elements, :], weights, optimize=True)
    transferred = np.empty((*field.shape[:-2], target.node_count, field.shape[-1]), dtype=values.dtype)
    transferred[..., target.elements, :] = values
    return transferred


def untangle_nodes(nodes: Floats, elements: Integers, *, order: int) -> Floats:
    r"""Node coordinates with tangled elements straightened step by step until no Jacobian determinant is negative.

    `nodes` has shape (n, 3). `elements` has shape (m, a).

    Shape (n, 3). Corners stay where they are.

    An element counts as tangled where :math:`\min_q \det J` over its quadrature points is below a thousandth of their
    mean. Its nodes then move towards those of the straight element, :math:`x \leftarrow x_s + 0.8\,(x - x_s)`.
    """
    points, _ = simplex_quadrature(2 * order, corners=4)
    _, gradients = shape_functions(order, points)
    barycentric = lagrange_nodes(order, corners=4) / order
    untangled = nodes.copy()
    for _ in range(_MAX_STEPS):
        jacobian = determinant(jacobian_matrices(untangled[elements], gradients))
        tangled = elements[jacobian.min(axis=1) < _MIN_JACOBIAN * np.abs(jacobian).mean(axis=1)]
        if not len(tangled):
            break
        straight = np.einsum("ac,ecx->eax", barycentric, untangled[tangled[:, :4]])
        untangled[tangled] = straight + _CURVATURE_KEPT * (untangled[tangled] - straight)
    return untangled


def _node_coordinates(mesh: Mesh, order: int) -> Floats:
    """Coordinates of the nodes of each element at an order, shape (m, a, 3)."""
    if mesh.curved_nodes is not None:
        corners = mesh.curved_nodes(mesh.order)[:, :4]
        if np.allclose(corners, mesh.nodes[mesh.elements[:, :4]], rtol=0.0, atol=1e-9 * np.ptp(mesh.nodes)):
            return mesh.curved_nodes(order)  # valid only while the nodes were not moved
    weights, _ = shape_functions(mesh.order, lagrange_nodes(order, corners=4) / order)
    return np.asarray(np.einsum("ab,eax->ebx", weights, mesh.nodes[mesh.elements], optimize=True))


# Node numbering of netgen to that of `Mesh`: opposite orientation, other sequence of the edges.
_TETRAHEDRON = [0, 2, 1, 3, 5, 7, 4, 6, 9, 8]
_TRIANGLE = [0, 1, 2, 5, 3, 4]
_ELEMENTS_PER_RADIUS = 1.5  # of curvature; with fewer, curved elements become tangled
_MAX_LINES = 2  # of the output quoted when meshing fails; later lines repeat


def generate_mesh(geometry: Geometry, *, element_size: float, order: int = 2) -> Mesh:
    """Mesh of isoparametric tetrahedra whose nodes lie on the geometry.

    Parameters
    ----------
    geometry : Geometry
    element_size : float
        Largest edge of an element; edges are shorter where the geometry is finer. [m]
    order : int
        Polynomial degree of the elements, from 2 to 8.

    Returns
    -------
    Mesh

    Raises
    ------
    InvalidInput
        If netgen fails or its mesh does not fill the body: the geometry is open or intersects itself.

    Notes
    -----
    Meshing is deterministic: the same geometry and element size give the same mesh, whatever was meshed before.

    References
    ----------
    .. [1] J. Schöberl, Comput. Vis. Sci. 1, 41 (1997). doi:10.1007/s007910050004
    """
    require_positive(element_size=element_size)
    fresh = geometry.shape.Move((0.0, 0.0, 0.0))  # a copy: the kernel would reuse triangles of an earlier meshing
    printed: list[str] = []
    try:
        with captured_output() as printed:
            raw = (
                cad_kernel()
                .OCCGeometry(fresh)
                .GenerateMesh(
                    maxh=element_size / MILLIMETRE,
                    grading=0.5,
                    curvaturesafety=_ELEMENTS_PER_RADIUS,
                    parallel_meshing=False,  # contention of its threads makes it ten times slower
                )
            )
            straight = raw.Copy()
            raw.SecondOrder()
    except Exception as failure:  # netgen raises no narrower class
        reason = "; ".join([str(failure), *printed[:_MAX_LINES]])
        raise InvalidInput(f"the body could not be meshed; is it open, or does it cut itself? ({reason})") from None
    cells = raw.Elements3D().NumPy()
    if not len(cells):
        raise InvalidInput("the mesher found no volume: the geometry is open or has no thickness")
    tetrahedra = cells["nodes"][:, _TETRAHEDRON].astype(np.int64) - 1
    mesh = Mesh(
        nodes=untangle_nodes(np.asarray(raw.Coordinates(), dtype=np.float64) * MILLIMETRE, tetrahedra, order=2),
        elements=tetrahedra,
        region_of_element=cells["index"].astype(np.int64) - 1,
        regions=geometry.regions,
        faces=_faces(raw, geometry.regions),
        curved_nodes=lambda degree: _curved_nodes(straight, degree),
    )
    _require_filled(mesh, geometry)
    return change_order(mesh, order=order)


def _curved_nodes(straight: Any, order: int) -> Floats:
    """Coordinates in m of the nodes of each tetrahedron of an order, by netgen's projection onto the geometry."""
    straight.Curve(order)
    points = lagrange_nodes(order, corners=4)[:, [0, 2, 1]] / order  # the fourth corner is netgen's origin
    nodes = np.zeros((len(straight.Elements3D()), len(points), 3))
    straight.CalcElementMapping(np.ascontiguousarray(points), nodes)
    return nodes * MILLIMETRE


def _faces(raw: Any, regions: tuple[str, ...]) -> dict[str, Integers]:
    """Triangles of each named face; faces between two regions are named after both."""
    triangles = raw.Elements2D().NumPy()
    nodes = triangles["nodes"][:, _TRIANGLE].astype(np.int64) - 1
    by_name = defaultdict(list)
    for number, face in enumerate(raw.FaceDescriptors(), start=1):
        sides = sorted(side - 1 for side in (face.domin, face.domout) if side > 0)
        name = "|".join(regions[side] for side in sides) if len(sides) == 2 else face.bcname
        by_name[name].append(nodes[triangles["index"] == number])
    return {name: np.concatenate(parts) for name, parts in by_name.items()}


def _require_filled(mesh: Mesh, geometry: Geometry) -> None:
    """Refuse a mesh whose volume differs from that of the geometry by a quarter or more."""
    corner = mesh.nodes[mesh.elements[:, :4]]
    filled = float(np.linalg.det(corner[:, 1:] - corner[:, :1]).sum()) / 6
    if not abs(filled / geometry.volume - 1) < 0.25:  # elements with straight sides miss part of curved bodies
        raise InvalidInput(
            f"the mesh fills {filled:.4g} m3 of a body of {geometry.volume:.4g} m3: "
            "its faces cut each other, or the elements are far too large for its curves"
        )
