import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from pytest import approx, raises

from sonolube.actuator import driver_power
from sonolube.errors import InvalidInput


def test_the_stack_of_the_tribometer_draws_what_the_dissertation_lists() -> None:
    # D Table 4.1, drive from zero to its peak-to-peak voltage, powers printed to two digits after the point
    volts = np.array([5.1, 10.3, 15.5, 20.7, 25.9])
    power = driver_power(capacitance=360e-9, voltage_maximum=volts, voltage_peak_to_peak=volts, frequency=22e3)
    assert power == approx(np.array([0.21, 0.84, 1.9, 3.39, 5.31]), abs=0.005)


def test_an_offset_costs_power() -> None:
    # D 2.2: 4 V peak to peak on an offset of 4, 6 and 8 V
    power = driver_power(capacitance=1.53e-6, voltage_maximum=[6, 8, 10], voltage_peak_to_peak=4, frequency=16e3)
    assert power == approx(np.array([0.59, 0.78, 0.98]), abs=0.005)


@given(volts=st.floats(0.1, 200), frequency=st.floats(1, 1e5))
def test_a_period_moves_one_charge_through_the_highest_voltage(volts: float, frequency: float) -> None:
    # a supply at U that charges C once each period gives C U^2: half of it stored, half lost in the amplifier
    stored = 0.5 * 1e-6 * volts**2
    power = driver_power(capacitance=1e-6, voltage_maximum=volts, voltage_peak_to_peak=volts, frequency=frequency)
    assert power == approx(2 * stored * frequency)


def test_a_negative_voltage_is_refused_by_name() -> None:
    with raises(InvalidInput, match=r"voltage_peak_to_peak must not be negative, got -4\.0 V"):
        driver_power(capacitance=1e-6, voltage_maximum=4, voltage_peak_to_peak=-4, frequency=1e3)
