"""Predictive draws: limits, the update by own tests against closed forms, and tests that no closure explains."""

from dataclasses import replace

import numpy as np
from pytest import approx, mark
from scipy.stats import multivariate_normal
from tests.prediction.linear_rigs import LINEAR, conditions, measured_rig
from tests.same import same

from sonolube.checks import Floats
from sonolube.prediction.evidence import TestedRig, UncertainConditions, published_rigs
from sonolube.prediction.hierarchy import log_normal_density
from sonolube.prediction.posterior import Posterior, learned
from sonolube.prediction.predictive import ratio_draws, rig_prediction

MU, TAU, SIGMA, LENGTH = 0.4, 0.06, 2e-4, 0.7
SHARP = np.tile([MU, 0.0, np.log(TAU), 0.0, np.log(SIGMA), np.log(LENGTH)], (1024, 1))
KNOWN = Posterior(closure=LINEAR, hyperparameters=SHARP)
"""With next to no discrepancy, the heavy tail of its scale does not count, and all is normal."""


def uncertain(
    amplitudes: list[float], speeds: list[float], *, length: float | None = None, frequency: float = 2e4
) -> UncertainConditions:
    at = replace(conditions(amplitudes, speeds), frequency=np.full(len(speeds), frequency))
    return UncertainConditions(conditions=at, decay_length_spread=length, amplitude_spread=0.05)


def spread(ratio: Floats) -> float:
    low, high = np.quantile(ratio[:, 0], [0.1, 0.9])
    return float(high - low)


def runs(ratios: list[float], amplitudes: list[float], speeds: list[float], *, noise: float = 0.05) -> TestedRig:
    own = measured_rig(ratios, conditions(amplitudes, speeds))
    return replace(own, uncertainty=np.full(len(ratios), noise))


def test_without_own_tests_the_scatter_between_rigs_and_a_heavy_tailed_discrepancy_add_up() -> None:
    sigma = 0.05
    wide = replace(KNOWN, hyperparameters=SHARP + np.array([0, 0, 0, 0, np.log(sigma / SIGMA), 0]))
    draws = ratio_draws(wide, uncertain([2e-6], [0.02]), count=8000)[:, 0]
    reference = np.random.default_rng(1)
    student = sigma * reference.standard_t(4, 400_000) + TAU * reference.standard_normal(400_000)
    for share in (0.025, 0.1, 0.5, 0.9, 0.975):
        assert np.quantile(draws, share) == approx(MU + np.quantile(student, share), abs=0.01)


def test_own_tests_update_a_linear_closure_as_a_normal_distribution_is_conditioned() -> None:
    own = runs([0.5, 0.45], [1.5e-6, 2e-6], [0.02, 0.03])
    draws = ratio_draws(KNOWN, uncertain([2e-6], [0.02]), count=4000, own=own)[:, 0]
    variance = 1 / (1 / TAU**2 + 2 / 0.05**2)
    assert draws.mean() == approx(variance * (MU / TAU**2 + 0.95 / 0.05**2), abs=0.005)
    assert draws.std() == approx(np.sqrt(variance), rel=0.06)


def test_many_sharp_tests_are_conditioned_on_by_steps_as_by_one_formula() -> None:
    ratios = [0.52, 0.5, 0.51, 0.49, 0.5, 0.515]
    own = runs(ratios, [1e-6, 1.5e-6, 2e-6, 2.5e-6, 3e-6, 3.5e-6], [0.02] * 6, noise=0.01)
    found = rig_prediction(KNOWN, uncertain([2e-6], [0.02]), count=4000, own=own)
    weights = (own.uncertainty / found.draws.own.uncertainty) ** 2 if found.draws.own is not None else np.ones(6)
    precision = weights / 0.01**2
    variance = 1 / (1 / TAU**2 + precision.sum())
    parameter = found.draws.parameters.log_parameter
    assert parameter.mean() == approx(variance * (MU / TAU**2 + precision @ ratios), abs=0.002)
    assert parameter.std() == approx(np.sqrt(variance), rel=0.15)


