"""Functions of probabilities, against scipy."""

import numpy as np
from pytest import approx
from scipy.special import logsumexp, ndtri

from sonolube.prediction.probabilities import log_sum_exp, normal_quantiles


def test_normal_quantiles_are_those_of_scipy_far_into_both_tails() -> None:
    tails = np.geomspace(1e-300, 0.4, 500)
    p = np.concatenate([tails, np.linspace(0.05, 0.95, 181), 1 - tails[tails > 1e-15]])
    assert normal_quantiles(p) == approx(ndtri(p), rel=1e-13, abs=1e-15)


def test_sums_of_exponentials_neither_overflow_nor_vanish() -> None:
    logarithms = np.random.default_rng(0).normal(0.0, 2000.0, (40, 7))
    logarithms[3] = -np.inf
    assert log_sum_exp(logarithms) == approx(logsumexp(logarithms, axis=1), rel=1e-14)
