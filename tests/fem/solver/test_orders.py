"""Elements of any order: what they represent exactly, how fast they converge, and the shapes they follow."""

import math

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.fem import (
    FixedSupport,
    Mesh,
    Model,
    box_mesh,
    change_order,
    face_triangulation,
    isotropic_medium,
    natural_modes,
    transfer_field,
)
from sonolube.fem.solver.assembly import assemble_matrices, tributary_areas
from sonolube.fem.solver.grading import grade_reentrant_edges
from sonolube.fem.solver.simplex import lagrange_nodes, shape_functions, simplex_quadrature

ORDERS = (2, 3, 4, 5, 6)
STEEL = isotropic_medium(youngs_modulus=200e9, poisson_ratio=0.29, density=7900.0)


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
def test_shape_functions_are_one_at_their_own_node_and_sum_to_one(order: int) -> None:
    nodes = lagrange_nodes(order, corners=4)
    values, slopes = shape_functions(order, nodes / order)
    assert values == approx(np.eye(len(nodes)), abs=1e-9)
    assert slopes.sum(axis=0) == approx(0.0, abs=1e-9)


@pytest.mark.parametrize("degree", [1, 4, 9, 12])
def test_quadrature_integrates_powers_as_the_factorials_of_dirichlet_say(degree: int) -> None:
    # int x^a y^b z^c dV = a! b! c!/(a + b + c + 3)! over the unit tetrahedron, alike with two coordinates.
    places, weights = simplex_quadrature(degree, corners=4)
    for a, b, c in ((degree, 0, 0), (degree // 2, degree - degree // 2, 0), (degree // 3, degree // 3, degree // 3)):
        exact = math.factorial(a) * math.factorial(b) * math.factorial(c) / math.factorial(a + b + c + 3)
        assert weights @ (places[:, 1] ** a * places[:, 2] ** b * places[:, 3] ** c) == approx(exact, rel=1e-12)
    places, weights = simplex_quadrature(degree, corners=3)
    assert weights @ places[:, 1] ** degree == approx(1 / ((degree + 1) * (degree + 2)), rel=1e-12)
    assert np.all(weights > 0)


@pytest.mark.parametrize("order", ORDERS)
def test_a_uniform_strain_passes_through_elements_of_every_order(order: int) -> None:
    mesh = oblique_mesh(order)
    gradient = np.array([[1.0, 0.3, -0.2], [0.1, -0.4, 0.5], [0.7, 0.2, 0.6]])
    displacement = (mesh.nodes @ gradient.T).ravel()
    stiffness = assemble_matrices(Model(mesh=mesh, media={"block": STEEL})).stiffness
    force = (stiffness @ displacement).reshape(-1, 3)
    surface = np.unique(np.concatenate([mesh.face_nodes(name) for name in mesh.faces]))
    inner = np.setdiff1d(np.arange(mesh.node_count), surface)
    assert np.abs(force[inner]).max() < 1e-9 * np.abs(force).max()
    strain = (gradient + gradient.T) / 2
    voigt = np.array([*strain.diagonal(), 2 * strain[1, 2], 2 * strain[0, 2], 2 * strain[0, 1]])
    assert displacement @ (stiffness @ displacement) == approx(3e-5 * voigt @ STEEL.elastic_stiffness @ voigt)


@pytest.mark.parametrize("order", ORDERS)
def test_the_mass_and_the_areas_are_those_of_the_body_at_every_order(order: int) -> None:
    mesh = oblique_mesh(order)
    along = np.tile([0.0, 1.0, 0.0], mesh.node_count)
    assert along @ (assemble_matrices(Model(mesh=mesh, media={"block": STEEL})).mass @ along) == approx(7900.0 * 3e-5)
    assert tributary_areas(mesh, "+z").sum() == approx(0.05 * 0.03)


def energy_of_error(order: int, cells: int) -> float:
    """Share of the energy that the elements miss of a rod loaded so that u = (cos kx, 0, 0), held at its ends."""
    length, k = 0.1, math.pi / 0.1
    box = box_mesh(length=length, width=length / cells, thickness=length / cells, divisions=(cells, 1, 1))
    mesh = change_order(box, order=order)
    held = (FixedSupport(face=None, along="yz"), FixedSupport(face="-x"), FixedSupport(face="+x"))
    model = Model(mesh=mesh, media={"block": STEEL}, fixed=held)
    matrices = assemble_matrices(model)
    inner = np.setdiff1d(
        3 * np.arange(mesh.node_count), 3 * np.concatenate([mesh.face_nodes("-x"), mesh.face_nodes("+x")])
    )
    # cos kx vanishes at both ends, x = +-pi/(2 k); its force density is c_11 k^2 cos kx.
    places, weights = simplex_quadrature(2 * order + 6, corners=4)
    value, slope = shape_functions(order, places)
    nodes = mesh.nodes[mesh.elements]
    volume = np.linalg.det(np.einsum("eax,adq->eqdx", nodes, slope)) * weights
    x = np.einsum("ea,aq->eq", nodes[:, :, 0], value)
    modulus = STEEL.elastic_stiffness[0, 0]
    load = np.zeros(3 * mesh.node_count)
    np.add.at(load, 3 * mesh.elements, np.einsum("aq,eq->ea", value, volume * modulus * k**2 * np.cos(k * x)))
    solution = np.linalg.solve(matrices.stiffness[inner][:, inner].toarray(), load[inner])
    exact = modulus * k**2 * (length / cells) ** 2 * length / 2
    return float(1 - load[inner] @ solution / exact)


@pytest.mark.parametrize(("order", "cells"), [(2, 4), (3, 3), (4, 2), (5, 2)])
def test_the_energy_of_a_manufactured_solution_converges_with_twice_the_order(order: int, cells: int) -> None:
    errors = [energy_of_error(order, n) for n in (cells, 2 * cells)]
    assert math.log2(errors[0] / errors[1]) == approx(2 * order, abs=0.35)


@pytest.mark.parametrize("order", ORDERS)
def test_a_field_carried_to_a_higher_order_and_back_is_the_same(order: int) -> None:
    coarse = oblique_mesh(2)
    fine = change_order(coarse, order=order)
    field = np.random.default_rng(3).standard_normal((2, coarse.node_count, 3))
    there = transfer_field(field, source=coarse, target=fine)
    assert transfer_field(there, source=fine, target=coarse) == approx(field, abs=1e-9)
    assert transfer_field(coarse.nodes, source=coarse, target=fine) == approx(fine.nodes, abs=1e-12)


@pytest.mark.parametrize("order", ORDERS)
def test_flat_triangles_tile_a_face_and_turn_alike(order: int) -> None:
    mesh = change_order(box_mesh(length=0.03, width=0.02, thickness=0.01, divisions=(3, 2, 1)), order=order)
    corner = mesh.nodes[face_triangulation(mesh, face="+z")]
    area = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])[:, 2] / 2
    assert len(area) == 12 * order**2
    assert np.abs(area).sum() == approx(6e-4)
    own = np.sign(area).reshape(12, -1)
    assert np.all(own == own[:, :1])


