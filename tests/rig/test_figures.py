"""Figures of a rig's results: units on every axis, and the curves of the results themselves."""

from pathlib import Path

import numpy as np
import pytest
from pytest import approx

from sonolube.models.friction import BoundaryLubricant
from sonolube.rig import (
    Rig,
    frequency_grid,
    frequency_response,
    lubrication_map,
    lubrication_point,
    read_rig,
    simulate,
    start_up,
    temperature_point,
    thermal_solid,
)
from sonolube.rig.figures import (
    lubrication_figure,
    response_figure,
    simulation_figure,
    start_up_figure,
    temperature_figure,
)
from sonolube.rig.result_datasets import response_arrays, simulation_arrays, start_up_arrays


@pytest.fixture(scope="module")
def tribometer() -> Rig:
    return read_rig(Path(__file__).parents[2] / "examples" / "rigs" / "tribometer.toml")


def test_the_steady_vibration_is_drawn_and_stored_over_one_period(tribometer: Rig) -> None:
    result = simulate(tribometer)
    gap, force = simulation_figure(simulation_arrays(tribometer, result)).axes
    assert gap.lines[0].get_ydata() == approx(1e6 * result.vibration.motions[0].displacement)
    assert force.lines[0].get_ydata() == approx(result.vibration.motions[0].normal_force)
    assert (force.get_xlabel(), force.get_ylabel()) == ("Time [µs]", "Contact force [N]")
    stored = simulation_arrays(tribometer, result)
    step = 1 / (result.vibration.motions[0].frequency * result.vibration.motions[0].displacement.size)
    assert np.diff(stored["time"].to_numpy()) == approx(step)
    assert stored["normal_force"].attrs["units"] == "N"


def test_the_linear_response_is_drawn_and_stored_over_frequency(tribometer: Rig) -> None:
    result = frequency_response(tribometer, frequency=frequency_grid(tribometer, lowest=15e3, highest=30e3))
    amplitude, impedance, phase = response_figure(tribometer, result).axes
    assert amplitude.lines[0].get_ydata() == approx(1e6 * result.amplitude_per_volt)
    assert impedance.lines[0].get_ydata() == approx(result.impedance)
    assert phase.get_xlabel() == "Frequency [kHz]"
    assert response_arrays(tribometer, result)["impedance"].attrs["units"] == "ohm"


def test_the_last_periods_of_a_start_up_pass_through_the_computed_steps(tribometer: Rig) -> None:
    result = start_up(tribometer, duration=2e-3)
    _, last = start_up_figure(tribometer, result).axes
    time, displacement = (np.asarray(data, dtype=float) for data in last.lines[0].get_data())
    steps = 1e3 * result.trajectory.time
    shown = (steps >= time[0]) & (steps <= time[-1])
    between = np.interp(steps[shown], time, displacement)
    assert between == approx(1e6 * result.trajectory.contact.displacement[shown], abs=0.02 * np.ptp(displacement))
    assert start_up_arrays(tribometer, result).sizes["time"] == result.trajectory.time.size


def test_vibration_lowers_the_drawn_temperature_in_proportion_to_friction(tribometer: Rig) -> None:
    result = temperature_point(
        tribometer,
        pin=thermal_solid("stainless_steel_316"),
        disc=thermal_solid("aluminium_2024"),
        heat_capacity=1.5,
        thermal_conductance=0.05,
        duration=50.0,
    )
    (axes,) = temperature_figure(tribometer, result).axes
    contact, _, vibrated, _ = (np.asarray(line.get_ydata(), dtype=float) for line in axes.lines)
    assert vibrated[-1] / contact[-1] == approx(result.friction_ratio, rel=1e-6)
    assert axes.get_ylabel() == "Rise of the temperature [K]"


def test_the_rig_is_marked_on_the_map_of_lubrication(tribometer: Rig) -> None:
    lubricant = BoundaryLubricant(film_coefficient=0.25, full_asperity_pressure=10e6)
    point, surroundings = (make(tribometer, lubricant=lubricant) for make in (lubrication_point, lubrication_map))
    (axes,) = lubrication_figure(tribometer, point, surroundings).axes  # type: ignore[arg-type]
    assert np.ravel(axes.lines[0].get_xydata()) == approx((1e3 * point.sliding_speed, 1e-6 * point.nominal_pressure))
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("Sliding speed [mm/s]", "Nominal pressure [MPa]")
