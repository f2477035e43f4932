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
