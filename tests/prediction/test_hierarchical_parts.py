"""Parts of the hierarchical model: priors, deviates, parameters of a rig, scale and width of discrepancy, scores."""

from dataclasses import replace
from math import exp, log, pi, sqrt

import numpy as np
from pytest import approx, mark
from scipy.stats import chi2, multivariate_normal, norm, truncnorm
from tests.prediction.linear_rigs import LINEAR, conditions, measured_rig

from sonolube.prediction.evidence import Conditions, UncertainConditions, normal_effect
from sonolube.prediction.hierarchy import (
    OwnParameters,
    Prior,
    RigLikelihood,
    binomial_interval,
    bounded_normals,
    central_interval,
    covariance_of_tests,
    discrepancy_correlation,
    discrepancy_deviation,
    interval_score,
    log_discrepancy_scale,
    log_hyperprior,
    squared_distances,
    standard_normals,
)


def test_the_interval_score_counts_what_lies_below_by_its_probability() -> None:
    # uniform draws: 25 to 75 % is 0.5 wide; 0.35 below it costs 2/(1 - 0.5) times as much
    draws = np.linspace(0, 1, 10_001)
    assert interval_score(draws, -0.1, probability=0.5) == approx(0.5 + 4 * 0.35)
    assert interval_score(draws, 1.2, probability=0.5) == approx(0.5 + 4 * 0.45)
    assert interval_score(draws, 0.3, probability=0.5) == approx(0.5)


def test_a_central_interval_is_of_the_draws_of_each_column() -> None:
    draws = np.stack([np.linspace(0, 1, 1001), np.linspace(5, 9, 1001)], axis=1)
    low, high = central_interval(draws, 0.8)
    assert low == approx([0.1, 5.4])
    assert high == approx([0.9, 8.6])


def test_three_successes_of_ten_have_the_tabulated_interval_of_clopper_and_pearson() -> None:
    assert binomial_interval(3, 10) == approx((0.0667, 0.6525), abs=1e-4)


def test_a_prior_has_the_logarithms_of_its_medians_with_that_of_the_closure_first() -> None:
    closure = replace(LINEAR, median=2e-6, spread=0.9)
    prior = Prior(
        length_factor=(1.1, 0.2),
        parameter_spread=(0.4, 0.3),
        length_spread=(0.6, 0.5),
        discrepancy=(0.07, 0.8),
        correlation_length=(0.5, 0.1),
    )
    means, deviations = prior.of(closure)
    assert np.exp(means) == approx([2e-6, 1.1, 0.4, 0.6, 0.07, 0.5])
    assert deviations == approx([0.9, 0.2, 0.3, 0.5, 0.8, 0.1])
    assert replace(prior, parameter_deviation=0.25).of(closure)[1][0] == approx(0.25)
    # two rows off by whole deviations: -(1 + 4)/2 and -(9 + 1)/2
    rows = means + deviations * np.array([[1, 0, 0, -2, 0, 0], [0, 3, 0, 0, 0, 1]])
    assert log_hyperprior(closure, rows, prior) == approx([-2.5, -5.0])


@mark.parametrize(("columns", "root"), [(1, 1.6180339887), (2, 1.3247179572), (3, 1.2207440846)])
def test_even_deviates_step_by_powers_of_the_golden_plastic_and_next_ratio(columns: int, root: float) -> None:
    # g^(d+1) = g + 1: golden ratio, plastic number, and the root for d = 3
    shares = norm.cdf(standard_normals(50, columns=columns, seed=3))
    steps = np.diff(shares, axis=0) % 1.0
    assert steps == approx(np.tile([root**-k for k in range(1, columns + 1)], (49, 1)), abs=1e-8)
    assert shares.shape == (50, columns)
    assert not standard_normals(50, columns=columns, seed=3).flags.writeable
    assert np.max(np.abs(shares - norm.cdf(standard_normals(50, columns=columns, seed=4)))) > 0.01


