"""Named and tuned modes against bar theory and other meshes."""

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.models.fem import (
    Medium,
    Model,
    box_mesh,
    conical_horn,
    generate_mesh,
    isotropic_medium,
    mode_names,
    named_mode,
    natural_modes,
    tuned_mode,
)
from sonolube.models.fem.mesh.element_order import change_order
from sonolube.models.fem.solver.modes import NotConverged

E, NU, RHO = 200e9, 0.3, 8000.0

STEEL = isotropic_medium(youngs_modulus=E, poisson_ratio=NU, density=RHO)

SLIM = isotropic_medium(youngs_modulus=E, poisson_ratio=0.0, density=RHO)

SPEED = float(np.sqrt(E / RHO))


def bar(length: float, cells: int) -> Model:
    mesh = box_mesh(length=length, width=0.004, thickness=0.006, divisions=(cells, 1, 1))
    return Model(mesh=mesh, media={"block": SLIM})


def test_a_bar_is_tuned_to_half_a_wavelength_with_the_slope_of_bar_theory() -> None:
    def model_at(length: float, element_size: float) -> Model:
        return bar(length, max(2, round(0.1 / element_size)))

    found = tuned_mode(
        model_at, name="axial 1", axis="x", frequency=20e3, length=0.1, element_size=0.025, relative_tolerance=1e-3
    )
    assert found.length == approx(SPEED / 40e3, rel=5e-4)
    assert found.mode.frequency == approx(20e3, rel=5e-4)
    assert found.frequency_per_length == approx(-20e3 / found.length, rel=0.01)


@pytest.mark.parametrize("start", [0.012, 0.014])
def test_a_frequency_that_bends_over_a_size_is_met_within_half_a_thousandth(start: float) -> None:
    # f falls by 4e-3 (size / 20 mm)^2 of itself, so that one step along the slope misses the size where f is 20 kHz
    def model_at(size: float, element_size: float) -> Model:
        length = SPEED / 40e3 * (1 + 4e-3 * (size / 0.02) ** 2) / (1 + 4e-3)
        return bar(length, max(2, round(0.1 / element_size)))

    found = tuned_mode(
        model_at, name="axial 1", axis="x", frequency=20e3, length=start, element_size=0.025, relative_tolerance=1e-4
    )
    assert found.mode.frequency == approx(20e3, rel=5e-4)
    assert found.length == approx(0.02, rel=0.5 * 5e-4 / 4e-3 * 1.1)


def test_a_tuned_horn_keeps_its_frequency_on_a_finer_mesh_of_another_order() -> None:
    pytest.importorskip("netgen.occ", reason="netgen-mesher is not installed")

    def model_at(length: float, element_size: float) -> Model:
        horn = conical_horn(radius=0.012, end_radius=0.006, length=length)
        return Model(mesh=generate_mesh(horn, element_size=element_size), media={horn.regions[0]: STEEL})

    found = tuned_mode(model_at, name="axial 1", axis="z", frequency=30e3, length=0.09, element_size=0.02, count=8)
    finer = model_at(found.length, 0.004)
    modes = natural_modes(finer, count=8)
    row = mode_names(finer, modes, axis="z").index("axial 1")
    assert finer.mesh.node_count > 1.2 * change_order(found.mode.model.mesh, order=2).node_count
    assert modes.natural_frequency[row] == approx(30e3, rel=1e-3)
    assert modes.natural_frequency[row] == approx(found.mode.frequency, rel=5e-4)


@pytest.mark.parametrize("length", [0.1253, 0.1247])
@pytest.mark.parametrize("medium", [STEEL, SLIM])
def test_a_size_that_the_frequency_hardly_depends_on_is_refused(length: float, medium: Medium) -> None:
    # the bar of half a wavelength at 20 kHz is 0.125 m long, whatever its width
    def model_at(width: float, element_size: float) -> Model:
        mesh = box_mesh(length=length, width=width, thickness=0.006, divisions=(4, 1, 1))
        return Model(mesh=mesh, media={"block": medium})

    with raises(NotConverged, match=r"^no length near 0.004 m gives 20000 Hz; start nearer .*, or tune another size$"):
        tuned_mode(model_at, name="axial 1", axis="x", frequency=20e3, length=0.004, element_size=0.025)


def test_a_missing_mode_is_refused_with_the_names_of_those_found() -> None:
    with raises(InvalidInput, match=r"no mode called 'axial 9' among the first 4: bending 1"):
        named_mode(lambda size: bar(0.1, round(0.1 / size)), name="axial 9", axis="x", element_size=0.02, count=4)
