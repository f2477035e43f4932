"""Averages over the separating half period against closed forms."""

import mpmath
import numpy as np
import pytest
from hypothesis import given, strategies as st
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.models.contact.period_mean import sampled_separating_mean, separating_half_period_mean


def test_the_mean_displacement_of_the_separating_half_is_two_over_pi_of_the_amplitude() -> None:
    gap = separating_half_period_mean(lambda d: d, separation=10e-6, vibration_amplitude=3e-6)
    assert gap == approx(10e-6 + 2 / np.pi * 3e-6, rel=1e-14)


@pytest.mark.parametrize("decays", [0.01, 1.25, 10.0, 100.0])
def test_an_exponential_averages_to_bessel_less_struve(decays: float) -> None:
    # (1/pi) times the integral of exp(-z sin theta) from 0 to pi is I0(z) - L0(z)
    with mpmath.workdps(80):  # both grow as exp(z)
        exact = float(mpmath.besseli(0, decays) - mpmath.struvel(0, decays))
    mean = separating_half_period_mean(
        lambda d: np.exp(-(d - 1.0) * decays / 0.5), separation=1.0, vibration_amplitude=0.5
    )
    assert mean == approx(exact, rel=1e-12)


@given(ratio=st.floats(0, 0.999))
def test_the_inverse_gap_averages_to_its_closed_form(ratio: float) -> None:
    # (1/pi) times the integral of 1/(1 + s sin theta) from 0 to pi is (2/pi) arccos(s)/sqrt(1 - s^2)
    mean = separating_half_period_mean(lambda d: 1 / d, separation=1.0, vibration_amplitude=ratio)
    assert mean == approx(2 / np.pi * np.arccos(ratio) / np.sqrt(1 - ratio**2), rel=1e-12)


def test_empty_arguments_give_empty_results() -> None:
    assert separating_half_period_mean(lambda d: d, separation=np.empty((0, 3)), vibration_amplitude=1.0).shape == (
        0,
        3,
    )


def test_a_separation_that_is_not_positive_is_refused() -> None:
    with raises(InvalidInput, match=r"separation must be positive, got 0\.0 m"):
        separating_half_period_mean(lambda d: d, separation=0.0, vibration_amplitude=0.0)


@pytest.mark.parametrize("mean", [0.0, 0.3, -0.6, 1.5, -2.0])
def test_a_sampled_sine_about_any_mean_averages_over_the_time_above_rest(mean: float) -> None:
    # of x = mean + sin theta, above zero between -b and pi + b with sin b = mean
    x = mean + np.sin(2 * np.pi * np.arange(4000) / 4000)
    b = np.arcsin(np.clip(mean, -1, 1))
    expected = mean + 2 * np.cos(b) / (np.pi + 2 * b) if mean > -1 else 0.0
    assert sampled_separating_mean(lambda d: 3 + d, displacement=x) == approx(3 + expected, rel=1e-5)


def test_a_motion_at_rest_has_the_value_at_rest_and_a_constant_opening_its_own() -> None:
    assert sampled_separating_mean(lambda d: 5 + d, displacement=np.zeros(8)) == 5
    assert sampled_separating_mean(lambda d: 5 + d, displacement=np.full(8, 2.0)) == 7
    assert sampled_separating_mean(lambda d: 5 + d, displacement=np.full(8, -2.0)) == 5


def test_a_coarse_period_is_interpolated_between_neighbouring_samples() -> None:
    # steps -1 to 1, 1 to 3, 3 to -1: parts 1/2, 1 and 3/4 lie above rest; the quantity, 0 below rest, is linear between
    # samples, with means 3/4, 2 and 15/8 over these parts
    x = np.array([1.0, 3.0, -1.0, -1.0])
    expected = (0.5 * 0.75 + 2.0 + 0.75 * 1.875) / 2.25
    assert sampled_separating_mean(lambda d: d, displacement=x) == approx(expected, rel=1e-12)
