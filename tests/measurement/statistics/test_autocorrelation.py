"""Standard errors of correlated samples against Monte Carlo and the closed form of an autoregressive process."""

import numpy as np
import pytest
from pytest import approx, raises
from scipy.signal import lfilter

from sonolube.errors import InvalidInput
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


def test_the_sum_of_the_autocorrelation_ends_at_sokals_window() -> None:
    values = np.array([3.0, 2.5, 2.0, 1.0, 0.5, 0.0, -0.5, -1.0, -2.0, -2.0, -1.0, 1.0, 2.0, 2.5, 0.5, -1.5, -2.0, 0.0])
    x = values - values.mean()
    rho = np.array([x[k:] @ x[: x.size - k] for k in range(x.size)]) / (x @ x)
    cumulative = 2 * np.cumsum(rho) - 1
    first = next(lag for lag in range(x.size) if lag >= 2.5 * cumulative[lag])
    assert cumulative[first] > 1
    assert statistical_inefficiency(values) == approx(cumulative[first])
    assert statistical_inefficiency(np.tile([1.0, -1.0], 20)) == 1.0  # negative correlation counts as none
    assert statistical_inefficiency(np.full(9, 7.0)) == 1.0


def test_a_mean_leaves_out_missing_values_and_counts_independent_ones() -> None:
    values = np.array([1.0, np.nan, 5.0, 2.0, 8.0, 3.0, np.inf, 4.0, 6.0])
    known = np.array([1.0, 5, 2, 8, 3, 4, 6])
    estimate = correlated_mean(values)
    assert estimate.samples == 7
    assert estimate.mean == approx(known.mean())
    assert estimate.deviation == approx(known.std(ddof=1))
    assert estimate.effective_samples == approx(7 / statistical_inefficiency(known))
    assert estimate.uncertainty == approx(known.std(ddof=1) / np.sqrt(estimate.effective_samples))
    with raises(InvalidInput, match="needs at least two samples, got 1"):
        correlated_mean([1.0, np.nan])
    assert correlated_mean([1.0, 3.0]).mean == 2.0
