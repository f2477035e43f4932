"""Global matrices and natural frequencies against scikit-fem's own elements, numbering and assembly.

scikit-fem: T. Gustafsson and G. D. McBain, J. Open Source Softw. 5, 2369 (2020), doi:10.21105/joss.02369. It has
tetrahedra of orders one and two; their spaces are subspaces of those of any higher order on the same straight-edged
tetrahedra, so that restricted to them the matrices of every order must be the same.
"""

from typing import Any

import numpy as np
import pytest
from pytest import approx
from scipy import sparse
from scipy.linalg import eigh
from scipy.spatial import cKDTree
from skfem import Basis, BilinearForm, ElementTetP1, ElementTetP2, ElementVector, MeshTet
from skfem.helpers import ddot, dot, eye, grad, sym_grad, trace

from sonolube.checks import Integers
from sonolube.facts.materials import piezo_ceramic
from sonolube.models.fem import (
    Electrodes,
    Medium,
    Mesh,
    Model,
    box_mesh,
    change_order,
    isotropic_medium,
    natural_modes,
    poled_medium,
    transfer_field,
    transform_nodes,
)
from sonolube.models.fem.solver.assembly import POTENTIAL_SCALE, assemble_matrices

YOUNGS_MODULUS, POISSON_RATIO, DENSITY = 200e9, 0.29, 7900.0
STEEL = isotropic_medium(youngs_modulus=YOUNGS_MODULUS, poisson_ratio=POISSON_RATIO, density=DENSITY)
PZT = poled_medium(piezo_ceramic("pzt4"), along=(0.3, -0.5, 1.0), lossless=True)
VOIGT = np.array([[0, 5, 4], [5, 1, 3], [4, 3, 2]])
ROUNDING = 1e-12  # of the largest entry of a matrix


def irregular_mesh() -> Mesh:
    """Block with its corners displaced at random and straight edges."""
    block = box_mesh(length=0.03, width=0.02, thickness=0.01, divisions=(2, 2, 2))
    corners = np.unique(block.elements[:, :4])
    offset = np.zeros_like(block.nodes)
    offset[corners] = np.random.default_rng(7).uniform(-6e-4, 6e-4, (len(corners), 3))
    for k, (a, b) in enumerate(((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))):
        offset[block.elements[:, 4 + k]] = (offset[block.elements[:, a]] + offset[block.elements[:, b]]) / 2
    return transform_nodes(block, lambda nodes: nodes + offset)


MESH = irregular_mesh()


def scikit_fem_mesh() -> MeshTet:
    corners, connectivity = np.unique(MESH.elements[:, :4], return_inverse=True)
    return MeshTet(np.ascontiguousarray(MESH.nodes[corners].T), connectivity.reshape(-1, 4).T.copy())


def node_numbers(mesh: MeshTet, *, order: int) -> Integers:
    """Nodes of `MESH` in scikit-fem's sequence: vertices and, for order two, midpoints of edges."""
    points = [mesh.p.T, mesh.p[:, mesh.edges].mean(axis=1).T][:order]
    distance, numbers = cKDTree(MESH.nodes).query(np.concatenate(points))
    assert distance.max() < 1e-12
    return np.asarray(numbers)


def vector_dofs(basis: Basis) -> Integers:
    """Degrees of freedom of a vector basis by node and component, shape (nodes, 3)."""
    dofs = [basis.nodal_dofs.T, basis.edge_dofs.T]
    return np.concatenate([block for block in dofs if block.size])


def our_dofs(nodes: Integers) -> Integers:
    return np.asarray(3 * nodes[:, np.newaxis] + np.arange(3))


def restriction(order: int) -> sparse.csr_array:
    """Nodal values of a mesh of an order from those of the same field at order two, shape (n, n of order two)."""
    unit = np.eye(MESH.node_count)[:, :, np.newaxis]
    values = transfer_field(unit, source=MESH, target=change_order(MESH, order=order))
    return sparse.csr_array(values[:, :, 0].T)


def linear_restriction() -> sparse.csr_array:
    """Nodal values at order two from those at the corners, columns in scikit-fem's sequence of vertices."""
    corners = np.unique(MESH.elements[:, :4])
    matrix = np.zeros((MESH.node_count, len(corners)))
    matrix[corners, np.arange(len(corners))] = 1.0
    column = np.full(MESH.node_count, -1)
    column[corners] = np.arange(len(corners))
    for k, (a, b) in enumerate(((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))):
        for end in (a, b):
            matrix[MESH.elements[:, 4 + k], column[MESH.elements[:, end]]] = 0.5
    return sparse.csr_array(matrix)


def assert_same(ours: Any, theirs: Any) -> None:
    ours, theirs = (matrix.toarray() if hasattr(matrix, "toarray") else np.asarray(matrix) for matrix in (ours, theirs))
    assert ours == approx(theirs, rel=0, abs=ROUNDING * np.abs(theirs).max())


def elasticity(u: Any, v: Any, w: Any) -> Any:
    mu = YOUNGS_MODULUS / (2 * (1 + POISSON_RATIO))
    lam = 2 * mu * POISSON_RATIO / (1 - 2 * POISSON_RATIO)
    strain = sym_grad(u)
    return ddot(2 * mu * strain + eye(lam * trace(strain), 3), sym_grad(v))


def inertia(u: Any, v: Any, w: Any) -> Any:
    return w.density * dot(u, v)


def anisotropic_elasticity(u: Any, v: Any, w: Any) -> Any:
    c = PZT.elastic_stiffness[VOIGT[:, :, np.newaxis, np.newaxis], VOIGT]
    return np.einsum("ikjl,ik...,jl...->...", c, grad(v), grad(u))