def test_the_scale_of_a_discrepancy_is_the_root_of_four_over_chi_squared_rising_with_its_deviate() -> None:
    z = np.array([-4.0, -2.0, -0.3, 0.0, 1.0, 2.5, 5.0])
    assert log_discrepancy_scale(z) == approx(0.5 * np.log(4 / chi2(4).isf(norm.cdf(z))), abs=1e-4)
    # beyond seven deviates it is that at seven
    assert log_discrepancy_scale(np.array([8.0])) == approx(log_discrepancy_scale(np.array([7.0])))
    assert log_discrepancy_scale(np.array([6.9])) < log_discrepancy_scale(np.array([7.0]))


def test_the_parameters_of_a_rig_are_those_of_the_population_moved_by_its_own_deviates() -> None:
    at = UncertainConditions(
        conditions=conditions([1e-6], [0.1]), decay_length_spread=None, amplitude_spread=0.8, amplitude_factor=2.0
    )
    row = np.array([[0.5, 0.3, log(0.2), log(0.6), log(0.07), log(0.9)]])
    own = OwnParameters(row, np.array([[1.5, -2.0, 0.0]]), at)
    assert own.log_parameter == approx([0.5 + 0.2 * 1.5])
    assert own.log_factor == approx([-log(2) + 0.3 - 2.0 * 1.0])  # hypot(0.6, 0.8) = 1
    median_scale = 0.5 * log(4 / chi2(4).median())
    assert own.log_discrepancy == approx([log(0.07) + median_scale], abs=1e-4)


def test_squared_distances_have_a_row_for_each_of_the_first_conditions() -> None:
    one, other = conditions([1e-6, 1e-6], [0.1, 0.1 * exp(3)]), conditions([exp(2) * 1e-6, 1e-6, 1e-6], [0.1] * 3)
    assert squared_distances(one, other) == approx(np.array([[4, 0, 0], [13, 9, 9]]))


def test_a_discrepancy_decays_with_the_square_of_the_distance_over_its_length() -> None:
    one, other = conditions([1e-6], [0.1]), conditions([exp(0.5) * 1e-6, 1e-6], [0.1, 0.1])
    # d = 0.5, lambda = 0.4 and 1: exp(-0.25/0.32) and exp(-0.25/2)
    found = discrepancy_correlation(one, other, log_length=np.log([0.4, 1.0]))
    assert found.shape == (2, 1, 2)
    assert found[:, 0, 0] == approx([exp(-0.25 / 0.32), exp(-0.125)])
    assert found[:, 0, 1] == approx([1, 1])


def test_a_discrepancy_is_a_quarter_without_a_reduction_and_full_from_a_fifth_on() -> None:
    at = conditions([2e-6] * 5, [0.04] * 5)
    scale, ratio = np.log(np.array(0.1)), np.array([1.0, 0.96, 0.9, 0.8, 0.3])
    assert discrepancy_deviation(ratio, at, log_discrepancy=scale, effect=1.0) == approx([0.025, 0.025, 0.05, 0.1, 0.1])
    effect = np.array([0.0, 0.5, 1.0, 0.1, 0.2])  # what vibration can do
    assert discrepancy_deviation(ratio, at, log_discrepancy=scale, effect=effect) == approx(
        [0, 0.0125, 0.05, 0.01, 0.02]
    )


def test_half_the_distance_from_the_tests_is_added_to_the_least_share_and_widens_all() -> None:
    distance = 0.4
    at = conditions([2e-6] * 3, [0.26590 * exp(distance)] * 3)
    known = float(at.distance()[0])
    assert known == approx(distance, abs=1e-3)
    found = discrepancy_deviation(np.array([1.0, 0.9, 0.5]), at, log_discrepancy=np.log(np.array(0.1)), effect=1.0)
    wider = 0.1 * sqrt(1 + known**2)
    assert found == approx([(0.25 + known / 2) * wider, 0.5 * wider, wider])


