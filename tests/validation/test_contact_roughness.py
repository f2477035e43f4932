"""Roughness of the published contacts: how well each is known, by hand from what was printed."""

from math import hypot, log, pi, sqrt

import pytest
from pytest import approx

from sonolube.validation.contacts import RMS_OVER_ARITHMETIC_MEAN, roughness_spread


def test_the_rms_of_a_gaussian_profile_is_its_mean_deviation_times_the_root_of_half_pi() -> None:
    assert approx(sqrt(pi / 2)) == RMS_OVER_ARITHMETIC_MEAN


@pytest.mark.parametrize(
    ("label", "spread"), [("A-1", 0.69), ("H-2", 0.69), ("C-1", 0.98), ("G-1", 0.86), ("G-2", 1.93)]
)
def test_a_roughness_is_known_within_the_factor_that_its_origin_leaves(label: str, spread: float) -> None:
    assert abs(roughness_spread(label)) == approx(spread, abs=0.006)


def test_the_spread_of_set_b_adds_half_a_step_to_the_mean_deviation_and_half_of_that_to_a_second_surface() -> None:
    assert roughness_spread("B-1") == approx(hypot(log(pi / 2) / 4, log(2) / 4), rel=1e-9)
    assert roughness_spread("B-1") == approx(0.21, abs=0.005)
