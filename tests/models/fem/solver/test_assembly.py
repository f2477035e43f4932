"""Global matrices: patch test, mass and area of the body, convergence of a manufactured solution."""

import math

import numpy as np
import pytest
from pytest import approx

from sonolube.models.fem import FixedSupport, Mesh, Model, box_mesh, change_order, isotropic_medium
from sonolube.models.fem.mesh.mesh import lagrange_nodes, shape_functions, simplex_quadrature
from sonolube.models.fem.solver.assembly import assemble_matrices, tributary_areas

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


BLOCK = {"length": 0.127, "width": 0.06096, "thickness": 0.0254}


def sheared(mesh: Mesh) -> Mesh:
    """The same mesh with its inner nodes out of line, still with straight edges."""
    moved = mesh.nodes.copy()
    half = np.abs(mesh.nodes).max(axis=0)
    bump = np.prod(1 - (mesh.nodes / half) ** 2, axis=1, keepdims=True)
    moved += bump * np.array([0.08, -0.06, 0.03]) * half
    for k, (a, b) in enumerate(((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))):
        moved[mesh.elements[:, 4 + k]] = (moved[mesh.elements[:, a]] + moved[mesh.elements[:, b]]) / 2
    return Mesh(
        nodes=moved,
        elements=mesh.elements,
        region_of_element=mesh.region_of_element,
        regions=mesh.regions,
        faces=mesh.faces,
    )


@pytest.mark.parametrize("order", ORDERS)
def test_elements_of_every_order_pass_the_patch_test(order: int) -> None:
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


@pytest.mark.parametrize(("order", "cells"), [(2, 4), (3, 3), (4, 2), (5, 2)])
def test_the_energy_of_a_manufactured_solution_converges_with_twice_the_order(order: int, cells: int) -> None:
    errors = [energy_of_error(order, n) for n in (cells, 2 * cells)]
    assert math.log2(errors[0] / errors[1]) == approx(2 * order, abs=0.35)


def test_a_mesh_of_distorted_elements_passes_the_patch_test() -> None:
    # The patch test: forces inside vanish, and the energy is that of the strain in the volume.
    mesh = sheared(box_mesh(**BLOCK, divisions=(3, 2, 2)))
    gradient = np.array([[1.0, 0.3, -0.2], [0.1, -0.4, 0.5], [0.7, 0.2, 0.6]])
    displacement = (mesh.nodes @ gradient.T).ravel()
    stiffness = assemble_matrices(Model(mesh=mesh, media={"block": STEEL})).stiffness
    force = (stiffness @ displacement).reshape(-1, 3)
    surface = np.unique(np.concatenate([mesh.face_nodes(name) for name in mesh.faces]))
    inner = np.setdiff1d(np.arange(mesh.node_count), surface)
    assert inner.size
    assert np.abs(force[inner]).max() < 1e-9 * np.abs(force).max()
    strain = (gradient + gradient.T) / 2
    voigt = np.array([*strain.diagonal(), 2 * strain[1, 2], 2 * strain[0, 2], 2 * strain[0, 1]])
    volume = BLOCK["length"] * BLOCK["width"] * BLOCK["thickness"]
    assert displacement @ (stiffness @ displacement) == approx(volume * voigt @ STEEL.elastic_stiffness @ voigt)


def test_the_mass_of_a_translation_is_the_mass_of_the_body() -> None:
    mesh = sheared(box_mesh(**BLOCK, divisions=(3, 2, 2)))
    along = np.tile([0.0, 1.0, 0.0], mesh.node_count)
    mass = 7900.0 * BLOCK["length"] * BLOCK["width"] * BLOCK["thickness"]
    assert along @ (assemble_matrices(Model(mesh=mesh, media={"block": STEEL})).mass @ along) == approx(mass, rel=1e-9)
