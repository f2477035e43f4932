"""Natural modes against exact solutions, the Rayleigh-Ritz method and dense eigenvalues."""

from typing import Any

import numpy as np
import pytest
from pytest import approx
from scipy.linalg import eigh
from tests.models.fem.ritz import rectangular_section, ritz_frequencies

from sonolube.models.fem import (
    FaceSpring,
    FixedSupport,
    Model,
    box_mesh,
    isotropic_medium,
    natural_modes,
    rigid_body_mode_count,
)
from sonolube.models.fem.solver.assembly import assemble_matrices

STEEL = isotropic_medium(youngs_modulus=200e9, poisson_ratio=0.29, density=7900.0)

BLOCK = {"length": 0.127, "width": 0.06096, "thickness": 0.0254}


def box_model(divisions: tuple[int, int, int], **support: Any) -> Model:
    return Model(mesh=box_mesh(**BLOCK, divisions=divisions), media={"block": STEEL}, **support)


@pytest.mark.parametrize("poisson_ratio", [0.0, 0.3, 0.45])
def test_the_lame_mode_of_a_free_cube_is_independent_of_poissons_ratio(poisson_ratio: float) -> None:
    # f = sqrt(mu/(2 rho))/L: equivoluminal, its faces free of traction, whatever the ratio.
    medium = isotropic_medium(youngs_modulus=2e11 * (1 + poisson_ratio), poisson_ratio=poisson_ratio, density=8000.0)
    lame = np.sqrt(1e11 / (2 * 8000.0)) / 0.02
    exact = ritz_frequencies(
        rectangular_section(length=0.02, width=0.02, order=12), length=0.02, medium=medium, order=12
    )
    assert np.abs(exact / lame - 1).min() < 1e-7
    mesh = box_mesh(length=0.02, width=0.02, thickness=0.02, divisions=(4, 4, 4))
    found = natural_modes(Model(mesh=mesh, media={"block": medium}), count=25).elastic_frequency
    assert np.abs(found / lame - 1).min() < 5e-3


def test_errors_of_frequencies_fall_with_the_fourth_power_of_the_element_size() -> None:
    speed = np.sqrt(STEEL.elastic_stiffness[0, 0] / STEEL.density)
    errors = []
    for n in (4, 8):
        mesh = box_mesh(length=0.1, width=0.01, thickness=0.01, divisions=(n, 1, 1))
        held = Model(mesh=mesh, media={"block": STEEL}, fixed=(FixedSupport(face=None, along="yz"),))
        errors.append(natural_modes(held, count=1).elastic_frequency[0] / (speed / 0.2) - 1)
    assert errors[0] > errors[1] > 0
    assert np.log2(errors[0] / errors[1]) == approx(4.0, abs=0.3)


def test_frequencies_converge_from_above_to_those_of_ritz() -> None:
    section = rectangular_section(length=0.03, width=0.02, order=14)
    reference = ritz_frequencies(section, length=0.024, medium=STEEL, order=14)[:6]
    errors = []
    for n in (2, 4):
        mesh = box_mesh(length=0.03, width=0.02, thickness=0.024, divisions=(n, n, n))
        found = natural_modes(Model(mesh=mesh, media={"block": STEEL}), count=6).elastic_frequency
        errors.append(found / reference - 1)
    assert np.all(errors[0] > 3 * errors[1])
    assert np.all(errors[1] > 0)


def test_a_body_without_lateral_motion_has_the_frequencies_of_a_rod() -> None:
    # With all lateral motion fixed only longitudinal waves of speed sqrt((lambda + 2 mu)/rho) are left.
    mesh = box_mesh(length=BLOCK["length"], width=0.02, thickness=0.02, divisions=(8, 1, 1))
    held = Model(mesh=mesh, media={"block": STEEL}, fixed=(FixedSupport(face=None, along="yz"),))
    found = natural_modes(held, count=3)
    speed = np.sqrt(STEEL.elastic_stiffness[0, 0] / STEEL.density)
    assert found.rigid_body_count == 1
    assert found.elastic_frequency == approx(np.arange(1, 4) * speed / (2 * BLOCK["length"]), rel=1e-3)


