"""A tuned wedge without lateral contraction against the wave equation of bars, integrated as an ordinary one."""

from dataclasses import replace
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from pytest import approx, raises
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from sonolube.charts import Band, Line, Rule
from sonolube.design.horns.shapes import horn_body
from sonolube.design.horns.tuning import (
    HornDesign,
    _asymmetry,
    _curve,
    _highest,
    _lower_order_results,
    _node,
    _uniformity,
    amplitude_limits,
    horn_axis_chart,
    loaded_frequency,
    tuned_horn,
)
from sonolube.errors import InvalidInput
from sonolube.models.fem import isotropic_medium

E, RHO = 200e9, 8000.0
SPEED = 5000.0
FREQUENCY = 20e3
WIDTH, END, THICKNESS = 0.03, 0.012, 0.02
PLANE = 3e-3  # relative, to which its sections stay plane: the slope of its sides squared, 0.07^2, is 5e-3
SLIM = isotropic_medium(youngs_modulus=E, poisson_ratio=0.0, density=RHO)


@pytest.fixture(scope="module")
def wedge() -> HornDesign:
    pytest.importorskip("netgen.occ", reason="netgen-mesher is not installed")
    sizes = {"width": WIDTH, "thickness": THICKNESS, "end_width": END}
    body = horn_body("block", frequency=FREQUENCY, wave_speed=SPEED, sizes=sizes)
    return tuned_horn(body, medium=SLIM, frequency=FREQUENCY, relative_tolerance=2e-2)


