"""Means, deviations and quantiles of samples against closed forms, and intervals that hold them."""

import numpy as np
from pytest import approx, raises
from scipy import stats
from scipy.special import ndtri

from sonolube.design import sample_statistics, sobol_sample
from sonolube.errors import InvalidInput

# a linear model with normal inputs is normal: 10 + 3 x + 4 y has mean 10 and deviation 5
EXACT = stats.norm(10, 5)


def linear(seed: int, samples: int = 1024) -> tuple[np.ndarray, np.ndarray]:
    shares, subsequence = sobol_sample(2, samples=samples, seed=seed)
    return 10 + ndtri(shares) @ np.array([3.0, 4.0]), subsequence


def test_a_linear_model_of_normal_inputs_is_normal() -> None:
    values, subsequence = linear(0, 16384)
    found = sample_statistics(values, subsequence=subsequence)
    assert found.mean.value == approx(10, abs=1e-3)
    assert found.standard_deviation.value == approx(5, rel=1e-3)
    for share, each in found.quantiles.items():
        assert each.value == approx(EXACT.ppf(share), abs=0.05)
    assert found.has_converged


def test_intervals_hold_the_exact_numbers_at_least_as_often_as_they_say() -> None:
    held = []
    for seed in range(40):
        values, subsequence = linear(seed)
        found = sample_statistics(values, subsequence=subsequence)
        exact = {share: EXACT.ppf(share) for share in found.quantiles}
        held += [each.lower <= exact[share] <= each.upper for share, each in found.quantiles.items()]
        held += [found.mean.lower <= 10 <= found.mean.upper]
    assert np.mean(held) >= 0.95


def test_few_samples_are_said_to_be_too_few() -> None:
    values, subsequence = linear(0, 32)
    assert not sample_statistics(values, subsequence=subsequence).has_converged


def test_only_what_has_a_result_counts() -> None:
    values, subsequence = linear(0)
    values[::4] = np.nan
    found = sample_statistics(values, subsequence=subsequence)
    assert (found.samples, found.valid_samples) == (1024, 768)
    assert found.mean.value == approx(10, abs=0.3)


def test_a_certain_outcome_is_certain() -> None:
    found = sample_statistics(np.full(64, 0.35), subsequence=np.repeat(np.arange(16), 4))
    assert found.standard_deviation.value == approx(0)
    assert found.relative_error == 0


def test_nothing_cannot_be_summed_up() -> None:
    with raises(InvalidInput, match=r"hardly any sample has a result"):
        sample_statistics(np.full(64, np.nan), subsequence=np.repeat(np.arange(16), 4))
