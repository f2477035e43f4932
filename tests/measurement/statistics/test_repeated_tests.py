"""Few repeated tests: scipy for Welch, enumeration of permutations, the definition of Fieller."""

from itertools import permutations

import numpy as np
import pytest
from hypothesis import assume, given, strategies as st
from pytest import approx, raises
from scipy import stats
from tests.tiers import examples

from sonolube.errors import InvalidInput
from sonolube.measurement.statistics.repeated_tests import compare_means, mean_estimate, ratio_interval

tests = st.lists(st.floats(-100, 100).map(lambda x: round(x, 3)), min_size=2, max_size=4)


def test_a_mean_of_three_tests_has_students_interval() -> None:
    estimate = mean_estimate([1.0, 1.2, 0.8])
    assert (estimate.mean, estimate.deviation) == approx((1.0, 0.2))
    # t of 2 degrees of freedom at 97.5 % is 4.30265
    assert (estimate.lower, estimate.upper) == approx((1 - 4.30265 * 0.2 / 3**0.5, 1 + 4.30265 * 0.2 / 3**0.5))


@given(tests, tests)
@examples(150)
def test_welchs_test_agrees_with_scipy(first: list[float], second: list[float]) -> None:
    assume(np.ptp(first) > 0.01 and np.ptp(second) > 0.01)
    found, known = compare_means(first, second), stats.ttest_ind(second, first, equal_var=False)
    assert found.t_statistic == approx(known.statistic, rel=1e-9, abs=1e-12)
    assert found.welch_p == approx(known.pvalue, rel=1e-9)
    interval = known.confidence_interval(0.95)
    assert (found.lower, found.upper) == approx((interval.low, interval.high), rel=1e-8, abs=1e-9)


@given(tests, tests)
@examples(40)
def test_the_permutation_test_agrees_with_enumeration_of_all_orders(first: list[float], second: list[float]) -> None:
    assume(len(first) + len(second) <= 7)
    observed = abs(np.mean(second) - np.mean(first))
    n = len(first)
    extreme = [abs(np.mean(p[n:]) - np.mean(p[:n])) >= observed - 1e-7 for p in permutations(first + second)]
    assert compare_means(first, second).permutation_p == approx(np.mean(extreme))


@pytest.mark.parametrize(("n", "smallest"), [(2, 1 / 3), (3, 1 / 10), (4, 1 / 35)])
def test_few_tests_cannot_fall_below_the_smallest_permutation_p_value(n: int, smallest: float) -> None:
    found = compare_means(np.arange(n), 1000 + np.arange(n))
    assert found.smallest_permutation_p == approx(smallest)
    assert found.permutation_p == approx(smallest)


def test_two_against_three_tests_have_a_smallest_p_value_of_a_tenth() -> None:
    assert compare_means([0, 1], [100, 101, 103]).permutation_p == approx(0.1)
    assert compare_means([0, 1], [100, 101, 103]).smallest_permutation_p == approx(0.1)


def test_tests_without_scatter_have_p_values_of_zero_or_one() -> None:
    assert compare_means([1, 1], [2, 2]).welch_p == 0
    assert compare_means([1, 1], [1, 1]).welch_p == 1


def test_the_limits_of_fiellers_interval_satisfy_its_definition() -> None:
    x, y = np.array([0.35, 0.41, 0.38]), np.array([1.02, 0.95, 1.08, 1.0])
    found = ratio_interval(x, y)
    v_x, v_y = x.var(ddof=1) / 3, y.var(ddof=1) / 4
    freedom = (v_x + found.ratio**2 * v_y) ** 2 / (v_x**2 / 2 + (found.ratio**2 * v_y) ** 2 / 3)
    for end in (found.lower, found.upper):
        t = abs(x.mean() - end * y.mean()) / np.sqrt(v_x + end**2 * v_y)
        assert t == approx(stats.t.ppf(0.975, freedom))


