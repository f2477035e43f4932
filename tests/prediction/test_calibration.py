"""Calibration on the published rigs, each left out in turn, and the scores against closed forms."""

import numpy as np
from pytest import approx
from scipy.stats import norm

from sonolube.prediction.calibration import Calibration, calibrations
from sonolube.prediction.scores import (
    PROBABILITIES,
    binomial_interval,
    central_interval,
    continuous_ranked_probability_score,
    interval_score,
)


def by_name() -> dict[str, Calibration]:
    return {one.name: one for one in calibrations()}


def test_the_coverage_of_unseen_rigs_agrees_with_the_probability_of_every_interval() -> None:
    found = by_name()["hierarchical model"]
    assert all(found.p_value(probability) > 0.05 for probability in PROBABILITIES)


def test_unseen_rigs_are_predicted_better_than_by_simpler_ways() -> None:
    found = by_name()
    best = found.pop("hierarchical model")
    for rival in found.values():
        assert best.crps < rival.crps
        assert best.interval_score < rival.interval_score


def test_intervals_of_unseen_rigs_are_no_wider_than_half_the_range_of_ratios() -> None:
    assert by_name()["hierarchical model"].median_width < 0.5


def test_every_test_is_predicted_once_by_each_way() -> None:
    assert {len(one.predictions) for one in calibrations()} == {17}


def test_the_crps_of_normal_draws_is_that_of_the_closed_form() -> None:
    draws, measured = 0.3 + 0.1 * norm.ppf((np.arange(20_000) + 0.5) / 20_000), 0.42
    z = (measured - 0.3) / 0.1
    closed = 0.1 * (z * (2 * norm.cdf(z) - 1) + 2 * norm.pdf(z) - 1 / np.sqrt(np.pi))
    assert continuous_ranked_probability_score(draws, measured) == approx(closed, rel=1e-3)


def test_the_interval_score_is_the_width_within_and_ten_times_the_distance_more_outside() -> None:
    draws = np.linspace(0, 1, 10_001)
    assert interval_score(draws, 0.5) == approx(0.8)
    assert interval_score(draws, 0.95) == approx(0.8 + 10 * 0.05)


def test_the_central_interval_of_uniform_draws_leaves_equal_tails() -> None:
    assert central_interval(np.linspace(0, 1, 10_001), 0.5) == approx((0.25, 0.75))


def test_the_binomial_interval_of_no_success_in_n_is_that_of_clopper_and_pearson() -> None:
    low, high = binomial_interval(0, 10)
    assert (low, high) == approx((0.0, 1 - 0.025 ** (1 / 10)))
