"""Natural modes by finite elements against exact ones, Ritz's, and laws every discretisation must keep."""

from typing import Any

import numpy as np
import pytest
from pytest import approx, raises
from scipy.linalg import eigh

from sonolube.errors import InvalidInput, UnknownName
from sonolube.fem import (
    FaceSpring,
    FixedSupport,
    Mesh,
    Model,
    annular_section,
    box_mesh,
    extrapolate_frequencies,
    isotropic_medium,
    mode_names,
    natural_modes,
    rectangular_section,
    rigid_body_mode_count,
    ritz_frequencies,
)
from sonolube.fem.solver.assembly import assemble_matrices

STEEL = isotropic_medium(youngs_modulus=200e9, poisson_ratio=0.29, density=7900.0)
BLOCK = {"length": 0.127, "width": 0.06096, "thickness": 0.0254}


def box_model(divisions: tuple[int, int, int], **support: Any) -> Model:
    return Model(mesh=box_mesh(**BLOCK, divisions=divisions), media={"block": STEEL}, **support)


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


def test_a_uniform_strain_passes_through_any_mesh() -> None:
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


@pytest.mark.parametrize("poisson_ratio", [0.0, 0.3, 0.45])
def test_the_lame_mode_of_a_free_cube_does_not_know_poissons_ratio(poisson_ratio: float) -> None:
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


def test_frequencies_fall_with_the_fourth_power_of_the_element_size() -> None:
    speed = np.sqrt(STEEL.elastic_stiffness[0, 0] / STEEL.density)
    errors = []
    for n in (4, 8):
        mesh = box_mesh(length=0.1, width=0.01, thickness=0.01, divisions=(n, 1, 1))
        held = Model(mesh=mesh, media={"block": STEEL}, fixed=(FixedSupport(face=None, along="yz"),))
        errors.append(natural_modes(held, count=1).elastic_frequency[0] / (speed / 0.2) - 1)
    assert errors[0] > errors[1] > 0
    assert np.log2(errors[0] / errors[1]) == approx(4.0, abs=0.3)


def test_frequencies_lie_above_those_of_ritz_and_fall_to_them() -> None:
    section = rectangular_section(length=0.03, width=0.02, order=14)
    reference = ritz_frequencies(section, length=0.024, medium=STEEL, order=14)[:6]
    errors = []
    for n in (2, 4):
        mesh = box_mesh(length=0.03, width=0.02, thickness=0.024, divisions=(n, n, n))
        found = natural_modes(Model(mesh=mesh, media={"block": STEEL}), count=6).elastic_frequency
        errors.append(found / reference - 1)
    assert np.all(errors[0] > 3 * errors[1])
    assert np.all(errors[1] > 0)


def test_a_body_held_to_one_direction_vibrates_as_its_one_dimensional_rod() -> None:
    # With all lateral motion fixed only longitudinal waves of speed sqrt((lambda + 2 mu)/rho) are left.
    mesh = box_mesh(length=BLOCK["length"], width=0.02, thickness=0.02, divisions=(8, 1, 1))
    held = Model(mesh=mesh, media={"block": STEEL}, fixed=(FixedSupport(face=None, along="yz"),))
    found = natural_modes(held, count=3)
    speed = np.sqrt(STEEL.elastic_stiffness[0, 0] / STEEL.density)
    assert found.rigid_body_count == 1
    assert found.elastic_frequency == approx(np.arange(1, 4) * speed / (2 * BLOCK["length"]), rel=1e-3)


def test_a_clamped_bar_of_no_lateral_strain_vibrates_at_quarter_waves() -> None:
    mesh = box_mesh(length=BLOCK["length"], width=0.02, thickness=0.02, divisions=(8, 1, 1))
    held = Model(
        mesh=mesh, media={"block": STEEL}, fixed=(FixedSupport(face=None, along="yz"), FixedSupport(face="-x"))
    )
    found = natural_modes(held, count=2)
    speed = np.sqrt(STEEL.elastic_stiffness[0, 0] / STEEL.density)
    assert found.rigid_body_count == 0
    assert found.elastic_frequency == approx(np.array([1, 3]) * speed / (4 * BLOCK["length"]), rel=1e-4)


def test_soft_springs_bear_the_block_as_one_mass() -> None:
    soft = box_model((3, 2, 1), springs=(FaceSpring(face="-x", spring_stiffness=1e3, along=(1.0, 0.0, 0.0)),))
    found = natural_modes(soft, count=1)
    mass = 7900.0 * BLOCK["length"] * BLOCK["width"] * BLOCK["thickness"]
    held = Model(mesh=soft.mesh, media=soft.media, springs=soft.springs, fixed=(FixedSupport(face=None, along="yz"),))
    assert found.rigid_body_count == 3
    assert natural_modes(held, count=1).elastic_frequency[0] == approx(np.sqrt(1e3 / mass) / (2 * np.pi), rel=1e-5)


