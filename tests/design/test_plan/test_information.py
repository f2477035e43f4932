"""Expected information: a closed form, quadrature, bounds, and the best of all batches on small rigs."""

from collections.abc import Sequence
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.stats import multivariate_normal
from tests.same import same
from tests.tiers import examples

from sonolube.checks import Floats
from sonolube.design.test_plan.information import ModelOutcomes, _Mixture, _terms, best_batch, mutual_information

DRAWS = 512


def gaussian(mean: Sequence[float], weight: float, *, draws: int = DRAWS) -> ModelOutcomes:
    """Model that is sure of its outcomes."""
    count = len(mean)
    return ModelOutcomes(
        name="sure",
        weight=weight,
        means=np.tile(np.asarray(mean, float), (draws, 1)),
        deviations=np.zeros((draws, count)),
        squared_distances=np.zeros((count, count)),
        lengths=np.ones(draws),
    )


def uncertain(
    seed: int, weight: float, speeds: Floats, *, length: float, spread: float, discrepancy: float
) -> ModelOutcomes:
    """Model whose outcome falls over the speeds, by draws of its length."""
    rng = np.random.default_rng(seed)
    lengths = length * np.exp(spread * rng.standard_normal(256))
    means = speeds / (speeds + lengths[:, None])
    return ModelOutcomes(
        name=f"{seed}",
        weight=weight,
        means=means**2 if seed % 2 else means,
        deviations=np.full(means.shape, discrepancy),
        squared_distances=np.log(speeds[:, None] / speeds) ** 2,
        lengths=np.full(256, 0.7),
    )


def two_gaussians(distance: float, weight: float) -> float:
    """Information in bits about which of two normal distributions of equal spread, by quadrature over the outcome."""
    outcome = np.linspace(-12, 12 + distance, 200_001)
    first, second = (np.exp(-0.5 * (outcome - mean) ** 2) / np.sqrt(2 * np.pi) for mean in (0.0, distance))
    both = weight * first + (1 - weight) * second
    with np.errstate(divide="ignore", invalid="ignore"):
        terms = [
            share * np.nan_to_num(density * np.log2(density / both))
            for share, density in ((weight, first), (1 - weight, second))
        ]
    return float(np.trapezoid(sum(terms), outcome))


@pytest.mark.parametrize("weight", [0.5, 0.8])
@pytest.mark.parametrize("distance", [0.5, 1.0, 2.0, 4.0])
def test_two_gaussian_closures_of_equal_spread_have_the_information_of_the_closed_form(
    distance: float, weight: float
) -> None:
    models = [gaussian([0.3], weight), gaussian([0.3 + 0.05 * distance], 1 - weight)]
    found = mutual_information(models, np.array([0]), noise=np.array([0.05]))
    assert found == pytest.approx(two_gaussians(distance, weight), abs=0.004)


def test_a_batch_of_two_gaussian_closures_depends_on_the_distance_in_units_of_the_noise() -> None:
    models = [gaussian(each, 0.5, draws=4096) for each in ([0.3, 0.6, 0.5], [0.35, 0.54, 0.6])]
    noise = np.array([0.05, 0.04, 0.2])
    distance = np.sqrt(1.0 + 1.5**2 + 0.5**2)
    found = mutual_information(models, np.arange(3), noise=noise)
    assert found == pytest.approx(two_gaussians(distance, 0.5), abs=0.01)


def test_information_of_one_test_is_that_by_quadrature_over_the_outcome() -> None:
    speeds = np.array([1.0])
    models = [uncertain(each, 0.5, speeds, length=1.0, spread=0.3, discrepancy=0.05) for each in (1, 2)]
    outcome = np.linspace(-1, 2, 20_001)
    spread = np.hypot(0.05, 0.03)
    densities = [
        np.mean(np.exp(-0.5 * ((outcome - model.means) / spread) ** 2), axis=0) / spread / np.sqrt(2 * np.pi)
        for model in models
    ]
    both = sum(densities) / 2
    with np.errstate(divide="ignore", invalid="ignore"):
        exact = sum(np.trapezoid(np.nan_to_num(each * np.log2(each / both)), outcome) / 2 for each in densities)
    seeds = [mutual_information(models, np.array([0]), noise=np.array([0.03]), seed=seed) for seed in range(4)]
    assert np.mean(seeds) == pytest.approx(float(exact), rel=0.05)


