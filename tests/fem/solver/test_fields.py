"""Fields at points and as stress against fields known in closed form; grids read back; masses against a bar's roots."""

import base64
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
from numpy.typing import NDArray
from pytest import approx, raises
from scipy.optimize import brentq

from sonolube.errors import InvalidInput
from sonolube.fem import (
    Model,
    box_mesh,
    conical_horn,
    gauss_point_stress,
    generate_mesh,
    interpolate_at_points,
    isotropic_medium,
    mass_loaded_frequencies,
    mode_names,
    named_mode,
    natural_modes,
    tuned_mode,
    von_mises_stress,
    vtu_text,
)
from sonolube.fem.solver.element_order import change_order

E, NU, RHO = 200e9, 0.3, 8000.0
STEEL = isotropic_medium(youngs_modulus=E, poisson_ratio=NU, density=RHO)
SLIM = isotropic_medium(youngs_modulus=E, poisson_ratio=0.0, density=RHO)
MESH = box_mesh(length=0.1, width=0.02, thickness=0.02, divisions=(4, 1, 1))


def bar(length: float, cells: int) -> Model:
    mesh = box_mesh(length=length, width=0.004, thickness=0.006, divisions=(cells, 1, 1))
    return Model(mesh=mesh, media={"block": SLIM})


def test_a_quadratic_field_is_met_exactly_between_the_nodes() -> None:
    def field(points: NDArray[np.float64]) -> NDArray[np.float64]:
        x, y, z = points.T
        return np.stack([x**2 - y * z, 3 * x * y + 1, z**2 + x], axis=-1)

    points = np.random.default_rng(1).uniform([-0.05, -0.01, -0.01], [0.05, 0.01, 0.01], (50, 3))
    points = np.vstack([points, [0.05, 0.01, -0.01]])
    assert interpolate_at_points(MESH, field(MESH.nodes), points=points) == approx(field(points), abs=1e-12)
    with raises(InvalidInput, match="outside the body"):
        interpolate_at_points(MESH, field(MESH.nodes), points=[[0.2, 0.0, 0.0]])


def test_a_pulled_bar_is_in_uniaxial_stress_and_a_sheared_one_in_pure_shear() -> None:
    model = Model(mesh=MESH, media={"block": STEEL})
    pulled = MESH.nodes * [1e-3, -NU * 1e-3, -NU * 1e-3]
    stress = gauss_point_stress(model, pulled)
    assert stress[..., 0] == approx(E * 1e-3)
    assert stress[..., 1:] == approx(0.0, abs=1e-4 * E * 1e-3)
    assert von_mises_stress(stress) == approx(E * 1e-3)
    sheared = np.zeros_like(MESH.nodes)
    sheared[:, 0] = 2e-3 * MESH.nodes[:, 1]
    assert von_mises_stress(gauss_point_stress(model, sheared)) == approx(np.sqrt(3) * 2e-3 * E / (2 * (1 + NU)))


def test_a_grid_reads_back_as_it_was() -> None:
    wave = np.random.default_rng(2).standard_normal((MESH.node_count, 3))
    root = ElementTree.fromstring(vtu_text(MESH, fields={"axial & <1>": wave, "phasor": wave[:, 0] + 1j * wave[:, 1]}))
    kinds = {"Float64": "<f8", "Int64": "<i8", "UInt8": "u1"}
    arrays = {}
    for entry in root.iter("DataArray"):
        raw = base64.b64decode((entry.text or "").strip())
        assert np.frombuffer(raw[:8], dtype="<u8")[0] == len(raw) - 8
        values = np.frombuffer(raw[8:], dtype=kinds[entry.attrib["type"]])
        arrays[entry.attrib["Name"]] = values.reshape(-1, int(entry.attrib.get("NumberOfComponents", 1)))
    piece = root.find(".//Piece")
    assert piece is not None
    assert int(piece.attrib["NumberOfPoints"]) == MESH.node_count
    assert arrays["Points"] == approx(MESH.nodes)
    assert np.array_equal(arrays["connectivity"].reshape(-1, 10), MESH.elements)
    assert arrays["offsets"][-1, 0] == MESH.elements.size
    assert set(arrays["types"].ravel()) == {24}
    assert np.array_equal(arrays["axial & <1>"], wave)
    assert np.array_equal(arrays["phasor imaginary"].ravel(), wave[:, 1])
    with raises(InvalidInput, match="one value or vector per node"):
        vtu_text(MESH, fields={"wrong": np.zeros(3)})


@pytest.mark.parametrize("mass", [0.0, 2e-3, 20e-3])
def test_a_mass_on_its_end_lowers_a_bar_to_the_root_of_its_equation(mass: float) -> None:
    # tan kL = -(m/m_bar) kL for a bar with one end free and a mass on the other; no Poisson ratio, so exactly so.
    model = bar(0.1, 12)
    modes = natural_modes(model, count=24)
    row = mode_names(model, modes, axis="x").index("axial 1")
    share = mass / (RHO * 0.1 * 0.004 * 0.006)
    root = brentq(lambda x: np.sin(x) + share * x * np.cos(x), np.pi / 2 + 1e-9, np.pi + 1e-9)
    expected = root * np.sqrt(E / RHO) / (2 * np.pi * 0.1)
    found = mass_loaded_frequencies(modes, model, face="+x", along="x", tool_mass=mass)
    assert found[row] == approx(expected, rel=1e-3)


def test_a_bar_is_tuned_to_the_length_of_half_a_wave_and_its_trim() -> None:
    def model_at(length: float, element_size: float) -> Model:
        return bar(length, max(2, round(0.1 / element_size)))

    speed = float(np.sqrt(E / RHO))
    found = tuned_mode(
        model_at, name="axial 1", axis="x", frequency=20e3, length=0.1, element_size=0.025, relative_tolerance=1e-3
    )
    assert found.length == approx(speed / 40e3, rel=5e-4)
    assert found.mode.frequency == approx(20e3, rel=5e-4)
    assert found.frequency_per_length == approx(-20e3 / found.length, rel=0.01)


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


def test_a_mode_that_is_not_there_is_told_by_what_is() -> None:
    with raises(InvalidInput, match=r"no mode called 'axial 9' among the first 4: bending 1"):
        named_mode(lambda size: bar(0.1, round(0.1 / size)), name="axial 9", axis="x", element_size=0.02, count=4)
