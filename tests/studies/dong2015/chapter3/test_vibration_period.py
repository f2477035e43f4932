"""One period of the vibration: velocity, stiffness of the cube, and friction by D 3.47."""

import numpy as np
import pytest
from pytest import approx

from dong2015.chapter3.tribometer_response import mean_friction_ratio, response_over_voltage, vibration_period

VOLTAGES = [50.0, 200.0]


@pytest.mark.parametrize("voltage", VOLTAGES)
def test_the_mean_of_the_drawn_friction_is_that_of_the_friction_model(voltage: float) -> None:
    friction = vibration_period(voltage).friction_ratio
    assert friction[:-1].mean() == approx(mean_friction_ratio(voltage), rel=1e-3)


@pytest.mark.parametrize("voltage", VOLTAGES)
def test_the_velocity_is_the_amplitude_times_the_angular_frequency(voltage: float) -> None:
    amplitude = response_over_voltage()["vibration_amplitude"].sel(voltage_peak_to_peak=voltage).item()
    assert vibration_period(voltage).velocity.max() == approx(2 * np.pi * 22e3 * amplitude, rel=0.02)


@pytest.mark.parametrize("voltage", VOLTAGES)
def test_stiffness_and_friction_peak_where_the_bodies_are_closest(voltage: float) -> None:
    period = vibration_period(voltage)
    closest = int(np.argmin(period.displacement))
    assert int(np.argmax(period.stiffness_ratio)) == closest
    assert int(np.argmax(period.friction_ratio)) == approx(closest, abs=2)
    assert abs(period.velocity[closest]) < 0.02 * np.abs(period.velocity).max()


def test_a_larger_displacement_than_that_of_hopping_leaves_virtually_no_stiffness() -> None:
    period = vibration_period(200.0)
    apart = period.displacement > 3.8e-6  # D 3.3.5
    assert period.stiffness_ratio[apart].max() < 0.02
