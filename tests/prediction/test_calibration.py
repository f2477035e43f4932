"""Calibration on the published rigs, each left out in turn, and the scores against closed forms."""

import numpy as np
from pytest import approx
from scipy.stats import norm

from sonolube.prediction.calibration import (
    BLIND,
    BY_RECORDS,
    MEAN_RATIO,
    SAME_TRIBOMETER,
    Calibration,
    UnseenPrediction,
    blind_calibration,
    calibrations,
    plane_calibration,
)
from sonolube.prediction.figures import blind_caption, plane_caption
from sonolube.prediction.hierarchy import (
    PROBABILITIES,
    binomial_interval,
    central_interval,
    continuous_ranked_probability_score,
    interval_score,
)


def by_name() -> dict[str, Calibration]:
    return {one.name: one for one in calibrations()}


def test_blind_intervals_hold_what_a_binomial_distribution_allows() -> None:
    for found in (by_name()[BLIND], blind_calibration(SAME_TRIBOMETER)):
        for probability, (low, high) in zip(PROBABILITIES, ((5, 12), (10, 16), (14, 17)), strict=True):
            assert low <= found.covered(probability) <= high


def test_the_blind_score_is_below_that_of_the_mean_ratio_but_not_shown_to_be() -> None:
    blind, mean = by_name()[BLIND], by_name()[MEAN_RATIO]
    assert blind.crps < 0.157
    gain, low, high = blind.gain_over(mean)
    assert low < 0 < gain < high
    assert "not shown to be better than the mean of published tests" in blind_caption()


def test_records_that_no_user_has_make_the_score_look_better_than_it_is() -> None:
    assert by_name()[BY_RECORDS].crps < 0.7 * by_name()[BLIND].crps


def test_within_the_plane_each_point_is_predicted_by_the_other_and_how_far_is_said_first() -> None:
    found = plane_calibration()
    littmann, gutowski = found.predictions
    assert (littmann.friction_ratio, gutowski.friction_ratio) == approx((1.0, 0.1))  # D 2.2.5 and 1.3.1
    assert found.covered(0.8) == found.covered(0.95) == 2
    assert found.median_width < 0.4  # and does not hold everything
    assert plane_caption().startswith("Within the plane of contact it was tested with 2 published points along")


def test_the_gain_over_a_rival_has_the_mean_and_the_bootstrap_of_two_sets() -> None:
    def way(name: str, offsets: dict[str, float]) -> Calibration:
        return Calibration(
            name=name,
            predictions=tuple(
                UnseenPrediction(rig=rig, friction_ratio=0.0, uncertainty=0.05, draws=np.full(10, offset))
                for rig, offset in offsets.items()
            ),
        )

    # certain predictions have their distance as score: gains of 0.1 and 0.3, and resamples (a,a), (a,b), (b,b)
    gain = way("good", {"a": 0.1, "b": 0.1}).gain_over(way("bad", {"a": 0.2, "b": 0.4}))
    assert gain == approx((0.2, 0.1, 0.3))


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
