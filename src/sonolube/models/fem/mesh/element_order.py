"""p-refinement: meshes of another element order, transfer of nodal fields between them, untangling of elements."""

from collections.abc import Callable, Mapping

import numpy as np

from sonolube.checks import Floats, Integers
from sonolube.errors import InvalidInput
from sonolube.models.fem.mesh.mapping import determinant, jacobian_matrices
from sonolube.models.fem.mesh.mesh import HIGHEST_ORDER, Mesh
from sonolube.models.fem.mesh.simplex import lagrange_nodes, shape_functions, simplex_quadrature

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
