"""Requested tolerance and estimated error of every mode against Rayleigh-Ritz frequencies."""

from collections.abc import Callable

import numpy as np
import pytest
from pytest import approx, raises
from tests.models.fem.ritz import annular_section, rectangular_section, ritz_frequencies

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.models.fem import (
    Geometry,
    Medium,
    Model,
    NotConverged,
    Slot,
    block,
    box_mesh,
    change_order,
    converged_modes,
    cylinder,
    extrapolate_frequencies,
    generate_mesh,
    isotropic_medium,
    natural_modes,
)
from sonolube.models.fem.mesh.grading import grade_reentrant_edges

STEEL = isotropic_medium(youngs_modulus=200e9, poisson_ratio=0.29, density=7900.0)

LENGTH, WIDTH, THICKNESS = 0.127, 0.06096, 0.0254

MODES = 20

RITZ_ERROR = 5e-6  # left in Ritz's frequencies at these orders


def of_block(medium: Medium, *sizes: float) -> Floats:
    section = rectangular_section(length=sizes[0], width=sizes[1], order=19)
    return ritz_frequencies(section, length=sizes[2], medium=medium, order=19)[:MODES]


def of_bar(radius: float, length: float) -> Floats:
    section = annular_section(outer_radius=radius, inner_radius=0.0, order=18)
    return ritz_frequencies(section, length=length, medium=STEEL, order=18)[:MODES]


def model_of(body: Geometry, medium: Medium = STEEL) -> Callable[[float], Model]:
    return lambda size: Model(mesh=generate_mesh(body, element_size=size), media={body.regions[0]: medium})


@pytest.fixture(scope="module", autouse=True)
def _needs_the_mesher() -> None:
    pytest.importorskip("netgen.occ", reason="netgen-mesher is not installed")


@pytest.mark.parametrize(
    ("youngs_modulus", "poisson_ratio", "density", "axial"),
    [(200e9, 0.29, 7900.0, 19585.35), (73e9, 0.33, 2780.0, 19883.02)],
    ids=["steel", "aluminium"],
)
def test_twenty_modes_of_the_horns_block_are_within_a_thousandth(
    youngs_modulus: float, poisson_ratio: float, density: float, axial: float
) -> None:
    medium = isotropic_medium(youngs_modulus=youngs_modulus, poisson_ratio=poisson_ratio, density=density)
    body = block(length=LENGTH, width=WIDTH, thickness=THICKNESS)
    found = converged_modes(model_of(body, medium), count=MODES, element_size=0.03, relative_tolerance=1e-3)
    actual = np.abs(found.natural_frequency[6:] / of_block(medium, LENGTH, WIDTH, THICKNESS) - 1)
    assert found.frequency_error.max() <= 1e-3
    assert actual.max() < 1e-3
    assert np.all(actual <= found.frequency_error[6:])
    assert found.natural_frequency[11] == approx(axial, rel=1e-5)  # the first axial mode is the sixth elastic one


@pytest.mark.slow
def test_the_estimated_error_bounds_that_of_nearly_every_mode_and_is_of_its_size() -> None:
    bodies = [
        (
            block(length=LENGTH, width=WIDTH, thickness=THICKNESS),
            STEEL,
            of_block(STEEL, LENGTH, WIDTH, THICKNESS),
            0.03,
        ),
        (block(length=0.03, width=0.03, thickness=0.03), STEEL, of_block(STEEL, 0.03, 0.03, 0.03), 0.03),
        (block(length=0.03, width=0.03, thickness=0.03), STEEL, of_block(STEEL, 0.03, 0.03, 0.03), 0.015),
        (cylinder(radius=0.03, length=0.008), STEEL, of_bar(0.03, 0.008), 0.03),
    ]
    ratios = []
    for body, medium, exact, size in bodies:
        base = generate_mesh(body, element_size=size)
        media = {body.regions[0]: medium}
        history = [
            natural_modes(Model(mesh=change_order(base, order=order), media=media), count=MODES).elastic_frequency
            for order in (2, 3, 4, 5)
        ]
        for known in (history[:3], history):
            frequency, error = extrapolate_frequencies(np.array(known))
            ratios.append(error / np.maximum(np.abs(frequency / exact - 1), RITZ_ERROR))
    stacked = np.concatenate(ratios)
    assert np.mean(stacked >= 1) > 0.95
    assert 1 < np.median(stacked) < 20


@pytest.mark.slow
def test_the_estimated_error_bounds_that_of_every_mode_with_re_entrant_edges() -> None:
    # Exact to 1e-4: elements of order six, cut once more towards the edges, whose frequencies are bounds from above.
    body = block(length=0.06, width=0.05, thickness=0.012, slots=(Slot(length=0.04, width=0.034),))
    base = generate_mesh(body, element_size=0.014)

    def frequencies(levels: int, order: int) -> Floats:
        mesh = change_order(grade_reentrant_edges(base, levels=levels), order=order)
        return natural_modes(Model(mesh=mesh, media={body.regions[0]: STEEL}), count=10).elastic_frequency

    exact = frequencies(2, 6)
    history = [frequencies(1, order) for order in (2, 3, 4, 5)]
    for known in (history[:3], history):
        frequency, error = extrapolate_frequencies(np.array(known), singular=True)
        assert np.all(np.abs(frequency / exact - 1) <= error)
        assert error.max() < 0.012


def test_a_structured_mesh_reaches_its_tolerance_without_a_mesh_generator() -> None:
    def model_at(size: float) -> Model:
        n = [max(1, round(extent / size)) for extent in (0.03, 0.02, 0.024)]
        mesh = box_mesh(length=0.03, width=0.02, thickness=0.024, divisions=(n[0], n[1], n[2]))
        return Model(mesh=mesh, media={"block": STEEL})

    found = converged_modes(model_at, count=6, element_size=0.03, relative_tolerance=1e-4)
    actual = np.abs(found.natural_frequency[6:] / of_block(STEEL, 0.03, 0.02, 0.024)[:6] - 1)
    assert np.all(actual <= 1e-4)
    assert found.modes.natural_frequency.shape == found.frequency_error.shape == found.natural_frequency.shape
    with raises(InvalidInput, match="relative_tolerance must be at least 1e-08, got 1e-12"):
        converged_modes(model_at, count=6, element_size=0.03, relative_tolerance=1e-12)
    with raises(NotConverged, match="allow more"):
        converged_modes(model_at, count=6, element_size=0.03, relative_tolerance=1e-8, most_nodes=300)


def test_a_geometric_sequence_is_extrapolated_to_its_limit() -> None:
    history = 100.0 + np.array([[8.0], [2.0], [0.5]])
    frequency, error = extrapolate_frequencies(history)
    assert frequency == approx(100.0, rel=1e-12)
    assert error[0] == approx(0.5 / 100.0)
