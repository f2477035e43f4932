"""Mesh editing without a CAD kernel: coordinate transformation, named face patches, nodes of edges."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats, Integers
from sonolube.errors import InvalidInput, UnknownName
from sonolube.models.fem.mesh.mesh import DIRECTIONS, Mesh


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