def l_shaped() -> Mesh:
    """A bar with a quarter cut away, whose corner re-enters along z."""
    box = box_mesh(length=0.04, width=0.04, thickness=0.01, divisions=(2, 2, 1))
    centre = box.nodes[box.elements[:, :4]].mean(axis=1)
    kept = box.elements[(centre[:, 0] < 0) | (centre[:, 1] < 0)]
    used, elements = np.unique(kept, return_inverse=True)
    faces = {
        name: np.searchsorted(used, own[np.isin(own, used).all(axis=1)])
        for name, own in box.faces.items()
        if name in ("-x", "-y", "-z")
    }
    return Mesh(
        nodes=box.nodes[used],
        elements=elements.reshape(kept.shape),
        region_of_element=np.zeros(len(kept), dtype=np.int64),
        regions=("block",),
        faces=faces,
    )


@pytest.mark.parametrize("levels", [1, 2, 3])
def test_grading_leaves_the_body_as_it_is_and_makes_it_softer(levels: int) -> None:
    coarse = l_shaped()
    fine = grade_reentrant_edges(coarse, levels=levels)
    assert len(fine.elements) > 2 * len(coarse.elements)
    assert assemble_matrices(Model(mesh=fine, media={"block": STEEL})).mass.sum() / 3 == approx(7900.0 * 1.2e-5)
    assert tributary_areas(fine, "-x").sum() == approx(4e-4)
    assert tributary_areas(fine, "-z").sum() == approx(1.2e-3)
    assert fine.face_nodes("-z").size > coarse.face_nodes("-z").size
    before, after = (
        natural_modes(Model(mesh=change_order(mesh, order=3), media={"block": STEEL}), count=6).elastic_frequency
        for mesh in (coarse, fine)
    )
    assert np.all(after < before)  # the finer space holds the coarser one


def test_a_body_that_nowhere_re_enters_is_not_graded() -> None:
    mesh = box_mesh(length=0.03, width=0.02, thickness=0.01, divisions=(3, 2, 1))
    assert grade_reentrant_edges(mesh, levels=2) is mesh


def test_an_order_that_there_is_not_is_refused() -> None:
    mesh = box_mesh(length=0.03, width=0.02, thickness=0.01, divisions=(1, 1, 1))
    with raises(InvalidInput, match="order must be from 2 to 8, got 9"):
        change_order(mesh, order=9)
    with raises(InvalidInput, match="same tetrahedra"):
        transfer_field(mesh.nodes, source=mesh, target=oblique_mesh(2))