def piezoelectric_coupling(potential: Any, v: Any, w: Any) -> Any:
    assert PZT.stress_constants is not None
    e = PZT.stress_constants[:, VOIGT]  # e_lik
    return np.einsum("lik,ik...,l...->...", e, grad(v), grad(potential))


def permittivity(potential: Any, test: Any, w: Any) -> Any:
    assert PZT.permittivity is not None
    return np.einsum("kl,k...,l...->...", PZT.permittivity, grad(test), grad(potential))


@pytest.mark.parametrize("element_order", [1, 2])
def test_stiffness_and_mass_of_an_isotropic_body_are_those_of_scikit_fem(element_order: int) -> None:
    mesh = scikit_fem_mesh()
    basis = Basis(mesh, ElementVector({1: ElementTetP1, 2: ElementTetP2}[element_order]()), intorder=4)
    ours = assemble_matrices(Model(mesh=MESH, media={"block": STEEL}))
    theirs = [BilinearForm(elasticity).assemble(basis), BilinearForm(inertia).assemble(basis, density=DENSITY)]
    dofs = vector_dofs(basis).ravel()
    if element_order == 2:
        nodes = our_dofs(node_numbers(mesh, order=2)).ravel()
        pairs = [matrix[nodes][:, nodes] for matrix in (ours.stiffness, ours.mass)]
    else:
        to_quadratic = sparse.kron(linear_restriction(), sparse.eye_array(3), format="csr")
        pairs = [to_quadratic.T @ matrix @ to_quadratic for matrix in (ours.stiffness, ours.mass)]
    for own, other in zip(pairs, theirs, strict=True):
        assert_same(own, other[dofs][:, dofs])


@pytest.mark.parametrize("order", [2, 3, 4, 5])
def test_matrices_of_a_piezoelectric_body_restricted_to_quadratic_fields_are_those_of_scikit_fem(order: int) -> None:
    mesh = scikit_fem_mesh()
    displacement = Basis(mesh, ElementVector(ElementTetP2()), intorder=4)
    potential = Basis(mesh, ElementTetP2(), intorder=4)
    ours = assemble_matrices(
        Model(mesh=change_order(MESH, order=order), media={"block": PZT}, electrodes=Electrodes(grounded=("-z",)))
    )
    scalar = restriction(order)
    vector = sparse.kron(scalar, sparse.eye_array(3), format="csr")
    numbers = node_numbers(mesh, order=2)
    nodes, rows = our_dofs(numbers).ravel(), vector_dofs(displacement).ravel()
    columns = np.concatenate([potential.nodal_dofs.T, potential.edge_dofs.T]).ravel()
    assert_same(
        (vector.T @ ours.stiffness @ vector)[nodes][:, nodes],
        BilinearForm(anisotropic_elasticity).assemble(displacement)[rows][:, rows],
    )
    assert_same(
        (vector.T @ ours.mass @ vector)[nodes][:, nodes],
        BilinearForm(inertia).assemble(displacement, density=PZT.density)[rows][:, rows],
    )
    assert_same(
        (vector.T @ ours.coupling @ scalar)[nodes][:, numbers] / POTENTIAL_SCALE,
        BilinearForm(piezoelectric_coupling).assemble(potential, displacement)[rows][:, columns],
    )
    assert_same(
        (scalar.T @ ours.dielectric @ scalar)[numbers][:, numbers] / POTENTIAL_SCALE**2,
        BilinearForm(permittivity).assemble(potential)[columns][:, columns],
    )


def test_natural_frequencies_of_a_free_body_are_those_of_scikit_fems_matrices() -> None:
    basis = Basis(scikit_fem_mesh(), ElementVector(ElementTetP2()), intorder=4)
    stiffness, mass = BilinearForm(elasticity).assemble(basis), BilinearForm(inertia).assemble(basis, density=DENSITY)
    squares = eigh(stiffness.toarray(), mass.toarray(), eigvals_only=True)[6:16]
    found = natural_modes(Model(mesh=MESH, media={"block": STEEL}), count=10).elastic_frequency
    assert found == approx(np.sqrt(squares) / (2 * np.pi), rel=1e-8)


def test_short_circuit_frequencies_of_a_piezoelectric_body_are_those_of_scikit_fems_matrices() -> None:
    mesh = scikit_fem_mesh()
    displacement = Basis(mesh, ElementVector(ElementTetP2()), intorder=4)
    potential = Basis(mesh, ElementTetP2(), intorder=4)
    medium: Medium = PZT
    model = Model(mesh=MESH, media={"block": medium}, electrodes=Electrodes(driven=("+z",), grounded=("-z",)))
    electroded = np.union1d(MESH.face_nodes("+z"), MESH.face_nodes("-z"))
    columns = np.concatenate([potential.nodal_dofs.T, potential.edge_dofs.T]).ravel()
    free = columns[~np.isin(node_numbers(mesh, order=2), electroded)]
    coupling = BilinearForm(piezoelectric_coupling).assemble(potential, displacement)[:, free].toarray()
    inner = BilinearForm(permittivity).assemble(potential)[free][:, free].toarray()
    stiffness = BilinearForm(anisotropic_elasticity).assemble(displacement).toarray()
    condensed = stiffness + coupling @ np.linalg.solve(inner, coupling.T)
    mass = BilinearForm(inertia).assemble(displacement, density=PZT.density).toarray()
    squares = eigh((condensed + condensed.T) / 2, mass, eigvals_only=True)[6:16]
    assert natural_modes(model, count=10).elastic_frequency == approx(np.sqrt(squares) / (2 * np.pi), rel=1e-8)
