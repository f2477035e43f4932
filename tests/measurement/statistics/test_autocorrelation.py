"""Standard errors of correlated samples against Monte Carlo and the closed form of an autoregressive process."""

import numpy as np
import pytest
from pytest import approx
from scipy.signal import lfilter

from sonolube.measurement.statistics.autocorrelation import correlated_mean, statistical_inefficiency

RNG = np.random.default_rng(7)


def autoregressive(phi: float, shape: tuple[int, ...], rng: np.random.Generator = RNG) -> np.ndarray:
    start = rng.normal(size=(*shape[:-1], 1)) / np.sqrt(1 - phi**2)
    noise = rng.normal(size=shape)
    return np.asarray(lfilter([1], [1, -phi], noise, zi=phi * start)[0])


@pytest.mark.parametrize("phi", [0.0, 0.5, 0.9])
def test_the_standard_error_is_the_standard_deviation_of_repeated_means(phi: float) -> None:
    tests = autoregressive(phi, (400, 5000))
    claimed = np.array([correlated_mean(test).uncertainty for test in tests])
    assert np.mean(claimed) == approx(np.std(tests.mean(axis=1), ddof=1), rel=0.12)  # 400 means: 3.5 % each


def test_the_statistical_inefficiency_of_an_autoregressive_process_has_its_closed_form() -> None:
    x = autoregressive(0.8, (400_000,))
    assert statistical_inefficiency(x) == approx(1.8 / 0.2, rel=0.05)


def test_the_mean_of_a_constant_has_no_uncertainty() -> None:
    estimate = correlated_mean(np.full(1000, 0.89))
    assert (estimate.mean, estimate.uncertainty) == approx((0.89, 0.0), abs=1e-15)
