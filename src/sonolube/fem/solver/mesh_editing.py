"""Meshes made from meshes: nodes moved, patches of faces named, edges found."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats, Integers
from sonolube.errors import InvalidInput, UnknownName
from sonolube.fem.solver.mesh import Mesh
from sonolube.fem.solver.model import DIRECTIONS


def transform_nodes(mesh: Mesh, to: Callable[[Floats], Floats]) -> Mesh:
    """Return a mesh with its nodes moved: a block made a wedge, or tapered, without a CAD kernel.

    Parameters
    ----------
    mesh : Mesh
    to : callable
        From coordinates in m, shape (n, 3), to those of the new body. Where it has a kink, let elements meet.

    Returns
    -------
    Mesh
    """
    return replace(mesh, nodes=to(mesh.nodes))


def add_face_patch(mesh: Mesh, name: str, *, of: str, where: Callable[[Floats], NDArray[np.bool_]]) -> Mesh:
    """Return a mesh in which part of a face has a name of its own.

    Parameters
    ----------
    mesh : Mesh
    name : str
        What to call the part.
    of : str
        Name of the face, which stays whole.
    where : callable
        From the middles of triangles in m, shape (t, 3), to whether they belong to the part, shape (t,).

    Returns
    -------
    Mesh

    Raises
    ------
    InvalidInput
        If no triangle belongs to the part.
    """
    mesh.face_nodes(of)
    triangles = mesh.faces[of]
    chosen = triangles[where(mesh.nodes[triangles[:, :3]].mean(axis=1))]
    if not len(chosen):
        raise InvalidInput(f"no triangle of face {of} belongs to {name}; mesh it finer, or make the patch larger")
    return replace(mesh, faces={**mesh.faces, name: chosen})


def edge_nodes(mesh: Mesh, one: str, other: str, *, along: str) -> Integers:
    """Return the nodes on the edge between two faces, in order of a coordinate.

    Parameters
    ----------
    mesh : Mesh
    one, other : str
        Names of the faces.
    along : str
        "x", "y" or "z".

    Returns
    -------
    ndarray of int, shape (k,)

    Raises
    ------
    InvalidInput
        If the faces do not meet.
    UnknownName
        If there is no such face or direction.
    """
    if along not in DIRECTIONS:
        raise UnknownName.among(DIRECTIONS, kind="direction", name=along)
    shared = np.intersect1d(mesh.face_nodes(one), mesh.face_nodes(other))
    if not shared.size:
        raise InvalidInput(f"the faces {one} and {other} do not meet")
    return np.asarray(shared[np.argsort(mesh.nodes[shared, DIRECTIONS.index(along)])])