def test_equal_closures_cannot_be_told_apart() -> None:
    models = [gaussian([0.3, 0.4], 0.5), gaussian([0.3, 0.4], 0.5)]
    assert mutual_information(models, np.arange(2), noise=np.full(2, 0.05)) == pytest.approx(0.0, abs=1e-3)


@given(weight=st.floats(0.05, 0.95), distance=st.floats(0.0, 40.0))
@examples(20)
def test_information_lies_between_zero_and_the_entropy_of_the_weights(weight: float, distance: float) -> None:
    models = [gaussian([0.0], weight, draws=64), gaussian([0.05 * distance], 1 - weight, draws=64)]
    entropy = -weight * np.log2(weight) - (1 - weight) * np.log2(1 - weight)
    assert 0.0 <= mutual_information(models, np.array([0]), noise=np.array([0.05])) <= entropy + 1e-9


def test_more_noise_gives_less_information() -> None:
    speeds = np.geomspace(0.1, 10, 5)
    models = [uncertain(each, 0.5, speeds, length=1.0, spread=0.3, discrepancy=0.02) for each in (1, 2)]
    found = [mutual_information(models, np.array([0, 3]), noise=np.full(5, noise)) for noise in (0.01, 0.05, 0.2)]
    assert found[0] > found[1] > found[2]


@pytest.mark.parametrize("count", [2, 3])
@pytest.mark.parametrize("discrepancy", [0.02, 0.08])
def test_the_chosen_batch_is_the_best_of_all_batches_of_a_small_rig(count: int, discrepancy: float) -> None:
    speeds = np.geomspace(0.05, 20, 9)
    models = [uncertain(each, 0.5, speeds, length=1.0, spread=0.5, discrepancy=discrepancy) for each in (1, 2)]
    noise = np.full(9, 0.03)
    every = {batch: mutual_information(models, np.array(batch), noise=noise) for batch in combinations(range(9), count)}
    batch = best_batch(models, count=count, noise=noise, allowed=np.arange(9))
    assert every[tuple(sorted(batch.points))] > 0.95 * max(every.values())
    same(batch.information[-1], every[tuple(sorted(batch.points))])


def test_the_information_of_a_batch_does_not_depend_on_its_order() -> None:
    speeds = np.geomspace(0.05, 20, 5)
    models = [uncertain(each, 0.5, speeds, length=1.0, spread=0.5, discrepancy=0.05) for each in (1, 2)]
    found = [mutual_information(models, np.array(each), noise=np.full(5, 0.03)) for each in ([0, 3, 4], [4, 0, 3])]
    same(found[0], found[1])


def test_points_outside_the_allowed_ones_are_not_chosen() -> None:
    speeds = np.geomspace(0.05, 20, 9)
    models = [uncertain(each, 0.5, speeds, length=1.0, spread=0.5, discrepancy=0.05) for each in (1, 2)]
    batch = best_batch(models, count=2, noise=np.full(9, 0.03), allowed=np.array([1, 3, 8]))
    assert set(batch.points) <= {1, 3, 8}


def test_the_density_of_a_mixture_is_the_mean_of_those_of_its_parts() -> None:
    rng = np.random.default_rng(6)
    means, outcomes = rng.uniform(0.0, 1.0, (3, 2)), rng.uniform(0.0, 1.0, (3, 2))
    factor = np.array([np.linalg.cholesky(np.diag(rng.uniform(0.02, 0.1, 2)) + 0.01) for _ in range(3)])
    pairs = zip(means, factor, strict=True)
    parts = np.array([multivariate_normal(mean, each @ each.T).pdf(outcomes) for mean, each in pairs])
    mixture = _Mixture.of(means, factor)
    assert np.exp(mixture.log_density(_terms(outcomes), own=False)) == pytest.approx(parts.mean(axis=0))
    others = (parts.sum(axis=0) - np.diagonal(parts)) / 2
    assert np.exp(mixture.log_density(_terms(outcomes), own=True)) == pytest.approx(others)
