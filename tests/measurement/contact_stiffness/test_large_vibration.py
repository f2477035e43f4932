"""Equivalent stiffness of an exponential contact against the first harmonic of its force."""

import numpy as np
from pytest import approx, mark, raises

from sonolube.errors import OutsideRange
from sonolube.measurement.contact_stiffness.large_vibration import (
    decay_length_from_ratio,
    equivalent_stiffness_ratio,
    log_ratio_slope,
)


@mark.parametrize("amplitude", [1e-9, 0.2e-6, 1.5e-6, 6e-6, 40e-6])
def test_the_equivalent_stiffness_is_the_first_harmonic_of_the_force_at_constant_mean(amplitude: float) -> None:
    load, length = 3.0, 1.5e-6
    theta = (np.arange(100_000) + 0.5) * 2 * np.pi / 100_000
    force = np.exp(-amplitude / length * (1 + np.cos(theta)))
    force *= load / force.mean()
    harmonic = -2 * np.mean(force * np.cos(theta)) / amplitude
    ratio = equivalent_stiffness_ratio(vibration_amplitude=amplitude, decay_length=length)
    assert float(ratio) == approx(harmonic / (load / length), rel=1e-8)


def test_the_limits_are_those_of_small_and_of_large_amplitudes() -> None:
    small, large = equivalent_stiffness_ratio(vibration_amplitude=[0.01, 1e4], decay_length=1.0)
    assert small == approx(1 - 0.01**2 / 8, abs=1e-9)
    assert large == approx(2e-4, rel=1e-4)
    assert float(equivalent_stiffness_ratio(vibration_amplitude=0.0, decay_length=1e-6)) == 1


@mark.parametrize("length", [0.2e-6, 1.5e-6, 20e-6])
def test_the_decay_length_comes_back_from_the_ratio(length: float) -> None:
    ratio = float(equivalent_stiffness_ratio(vibration_amplitude=2.5e-6, decay_length=length))
    assert decay_length_from_ratio(ratio, vibration_amplitude=2.5e-6) == approx(length, rel=1e-8)


def test_a_large_vibration_tells_its_amplitude_alone() -> None:
    # k_eq is 2 F_N/a there whatever l, so the ratio is proportional to l/a
    assert log_ratio_slope(vibration_amplitude=1e-3, decay_length=1e-6) == approx(-1, abs=1e-3)
    assert log_ratio_slope(vibration_amplitude=1e-8, decay_length=1e-6) == approx(0, abs=1e-4)


def test_a_contact_that_stiffens_under_vibration_is_refused() -> None:
    with raises(OutsideRange, match=r"stiffness_ratio must lie between 0 and 1, got 1\.2"):
        decay_length_from_ratio(1.2, vibration_amplitude=1e-6)