def test_a_test_counts_near_its_conditions_and_less_the_farther_away() -> None:
    own = runs([0.3], [2e-6], [0.02])

    def share_left(speed: float) -> float:
        at = uncertain([2e-6], [speed])
        left, before = (spread(ratio_draws(learned().friction, at, count=4000, own=each)) for each in (own, None))
        return left / before

    near, far = share_left(0.02), share_left(0.3)
    assert near < 0.75 * far
    assert far < 1.05


def test_more_own_tests_narrow_the_interval() -> None:
    at = uncertain([2.5e-6], [0.02])
    none = spread(ratio_draws(learned().friction, at, count=4000))
    one = spread(ratio_draws(learned().friction, at, count=4000, own=runs([0.4], [2.5e-6], [0.08])))
    several = runs([0.4, 0.35, 0.3], [2.5e-6, 2e-6, 2.5e-6], [0.08, 0.02, 0.02])
    assert none > one > spread(ratio_draws(learned().friction, at, count=4000, own=several))


def test_a_measured_decay_length_narrows_the_interval_the_more_the_better_it_is_known() -> None:
    widths = [
        spread(ratio_draws(learned().friction, uncertain([2e-6], [0.03], length=length), count=4000))
        for length in (None, 0.3, 0.05)
    ]
    assert widths == sorted(widths, reverse=True)


def test_a_sharp_own_test_at_the_asked_conditions_is_believed() -> None:
    at = uncertain([2.5e-6], [0.02])
    draws = ratio_draws(learned().friction, at, count=2000, own=runs([0.5], [2.5e-6], [0.02], noise=0.005))[:, 0]
    assert np.quantile(draws, [0.05, 0.95]) == approx([0.5, 0.5], abs=0.015)


def test_repeats_narrow_the_interval_as_one_test_of_less_noise() -> None:
    at = uncertain([2.5e-6], [0.02])
    thrice = ratio_draws(learned().friction, at, count=4000, own=runs([0.5] * 3, [2.5e-6] * 3, [0.02] * 3))
    once = ratio_draws(learned().friction, at, count=4000, own=runs([0.5], [2.5e-6], [0.02], noise=0.05 / 3**0.5))
    assert np.quantile(thrice, [0.1, 0.5, 0.9]) == approx(np.quantile(once, [0.1, 0.5, 0.9]), abs=0.01)


def test_ratios_above_one_that_were_measured_are_believed_where_they_were_measured() -> None:
    at = uncertain([2.5e-6], [0.02])
    found = rig_prediction(learned().friction, at, count=2000, own=runs([1.2, 1.15], [2.5e-6, 2.5e-6], [0.02, 0.02]))
    low, high = np.quantile(found.ratios(at.conditions)[:, 0], [0.1, 0.9])
    assert 1.0 < low < 1.18 < high < 1.3
    assert found.check is not None
    assert found.check.contradicted


@mark.parametrize("frequency", [1e3, 2e4, 1e6])
def test_a_picometre_of_vibration_changes_nothing_at_any_frequency(frequency: float) -> None:
    at = uncertain([1e-12], [0.1], frequency=frequency)
    assert ratio_draws(learned().friction, at, count=4000) == approx(np.ones((4000, 1)), abs=1e-4)


@mark.parametrize("amplitude", [0.5e-6, 3e-6, 20e-6])
@mark.parametrize(("times", "least"), [(30.0, 0.9), (100.0, 0.97)])
def test_sliding_much_faster_than_the_vibration_leaves_friction_as_it_is(
    amplitude: float, times: float, least: float
) -> None:
    speed = times * 2 * np.pi * 2e4 * amplitude
    draws = ratio_draws(learned().friction, uncertain([amplitude], [speed]), count=4000)
    assert np.quantile(draws, 0.025) > least
    assert draws.max() <= 1


