"""Maps against Table 4.1, single operating points and closed forms; Gaussian process regression of measured runs."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pytest import approx, raises
from scipy.optimize import brentq
from scipy.special import i0e

from sonolube.design import (
    frequency_voltage_map,
    gaussian_process_map,
    map_chart,
    map_page,
    saturation_power,
    velocity_power_map,
    velocity_stress_map,
)
from sonolube.design.map_figures import panels_text
from sonolube.design.maps import default_axes, map_kinds
from sonolube.errors import InvalidInput
from sonolube.rig import AMPLITUDE, VOLTAGE, Rig, operating_points, read_rig

RIGS = Path(__file__).parents[2] / "examples" / "rigs"
RIG = read_rig(RIGS / "power_map.toml")
SPEEDS, VOLTS, LOADS = np.linspace(0.02, 0.2, 7), np.array([5.1, 10.3, 15.5, 20.7, 25.9]), np.arange(3.0, 10.0)


def test_powers_and_stresses_are_those_of_table_4_1() -> None:
    computed = velocity_power_map(RIG, sliding_speed=SPEEDS, voltage_peak_to_peak=VOLTS, normal_load=LOADS)
    of_charge = computed["charging_power"].isel(normal_load=0).values
    assert of_charge == approx([0.21, 0.84, 1.9, 3.39, 5.31], abs=0.005)
    heat = computed["dissipated_power"].isel(sliding_speed=0).values
    assert np.all(heat > of_charge)  # at resonance
    assert computed["power_to_supply"].values == approx(heat)
    assert computed["nominal_pressure"].values[[0, 4, 6]] == approx([23.8e6, 55.6e6, 71.4e6], abs=0.05e6)  # E34
    assert dict(computed["friction_reduction"].sizes) == {
        "normal_load": 7,
        "voltage_peak_to_peak": 5,
        "sliding_speed": 7,
    }


def test_more_power_and_less_speed_reduce_friction_more_at_any_stress() -> None:
    # D 4.1.4, of figure 4.20
    computed = velocity_power_map(RIG, sliding_speed=SPEEDS, voltage_peak_to_peak=VOLTS, normal_load=LOADS)
    reduction = computed["friction_reduction"].transpose("normal_load", "voltage_peak_to_peak", "sliding_speed").values
    assert np.all(np.diff(reduction, axis=1) > -1e-4)
    assert np.all(np.diff(reduction, axis=2) < 1e-4)
    assert np.ptp(reduction, axis=0).max() < 0.01


def test_a_map_holds_the_single_operating_points() -> None:
    computed = velocity_stress_map(RIG, sliding_speed=SPEEDS[:2], normal_load=[3.0, 9.0], voltage_peak_to_peak=[20.0])
    expected = operating_points(
        RIG,
        voltage_peak_to_peak=20.0,
        voltage_offset=10.0,
        normal_load=np.array([[3.0], [9.0]]),
        sliding_speed=SPEEDS[:2],
    )
    assert computed["friction_reduction"].values[0] == approx(expected.friction_reduction, abs=1e-4)


def test_over_frequency_friction_is_lowest_where_the_amplitude_is_largest() -> None:
    computed = frequency_voltage_map(RIG, frequency=np.linspace(20e3, 24e3, 41), voltage_peak_to_peak=[10.0, 25.9])
    assert np.array_equal(
        computed["friction_reduction"].values.argmax(axis=1), computed["vibration_amplitude"].values.argmax(axis=1)
    )


def test_the_saturation_power_of_slow_sliding_has_its_closed_form() -> None:
    # slow sliding leaves exp(-beta)/I0(beta), beta = a/l in proportion to the voltage, and power goes as its square
    def reduction(beta: np.ndarray | float) -> np.ndarray:
        return np.asarray(1 - np.exp(-2 * np.asarray(beta)) / i0e(beta))

    expected = brentq(lambda beta: float(reduction(np.sqrt(2) * beta) - reduction(beta)) - 0.05, 0.5, 4)
    beta = np.linspace(0, 8, 4001)
    saturation = saturation_power(friction_reduction=reduction(beta), actuator_power=beta**2)
    assert np.sqrt(saturation) == approx(expected, rel=1e-3)


def test_a_saturation_power_beyond_the_map_or_without_results_is_nan() -> None:
    power = np.linspace(0, 10, 101)
    rows = np.stack([power / 10, np.full(101, np.nan), np.minimum(power / 4, 0.5)])
    saturation = saturation_power(friction_reduction=rows, actuator_power=power)
    assert np.isnan(saturation).tolist() == [True, True, False]
    assert saturation[2] == approx(1.8)  # where 0.45 of the 0.5 are had


@pytest.mark.parametrize("kind", ["stress", "power", "frequency"])
def test_every_kind_of_map_is_drawn(kind: str) -> None:
    computed = {
        "stress": lambda: velocity_stress_map(RIG, sliding_speed=SPEEDS, normal_load=LOADS, voltage_peak_to_peak=VOLTS),
        "power": lambda: velocity_power_map(RIG, sliding_speed=SPEEDS, normal_load=LOADS, voltage_peak_to_peak=VOLTS),
        "frequency": lambda: frequency_voltage_map(RIG, frequency=[21e3, 22e3, 23e3], voltage_peak_to_peak=VOLTS),
    }[kind]()
    shown = [panel for panel in map_chart(computed).panels if panel.title]
    assert len(shown) == {"stress": 5, "power": 1, "frequency": 0}[kind]  # the same at all seven loads


def test_panels_that_differ_are_all_drawn() -> None:
    computed = velocity_power_map(RIG, sliding_speed=SPEEDS, normal_load=LOADS, voltage_peak_to_peak=VOLTS)
    slope = computed["normal_load"] / computed["normal_load"].max() / 10
    changed = computed.assign(friction_reduction=slope + computed["friction_reduction"])
    assert panels_text(computed).startswith("the same at each normal load from 3 N to 9 N")
    assert len([panel for panel in map_chart(changed).panels if panel.title]) == 7


def test_an_interactive_map_is_self_contained_or_names_the_package_to_install() -> None:
    computed = frequency_voltage_map(RIG, frequency=[21e3, 22e3], voltage_peak_to_peak=VOLTS)
    try:
        import plotly  # noqa: F401
    except ImportError:
        with raises(InvalidInput, match=r"pip install plotly"):
            map_page(computed)
    else:
        page = map_page(computed)
        assert "<script src=" not in page
        assert "Drive frequency [kHz]" in page


def test_values_that_do_not_increase_are_refused() -> None:
    with raises(InvalidInput, match=r"sliding_speed must increase from value to value, got 0\.2 before 0\.1"):
        velocity_stress_map(RIG, sliding_speed=[0.2, 0.1], normal_load=[3.0], voltage_peak_to_peak=[20.0])


def scattered(noise: float, runs: int = 60) -> tuple[np.ndarray, np.ndarray]:
    random = np.random.default_rng(5)
    places = random.uniform([0.05, 0.2], [0.2, 5.3], (runs, 2))
    return places, surface(places) + noise * random.standard_normal(runs)


def surface(places: np.ndarray) -> np.ndarray:
    return np.asarray(1 - np.exp(-0.05 * places[..., 1] / places[..., 0]))


def test_a_gaussian_process_covers_the_truth_by_its_own_uncertainty() -> None:
    places, reduction = scattered(0.03)
    points = np.random.default_rng(6).uniform([0.06, 0.5], [0.19, 5.0], (400, 2))
    computed = gaussian_process_map(runs=places, friction_reduction=reduction, points=points)
    error = np.abs(computed.friction_reduction - surface(points)) / computed.friction_reduction_uncertainty
    assert 0.85 < np.mean(error < 2) <= 1.0  # 0.95 of a Gaussian's
    assert computed.scatter == approx(0.03, rel=0.3)
    assert computed.leave_one_out_error == approx(0.03, rel=0.4)


def test_the_leave_one_out_error_is_that_of_fits_without_each_run() -> None:
    places, reduction = scattered(0.02, runs=25)
    computed = gaussian_process_map(runs=places, friction_reduction=reduction, points=places)
    errors = [
        gaussian_process_map(
            runs=np.delete(places, i, axis=0), friction_reduction=np.delete(reduction, i), points=places[i]
        ).friction_reduction
        - reduction[i]
        for i in range(25)
    ]
    assert computed.leave_one_out_error == approx(float(np.sqrt(np.mean(np.square(errors)))), rel=0.25)


def test_far_from_all_runs_the_uncertainty_of_a_gaussian_process_grows() -> None:
    places, reduction = scattered(0.01)
    computed = gaussian_process_map(runs=places, friction_reduction=reduction, points=[[0.1, 2.5], [5.0, 500.0]])
    near, far = computed.friction_reduction_uncertainty
    assert far > 5 * near


@pytest.mark.parametrize(
    ("runs", "reduction", "message"),
    [
        (np.zeros((3, 2)), np.zeros(3), "needs 6 runs or more, got 3"),
        (np.zeros((6, 2)), np.zeros(6), "agree in a coordinate"),
        (np.zeros((6, 2)), np.zeros(5), "one reduction to a run"),
    ],
)
def test_unusable_runs_are_refused(runs: np.ndarray, reduction: np.ndarray, message: str) -> None:
    with raises(InvalidInput, match=message):
        gaussian_process_map(runs=runs, friction_reduction=reduction, points=[[0.0, 0.0]])


def axes_of(kind: str, rig: Rig = RIG) -> dict[str, Any]:
    """Number of values, first and last of each axis; all are even."""
    found = default_axes(rig, kind=kind)
    for values in found.values():
        assert np.diff(values) == approx(np.full(values.size - 1, (values[-1] - values[0]) / (values.size - 1)))
    return {name: (values.size, float(values[0]), float(values[-1])) for name, values in found.items()}


def test_axes_of_a_map_lie_about_the_operating_point_of_the_rig() -> None:
    assert RIG.drive is not None
    volts, f, load = RIG.drive.voltage_peak_to_peak or 0.0, RIG.drive.frequency, RIG.normal_load
    speeds = (77, approx(0.01), approx(0.2))
    assert axes_of("velocity-power") == {
        "sliding_speed": speeds,
        "voltage_peak_to_peak": (50, approx(0.02 * volts), approx(volts)),
        "normal_load": (7, approx(0.6 * load), approx(1.8 * load)),
    }
    assert axes_of("velocity-stress") == {
        "sliding_speed": speeds,
        "normal_load": (25, approx(0.6 * load), approx(1.8 * load)),
        "voltage_peak_to_peak": (5, approx(0.2 * volts), approx(volts)),
    }
    assert axes_of("frequency-voltage") == {
        "frequency": (161, approx(0.8 * f), approx(1.2 * f)),
        "voltage_peak_to_peak": (50, approx(0.02 * volts), approx(volts)),
    }


def test_axes_of_a_rig_by_its_amplitude_reach_up_to_it_and_a_frequency_needs_a_drive() -> None:
    bush = read_rig(RIGS / "bronze_bush.toml")  # 2 um at 20 kHz
    assert axes_of("velocity-amplitude", bush)["vibration_amplitude"] == (50, approx(0.04e-6), approx(2e-6))
    assert axes_of("velocity-stress", bush)["vibration_amplitude"] == (5, approx(0.4e-6), approx(2e-6))
    assert axes_of("frequency-amplitude", bush)["frequency"] == (41, approx(16e3), approx(24e3))
    with raises(InvalidInput, match=r"drive\.frequency is missing; give it, or map over the sliding speed"):
        default_axes(replace(bush, drive=None), kind="frequency-amplitude")


def test_each_kind_of_map_is_of_the_quantity_that_its_axes_have() -> None:
    assert map_kinds(VOLTAGE) == ("velocity-power", "velocity-stress", "frequency-voltage")
    assert map_kinds(AMPLITUDE) == ("velocity-amplitude", "velocity-stress", "frequency-amplitude")