def wave(frequency: float, length: float) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Place, displacement and strain of (w u')' + k^2 w u = 0 from a free end of unit displacement."""
    k = 2 * np.pi * frequency / SPEED
    taper = (END - WIDTH) / length

    def slope(x: float, state: NDArray[np.float64]) -> list[float]:
        u, strain = state
        return [strain, -taper / (WIDTH + taper * x) * strain - k**2 * u]

    x = np.linspace(0.0, length, 1001)
    found = solve_ivp(slope, (0.0, length), [1.0, 0.0], rtol=1e-8, atol=1e-8, t_eval=x)
    return x, found.y[0], found.y[1]


@cache
def resonance(length: float, tool_mass: float = 0.0) -> float:
    """Frequency at which the force of the end of the bar accelerates the tool."""

    def excess(frequency: float) -> float:
        _, u, strain = wave(frequency, length)
        return float(E * END * THICKNESS * strain[-1] - tool_mass * (2 * np.pi * frequency) ** 2 * u[-1])

    return float(brentq(excess, 15e3, 22e3, xtol=0.1))


def test_a_wedge_is_as_long_as_the_wave_equation_has_it(wedge: HornDesign) -> None:
    length = float(brentq(lambda each: resonance(each) - FREQUENCY, 0.126, 0.131, xtol=1e-6))
    assert wedge.tuned.length == approx(length, rel=PLANE)
    assert wedge.total_length == approx(wedge.tuned.length)
    assert wedge.working_face == "+x"
    assert wedge.geometry.volume == approx((WIDTH + END) / 2 * THICKNESS * wedge.tuned.length, rel=1e-6)


def test_gain_node_and_stress_are_those_of_the_wave(wedge: HornDesign) -> None:
    x, u, strain = wave(FREQUENCY, wedge.tuned.length)
    assert wedge.displacement_gain == approx(abs(u[-1]), rel=PLANE)
    assert wedge.node_position == approx(float(np.interp(0.0, -u, x)), rel=PLANE)
    assert wedge.stress_per_displacement == approx(E * np.abs(strain).max() / abs(u[-1]), rel=5e-3)
    assert 0.99 < wedge.face_uniformity <= 1
    assert 0 <= wedge.face_asymmetry < 1e-3
    assert 0 <= wedge.stress_change < 5e-3


def test_a_tool_lowers_the_frequency_as_much_as_the_wave_with_its_inertia_at_the_end(wedge: HornDesign) -> None:
    # modes beyond those computed count: without their compliance 50 g would be a percent off
    for tool in (0.01, 0.05):
        assert loaded_frequency(wedge, tool_mass=tool) == approx(resonance(wedge.tuned.length, tool), rel=PLANE)
    assert loaded_frequency(wedge, tool_mass=1e-9) == approx(FREQUENCY, rel=1e-5)
    assert loaded_frequency(replace(wedge, residual_compliance=0.0), tool_mass=0.05) != approx(
        resonance(wedge.tuned.length, 0.05), rel=5 * PLANE
    )


def test_other_modes_are_listed_by_their_distance_without_rigid_ones(wedge: HornDesign) -> None:
    names = [name for name, _ in wedge.neighbours]
    away = [abs(frequency - FREQUENCY) for _, frequency in wedge.neighbours]
    assert away == sorted(away)
    assert "axial 1" not in names
    assert not any(name.startswith("rigid") for name in names)
    modes = wedge.tuned.mode
    assert len(names) == len(modes.names) - 6 - 1
    assert dict(wedge.neighbours)["bending 1"] == approx(float(modes.modes.natural_frequency[6]))


def test_the_chart_shows_the_wedge_the_wave_and_its_stress(wedge: HornDesign) -> None:
    chart = horn_axis_chart(wedge)
    x, u, strain = wave(FREQUENCY, wedge.tuned.length)
    profile, motion, stress = (panel.parts[0] for panel in chart.panels)
    assert isinstance(profile, Band)
    assert isinstance(motion, Line)
    assert isinstance(stress, Line)
    length = 1e3 * wedge.tuned.length
    assert (profile.x[0], profile.x[-1]) == approx((0.0, length), abs=1e-3)
    # in mm: half the width where it is the greater extent, else half the thickness
    half = np.maximum(15 - 9 * profile.x / length, 10)
    assert profile.high == approx(half, rel=1e-3)
    assert profile.low == approx(-half, rel=1e-3)
    assert (motion.x[0], motion.x[-1]) == approx((0.0, length))
    assert motion.y == approx(np.interp(motion.x, 1e3 * x, u / u[-1]), abs=5e-3)
    expected = 1e-12 * E * np.abs(strain / u[-1])  # MPa per um
    assert stress.y.max() == approx(expected.max(), rel=5e-3)
    assert stress.y == approx(np.interp(stress.x, 1e3 * x, expected), abs=0.06 * expected.max())
    assert [part.value for panel in chart.panels for part in panel.parts if isinstance(part, Rule)] == approx(
        [1e3 * wedge.node_position, 0.0, 1e3 * wedge.node_position, 1e3 * wedge.node_position]
    )
    assert chart.title == "block, axial 1, 20000 Hz"
    assert [(panel.y.label, panel.y.unit) for panel in chart.panels] == [
        ("Half width", "mm"),
        ("Axial displacement over the tip's", ""),
        ("Peak stress", "MPa per µm"),
    ]


def test_the_amplitude_of_a_strength_is_strength_over_stress(wedge: HornDesign) -> None:
    strengths = {"yield_strength": 900e6, "fatigue_strength": 500e6, "hardness": 3e9}
    metal: Any = SimpleNamespace(properties=strengths, value=lambda name: strengths[name])
    limits = amplitude_limits(replace(wedge, stress_per_displacement=4e12), material=metal)
    assert limits == approx({"fatigue_strength": 125e-6, "yield_strength": 225e-6})
    ceramic: Any = SimpleNamespace(properties={"hardness": 3e9}, value=lambda name: strengths[name])
    assert amplitude_limits(wedge, material=ceramic) == {}


def test_a_mode_that_moves_all_sections_alike_has_no_node(wedge: HornDesign) -> None:
    mode = wedge.tuned.mode
    rigid = replace(mode, modes=replace(mode.modes, shapes=np.ones_like(mode.modes.shapes)))
    with raises(InvalidInput, match="this mode has no displacement node along the axis: tune an axial mode"):
        _node(rigid, "x")


def test_a_mode_that_lower_elements_do_not_show_has_a_stress_that_is_not_known(wedge: HornDesign) -> None:
    change, compliance = _lower_order_results(wedge.tuned.mode, "axial 9", "x", wedge.stress_per_displacement)
    assert change == np.inf
    assert compliance == approx(wedge.residual_compliance, rel=1e-6)


def test_uniformity_is_the_least_over_the_greatest_displacement_along_the_mean() -> None:
    assert _uniformity(np.array([-4.0, -2.0, -3.0])) == approx(0.5)
    assert _uniformity(np.array([4.0, 1.0, 3.0])) == approx(0.25)
    assert _uniformity(np.array([4.0, -1.0, 3.0])) == approx(-0.25)


def test_asymmetry_is_the_range_of_the_fitted_plane_over_the_mean() -> None:
    # displacement 5 + 0.2 y - 0.1 z, plus what no plane has, on the face x = 1 with y of -1 to 3, z of 0 to 4
    y, z = (each.ravel() for each in np.meshgrid(np.linspace(-1, 3, 5), np.linspace(0, 4, 5)))
    centred = (y - 1) * (z - 2)
    axial = -(5 + 0.2 * (y - 1) - 0.1 * (z - 2) + 0.7 * centred)
    nodes = np.vstack([np.zeros((1, 3)), np.column_stack([np.ones(y.size), y, z])])
    mesh = SimpleNamespace(nodes=nodes, face_nodes=lambda name: {"+x": np.arange(1, 26)}[name])
    shape = np.zeros((26, 3))
    shape[1:, 0] = axial
    mode: Any = SimpleNamespace(model=SimpleNamespace(mesh=mesh), displacement=shape)
    assert _asymmetry(mode, "x") == approx((0.2 * 4 + 0.1 * 4) / 5)


def test_the_curve_through_points_passes_them_without_maxima_of_its_own() -> None:
    place, values = np.array([0.0, 1.0, 4.0]), np.array([2.0, 5.0, 3.0])
    fine, curve = _curve(place, values)
    assert curve[np.isin(fine, place)] == approx(values)
    assert (fine[0], fine[-1], np.diff(fine).max()) == approx((0.0, 4.0, 4 / 800))
    assert curve.max() == approx(5.0)
    assert np.diff(curve[fine <= 1]).min() >= 0 >= np.diff(curve[fine >= 1]).max()


def test_the_highest_stress_of_a_slice_stands_at_its_node_and_end_faces_stand_alone() -> None:
    # 40 slices of 0 to 80: nodes in the third, 4 to 6, and both end faces beside their slices
    along = np.array([0.0, 0.0, 0.5, 4.5, 5.5, 5.0, 79.0, 80.0, 80.0])
    stress = np.array([3.0, 7.0, 9.0, 1.0, 6.0, 2.0, 4.0, 8.0, 5.0])
    place, highest = _highest(along, stress)
    assert place.tolist() == [0.0, 0.5, 5.5, 79.0, 80.0]
    assert highest.tolist() == [7.0, 9.0, 6.0, 4.0, 8.0]
