"""Vibration: proportionality of amplitude to voltage, operating deflection shapes and modal assurance."""

import numpy as np
from hypothesis import given, strategies as st
from pytest import approx, mark, raises
from scipy import stats

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


def test_slope_interval_and_curvature_are_those_of_their_sums() -> None:
    volts, amplitude = np.array([1.0, 2.0, 4.0, 5.0]), np.array([2.1, 3.8, 8.5, 10.4])
    found = amplitude_per_volt(voltage_peak_to_peak=volts, vibration_amplitude=amplitude, confidence_level=0.9)
    # sums of squares 46 and of products 2.1 + 7.6 + 34 + 52 = 95.7
    slope = 95.7 / 46
    left = amplitude - slope * volts
    deviation = np.sqrt(left @ left / 3)
    half = stats.t.ppf(0.95, 3) * deviation / np.sqrt(46)
    assert found.amplitude_per_volt == approx(slope)
    assert (found.lower, found.upper) == approx((slope - half, slope + half))
    assert found.amplitude_deviation == approx(deviation)
    parabola, rest, _, _ = np.linalg.lstsq(np.column_stack([volts, volts**2]), amplitude)
    f_statistic = (left @ left - rest[0]) / (rest[0] / 2)
    assert found.curvature_p_value == approx(stats.f.sf(f_statistic, 1, 2))
    # slope at 5 V less that at zero: 2 b_2 5 V, over the mean slope
    assert found.curvature == approx(10 * parabola[1] / slope)
    assert found.proportional == (found.curvature_p_value > 0.1)
    assert found.confidence_level == 0.9


def test_voltages_that_are_not_positive_or_all_equal_are_refused() -> None:
    for volts, words in (
        ([0.0, 1.0, 2.0], "voltage_peak_to_peak must be positive"),
        ([2.0, 2.0, 2.0], "at different voltages"),
    ):
        with raises(InvalidInput, match=words):
            amplitude_per_volt(voltage_peak_to_peak=volts, vibration_amplitude=[1.0, 2.0, 3.0])
    assert amplitude_per_volt(voltage_peak_to_peak=[1.0, 2.0, 3.0], vibration_amplitude=[0.0, 0.0, 0.0]).curvature == 0


def test_a_single_row_of_four_samples_over_a_period_has_its_amplitude() -> None:
    time = 0.7 + np.array([0.0, 0.3, 0.6, 1.0])
    known = 2 - 1j
    signal = 3 + np.real(known * np.exp(2j * np.pi * time))
    assert complex_amplitudes(time=time, signals=signal, frequency=1.0) == approx([known])
    with raises(
        InvalidInput, match=r"signals must have one sample per time in each row, got shapes \(1, 3\) and \(3,\)"
    ):
        complex_amplitudes(time=time[:3], signals=signal[:3], frequency=1.0)
    with raises(InvalidInput, match=r"got shapes \(1, 4\) and \(5,\)"):
        complex_amplitudes(time=np.arange(5.0), signals=signal, frequency=1.0)


def test_a_deflection_shape_is_scaled_to_its_largest_point_at_the_common_phase() -> None:
    found = operating_deflection_shape(np.array([1.0, -4.0, 2.0]) * np.exp(0.9j) * 1e-6)
    # the largest point is positive, whatever the phase of the drive
    assert found.shape == approx([-0.25, 1.0, -0.5])
    assert found.greatest_amplitude == approx(4e-6)
    assert np.cos(found.phase) == approx([-1.0, 1.0, -1.0])
    mixed = operating_deflection_shape([3.0, 1.0j])  # sum of squares 9 - 1: the common phase is that of the first
    assert mixed.standing_wave_fraction == approx(0.9)
    assert mixed.phase == approx([0.0, np.pi / 2])
    with raises(InvalidInput, match="one-dimensional and not all zero"):
        operating_deflection_shape(np.ones((2, 2)))
    with raises(InvalidInput, match="not all zero"):
        operating_deflection_shape([])


def test_assurance_of_complex_shapes_is_the_square_of_their_normed_product() -> None:
    first = np.array([[1.0, 1j], [1j, 2.0], [0.0, 1.0]])
    second = np.array([1.0, 1.0, 1.0])
    # |1 - i|^2/(2 * 3) and |-i + 2 + 1|^2/(6 * 3)
    assert modal_assurance_criterion(first, second) == approx(np.array([[2 / 6], [10 / 18]]))
    with raises(InvalidInput, match="second must be shapes in columns"):
        modal_assurance_criterion(first, np.ones((3, 1, 1)))
