"""Face patches, transformed meshes and common edges."""

import numpy as np
from pytest import approx, raises

from sonolube.errors import InvalidInput, UnknownName
from sonolube.models.fem import add_face_patch, box_mesh, edge_nodes, transform_nodes

L, W = 0.1, 0.02


def test_a_patch_is_part_of_its_face_and_an_empty_one_is_refused() -> None:
    mesh = box_mesh(length=L, width=W, thickness=W, divisions=(4, 2, 2))
    patched = add_face_patch(mesh, "right half", of="+z", where=lambda middles: middles[:, 0] > 0)
    assert set(patched.face_nodes("right half")) < set(patched.face_nodes("+z"))
    with raises(InvalidInput, match=r"no triangle of face \+z belongs to nowhere"):
        add_face_patch(mesh, "nowhere", of="+z", where=lambda middles: middles[:, 0] > 1)


def test_a_block_with_stretched_nodes_is_a_longer_block() -> None:
    short, long = (box_mesh(length=size, width=W, thickness=W, divisions=(3, 1, 1)) for size in (L, 2 * L))
    stretched = transform_nodes(short, lambda nodes: nodes * np.array([2.0, 1.0, 1.0]))
    assert stretched.nodes == approx(long.nodes)


def test_faces_without_a_common_edge_are_refused() -> None:
    mesh = box_mesh(length=L, width=W, thickness=W, divisions=(2, 1, 1))
    edge = edge_nodes(mesh, "-y", "-z", along="x")
    assert np.all(np.diff(mesh.nodes[edge, 0]) > 0)
    with raises(InvalidInput, match=r"the faces -x and \+x have no common edge"):
        edge_nodes(mesh, "-x", "+x", along="x")
    with raises(UnknownName, match="unknown direction 'w'"):
        edge_nodes(mesh, "-y", "-z", along="w")
