"""Densities by which own runs are held against a prediction: beside those of scipy's distributions."""

import numpy as np
from pytest import approx
from scipy.stats import multivariate_normal, norm

from sonolube.prediction.predictive import _log_density_of_anything_else, _mixture_log_density


def test_the_density_of_a_mixture_is_the_mean_of_those_of_its_parts() -> None:
    rng = np.random.default_rng(3)
    means, outcomes = rng.uniform(0.2, 0.9, (4, 2)), rng.uniform(0.0, 1.0, (5, 2))
    factors = np.array([np.linalg.cholesky(np.diag(rng.uniform(0.01, 0.1, 2)) + 0.002) for _ in range(4)])
    pairs = zip(means, factors, strict=True)
    parts = [multivariate_normal(mean, factor @ factor.T).pdf(outcomes) for mean, factor in pairs]
    assert np.exp(_mixture_log_density(outcomes, means, factors)) == approx(np.mean(parts, axis=0))


def test_anything_else_is_no_effect_one_ratio_or_any_ratio_each_a_third() -> None:
    outcomes, noise = np.array([[0.5, 0.55], [1.0, 0.98]]), np.array([0.03, 0.05])
    none = norm(1.0, noise).pdf(outcomes).prod(axis=1)
    ratios = np.linspace(0.0, 1.4, 20001)
    one = [np.mean(norm(ratios[:, None], noise).pdf(outcome).prod(axis=1)) for outcome in outcomes]
    found = np.exp(_log_density_of_anything_else(outcomes, noise))
    assert found == approx((none + one + 1.4**-2) / 3, rel=0.01)
