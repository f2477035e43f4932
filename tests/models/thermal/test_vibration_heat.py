"""Heat of vibration against hand calculation and summation over the bar."""

import numpy as np
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.models.thermal import (
    adiabatic_heat_rate,
    half_wave_bar_energy,
    interface_conductance,
    layer_conductance,
    vibration_loss_heat_rate,
)

BAR = {"density": 2780.0, "cross_section": 1.5e-3, "length": 0.127, "frequency": 20e3, "axial_amplitude": 11.24e-6}


def test_the_energy_of_a_half_wave_bar_is_the_sum_over_its_slices() -> None:
    x = (np.arange(10_000) + 0.5) / 10_000 * 0.127
    velocity = 2 * np.pi * 20e3 * 11.24e-6 * np.cos(np.pi * x / 0.127)
    slices = 2780.0 * 1.5e-3 * 0.127 / 10_000 * velocity**2 / 2
    assert half_wave_bar_energy(**BAR) == approx(slices.sum(), rel=1e-6)


def test_a_bar_dissipates_its_energy_once_per_q_radians() -> None:
    energy = half_wave_bar_energy(**BAR)
    heat = vibration_loss_heat_rate(stored_energy=energy, frequency=20e3, quality_factor=1000.0)
    assert heat == approx(2 * np.pi * 20e3 * energy / 1000)


def test_the_adiabatic_heat_rate_reproduces_the_temperature_rise() -> None:
    heat = adiabatic_heat_rate(heat_capacity=478.0, temperature_rise=60.0, duration=5.0)
    assert heat == approx(5736.0)
    assert heat * 5.0 / 478.0 == approx(60.0)


def test_the_interface_carries_the_heat_that_the_sensor_loses() -> None:
    joint = interface_conductance(temperature_rise=60.0, rise_behind_interface=21.0, convection_coefficient=100.0)
    assert joint * (60.0 - 21.0) == approx(100.0 * 21.0)


def test_the_conductance_of_a_foil_is_conductivity_over_thickness() -> None:
    assert layer_conductance(thermal_conductivity=121.0, thickness=0.2e-3) == approx(605e3)


def test_a_rise_behind_an_interface_above_that_of_the_source_is_refused() -> None:
    with raises(InvalidInput, match="rise_behind_interface must be smaller"):
        interface_conductance(temperature_rise=20.0, rise_behind_interface=21.0, convection_coefficient=10.0)
