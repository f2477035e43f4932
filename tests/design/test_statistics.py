"""Mean, standard deviation and quantiles against closed forms, and the coverage of their intervals."""

from dataclasses import replace
from types import MappingProxyType

import numpy as np
from pytest import approx, raises
from scipy import stats
from scipy.special import ndtri

from sonolube.design import sample_statistics, sobol_sample
from sonolube.design.statistics import IntervalEstimate, SampleStatistics
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


def test_the_interval_of_two_sections_is_that_of_student_by_hand() -> None:
    # means 2 and 7, deviation 5/sqrt(2) between them; t_1(0.975) = 12.7062; half-width 12.7062 * 3.5355/sqrt(2)
    statistics = sample_statistics([1.0, 3.0, 5.0, 9.0, np.nan], subsequence=np.array([0, 0, 1, 1, 1]))
    assert (statistics.samples, statistics.valid_samples) == (5, 4)
    assert statistics.mean.value == approx(4.5)
    assert (statistics.mean.lower, statistics.mean.upper) == approx((4.5 - 31.7655, 4.5 + 31.7655), rel=1e-5)
    # deviations of 1, 3, 5, 9 about 4.5: 12.25 + 2.25 + 0.25 + 20.25 = 35; of the sections sqrt(2) and sqrt(8)
    assert statistics.standard_deviation.value == approx(np.sqrt(35 / 3))
    half = 12.7062 * (np.sqrt(8) - np.sqrt(2)) / 2
    assert statistics.standard_deviation.upper - statistics.standard_deviation.value == approx(half, rel=1e-5)
    assert statistics.quantiles[0.5].value == approx(4.0)
    assert statistics.quantiles[0.25].value == approx(2.5)  # a quarter of the way along three gaps: 1 + 0.75 * 2
    assert set(statistics.quantiles) == {0.05, 0.25, 0.5, 0.75, 0.95}


def test_a_section_of_one_result_is_left_out_and_one_section_is_refused() -> None:
    statistics = sample_statistics([1.0, 3.0, 5.0, 9.0, 99.0], subsequence=np.array([0, 0, 1, 1, 2]))
    assert statistics.valid_samples == 4
    assert statistics.mean.value == approx(4.5)
    with raises(InvalidInput, match="too few samples have a result"):
        sample_statistics([1.0, 3.0, 5.0], subsequence=np.array([0, 0, 1]))


def estimated(value: float, half: float) -> IntervalEstimate:
    return IntervalEstimate(value=value, lower=value - half, upper=value + half)


def test_the_relative_error_is_the_widest_half_interval_over_the_range_of_ninety_percent() -> None:
    quantiles = {
        0.05: estimated(2.0, 0.3),
        0.25: estimated(3.0, 9.0),
        0.5: estimated(5.0, 0.1),
        0.75: estimated(6.0, 9.0),
    }
    known = SampleStatistics(
        samples=8,
        valid_samples=8,
        mean=estimated(5.0, 0.2),
        standard_deviation=estimated(1.0, 9.0),
        quantiles=MappingProxyType(quantiles | {0.95: estimated(12.0, 0.4)}),
    )
    assert known.relative_error == approx(0.4 / 10)
    assert known.has_converged
    wide = replace(known, mean=estimated(5.0, 0.6))
    assert wide.relative_error == approx(0.06)
    assert not wide.has_converged


def test_sobol_points_are_a_power_of_two_in_sixteen_parts_strictly_inside_the_cube() -> None:
    points, subsequence = sobol_sample(3, samples=33, seed=1)
    assert points.shape == (64, 3)
    assert np.all((points > 0) & (points < 1))
    assert np.bincount(subsequence).tolist() == [4] * 16
    assert subsequence.tolist() == sorted(subsequence.tolist())
    # a digital net: each sixty-fourth of every axis holds one point
    assert all(sorted(np.floor(64 * column).astype(int)) == list(range(64)) for column in points.T)
    assert sobol_sample(1, samples=32)[0].shape == (32, 1)
    for given, message in (((0, 32), "inputs must be at least 1, got 0"), ((1, 31), "samples must be at least 32")):
        with raises(InvalidInput, match=message):
            sobol_sample(given[0], samples=given[1])
