"""Requirements on the amplifier against textbook circuits."""

import numpy as np
from pytest import approx

from sonolube.models.actuator import amplifier_requirements

F = 22e3


def test_current_and_slew_rate_of_a_capacitance_are_those_of_the_textbook() -> None:
    c, amplitude = 360e-9, 14.0
    required = amplifier_requirements(
        admittance=2j * np.pi * F * c, voltage_amplitude=amplitude, frequency=F, voltage_offset=14.0
    )
    assert required.voltage_maximum == approx(28)
    assert required.peak_current == approx(2 * np.pi * F * c * amplitude)
    assert required.slew_rate == approx(2 * np.pi * F * amplitude)
    assert required.apparent_power == approx(2 * np.pi * F * c * amplitude**2 / 2)
    assert required.power_factor == approx(0, abs=1e-12)


def test_a_triangular_voltage_on_a_resistance_has_a_unity_power_factor_and_its_mean_square_power() -> None:
    orders = 16
    k = np.arange(1, orders + 1)
    triangle = np.where(k % 2 == 1, 8 / (np.pi * k) ** 2, 0.0)
    required = amplifier_requirements(admittance=np.full(orders, 0.01), voltage_amplitude=triangle, frequency=F)
    assert required.power_factor == approx(1)
    assert required.dissipated_power == approx(
        0.01 / 3, rel=1e-3
    )  # a triangle of height one has a mean square of a third
    assert required.slew_rate == approx(1.179 * 4 * F, rel=0.01)  # the slope is a square wave, with Gibbs's overshoot
