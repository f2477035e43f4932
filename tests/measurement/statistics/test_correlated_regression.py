"""Regression in white and red noise against closed forms and repeated draws."""

import numpy as np
from pytest import approx, raises
from scipy.signal import lfilter
from scipy.special import logit

from sonolube.errors import InvalidInput
from sonolube.measurement.statistics.autocorrelation import (
    _noise,
    _restricted_likelihood,
    correlated_regression,
    whitened,
)


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


def arma_covariance(samples: int, phi: float, theta: float) -> np.ndarray:
    """Covariance of an ARMA(1,1) process of innovations of unit variance by its moving-average form."""
    weights = np.concatenate([[1.0], (phi - theta) * phi ** np.arange(2000)])
    lags = [float(weights[lag:] @ weights[: weights.size - lag]) for lag in range(samples)]
    return np.array([[lags[abs(i - j)] for j in range(samples)] for i in range(samples)])


def test_whitening_and_restricted_likelihood_are_those_of_the_covariance_matrix() -> None:
    rng = np.random.default_rng(4)
    designs = [np.column_stack([np.ones(n), rng.standard_normal(n)]) for n in (7, 12)]
    values = [rng.standard_normal(n) for n in (7, 12)]
    stacked = [np.column_stack([y, x]) for y, x in zip(values, designs, strict=True)]
    likelihoods, expected = [], []
    theta = 1e-9  # an autoregression, whose first sample whitens exactly
    for phi in (0.3, 0.6, 0.95):
        inverse = np.zeros((19, 19))
        blocks = [arma_covariance(n, phi, theta) for n in (7, 12)]
        inverse[:7, :7], inverse[7:, 7:] = (np.linalg.inv(block) for block in blocks)
        x, y = np.concatenate(designs), np.concatenate(values)
        information = x.T @ inverse @ x
        residual = y - x @ np.linalg.solve(information, x.T @ inverse @ y)
        logs = sum(np.linalg.slogdet(block)[1] for block in blocks) + np.linalg.slogdet(information)[1]
        expected.append(17 * np.log(residual @ inverse @ residual) + logs)
        parameters = np.array([logit(phi / 0.9995), logit(theta / phi)])
        assert _noise(parameters) == approx((phi, theta))
        likelihoods.append(_restricted_likelihood(stacked, parameters))
        white = np.concatenate([whitened(part, phi, theta) for part in stacked])
        assert white[:, 1:].T @ white[:, 1:] == approx(information)
    assert np.array(likelihoods) - expected == approx(likelihoods[0] - expected[0])  # a constant of the data


def test_white_and_red_noise_iswhitened_by_its_recursion_from_the_expected_first_innovation() -> None:
    phi, theta = 0.8, 0.5
    variance = float(arma_covariance(1, phi, theta)[0, 0])
    x = np.array([2.0, -1.0, 0.5, 3.0])
    white = [x[0] / np.sqrt(variance), x[1] - phi * x[0] + theta * x[0] / variance]
    for at in (2, 3):
        white.append(x[at] - phi * x[at - 1] + theta * white[-1])
    assert whitened(x[:, np.newaxis], phi, theta)[:, 0] == approx(white)


def test_a_fit_of_fewer_values_than_columns_is_refused_and_parts_stay_apart() -> None:
    with raises(InvalidInput, match="2 values are too few for 2 coefficients"):
        correlated_regression([np.arange(2.0)], [np.eye(2)])
    rng = np.random.default_rng(5)
    parts = [rng.standard_normal(60), rng.standard_normal(40)]
    fit = correlated_regression(parts, [np.ones((60, 1)), np.ones((40, 1))])
    assert [each.size for each in fit.innovations] == [60, 40]
    assert 0 <= fit.moving_average <= fit.autoregression < 1
    whole = np.concatenate(fit.innovations)
    assert float(whole @ whole) / 99 == approx(1.0, rel=0.3)
