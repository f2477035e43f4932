"""Figures of a rig's results: units on every axis, and the curves of the results themselves."""

from pathlib import Path

import numpy as np
import pytest
from pytest import approx

from sonolube.charts import Line, Panel, Points
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
from sonolube.rig.figures import lubrication_chart, response_chart, simulation_chart, start_up_chart, temperature_chart
from sonolube.rig.responses import response_arrays, simulation_arrays, start_up_arrays


@pytest.fixture(scope="module")
def tribometer() -> Rig:
    return read_rig(Path(__file__).parents[2] / "examples" / "rigs" / "tribometer.toml")


def line(panel: Panel) -> Line:
    return next(part for part in panel.parts if isinstance(part, Line))


def test_the_steady_vibration_is_drawn_and_stored_over_one_period(tribometer: Rig) -> None:
    result = simulate(tribometer)
    gap, force = simulation_chart(simulation_arrays(tribometer, result)).panels
    assert line(gap).y == approx(1e6 * result.vibration.motions[0].displacement)
    assert line(force).y == approx(result.vibration.motions[0].normal_force)
    assert (force.x.text, force.y.text) == ("Time [µs]", "Contact force [N]")
    stored = simulation_arrays(tribometer, result)
    step = 1 / (result.vibration.motions[0].frequency * result.vibration.motions[0].displacement.size)
    assert np.diff(stored["time"].to_numpy()) == approx(step)
    assert stored["normal_force"].attrs["units"] == "N"


def test_the_linear_response_is_drawn_and_stored_over_frequency(tribometer: Rig) -> None:
    result = frequency_response(tribometer, frequency=frequency_grid(tribometer, lowest=15e3, highest=30e3))
    amplitude, impedance, phase = response_chart(tribometer, result).panels
    assert line(amplitude).y == approx(1e6 * result.amplitude_per_volt)
    assert line(impedance).y == approx(result.impedance)
    assert phase.x.text == "Frequency [kHz]"
    assert response_arrays(tribometer, result)["impedance"].attrs["units"] == "ohm"


def test_the_last_periods_of_a_start_up_pass_through_the_computed_steps(tribometer: Rig) -> None:
    result = start_up(tribometer, duration=2e-3)
    _, last = start_up_chart(tribometer, result).panels
    time, displacement = line(last).x, line(last).y
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
    (panel,) = temperature_chart(tribometer, result).panels
    contact, _, vibrated, _ = (part.y for part in panel.parts if isinstance(part, Line))
    assert vibrated[-1] / contact[-1] == approx(result.friction_ratio, rel=1e-6)
    assert panel.y.text == "Rise of the temperature [K]"


def test_the_rig_is_marked_on_the_map_of_lubrication(tribometer: Rig) -> None:
    lubricant = BoundaryLubricant(film_coefficient=0.25, full_asperity_pressure=10e6)
    point, surroundings = (make(tribometer, lubricant=lubricant) for make in (lubrication_point, lubrication_map))
    (panel,) = lubrication_chart(tribometer, point, surroundings).panels  # type: ignore[arg-type]
    (mark,) = (part for part in panel.parts if isinstance(part, Points))
    assert (mark.x[0], mark.y[0]) == approx((1e3 * point.sliding_speed, 1e-6 * point.nominal_pressure))
    assert (panel.x.text, panel.y.text) == ("Sliding speed [mm/s]", "Nominal pressure [MPa]")
