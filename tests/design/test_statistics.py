"""Mean, standard deviation and quantiles against closed forms, and the coverage of their intervals."""

import numpy as np
from pytest import approx, raises
from scipy import stats
from scipy.special import ndtri

from sonolube.design import sample_statistics, sobol_sample
from sonolube.errors import InvalidInput

# a linear model with normal inputs is normal: 10 + 3 x + 4 y has mean 10 and deviation 5
EXACT = stats.norm(10, 5)


def linear(seed: int, samples: int = 1024) -> tuple[np.ndarray, np.ndarray]:
    points, subsequence = sobol_sample(2, samples=samples, seed=seed)
    return 10 + ndtri(points) @ np.array([3.0, 4.0]), subsequence


def test_a_linear_model_of_normal_inputs_has_normal_statistics() -> None:
    values, subsequence = linear(0, 16384)
    statistics = sample_statistics(values, subsequence=subsequence)
    assert statistics.mean.value == approx(10, abs=1e-3)
    assert statistics.standard_deviation.value == approx(5, rel=1e-3)
    for probability, each in statistics.quantiles.items():
        assert each.value == approx(EXACT.ppf(probability), abs=0.05)
    assert statistics.has_converged


def test_the_coverage_of_the_intervals_is_at_least_nominal() -> None:
    covered = []
    for seed in range(40):
        values, subsequence = linear(seed)
        statistics = sample_statistics(values, subsequence=subsequence)
        exact = {probability: EXACT.ppf(probability) for probability in statistics.quantiles}
        covered += [
            each.lower <= exact[probability] <= each.upper for probability, each in statistics.quantiles.items()
        ]
        covered += [statistics.mean.lower <= 10 <= statistics.mean.upper]
    assert np.mean(covered) >= 0.95


def test_few_samples_have_not_converged() -> None:
    values, subsequence = linear(0, 32)
    assert not sample_statistics(values, subsequence=subsequence).has_converged


def test_samples_without_a_result_are_left_out() -> None:
    values, subsequence = linear(0)
    values[::4] = np.nan
    statistics = sample_statistics(values, subsequence=subsequence)
    assert (statistics.samples, statistics.valid_samples) == (1024, 768)
    assert statistics.mean.value == approx(10, abs=0.3)


def test_a_constant_outcome_has_no_deviation_and_no_error() -> None:
    statistics = sample_statistics(np.full(64, 0.35), subsequence=np.repeat(np.arange(16), 4))
    assert statistics.standard_deviation.value == approx(0)
    assert statistics.relative_error == 0


def test_samples_without_any_result_are_refused() -> None:
    with raises(InvalidInput, match=r"too few samples have a result"):
        sample_statistics(np.full(64, np.nan), subsequence=np.repeat(np.arange(16), 4))