@mark.parametrize("speed", [1e-6, 1e-3, 0.03, 1.0])
@mark.parametrize("amplitude", [1e-8, 2e-6, 2e-4])
def test_the_mean_ratio_is_at_most_one_and_no_draw_is_exactly_an_end(amplitude: float, speed: float) -> None:
    draws = ratio_draws(learned().friction, uncertain([amplitude], [speed]), count=4000)
    assert draws.min() > 0
    assert draws.max() <= 1
    assert np.mean(draws == 1) < 0.2  # but where friction does not change at all


def test_the_interval_narrows_towards_the_speed_from_which_on_vibration_does_nothing() -> None:
    widths = [
        spread(ratio_draws(learned().friction, uncertain([2e-6], [2 * np.pi * 2e4 * 2e-6 * ratio]), count=4000))
        for ratio in (0.5, 1.06, 2.1, 5.3, 27)
    ]
    assert widths == sorted(widths, reverse=True)


def test_own_tests_that_rise_with_the_amplitude_contradict_the_prediction() -> None:
    own = runs([0.3, 0.7, 1.3], [0.5e-6, 1.5e-6, 4e-6], [0.02, 0.02, 0.02])
    check = rig_prediction(learned().friction, uncertain([2e-6], [0.02]), count=500, own=own).check
    assert check is not None
    assert check.contradicted


def test_published_tests_contradict_no_prediction() -> None:
    for rig in published_rigs():
        check = rig_prediction(learned().friction, rig.at, count=500, own=rig).check
        assert check is not None
        assert not check.contradicted


def test_one_outlier_among_six_is_named_and_moves_an_unseen_median_little() -> None:
    at = uncertain([2e-6], [0.04])
    amplitudes, speeds = [1.5e-6, 2e-6, 2.5e-6, 2e-6, 1.5e-6, 2.5e-6], [0.03, 0.03, 0.03, 0.06, 0.06, 0.06]
    ratios = [0.58, 0.47, 0.38, 0.57, 0.67, 0.48]
    good, bad = (
        rig_prediction(learned().friction, at, count=2000, own=runs(measured, amplitudes, speeds))
        for measured in (ratios, [*ratios[:2], 0.95, *ratios[3:]])
    )
    assert good.check is not None
    assert bad.check is not None
    assert good.check.outliers == ()
    assert bad.check.outliers == (2,)
    medians = [float(np.median(each.ratios(at.conditions))) for each in (good, bad)]
    assert abs(medians[0] - medians[1]) < 0.08


def test_each_run_is_compared_with_what_the_others_predict_at_its_conditions() -> None:
    amplitudes, speeds = [1e-6, 1.5e-6, 2e-6, 2.5e-6], [0.03, 0.06, 0.03, 0.06]
    ratios = [0.8, 0.7, 0.45, 0.5]
    at = uncertain(amplitudes, speeds)
    check = rig_prediction(learned().friction, at, count=2000, own=runs(ratios, amplitudes, speeds)).check
    assert check is not None
    for place in range(4):
        others = [each for each in range(4) if each != place]
        known = runs(*([values[each] for each in others] for values in (ratios, amplitudes, speeds)))
        alone = uncertain([amplitudes[place]], [speeds[place]])
        predicted = ratio_draws(learned().friction, alone, count=4000, own=known)[:, 0]
        assert check.left_out[place] == approx(predicted.mean(), abs=0.025)


def test_the_same_seed_gives_the_same_draws() -> None:
    at = uncertain([2e-6], [0.02])
    own = runs([0.5, 0.4], [1e-6, 2e-6], [0.02, 0.02])
    one, other = (ratio_draws(learned().friction, at, count=300, seed=7, own=own) for _ in range(2))
    same(one, other)


def test_the_density_of_own_tests_is_that_of_a_multivariate_normal_distribution() -> None:
    covariance = np.array([[0.02, 0.01], [0.01, 0.03]])
    found = log_normal_density(np.array([0.1, -0.2]), covariance)
    assert found == approx(multivariate_normal([0, 0], covariance).logpdf([0.1, -0.2]))
