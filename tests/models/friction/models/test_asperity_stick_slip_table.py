"""Tabulated stick-slip ratios under sines: the quadrature, limits in closed form, ranges."""

import numpy as np
import pytest
from pytest import approx, raises
from scipy.special import i0e
from tests.models.friction.worst_errors import worst_error
from tests.same import same

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.models.friction import sine_stick_slip_ratio, tabulated_stick_slip_ratio

SECOND = 1 / (2 * np.pi)  # frequency of one radian a second


def tabulated(beta: Floats, v: Floats) -> Floats:
    return tabulated_stick_slip_ratio(
        decay_length=1.0, vibration_amplitude=beta, frequency=SECOND, sliding_speed=v * beta, memory_length=1.0
    )


def integrated(beta: Floats, v: Floats) -> Floats:
    return sine_stick_slip_ratio(
        decay_length=1.0, vibration_amplitude=beta, frequency=SECOND, sliding_speed=v * beta, memory_length=1.0
    )


@pytest.mark.parametrize("decades", [(-6.0, -3.0), (-4.0, 3.0), (3.0, 6.0)])
def test_no_amplitude_and_speed_is_farther_than_two_millionths_from_the_integral(decades: tuple[float, float]) -> None:
    assert worst_error(tabulated, integrated, decades=decades) < 2e-6


def test_beyond_the_table_the_ratio_is_the_integral() -> None:
    beta, v = np.array([2e6, 1e8]), np.array([3e-4, 1e-4])
    same(tabulated(beta, v), integrated(beta, v))
    assert np.all(tabulated(beta, np.ones(2)) == 1.0)


@pytest.mark.parametrize("beta", [1e-3, 0.3, 2.0, 30.0])
def test_slow_sliding_leaves_the_friction_of_the_widest_gap(beta: float) -> None:
    assert tabulated(np.array(beta), np.array(1e-30)) == approx(np.exp(-2 * beta) / i0e(beta), abs=2e-6)


def test_friction_is_whole_without_vibration_and_from_the_critical_speed_on() -> None:
    assert np.all(tabulated(np.geomspace(1e-9, 1e9, 50), np.ones(50)) == 1.0)
    assert np.all(tabulated(np.geomspace(1e-9, 1e9, 50), np.full(50, 7.0)) == 1.0)
    still = tabulated_stick_slip_ratio(decay_length=2e-6, vibration_amplitude=0.0, frequency=2e4, sliding_speed=0.02)
    assert still == 1.0


def test_below_the_critical_speed_the_reduction_vanishes_with_the_square_of_the_distance() -> None:
    far, near = 1 - tabulated(np.full(2, 0.5), np.array([1 - 2e-6, 1 - 1e-6]))
    assert far == approx(4 * near, rel=1e-3)
    assert near > 0


def test_more_vibration_lowers_friction_and_faster_sliding_raises_it() -> None:
    beta, v = np.geomspace(1e-3, 1e3, 80), np.linspace(0.0, 1.0, 90)[1:]
    ratio = tabulated(beta[:, None], v)
    assert np.all(np.diff(ratio[:, ::8], axis=1) >= -2e-6)
    assert np.all((ratio >= 0) & (ratio <= 1))


def test_lengths_of_draws_and_speeds_of_conditions_broadcast() -> None:
    length, speed = np.array([[1e-6], [2e-6], [4e-6]]), np.array([0.01, 0.05])
    at = {"vibration_amplitude": 2.5e-6, "frequency": 22e3, "memory_length": 1.5e-6}
    found = tabulated_stick_slip_ratio(decay_length=length, sliding_speed=speed, **at)
    assert found == approx(sine_stick_slip_ratio(decay_length=length, sliding_speed=speed, **at), abs=2e-6)
    assert found.shape == (3, 2)


def test_a_length_that_is_not_positive_is_refused_by_name() -> None:
    with raises(InvalidInput, match=r"decay_length must be positive, got 0\.0 m"):
        tabulated_stick_slip_ratio(decay_length=0.0, vibration_amplitude=1e-6, frequency=2e4, sliding_speed=0.02)
