"""Vibration: proportionality of amplitude to voltage, operating deflection shapes and modal assurance."""

import numpy as np
from hypothesis import given, strategies as st
from pytest import approx, mark, raises

from sonolube.errors import InvalidInput
from sonolube.measurement.vibration import (
    amplitude_per_volt,
    complex_amplitudes,
    modal_assurance_criterion,
    operating_deflection_shape,
)

VOLTS = np.array([5.1, 10.3, 15.5, 20.7, 25.9])


def test_the_amplitude_of_the_tribometer_is_proportional_to_its_voltage() -> None:
    # D Table 4.1: amplitudes in micrometres; 0.0892 um per volt peak to peak
    found = amplitude_per_volt(
        voltage_peak_to_peak=VOLTS, vibration_amplitude=1e-6 * np.array([0.46, 0.92, 1.38, 1.85, 2.31])
    )
    assert found.amplitude_per_volt == approx(0.0892e-6, abs=0.0001e-6)
    assert found.proportional
    assert found.lower < found.amplitude_per_volt < found.upper


def test_a_curved_response_is_distinguished_from_a_linear_one() -> None:
    curved = amplitude_per_volt(voltage_peak_to_peak=VOLTS, vibration_amplitude=1e-7 * VOLTS * (1 + 0.02 * VOLTS))
    assert not curved.proportional
    assert curved.curvature > 0.5
    straight = amplitude_per_volt(voltage_peak_to_peak=VOLTS, vibration_amplitude=1e-7 * VOLTS)
    assert straight.proportional
    assert straight.curvature == approx(0.0, abs=1e-9)


def test_the_interval_of_the_slope_and_the_test_have_their_nominal_coverage() -> None:
    rng = np.random.default_rng(0)
    volts = np.linspace(5, 25, 9)
    held = straight = 0
    for _ in range(300):
        found = amplitude_per_volt(
            voltage_peak_to_peak=volts,
            vibration_amplitude=volts * 1e-7 + 5e-8 * rng.standard_normal(9),
            confidence_level=0.9,
        )
        held += found.lower <= 1e-7 <= found.upper
        straight += found.proportional
    assert 254 <= held <= 286  # 270 expected, three binomial deviations either way
    assert 254 <= straight <= 286


@mark.parametrize("frequency", [25e3, 22.3e3])
def test_complex_amplitudes_are_recovered_from_signals(frequency: float) -> None:
    time = 3e-3 + np.arange(2000) / 500e3
    known = np.array([1.0, -0.5j, 0.3 * np.exp(2j)])
    signals = np.real(known[:, np.newaxis] * np.exp(2j * np.pi * frequency * time)) + 7.0
    assert complex_amplitudes(time=time, signals=signals, frequency=frequency) == approx(known, abs=1e-9)


def test_the_standing_wave_fraction_is_one_for_a_standing_and_half_for_a_travelling_wave() -> None:
    points = np.linspace(0, 1, 41)
    standing = operating_deflection_shape(3e-6 * np.exp(0.7j) * np.cos(2 * np.pi * points))
    assert standing.standing_wave_fraction == approx(1.0)
    assert standing.greatest_amplitude == approx(3e-6)
    assert np.abs(standing.shape) == approx(np.abs(np.cos(2 * np.pi * points)))
    running = operating_deflection_shape(np.exp(2j * np.pi * points[:-1]))
    assert running.standing_wave_fraction == approx(0.5)


shapes = st.lists(st.complex_numbers(max_magnitude=10, min_magnitude=0.1), min_size=4, max_size=4)


@given(shape=shapes, other=shapes, factor=st.complex_numbers(max_magnitude=100, min_magnitude=0.01))
def test_the_modal_assurance_criterion_is_symmetric_bounded_and_one_for_proportional_shapes(
    shape: list[complex], other: list[complex], factor: complex
) -> None:
    a, b = np.array(shape), np.array(other)
    assert modal_assurance_criterion(a, factor * a)[0, 0] == approx(1.0)
    between = modal_assurance_criterion(a, b)[0, 0]
    assert between <= 1 + 1e-12
    assert modal_assurance_criterion(factor * b, a)[0, 0] == approx(between)


def test_modes_of_a_uniform_chain_are_orthogonal() -> None:
    # equal masses and springs between fixed ends: sines, orthogonal because the mass matrix is the unit one
    points = np.arange(1, 8)
    modes = np.sin(np.pi * np.multiply.outer(points, np.arange(1, 4)) / 8)
    assert modal_assurance_criterion(modes, modes) == approx(np.eye(3), abs=1e-12)
    mixed = modes[:, 0] + modes[:, 1]
    assert modal_assurance_criterion(mixed, modes)[0] == approx([0.5, 0.5, 0.0], abs=1e-12)


def test_invalid_shapes_and_signals_are_refused() -> None:
    with raises(InvalidInput, match="same points, got 2 and 3"):
        modal_assurance_criterion([1.0, 2.0], [1.0, 2.0, 3.0])
    with raises(InvalidInput, match="none of them zero"):
        modal_assurance_criterion([0.0, 0.0], [1.0, 2.0])
    with raises(InvalidInput, match="not all zero"):
        operating_deflection_shape([0.0, 0.0])
    with raises(InvalidInput, match="sample faster"):
        complex_amplitudes(time=np.arange(100) / 25e3, signals=np.ones((1, 100)), frequency=25e3)
    with raises(InvalidInput, match=r"covers 0\.25 periods"):
        complex_amplitudes(time=np.linspace(0, 1e-5, 20), signals=np.ones((1, 20)), frequency=25e3)
    with raises(InvalidInput, match="three pairs"):
        amplitude_per_volt(voltage_peak_to_peak=[1.0, 2.0], vibration_amplitude=[1.0, 2.0])
