"""Factors of a mesh's matrices against dense algebra, and the order in which unknowns are eliminated."""

import numpy as np
import pytest
from pytest import approx, raises
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from sonolube.errors import InvalidInput
from sonolube.facts.materials import piezo_ceramic
from sonolube.models.fem import Electrodes, FixedSupport, Model, box_mesh, change_order, isotropic_medium, poled_medium
from sonolube.models.fem.solver.multifrontal import multifrontal_factor, nested_dissection
from sonolube.models.fem.solver.system import assemble_system, shift_invert_solver

SHIFT = -1e10  # rad2/s2
STEEL = isotropic_medium(youngs_modulus=200e9, poisson_ratio=0.29, density=7900.0)
MESH = box_mesh(length=0.02, width=0.01, thickness=0.005, divisions=(4, 2, 2))
ELECTRODES = {
    "two electrodes": Electrodes(driven=("+z",), grounded=("-z",)),
    "a floating electrode": Electrodes(grounded=("-z",), floating=("+z",)),
}


def test_every_node_is_eliminated_once() -> None:
    groups = nested_dissection(change_order(MESH, order=3))
    assert np.array_equal(np.sort(np.concatenate(groups)), np.arange(change_order(MESH, order=3).node_count))


def test_halves_touch_only_through_the_nodes_eliminated_after_them() -> None:
    # The last group parts the mesh: no element has nodes of both sides that are in no later group.
    mesh = box_mesh(length=0.04, width=0.01, thickness=0.01, divisions=(8, 2, 2))
    last = nested_dissection(mesh)[-1]
    pairs = np.concatenate([mesh.elements[:, [a, b]] for a in range(10) for b in range(10)])
    kept = pairs[~np.isin(pairs, last).any(axis=1)]
    apart = sparse.coo_array((np.ones(len(kept)), (kept[:, 0], kept[:, 1])), shape=(mesh.node_count, mesh.node_count))
    _, side = connected_components(apart)
    rest = np.setdiff1d(np.arange(mesh.node_count), last)
    assert len(np.unique(side[rest])) == 2
    assert np.bincount(side[rest]).max() < 0.75 * mesh.node_count


@pytest.mark.parametrize("held", [(), (FixedSupport(face="-x"),)], ids=["free", "held"])
@pytest.mark.parametrize("order", [2, 3])
def test_an_elastic_body_is_solved_as_dense_algebra_does(order: int, held: tuple[FixedSupport, ...]) -> None:
    model = Model(mesh=change_order(MESH, order=order), media={"block": STEEL}, fixed=held)
    equations = assemble_system(model)
    force = np.random.default_rng(0).standard_normal((len(equations.free_dofs), 3))
    dense = (equations.stiffness - SHIFT * equations.mass).toarray()
    expected = np.linalg.solve(dense, force)
    found = shift_invert_solver(model, equations, shift=SHIFT)
    assert found(force) == approx(expected, abs=1e-9 * np.abs(expected).max())
    assert found(force[:, 0]) == approx(expected[:, 0], abs=1e-9 * np.abs(expected).max())


@pytest.mark.parametrize("electrodes", list(ELECTRODES.values()), ids=list(ELECTRODES))
def test_a_piezoelectric_body_is_solved_as_dense_algebra_does(electrodes: Electrodes) -> None:
    ceramic = poled_medium(piezo_ceramic("pzt4"), along=(0.0, 0.0, 1.0))
    model = Model(mesh=MESH, media={"block": ceramic}, electrodes=electrodes)
    equations = assemble_system(model)
    force = np.random.default_rng(0).standard_normal(len(equations.free_dofs))
    coupling = equations.coupling.toarray()
    elastic = (equations.stiffness - SHIFT * equations.mass).toarray()
    expected = np.linalg.solve(elastic + coupling @ np.linalg.solve(equations.dielectric.toarray(), coupling.T), force)
    assert shift_invert_solver(model, equations, shift=SHIFT)(force) == approx(
        expected, abs=1e-8 * np.abs(expected).max()
    )


def test_a_matrix_without_a_unique_solution_is_refused() -> None:
    # Stiffness alone lets a free body move as it is.
    equations = assemble_system(Model(mesh=MESH, media={"block": STEEL}))
    groups = [(3 * nodes[:, np.newaxis] + np.arange(3)).ravel() for nodes in nested_dissection(MESH)]
    with raises(InvalidInput, match="no unique solution"):
        multifrontal_factor(equations.stiffness, groups=groups, signs=[1] * len(groups))
