"""Change of the element order: transfer of fields there and back."""

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.models.fem import Mesh, box_mesh, change_order, transfer_field
from sonolube.models.fem.mesh.mesh import lagrange_nodes

ORDERS = (2, 3, 4, 5, 6)


def oblique_mesh(order: int) -> Mesh:
    """A block whose inner nodes are out of line, with straight edges."""
    box = box_mesh(length=0.05, width=0.03, thickness=0.02, divisions=(3, 2, 2))
    half = np.ptp(box.nodes, axis=0) / 2
    bump = np.prod(1 - (box.nodes / half) ** 2, axis=1, keepdims=True)
    moved = box.nodes + bump * np.array([0.08, -0.06, 0.03]) * half
    corners = moved[box.elements[:, :4]]
    moved[box.elements] = np.einsum("ac,ecx->eax", lagrange_nodes(2, corners=4) / 2, corners)
    straight = Mesh(
        nodes=moved,
        elements=box.elements,
        region_of_element=box.region_of_element,
        regions=box.regions,
        faces=box.faces,
    )
    return change_order(straight, order=order)


@pytest.mark.parametrize("order", ORDERS)
def test_a_field_transferred_to_a_higher_order_and_back_is_unchanged(order: int) -> None:
    coarse = oblique_mesh(2)
    fine = change_order(coarse, order=order)
    field = np.random.default_rng(3).standard_normal((2, coarse.node_count, 3))
    there = transfer_field(field, source=coarse, target=fine)
    assert transfer_field(there, source=fine, target=coarse) == approx(field, abs=1e-9)
    assert transfer_field(coarse.nodes, source=coarse, target=fine) == approx(fine.nodes, abs=1e-12)


def test_an_order_out_of_range_and_another_mesh_are_refused() -> None:
    mesh = box_mesh(length=0.03, width=0.02, thickness=0.01, divisions=(1, 1, 1))
    with raises(InvalidInput, match="order must be from 2 to 8, got 9"):
        change_order(mesh, order=9)
    with raises(InvalidInput, match="same tetrahedra"):
        transfer_field(mesh.nodes, source=mesh, target=oblique_mesh(2))
