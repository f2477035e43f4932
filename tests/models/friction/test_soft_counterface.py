"""Friction on soft counterfaces against springs integrated in time, and closed forms."""

import numpy as np
from hypothesis import given, strategies as st
from pytest import approx, raises
from scipy.optimize import brentq
from scipy.special import i0, i0e, modstruve

from sonolube.errors import InvalidInput
from sonolube.models.friction import FaceVibrationMode, exponential_layer_ratio, linear_layer_ratio

UNIFORM_ON_RIGID = FaceVibrationMode(rim_displacement_ratio=1.0, following_fraction=0.0)
UNIFORM_ON_SOFT = FaceVibrationMode(rim_displacement_ratio=1.0, following_fraction=1.0)
OPPOSED = FaceVibrationMode()
amplitudes = st.floats(0.01, 8)


def slow_sliding_friction(limits: np.ndarray, rate: float) -> float:
    """Return the mean friction of springs stretched at a low rate up to their limits, one row of limits per patch."""
    force, total, count = limits.min(axis=1), 0.0, 0
    periods = 4
    for period in range(periods):
        for limit in limits.T:
            force = np.minimum(force + rate, limit)
            if period == periods - 1:
                total, count = total + force.mean(), count + 1
    return total / count


def test_slowly_sliding_patches_have_the_smallest_friction_of_the_period() -> None:
    phase = np.linspace(0, 2 * np.pi, 400, endpoint=False)
    # equal areas from centre to rim move from +a to -a
    motion = 0.7 * (1 - 2 * (np.arange(200) + 0.5) / 200)
    gap = motion[:, None] * np.cos(phase)

    def linear(mean: float) -> np.ndarray:
        return np.maximum(mean - gap, 0.0)

    mean = float(brentq(lambda each: linear(each).mean() - 1, 0, 2))
    by_hand = slow_sliding_friction(linear(mean), 1e-5)
    assert linear_layer_ratio(OPPOSED, vibration_amplitude=0.7, static_indentation=1.0) == approx(by_hand, abs=3e-3)

    pressure = np.exp(-gap)
    by_hand = slow_sliding_friction(pressure / pressure.mean(), 1e-5)
    assert exponential_layer_ratio(OPPOSED, vibration_amplitude=0.7, decay_length=1.0) == approx(by_hand, abs=3e-3)


def test_friction_on_a_linear_layer_falls_by_half_the_amplitude_over_indentation_without_contact_loss() -> None:
    a = np.array([0.0, 0.25, 0.5, 1.0])
    assert linear_layer_ratio(OPPOSED, vibration_amplitude=a, static_indentation=1.0) == approx(1 - a / 2)
    assert linear_layer_ratio(UNIFORM_ON_RIGID, vibration_amplitude=a, static_indentation=1.0) == approx(1 - a)


def test_the_mean_force_of_a_face_with_contact_loss_is_its_load() -> None:
    a = 3.0
    phase, motion = np.linspace(0, 2 * np.pi, 2000, endpoint=False), 1 - 2 * (np.arange(1000) + 0.5) / 1000
    gap = a * motion[:, None] * np.cos(phase)
    mean = float(brentq(lambda each: np.maximum(each - gap, 0).mean() - 1, -a, a))
    by_hand = np.maximum(mean - a * np.abs(motion), 0).mean()
    assert linear_layer_ratio(OPPOSED, vibration_amplitude=a, static_indentation=1.0) == approx(by_hand, rel=1e-3)


@given(a=amplitudes)
def test_an_exponential_layer_has_the_closed_forms_of_bessel_and_struve(a: float) -> None:
    uniform = exponential_layer_ratio(UNIFORM_ON_RIGID, vibration_amplitude=a, decay_length=1.0)
    assert uniform == approx(np.exp(-2 * a) / i0e(a))
    # the integral of I0 from 0 to x, DLMF 10.43.2 with L the modified Struve function
    from scipy.special import i1

    integral = a * (i0(a) + np.pi / 2 * (modstruve(1, a) * i0(a) - modstruve(0, a) * i1(a)))
    opposed = exponential_layer_ratio(OPPOSED, vibration_amplitude=a, decay_length=1.0)
    assert opposed == approx((1 - np.exp(-a)) / integral, rel=1e-9)


@given(a=amplitudes)
def test_a_body_that_follows_a_uniform_motion_leaves_friction_unchanged(a: float) -> None:
    assert linear_layer_ratio(UNIFORM_ON_SOFT, vibration_amplitude=a, static_indentation=1.0) == approx(1)
    assert exponential_layer_ratio(UNIFORM_ON_SOFT, vibration_amplitude=a, decay_length=1.0) == approx(1)


@given(a=amplitudes, following_fraction=st.floats(0, 1))
def test_a_mode_of_zero_mean_is_not_followed_by_any_body(a: float, following_fraction: float) -> None:
    mode = FaceVibrationMode(rim_displacement_ratio=-1.0, following_fraction=following_fraction)
    same = exponential_layer_ratio(OPPOSED, vibration_amplitude=a, decay_length=1.0)
    assert exponential_layer_ratio(mode, vibration_amplitude=a, decay_length=1.0) == approx(same)


def test_large_amplitudes_stay_finite() -> None:
    for ratio in (
        exponential_layer_ratio(OPPOSED, vibration_amplitude=1e3, decay_length=1.0),
        linear_layer_ratio(OPPOSED, vibration_amplitude=1e3, static_indentation=1.0),
    ):
        assert 0 <= ratio < 1e-3


def test_a_rim_displacement_above_that_of_the_centre_is_refused() -> None:
    with raises(InvalidInput, match="rim_displacement_ratio must lie between -1 and 1"):
        FaceVibrationMode(rim_displacement_ratio=-2.0)
