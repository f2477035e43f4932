"""Meshes of one order from those of another, and fields from one to the other."""

from collections.abc import Callable, Mapping

import numpy as np

from sonolube.checks import Floats, Integers
from sonolube.errors import InvalidInput
from sonolube.fem.solver.mesh import HIGHEST_ORDER, Mesh
from sonolube.fem.solver.simplex import lagrange_nodes, shape_functions, simplex_quadrature

_FOLDED = 1e-3  # smallest over mean volume per unit of an element that is taken as it is
_STRAIGHTENED = 0.8  # what is left of the curves of a folded element, step by step
_STEPS = 400  # straightening one element can fold the next, but nodes only ever come closer to straight


def change_order(mesh: Mesh, *, order: int) -> Mesh:
    """Return the same tetrahedra with the nodes of another order.

    Parameters
    ----------
    mesh : Mesh
    order : int
        Degree of the polynomials in an element, from 2 to 8.

    Returns
    -------
    Mesh
        Its nodes follow the curves of the body where the mesh knows them, else those of the given elements.

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
        places=_places(mesh, order),
        faces={name: triangles[:, :3] for name, triangles in mesh.faces.items()},
        order=order,
        region_of_element=mesh.region_of_element,
        regions=mesh.regions,
        curves=mesh.curves,
    )


def mesh_from_elements(
    corners: Integers,
    *,
    places: Floats,
    faces: Mapping[str, Integers],
    order: int,
    region_of_element: Integers,
    regions: tuple[str, ...],
    curves: Callable[[int], Floats] | None,
) -> Mesh:
    """Return a mesh of tetrahedra known by their corners, its nodes numbered and no element folded.

    Parameters
    ----------
    corners : ndarray of int, shape (m, 4)
        Any number for each corner, the same where elements share it.
    places : ndarray, shape (m, a, 3)
        Where the nodes of each element stand, in m.
    faces : mapping of str to ndarray of int, shape (k, 3)
        Corners of the triangles of each face.
    order : int
    region_of_element, regions, curves
        As in the mesh.

    Returns
    -------
    Mesh
    """
    # A node is known by the corners it lies between and its coordinates: their products with a number drawn for each
    # corner sum to a key, modulo 2^64, which two nodes share as good as never.
    drawn = np.random.default_rng(order).integers(1, 2**62, size=int(corners.max()) + 1)
    keys = drawn[corners] @ lagrange_nodes(order, corners=4).T
    known, first, numbers = np.unique(keys, return_index=True, return_inverse=True)
    rank = np.argsort(np.argsort(first))
    elements = rank[numbers].reshape(keys.shape)
    nodes = np.empty((len(known), 3))
    nodes[elements] = places
    on_sides = {name: drawn[triangles] @ lagrange_nodes(order, corners=3).T for name, triangles in faces.items()}
    return Mesh(
        nodes=untangle_nodes(nodes, elements, order=order),
        elements=elements,
        region_of_element=region_of_element,
        regions=regions,
        faces={name: rank[np.searchsorted(known, key)] for name, key in on_sides.items()},
        curves=curves,
    )


def transfer_field(field: Floats, *, source: Mesh, target: Mesh) -> Floats:
    """Return a field of one mesh on the nodes of another order of it.

    Parameters
    ----------
    field : ndarray, shape (..., n, c)
        Values on the nodes of the source.
    source, target : Mesh
        Of the same tetrahedra in the same order.

    Returns
    -------
    ndarray, shape (..., m, c)
    """
    if len(source.elements) != len(target.elements):
        raise InvalidInput("a field can be carried only to a mesh of the same tetrahedra")
    weights, _ = shape_functions(source.order, lagrange_nodes(target.order, corners=4) / target.order)
    values = np.einsum("...eai,ab->...ebi", field[..., source.elements, :], weights, optimize=True)
    moved = np.empty((*field.shape[:-2], target.node_count, field.shape[-1]), dtype=values.dtype)
    moved[..., target.elements, :] = values
    return moved


def untangle_nodes(nodes: Floats, elements: Integers, *, order: int) -> Floats:
    """Return the nodes with elements less curved where curving them has folded the element.

    Parameters
    ----------
    nodes : ndarray, shape (n, 3)
        Coordinates in m.
    elements : ndarray of int, shape (m, a)
    order : int

    Returns
    -------
    ndarray, shape (n, 3)
    """
    places, _ = simplex_quadrature(2 * order, corners=4)
    _, slopes = shape_functions(order, places)
    straight = lagrange_nodes(order, corners=4) / order
    kept = nodes.copy()
    for _ in range(_STEPS):
        volume = np.linalg.det(np.einsum("eax,adq->eqdx", kept[elements], slopes, optimize=True))
        folded = elements[volume.min(axis=1) < _FOLDED * np.abs(volume).mean(axis=1)]
        if not len(folded):
            break
        flat = np.einsum("ac,ecx->eax", straight, kept[folded[:, :4]])
        kept[folded] = flat + _STRAIGHTENED * (kept[folded] - flat)
    return kept


def _places(mesh: Mesh, order: int) -> Floats:
    """Return where the nodes of each element stand, shape (m, a, 3)."""
    if mesh.curves is not None:
        known = mesh.curves(mesh.order)[:, :4]
        if np.allclose(known, mesh.nodes[mesh.elements[:, :4]], rtol=0.0, atol=1e-9 * np.ptp(mesh.nodes)):
            return mesh.curves(order)  # the mesh was not moved since
    weights, _ = shape_functions(mesh.order, lagrange_nodes(order, corners=4) / order)
    return np.asarray(np.einsum("ab,eax->ebx", weights, mesh.nodes[mesh.elements], optimize=True))