def test_the_covariance_of_tests_is_that_of_their_discrepancies_and_of_each_noise() -> None:
    rig = measured_rig([0.5, 0.9], conditions([2e-6, 2e-6], [0.04, 0.04 * exp(0.3)]))
    rig = replace(rig, uncertainty=np.array([0.02, 0.03]))
    found = covariance_of_tests(np.array([0.1, 0.05]), rig, log_length=np.log(np.array(0.5)))
    across = 0.1 * 0.05 * exp(-0.09 / 0.5)  # exp(-0.3^2/(2 0.5^2))
    assert found == approx(np.array([[0.01 + 4e-4, across], [across, 0.0025 + 9e-4]]))


@mark.parametrize(("measured", "shift"), [(None, 0.2 - log(1.1)), (0.12, -log(1.1))])
def test_a_closure_that_is_linear_in_both_logarithms_has_normally_distributed_tests(
    measured: float | None, shift: float
) -> None:
    # R = ln theta + 0.8 ln(l/a): theta and l/a lognormal between rigs, hardly any discrepancy
    closure = replace(
        LINEAR, ratio=lambda logs, at: np.asarray(logs) + 0.8 * np.log(at.decay_length / at.vibration_amplitude)
    )
    mean = 0.5 + 0.8 * (shift + np.log([1.0, 0.5]))
    rig = measured_rig(list(mean + np.array([0.2, 0.0])), conditions([1e-6, 2e-6], [0.02, 0.03]))
    at = replace(rig.at, decay_length_spread=measured, amplitude_spread=0.05, amplitude_factor=1.1)
    rig = replace(rig, at=at, uncertainty=np.full(2, 0.15))
    row = np.array([[0.5, 0.2, log(0.1), log(0.15), log(1e-4), log(0.7)]])
    common = 0.1**2 + 0.8**2 * ((measured or 0.15) ** 2 + 0.05**2)
    exact = multivariate_normal(mean, common * np.ones((2, 2)) + 0.15**2 * np.eye(2)).logpdf(rig.friction_ratio)
    assert RigLikelihood(closure, rig)(np.vstack([row] * 300)) == approx(np.full(300, exact), abs=0.12)  # of 64 nodes


@mark.parametrize(
    ("mean", "deviation", "low", "high"), [(0.3, 0.2, 0.0, 1.0), (0.95, 0.4, 0.2, 1.0), (0.5, 0.1, 0.0, np.inf)]
)
def test_bounded_normals_are_those_of_a_truncated_normal_distribution(
    mean: float, deviation: float, low: float, high: float
) -> None:
    shares = (np.arange(2000) + 0.5) / 2000
    found = bounded_normals(np.array(mean), np.array(deviation), norm.ppf(shares), low=low, high=high)
    ends = (low - mean) / deviation, (high - mean) / deviation
    assert found == approx(truncnorm(*ends, loc=mean, scale=deviation).ppf(shares), abs=2e-5)


def test_bounded_normals_far_outside_are_at_the_bound_next_to_them() -> None:
    found = bounded_normals(np.array([3.0, -2.0]), np.array([0.01, 0.01]), np.array([0.3, 0.3]), low=0.0, high=1.0)
    assert found == approx([1.0, 0.0])
    assert bounded_normals(np.array(0.4), np.array(0.0), np.array(1.0), low=0.0, high=1.0) == approx(0.4)


def test_what_vibration_can_do_vanishes_with_its_amplitude_and_against_fast_sliding() -> None:
    # l = 1 um, D_c = 2 um, omega a of 1 um at 1/(2 pi) Hz is 1 um/s
    at = Conditions(
        vibration_amplitude=np.array([1e-6, 0.1e-6, 1e-6, 1e-6]), frequency=np.full(4, 0.5 / pi),
        sliding_speed=np.array([1e-12, 1e-13, 2e-6, 20e-6]), decay_length=np.full(4, 1e-6),
    )  # fmt: skip
    # a fifth of a decay length on counts in full; xi of 0, 0, 1, 10
    assert normal_effect(log(2e-6), at) == approx([1.0, 0.5, 0.5, 1 / 101])
