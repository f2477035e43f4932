"""Wear under vibration: published pairs, their posterior, and predictions of another pair."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from pytest import approx, mark, raises
from scipy.stats import multivariate_normal, norm

from sonolube.errors import InvalidInput, UnknownName
from sonolube.facts.published import si_value
from sonolube.prediction.posterior import learned
from sonolube.prediction.wear import (
    WEAR_PRIOR,
    WearPair,
    WearPosterior,
    log_wear_posterior,
    published_wear,
    vibration_weight,
)
from sonolube.rig import friction_point, read_rig, wear_point

RIGS = Path(__file__).parents[2] / "examples" / "rigs"


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


def one_draw() -> WearPosterior:
    """Posterior of M = ln 0.7, T = 0.5 and s = 0.1 without doubt."""
    return WearPosterior(hyperparameters=np.tile(np.log([0.7, 0.5, 0.1]), (500, 1)))


def test_without_an_effect_on_friction_the_vibration_does_not_change_wear() -> None:
    weight = vibration_weight(friction_ratio=np.repeat([1.0, 1.3], 500))
    assert np.all(weight == 0)
    assert np.all(learned().wear.wear_rate_ratios(1000, weight=weight) == 1)


def test_a_friction_reduction_of_a_thousandth_changes_wear_by_a_few_percent_at_most() -> None:
    weight = vibration_weight(friction_ratio=np.full(4000, 0.999))
    low, high = np.quantile(1 - learned().wear.wear_rate_ratios(4000, weight=weight), [0.1, 0.9])
    assert -0.02 < low <= 0 <= high < 0.03


def test_at_the_friction_of_the_published_wear_tests_the_vibration_has_its_full_effect() -> None:
    tested = [1 - si_value(f"table-2.5-friction_reduction-{row}") for row in (1, 2, 3)]
    assert np.all(vibration_weight(friction_ratio=np.tile(tested, (50, 1))) == 1)


def test_the_odds_of_the_weight_are_those_of_the_friction_reduction_within_a_factor_of_five() -> None:
    reduction = si_value("table-2.5-friction_reduction-3")
    for share in (0.03, 0.4):
        weight = vibration_weight(friction_ratio=np.full(20000, 1 - share * reduction))
        factor = np.log(weight / (1 - weight)) - np.log(share / (1 - share))
        assert np.mean(factor) == approx(0, abs=0.04)
        assert np.std(factor) == approx(np.log(5), rel=0.02)


def test_wear_by_the_separating_half_period_lies_within_the_spread_of_the_weight() -> None:
    rig = read_rig(RIGS / "tribometer.toml")
    full = np.log(wear_point(replace(rig, vibration_amplitude=2.0e-6, measured_under=None)).wear_rate_ratio)
    for speed, amplitude in ((0.0203, 0.5e-6), (0.0203, 1e-6), (0.0406, 1e-6), (0.087, 1.5e-6)):
        at = replace(rig, sliding_speed=speed, vibration_amplitude=amplitude, measured_under=None)
        by_friction = vibration_weight(friction_ratio=np.full(2000, friction_point(at).friction_ratio))
        low, high = np.quantile(by_friction, [0.025, 0.975])
        assert low < np.log(wear_point(at).wear_rate_ratio) / full < high


def test_draws_of_one_seed_have_one_factor_at_all_conditions() -> None:
    ratios = np.tile([0.95, 0.9, 0.8], (200, 1))
    together = vibration_weight(friction_ratio=ratios, seed=3)
    assert together[:, 1] == approx(vibration_weight(friction_ratio=ratios[:, 1], seed=3))
    assert np.all(np.diff(together, axis=1) > 0)


def test_at_full_weight_the_logarithm_of_the_ratio_is_normal_as_the_population_is() -> None:
    logs = np.log(one_draw().wear_rate_ratios(20000, weight=np.ones(20000)))
    expected = norm(np.log(0.7), 0.5).ppf([0.025, 0.1, 0.5, 0.9, 0.975])
    assert np.quantile(logs, [0.025, 0.1, 0.5, 0.9, 0.975]) == approx(expected, abs=0.03)


def test_the_tests_of_a_published_pair_count_for_a_rig_of_the_same_materials() -> None:
    # by hand: b = 0.25 / (0.25 + 0.01 + 0.04) = 5/6, mean ln 0.7 / 6, variance 0.25 / 6 + 0.3^2 = 0.1317
    logs = np.log(one_draw().wear_rate_ratios(20000, pair="titanium on titanium"))
    assert logs.mean() == approx(np.log(0.7) / 6, abs=0.01)
    assert logs.std() == approx(np.sqrt(0.1317), rel=0.02)


def test_own_tests_under_a_weaker_vibration_condition_the_effect_of_a_stronger_one() -> None:
    # x, and three tests of w x with independent errors, are jointly normal: conditioned by linear algebra
    measured, weight = np.array([0.8, 0.82, 0.85]), 0.4
    across = np.full(3, weight * 0.25)
    covariance = weight**2 * 0.25 * np.ones((3, 3)) + 0.01 * np.eye(3)
    gain = across @ np.linalg.inv(covariance)
    mean = np.log(0.7) + gain @ (np.log(measured) - weight * np.log(0.7))
    logs = np.log(one_draw().wear_rate_ratios(20000, measured=measured, measured_weight=weight))
    assert logs.mean() == approx(mean, abs=0.01)
    assert logs.std() == approx(np.sqrt(0.25 - gain @ across), rel=0.02)


def test_own_tests_win_where_they_contradict_the_weight() -> None:
    own = one_draw().wear_rate_ratios(4000, measured=np.array([0.5, 0.52, 0.48]), measured_weight=0.02, weight=0.02)
    assert np.median(own) == approx(0.5, abs=0.05)


@mark.parametrize(
    ("arguments", "refusal", "message"),
    [
        ({"weight": 1.5}, InvalidInput, "must lie between 0 and 1, got 1.5"),
        ({"weight": np.ones(3)}, InvalidInput, r"weight must be one number or one for each of 10 draws, got \(3,\)"),
        ({"measured": np.array([0.5, 0.0])}, InvalidInput, "wear_rate_ratio must be positive, got 0.0"),
        ({"pair": "titanium on titanum"}, UnknownName, "titanium on titanium"),
    ],
)
def test_what_cannot_be_is_refused(arguments: dict[str, Any], refusal: type[Exception], message: str) -> None:
    with raises(refusal, match=message):
        one_draw().wear_rate_ratios(10, **arguments)


def test_the_weight_is_one_from_a_friction_ratio_of_0_707_down_and_below_one_above() -> None:
    # D Table 2.5: the smallest reduction of the published wear tests is 29.3 %
    assert np.all(vibration_weight(friction_ratio=np.full(100, 0.706)) == 1)
    above = vibration_weight(friction_ratio=np.full(100, 0.709))
    assert np.all(above < 1)
    assert np.median(above) > 0.9


def test_tests_far_from_the_population_move_it_near_their_vibration_and_less_at_others() -> None:
    # by hand: off = ln 0.05 - w_t ln 0.7, beyond twice the deviation of the mean of two tests; the excess enters as a
    # deviation of its own, correlated over weights by exp(-(w - w_t)^2/(2 0.5^2))
    tests, tested, weight = np.array([0.05, 0.05]), 0.5, 0.9
    off = np.log(0.05) - tested * np.log(0.7)
    variance = tested**2 * 0.25 + 0.01 / 2
    departure = (off / 2) ** 2 - variance
    assert departure > 0
    covariance = weight * tested * 0.25 + departure * np.exp(-0.5 * (0.4 / 0.5) ** 2)
    gain = covariance / (variance + departure)
    expected = weight * np.log(0.7) + gain * off
    left = weight**2 * 0.25 + departure - gain * covariance
    logs = np.log(one_draw().wear_rate_ratios(20000, measured=tests, measured_weight=tested, weight=weight))
    assert logs.mean() == approx(expected, abs=0.02)
    assert logs.std() == approx(np.sqrt(left), rel=0.02)


def test_many_tests_of_a_published_pair_leave_the_difference_between_rigs() -> None:
    # six tests: b = 6 0.25/(6 0.25 + 0.01 + 0.02^2), mean of the logarithms of Tables 2.5 and 2.7
    pair = {each.name: each for each in published_wear()}["stainless steel on aluminium"]
    assert pair.uncertainty == approx(0.02)
    b = 1.5 / (1.5 + 0.01 + 0.02**2)
    mean = np.log(0.7) + b * (np.log(pair.wear_rate_ratio).mean() - np.log(0.7))
    logs = np.log(one_draw().wear_rate_ratios(20000, pair=pair.name))
    assert logs.mean() == approx(mean, abs=0.01)
    assert logs.std() == approx(np.sqrt(0.25 * (1 - b) + 0.09), rel=0.02)


def test_the_prior_of_wear_is_about_a_ratio_of_0_7_within_a_factor_of_two() -> None:
    pairs = (WearPair(name="pair", wear_rate_ratio=np.array([0.5]), uncertainty=0.3, source=""),)
    off = np.array(WEAR_PRIOR[0]) + np.array([[0.7, 0, 0], [0, 1.4, 0], [0, 0, -0.7]])
    assert log_wear_posterior(off, ()) == approx([-0.5, -2.0, -0.5])
    assert np.exp(WEAR_PRIOR[0]) == approx([0.7, 0.5, 0.1])
    # one test: normal about M with T^2 + s^2 + u^2
    row = np.log([[0.7, 0.4, 0.15]])
    closed = norm(np.log(0.7), np.sqrt(0.4**2 + 0.15**2 + 0.3**2)).logpdf(np.log(0.5)) + 0.5 * np.log(2 * np.pi)
    assert (log_wear_posterior(row, pairs) - log_wear_posterior(row, ())) == approx([closed])
