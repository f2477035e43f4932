"""Amplifier power, dissipated power and power factor against printed values and the time domain."""

import numpy as np
from hypothesis import given, strategies as st
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.models.actuator import dissipated_power, linear_amplifier_power, peak_current, power_factor


def test_the_amplifier_power_of_the_tribometers_stack_is_that_of_table_4_1() -> None:
    # D Table 4.1, drive from zero to its peak-to-peak voltage, powers printed to two digits after the point
    volts = np.array([5.1, 10.3, 15.5, 20.7, 25.9])
    power = linear_amplifier_power(
        capacitance=360e-9, voltage_maximum=volts, voltage_peak_to_peak=volts, frequency=22e3
    )
    assert power == approx(np.array([0.21, 0.84, 1.9, 3.39, 5.31]), abs=0.005)


def test_an_offset_raises_the_amplifier_power() -> None:
    # D 2.2: 4 V peak to peak on an offset of 4, 6 and 8 V
    power = linear_amplifier_power(
        capacitance=1.53e-6, voltage_maximum=[6, 8, 10], voltage_peak_to_peak=4, frequency=16e3
    )
    assert power == approx(np.array([0.59, 0.78, 0.98]), abs=0.005)


@given(volts=st.floats(0.1, 200), frequency=st.floats(1, 1e5))
def test_each_period_draws_the_charge_once_from_the_highest_voltage(volts: float, frequency: float) -> None:
    # a supply at U that charges C once each period gives C U^2: half of it stored, half lost in the amplifier
    stored = 0.5 * 1e-6 * volts**2
    power = linear_amplifier_power(
        capacitance=1e-6, voltage_maximum=volts, voltage_peak_to_peak=volts, frequency=frequency
    )
    assert power == approx(2 * stored * frequency)


def test_a_negative_voltage_is_refused_by_name() -> None:
    with raises(InvalidInput, match=r"voltage_peak_to_peak must not be negative, got -4\.0 V"):
        linear_amplifier_power(capacitance=1e-6, voltage_maximum=4, voltage_peak_to_peak=-4, frequency=1e3)


def test_a_resistor_dissipates_half_the_squared_amplitude_over_its_resistance() -> None:
    assert dissipated_power(admittance=1 / 50, voltage_amplitude=[10.0, 10j]) == approx(np.array([1.0, 1.0]))


def test_a_capacitance_dissipates_nothing_and_has_a_power_factor_of_zero() -> None:
    y = 2j * np.pi * 22e3 * 360e-9
    assert dissipated_power(admittance=y, voltage_amplitude=13.0) == 0
    assert power_factor(admittance=y, voltage_amplitude=13.0) == 0


@given(real=st.floats(1e-6, 1), imaginary=st.floats(-1, 1), volts=st.floats(0.1, 100))
def test_the_power_factor_of_a_sine_is_the_cosine_of_the_phase(real: float, imaginary: float, volts: float) -> None:
    y = complex(real, imaginary)
    assert power_factor(admittance=y, voltage_amplitude=volts) == approx(np.cos(np.angle(y)))
    assert peak_current(admittance=y, voltage_amplitude=volts) == approx(abs(y) * volts)


harmonics = st.lists(
    st.tuples(
        st.builds(complex, st.floats(0, 1), st.floats(-1, 1)), st.complex_numbers(max_magnitude=100, allow_nan=False)
    ),
    min_size=1,
    max_size=6,
)


@given(harmonics=harmonics)
def test_the_powers_of_harmonics_sum_to_the_mean_of_voltage_times_current(
    harmonics: list[tuple[complex, complex]],
) -> None:
    y, volts = np.array(harmonics).T
    theta = np.arange(4096) * 2 * np.pi / 4096
    waves = np.exp(1j * np.multiply.outer(np.arange(1, y.size + 1), theta))
    voltage, current = (volts @ waves).real, ((y * volts) @ waves).real
    power = float(dissipated_power(admittance=y, voltage_amplitude=volts).sum())
    assert power == approx(float(np.mean(voltage * current)), abs=1e-9)
    rms = np.sqrt(np.mean(voltage**2) * np.mean(current**2))
    assert float(power_factor(admittance=y, voltage_amplitude=volts)) * rms == approx(power, abs=1e-9)
    peak = float(np.abs(current).max())
    assert 0.995 * peak <= float(peak_current(admittance=y, voltage_amplitude=volts)) <= peak * 1.0001 + 1e-12


def test_an_admittance_that_is_not_finite_is_refused_by_name() -> None:
    with raises(InvalidInput, match=r"admittance must be finite, got nan S"):
        dissipated_power(admittance=complex(0, np.nan), voltage_amplitude=1.0)