def test_a_clamped_bar_without_lateral_strain_has_quarter_wave_frequencies() -> None:
    mesh = box_mesh(length=BLOCK["length"], width=0.02, thickness=0.02, divisions=(8, 1, 1))
    held = Model(
        mesh=mesh, media={"block": STEEL}, fixed=(FixedSupport(face=None, along="yz"), FixedSupport(face="-x"))
    )
    found = natural_modes(held, count=2)
    speed = np.sqrt(STEEL.elastic_stiffness[0, 0] / STEEL.density)
    assert found.rigid_body_count == 0
    assert found.elastic_frequency == approx(np.array([1, 3]) * speed / (4 * BLOCK["length"]), rel=1e-4)


def test_a_block_on_soft_springs_vibrates_as_a_rigid_mass() -> None:
    soft = box_model((3, 2, 1), springs=(FaceSpring(face="-x", spring_stiffness=1e3, along=(1.0, 0.0, 0.0)),))
    found = natural_modes(soft, count=1)
    mass = 7900.0 * BLOCK["length"] * BLOCK["width"] * BLOCK["thickness"]
    held = Model(mesh=soft.mesh, media=soft.media, springs=soft.springs, fixed=(FixedSupport(face=None, along="yz"),))
    assert found.rigid_body_count == 3
    assert natural_modes(held, count=1).elastic_frequency[0] == approx(np.sqrt(1e3 / mass) / (2 * np.pi), rel=1e-5)


def test_a_block_on_a_soft_foundation_heaves_and_rocks_as_a_rigid_body() -> None:
    # under the slope t the foundation returns the moment k t <x^2>, with <x^2> = L^2/12; inertia m (L^2 + T^2)/12
    soft = box_model((3, 2, 1), springs=(FaceSpring(face="-z", spring_stiffness=1e3, along=(0.0, 0.0, 1.0)),))
    mass = 7900.0 * BLOCK["length"] * BLOCK["width"] * BLOCK["thickness"]
    sides = np.array([BLOCK["width"], BLOCK["length"], np.inf])  # rocking across, along, and heaving
    expected = np.sqrt(1e3 / mass / (1 + (BLOCK["thickness"] / sides) ** 2)) / (2 * np.pi)
    assert natural_modes(soft, count=3).elastic_frequency == approx(expected, rel=1e-5)


@pytest.mark.parametrize(
    ("fixed", "free"),
    [
        ((), 6),
        ((FixedSupport(face="-x"),), 0),
        ((FixedSupport(face="-x", along="x"),), 3),
        ((FixedSupport(face=None, along="z"),), 3),
    ],
)
def test_supports_leave_the_rigid_body_modes_of_statics(fixed: tuple[FixedSupport, ...], free: int) -> None:
    assert rigid_body_mode_count(box_model((2, 2, 1), fixed=fixed)) == free


@pytest.mark.parametrize("count", [1, 2, 4, 9])
def test_no_mode_is_missed_where_frequencies_coincide(count: int) -> None:
    # A cube has its free modes in pairs and triples; the dense eigenvalues of the same matrices have them all.
    mesh = box_mesh(length=0.02, width=0.02, thickness=0.02, divisions=(2, 2, 2))
    model = Model(mesh=mesh, media={"block": STEEL})
    matrices = assemble_matrices(model)
    squares = eigh(matrices.stiffness.toarray(), matrices.mass.toarray(), eigvals_only=True)
    found = natural_modes(model, count=count)
    assert found.rigid_body_count == 6
    assert found.elastic_frequency == approx(np.sqrt(squares[6 : 6 + count]) / (2 * np.pi), rel=1e-6)


def test_mode_shapes_are_orthonormal_with_respect_to_mass() -> None:
    model = box_model((4, 2, 1))
    shapes = natural_modes(model, count=5).shapes.reshape(11, -1)
    assert shapes @ (assemble_matrices(model).mass @ shapes.T) == approx(np.eye(11), abs=1e-6)
