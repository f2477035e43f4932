"""Regression in white and red noise against closed forms and repeated draws."""

import numpy as np
from pytest import approx, raises
from scipy.signal import lfilter

from sonolube.errors import InvalidInput
from sonolube.measurement.statistics.autocorrelation import correlated_regression


def red(rng: np.random.Generator, samples: int, phi: float) -> np.ndarray:
    """First-order autoregression of unit variance."""
    drive = np.sqrt(1 - phi**2) * rng.standard_normal(samples)
    return np.asarray(lfilter([1.0], [1.0, -phi], drive, zi=[phi * rng.standard_normal()])[0])


def test_in_white_noise_the_fit_is_that_of_ordinary_least_squares() -> None:
    rng = np.random.default_rng(1)
    x = np.column_stack([np.ones(2000), np.linspace(-1, 1, 2000)])
    y = x @ [2.0, 0.5] + 0.1 * rng.standard_normal(2000)
    fit = correlated_regression([y], [x])
    assert fit.coefficients == approx(np.linalg.lstsq(x, y)[0], abs=2e-3)
    assert np.sqrt(np.diag(fit.covariance)) == approx(0.1 / np.sqrt([2000, 2000 / 3]), rel=0.15)


def test_the_mean_of_an_autoregression_has_its_closed_standard_error() -> None:
    # variance of the mean of an AR(1) process of unit variance: (1 + phi)/(1 - phi)/n
    fit = correlated_regression([red(np.random.default_rng(2), 20_000, 0.9)], [np.ones((20_000, 1))])
    assert fit.covariance[0, 0] ** 0.5 == approx((1.9 / 0.1 / 20_000) ** 0.5, rel=0.1)
    assert fit.autoregression == approx(0.9, abs=0.02)


def test_errors_of_means_in_white_and_red_noise_are_as_large_as_stated() -> None:
    rng, scores = np.random.default_rng(3), []
    for _ in range(40):
        parts = [red(rng, 300, 0.9) + 0.7 * rng.standard_normal(300) for _ in range(4)]
        designs = [np.tile(np.arange(4) == j, (300, 1)).astype(float) for j in range(4)]
        fit = correlated_regression(parts, designs)
        scores.append(fit.coefficients / np.sqrt(np.diag(fit.covariance)))
    assert np.sqrt(np.mean(np.square(scores))) == approx(1.0, abs=0.2)


def test_dependent_columns_are_refused() -> None:
    with raises(InvalidInput, match="linearly dependent"):
        correlated_regression([np.arange(50.0)], [np.ones((50, 2))])
