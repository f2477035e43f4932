"""Meshes: triangulation of faces."""

import numpy as np
import pytest
from pytest import approx

from sonolube.models.fem import box_mesh, change_order, face_triangulation

ORDERS = (2, 3, 4, 5, 6)


@pytest.mark.parametrize("order", ORDERS)
def test_the_triangulation_of_a_face_covers_it_with_one_orientation(order: int) -> None:
    mesh = change_order(box_mesh(length=0.03, width=0.02, thickness=0.01, divisions=(3, 2, 1)), order=order)
    corner = mesh.nodes[face_triangulation(mesh, face="+z")]
    area = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])[:, 2] / 2
    assert len(area) == 12 * order**2
    assert np.abs(area).sum() == approx(6e-4)
    own = np.sign(area).reshape(12, -1)
    assert np.all(own == own[:, :1])
