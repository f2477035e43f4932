"""Least squares over logarithms against closed forms: criterion, intervals, poles and distinct modes."""

import numpy as np
from pytest import approx
from scipy import stats

from sonolube.measurement.statistics.autocorrelation import statistical_inefficiency
from sonolube.measurement.statistics.log_parameter_fit import (
    ConfidenceInterval,
    LogParameterFit,
    confidence_intervals,
    distinct_modes,
    fit_log_parameters,
    rational_poles,
    residual_inefficiency,
    spanning_intervals,
)


def fit(covariance: np.ndarray, residuals: np.ndarray) -> LogParameterFit:
    return LogParameterFit(logarithms=np.log([2.0, 5.0]), covariance=covariance, residuals=residuals, converged=True)


def test_the_criterion_is_that_of_bayes_with_residuals_no_smaller_than_rounding() -> None:
    residuals = np.array([1.0, -2.0, 0.5, 1.5])  # sum of squares 7.5
    found = fit(np.eye(2), residuals)
    assert found.sum_of_squares == approx(7.5)
    assert found.information_criterion == approx(4 * np.log(7.5 / 4) + 2 * np.log(4))
    exact = fit(np.eye(2), np.zeros(4))
    assert exact.information_criterion == approx(4 * np.log(1e-20) + 2 * np.log(4))


def test_intervals_are_first_order_in_the_logarithms_with_students_t() -> None:
    covariance = np.array([[0.04, 0.01], [0.01, 0.09]])
    found = confidence_intervals(
        fit(covariance, np.ones(40)),
        lambda p: {"product": float(np.exp(p[0] + 2 * p[1])), "first": float(np.exp(p[0]))},
        correlation=4.0,
        confidence_level=0.9,
    )
    t = stats.t.ppf(0.95, 40 / 4 - 2)
    # slopes 1 and 2: 0.04 + 4 * 0.01 + 4 * 0.09 = 0.44, times 4
    factor = np.exp(t * np.sqrt(0.44 * 4))
    assert found["product"].value == approx(50.0)
    assert found["product"].lower == approx(50 / factor, rel=1e-6)
    assert found["product"].upper == approx(50 * factor, rel=1e-6)
    assert found["first"].upper == approx(2 * np.exp(t * 0.4), rel=1e-6)


def test_few_residuals_have_one_degree_of_freedom_and_undetermined_parameters_no_bound() -> None:
    few = confidence_intervals(
        fit(0.01 * np.eye(2), np.ones(2)), lambda p: {"a": float(np.exp(p[0]))}, correlation=1.0, confidence_level=0.5
    )
    assert few["a"].upper == approx(2 * np.exp(0.1), rel=1e-6)  # t of one degree at 75 % is 1
    undetermined = confidence_intervals(
        fit(np.full((2, 2), np.inf), np.ones(9)),
        lambda p: {"a": float(np.exp(p[0]))},
        correlation=1.0,
        confidence_level=0.9,
    )
    found = undetermined["a"]
    assert (found.value, found.lower, found.upper) == approx((2.0, 0.0, np.inf))


def test_intervals_of_several_fits_are_spanned() -> None:
    chosen = {
        "a": ConfidenceInterval(value=2.0, lower=1.0, upper=3.0),
        "b": ConfidenceInterval(value=5, lower=4, upper=6),
    }
    other = {
        "a": ConfidenceInterval(value=9.0, lower=0.5, upper=2.5),
        "b": ConfidenceInterval(value=1, lower=5, upper=7),
    }
    found = spanning_intervals(chosen, [other])
    assert found["a"] == ConfidenceInterval(value=2.0, lower=0.5, upper=3.0)
    assert found["b"] == ConfidenceInterval(value=5, lower=4, upper=7)


def test_of_candidates_near_each_other_the_best_is_kept() -> None:
    quality = np.log(10.0)
    ranked = [
        (3.0, np.array([1.06, quality])),  # beyond half of a width of a tenth
        (2.0, np.array([1.04, quality])),  # within it
        (1.0, np.array([1.0, quality])),
        (4.0, np.array([0.94, quality])),
    ]
    assert [float(one[0]) for one in distinct_modes(ranked, widths=0.5)] == [1.0, 1.06, 0.94]
    assert [float(one[0]) for one in distinct_modes(ranked, widths=0.3)] == [1.0, 1.04, 0.94]


def test_the_poles_of_a_rational_function_are_found_in_its_values() -> None:
    x = np.linspace(-1, 1, 81)
    poles = rational_poles(x, 1 / (x - (0.3 + 0.05j)) + 2 / (x + 0.5 - 0.1j), scale=10.0)
    for known in (3 + 0.5j, -5 + 1j):
        assert min(abs(pole - known) for pole in poles) < 1e-6


def test_the_inefficiency_is_the_largest_of_all_series() -> None:
    rng = np.random.default_rng(1)
    white, slow = rng.standard_normal(400), np.cumsum(rng.standard_normal(400))
    both = residual_inefficiency(fit(np.eye(2), np.concatenate([white, slow])), rows=2)
    assert both == approx(statistical_inefficiency(slow))
    assert residual_inefficiency(fit(np.eye(2), np.full(400, 3e-11)), rows=2) == 1.0


def test_a_straight_line_in_logarithms_has_the_estimate_and_covariance_of_linear_least_squares() -> None:
    x = np.linspace(0, 1, 30)
    noise = 0.1 * np.random.default_rng(2).standard_normal(30)
    y = 1.5 - 2.0 * x + noise
    design = np.column_stack([np.ones(30), x])
    found = fit_log_parameters(lambda p: design @ p - y, np.array([0.3, 0.1]))
    solution = np.linalg.lstsq(design, y)[0]
    left = y - design @ solution
    assert found.converged
    assert found.logarithms == approx(solution, abs=1e-6)
    assert found.residuals == approx(-left, abs=1e-6)
    expected = float(left @ left) / 28 * np.linalg.inv(design.T @ design)
    assert found.covariance == approx(expected, rel=1e-3, abs=1e-6)


def test_a_parameter_without_effect_is_not_determined_and_a_bare_nan_no_obstacle() -> None:
    x = np.linspace(1, 2, 20)
    found = fit_log_parameters(lambda p: np.exp(p[0]) * x - 3 * x + 0 * p[1], np.array([0.2, 0.5]))
    assert np.exp(found.logarithms[0]) == approx(3.0)
    assert not np.isfinite(found.covariance).all() or found.covariance[1, 1] > 1e6
    nothing = fit_log_parameters(lambda p: np.where(x > 1.5, np.nan, p[0] - 1.0), np.array([0.2]))
    assert nothing.residuals.max() == approx(1e6)