def test_fiellers_interval_has_its_nominal_coverage() -> None:
    rng = np.random.default_rng(5)
    hits = [
        (found := ratio_interval(rng.normal(0.4, 0.05, 4), rng.normal(1.0, 0.08, 4))).lower <= 0.4 <= found.upper
        for _ in range(2000)
    ]
    assert np.mean(hits) == approx(0.95, abs=0.02)


def test_a_denominator_not_significantly_different_from_zero_leaves_the_interval_unbounded() -> None:
    found = ratio_interval([1.0, 1.1], [0.1, -0.05])
    assert not found.bounded
    assert "may be zero" in found.reason


def test_a_single_test_is_refused() -> None:
    with raises(InvalidInput, match="tests must be at least two tests, got 1"):
        mean_estimate([1.0])


def test_a_mean_states_its_error_number_and_level() -> None:
    estimate = mean_estimate([2.0, 4.0, 9.0], confidence_level=0.9)
    # variance (9 + 1 + 16)/2 = 13
    assert estimate.mean == approx(5.0)
    assert estimate.deviation == approx(13**0.5)
    assert estimate.uncertainty == approx((13 / 3) ** 0.5)
    assert estimate.upper - 5 == approx(stats.t.ppf(0.95, 2) * (13 / 3) ** 0.5)
    assert 5 - estimate.lower == approx(estimate.upper - 5)
    assert (estimate.tests, estimate.confidence_level) == (3, 0.9)
    for level in (0.49, 0.99995):
        with raises(InvalidInput, match="confidence_level"):
            mean_estimate([1.0, 2.0], confidence_level=level)


def test_a_difference_is_the_second_less_the_first_with_satterthwaites_degrees_of_freedom() -> None:
    found = compare_means([1.0, 3.0], [4.0, 10.0, 7.0], confidence_level=0.8)
    # variances of the means 2/2 = 1 and 9/3 = 3: error 2; (1 + 3)^2/(1/1 + 9/2) = 16/5.5
    assert found.difference == approx(5.0)
    assert found.t_statistic == approx(2.5)
    assert found.degrees_of_freedom == approx(16 / 5.5)
    half = 2 * stats.t.ppf(0.9, 16 / 5.5)
    assert (found.lower, found.upper) == approx((5 - half, 5 + half))
    assert found.confidence_level == 0.8
    assert compare_means([3.0, 3.0], [2.0, 2.0]).t_statistic == -np.inf
    equal = compare_means([2.0, 2.0, 2.0], [2.0, 2.0])
    assert (equal.t_statistic, equal.degrees_of_freedom) == (0.0, 3.0)
    with raises(InvalidInput, match="permutations of 24 tests are too many"):
        compare_means(np.arange(12), np.arange(12))


def test_fiellers_interval_is_the_solution_of_its_quadratic() -> None:
    found = ratio_interval([1.0, 3.0], [9.0, 11.0, 13.0], confidence_level=0.8)
    # means 2 and 11; variances of them 1 and 4/3; ratio 2/11
    rho, v_x, v_y = 2 / 11, 1.0, 4 / 3
    freedom = (v_x + rho**2 * v_y) ** 2 / (v_x**2 / 1 + (rho**2 * v_y) ** 2 / 2)
    t = stats.t.ppf(0.9, freedom)
    roots = np.sort(np.roots([11**2 - t**2 * v_y, -2 * 2 * 11, 2**2 - t**2 * v_x]))
    assert found.ratio == approx(rho)
    assert (found.lower, found.upper) == approx(tuple(roots))
    assert (found.bounded, found.reason, found.confidence_level) == (True, "", 0.8)
    unbounded = ratio_interval([1.0, 1.1], [0.1, -0.05])
    assert (unbounded.lower, unbounded.upper) == (-np.inf, np.inf)
    assert "0.025 with standard error 0.075" in unbounded.reason
    with raises(InvalidInput, match="denominator must not have a mean of zero"):
        ratio_interval([1.0, 2.0], [-1.0, 1.0])