@pytest.mark.parametrize(
    ("fixed", "free"),
    [
        ((), 6),
        ((FixedSupport(face="-x"),), 0),
        ((FixedSupport(face="-x", along="x"),), 3),
        ((FixedSupport(face=None, along="z"),), 3),
    ],
)
def test_supports_leave_the_rigid_motions_that_statics_says(fixed: tuple[FixedSupport, ...], free: int) -> None:
    assert rigid_body_mode_count(box_model((2, 2, 1), fixed=fixed)) == free


@pytest.mark.parametrize("count", [1, 2, 4, 9])
def test_no_mode_is_passed_over_where_frequencies_coincide(count: int) -> None:
    # A cube has its free modes in pairs and triples; the dense eigenvalues of the same matrices have them all.
    mesh = box_mesh(length=0.02, width=0.02, thickness=0.02, divisions=(2, 2, 2))
    model = Model(mesh=mesh, media={"block": STEEL})
    matrices = assemble_matrices(model)
    squares = eigh(matrices.stiffness.toarray(), matrices.mass.toarray(), eigvals_only=True)
    found = natural_modes(model, count=count)
    assert found.rigid_body_count == 6
    assert found.elastic_frequency == approx(np.sqrt(squares[6 : 6 + count]) / (2 * np.pi), rel=1e-6)


def test_shapes_are_orthonormal_in_the_metric_of_mass() -> None:
    model = box_model((4, 2, 1))
    shapes = natural_modes(model, count=5).shapes.reshape(11, -1)
    assert shapes @ (assemble_matrices(model).mass @ shapes.T) == approx(np.eye(11), abs=1e-6)


def test_the_modes_of_a_slender_bar_carry_the_names_of_the_textbook() -> None:
    mesh = box_mesh(length=0.1, width=0.012, thickness=0.008, divisions=(10, 3, 2))
    model = Model(mesh=mesh, media={"block": STEEL})
    modes = natural_modes(model, count=12)
    names = dict(zip(mode_names(model, modes, axis="x"), modes.natural_frequency, strict=True))
    assert [name for name in names if name.startswith("rigid")] == [f"rigid {k}" for k in range(1, 7)]
    assert names["axial 1"] == approx(np.sqrt(200e9 / 7900) / 0.2, rel=5e-3)
    # Bending 1 across the thin side after Euler and Bernoulli, which overestimates somewhat.
    bending = 4.730**2 / (2 * np.pi) * np.sqrt(200e9 / 7900 * 0.008**2 / 12) / 0.1**2
    assert names["bending 1"] == approx(bending, rel=0.05)
    # Torsion after Saint-Venant: J/(b t^3) = 0.196 and polar moment (b^2 + t^2)/12 at b/t = 1.5.
    shear = 200e9 / 2 / 1.29
    torsion = np.sqrt(shear * 0.196 * 0.008**2 * 12 / (7900 * (0.012**2 + 0.008**2))) / 0.2
    assert names["torsional 1"] == approx(torsion, rel=0.02)


def test_a_sequence_that_falls_by_one_factor_is_extrapolated_to_its_limit() -> None:
    history = 100.0 + np.array([[8.0], [2.0], [0.5]])
    frequency, error = extrapolate_frequencies(history)
    assert frequency == approx(100.0, rel=1e-12)
    assert error[0] == approx(0.5 / 100.0)


def test_ritz_agrees_with_the_exact_radial_mode_of_a_thin_ring() -> None:
    # Breathing of a thin ring: omega = sqrt(E/rho)/R, to second order in thickness over radius.
    found = ritz_frequencies(
        annular_section(outer_radius=0.0505, inner_radius=0.0495, order=14), length=0.001, medium=STEEL, order=14
    )
    breathing = np.sqrt(200e9 / 7900) / 0.05 / (2 * np.pi)
    assert np.abs(found / breathing - 1).min() < 1e-3


def test_what_has_no_meaning_is_refused_by_name() -> None:
    mesh = box_mesh(**BLOCK, divisions=(1, 1, 1))
    with raises(InvalidInput, match=r"thickness must be positive, got 0\.0 m"):
        box_mesh(length=1.0, width=1.0, thickness=0.0, divisions=(1, 1, 1))
    with raises(InvalidInput, match="regions without a medium: block"):
        Model(mesh=mesh, media={})
    with raises(UnknownName, match="unknown face 'x'"):
        Model(mesh=mesh, media={"block": STEEL}, fixed=(FixedSupport(face="x"),))
    with raises(InvalidInput, match="letters of 'xyz'"):
        FixedSupport(face="-x", along="u")
    with raises(InvalidInput, match="no degree of freedom is free"):
        natural_modes(Model(mesh=mesh, media={"block": STEEL}, fixed=(FixedSupport(face=None),)), count=1)
    with raises(InvalidInput, match="count must be from 1 to 73 on this mesh, got 100"):
        natural_modes(Model(mesh=mesh, media={"block": STEEL}), count=100)
    with raises(InvalidInput, match="flat or turned inside out"):
        Mesh(
            nodes=mesh.nodes * [1, 1, 0],
            elements=mesh.elements,
            region_of_element=mesh.region_of_element,
            regions=mesh.regions,
            faces=mesh.faces,
        )
