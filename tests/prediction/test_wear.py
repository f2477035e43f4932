"""Wear under vibration: published pairs, their posterior, and predictions of another pair."""

import numpy as np
from pytest import approx
from scipy.stats import multivariate_normal

from sonolube.prediction.posterior import learned
from sonolube.prediction.wear import WEAR_PRIOR, WearPair, WearPosterior, log_wear_posterior, published_wear


def test_titanium_is_among_the_pairs_without_reduction() -> None:
    ratios = {pair.name: pair.wear_rate_ratio for pair in published_wear()}
    assert ratios["titanium on titanium"] == approx([1.0])
    assert ratios["stainless steel on aluminium"] == approx([0.5424, 0.5182, 0.5137, 0.625, 0.5405, 0.5455], abs=1e-3)


def test_the_density_is_that_of_normal_logarithms_with_a_mean_of_their_pair() -> None:
    pair = WearPair(name="pair", wear_rate_ratio=np.array([0.5, 0.6, 0.45]), uncertainty=0.02, source="")
    row = np.array([[np.log(0.7), np.log(0.4), np.log(0.15)]])
    covariance = 0.4**2 + (0.15**2 + 0.02**2) * np.eye(3)
    closed = multivariate_normal([np.log(0.7)] * 3, covariance).logpdf(np.log(pair.wear_rate_ratio))
    alone = log_wear_posterior(row, (pair,)) - log_wear_posterior(row, ())
    assert alone[0] == approx(closed + 1.5 * np.log(2 * np.pi))
    assert log_wear_posterior(np.array([WEAR_PRIOR[0]]), ())[0] == 0


def test_half_of_the_published_pairs_lie_within_the_50_percent_interval_or_nearly() -> None:
    low, high = np.quantile(learned().wear.wear_rate_ratios(4000), [0.1, 0.9])
    means = [np.exp(np.log(pair.wear_rate_ratio).mean()) for pair in published_wear()]
    assert sum(low <= mean <= high for mean in means) >= 4
    assert 0.15 < low < 0.35
    assert 0.8 < high < 1.6


def test_own_wear_tests_draw_the_prediction_to_their_mean_and_narrow_it() -> None:
    wear = WearPosterior(hyperparameters=np.tile(np.log([0.7, 0.5, 0.1]), (500, 1)))
    free, own = wear.wear_rate_ratios(4000), wear.wear_rate_ratios(4000, measured=np.array([0.4, 0.42, 0.38]))
    weight = 3 * 0.25 / (3 * 0.25 + 0.01)
    expected = np.log(0.7) + weight * (np.log([0.4, 0.42, 0.38]).mean() - np.log(0.7))
    assert np.log(own).mean() == approx(expected, abs=0.005)
    assert np.log(own).std() == approx(0.5 * np.sqrt(1 - weight), rel=0.05)
    assert np.log(free).std() == approx(0.5, rel=0.05)
