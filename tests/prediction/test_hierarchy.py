"""Hierarchical model: its likelihood against closed forms, its posterior against another sampler."""

import json
from dataclasses import replace
from importlib.resources import files

import numpy as np
from pytest import approx, mark
from scipy.integrate import quad
from scipy.stats import chi2, multivariate_normal
from tests.prediction.linear_rigs import LINEAR, conditions, measured_rig

from sonolube.prediction.evidence import CLOSURES, Closure, Conditions, distance_from_tests, published_rigs
from sonolube.prediction.hierarchy import RigLikelihood, discrepancy_deviation, sorted_quantiles, squared_distances
from sonolube.prediction.learning import sampled_hyperparameters
from sonolube.prediction.posterior import Population, evidence_fingerprint, learned, published_population
from sonolube.rig.friction_and_wear import PUBLISHED_DECAY_LENGTH


def test_of_a_linear_closure_the_likelihood_is_that_of_a_normal_discrepancy_with_students_scale() -> None:
    rig = measured_rig([0.3, 0.42, 0.5], conditions([1e-6, 2e-6, 2e-6], [0.02, 0.02, 0.06]))
    mu, tau, sigma, length = 0.38, 0.06, 0.1, 0.8
    found = RigLikelihood(LINEAR, rig)(np.array([[mu, 0.0, np.log(tau), 0.0, np.log(sigma), np.log(length)]]))
    distances = squared_distances(rig.at.conditions, rig.at.conditions)

    def density(chi_squared: float) -> float:
        variance = sigma**2 * 4 / chi_squared  # s^2 = nu/chi^2 with nu = 4
        covariance = tau**2 + variance * np.exp(-distances / (2 * length**2)) + 0.05**2 * np.eye(3)
        return float(multivariate_normal([mu] * 3, covariance).pdf(rig.friction_ratio) * chi2(4).pdf(chi_squared))

    assert found[0] == approx(np.log(quad(density, 0, 60, points=[0.5, 3])[0]), abs=0.03)


def test_the_discrepancy_grows_with_the_distance_from_the_published_tests() -> None:
    within, beyond = conditions([2e-6, 2e-6], [0.04, 0.04]), conditions([2e-6, 2e-6], [0.04, 10.0])
    assert distance_from_tests(within) == approx([0, 0])
    fastest = max(rig.at.conditions.sliding_speed.max() for rig in published_rigs())
    assert distance_from_tests(beyond)[1] == approx(np.log(10.0 / fastest))
    near, far = discrepancy_deviation(np.array([1.0, 1.0]), beyond, log_discrepancy=np.log(np.array(0.1)), effect=1.0)
    assert near == approx(0.025)
    assert far == approx(0.1 * np.hypot(1, np.log(10.0 / fastest)))


def test_towards_no_vibration_no_distance_counts() -> None:
    assert distance_from_tests(conditions([1e-9], [0.04])) == approx([0.0])


def test_conditions_an_e_fold_apart_in_amplitude_and_speed_have_a_squared_distance_of_two() -> None:
    one, other = conditions([1e-6], [0.02]), conditions([np.e * 1e-6], [0.02 / np.e])
    assert squared_distances(one, other)[0, 0] == approx(2.0)


@mark.parametrize("closure", CLOSURES, ids=lambda closure: closure.name)
def test_closures_depend_on_amplitude_over_decay_length_alone(closure: Closure) -> None:
    at = conditions([1e-6, 3e-6], [0.01, 0.2])
    doubled = Conditions(
        vibration_amplitude=2 * at.vibration_amplitude,
        frequency=at.frequency,
        sliding_speed=at.sliding_speed,
        decay_length=2 * at.decay_length,
    )
    scale = np.log(closure.median)
    halved = at.scaled(decay_length=np.full(2, 0.5))
    more = Conditions(
        vibration_amplitude=2 * at.vibration_amplitude,
        frequency=at.frequency,
        sliding_speed=at.sliding_speed,
        decay_length=at.decay_length,
    )
    assert closure.ratio(scale, halved) == approx(closure.ratio(scale, more), rel=1e-9)
    assert closure.ratio(scale, doubled) == approx(closure.ratio(scale, at), rel=1e-9)


@mark.parametrize("closure", CLOSURES, ids=lambda closure: closure.name)
def test_an_ensemble_sampler_finds_the_posterior_of_the_weighed_prior_draws(closure: Closure) -> None:
    draws = sampled_hyperparameters(closure, published_rigs(), steps=600)
    posterior = Population.of(closure, published_rigs()).posterior()
    deviation = posterior.hyperparameters.std(axis=0)
    assert np.all(np.abs(draws.mean(axis=0) - posterior.hyperparameters.mean(axis=0)) < 0.35 * deviation)
    assert draws.std(axis=0) == approx(deviation, rel=0.4)


def test_the_shipped_posterior_is_that_of_the_published_tests() -> None:
    content = json.loads(files("sonolube.prediction").joinpath("learned.json").read_text(encoding="utf-8"))
    assert content["evidence"] == evidence_fingerprint()
    one, other = learned().friction.hyperparameters, published_population().posterior().hyperparameters
    assert np.all(np.abs(one.mean(axis=0) - other.mean(axis=0)) < 0.2 * other.std(axis=0))
    assert one.std(axis=0) == approx(other.std(axis=0), rel=0.15)


def test_rig_files_take_the_decay_length_that_was_learned() -> None:
    median, spread = learned().friction.decay_length()
    assert PUBLISHED_DECAY_LENGTH.median == approx(median, rel=0.03)
    assert PUBLISHED_DECAY_LENGTH.log_spread == approx(spread, rel=0.03)


def test_leaving_rigs_out_weighs_draws_by_the_likelihoods_of_the_others() -> None:
    logs = np.log(np.array([[1.0, 5.0], [3.0, 7.0]]))
    two = Population(closure=LINEAR, draws=np.array([[0.0] * 6, [1.0] * 6]), log_likelihoods=np.tile(logs, (500, 1)))
    two = replace(two, draws=np.tile(two.draws, (500, 1)))
    assert two.posterior(without=(1,)).hyperparameters[:, 0].mean() == approx(0.75, abs=0.05)
    assert two.posterior().hyperparameters[:, 0].mean() == approx(21 / 26, abs=0.05)


@mark.parametrize("shape", [(100,), (1000,), (4001,), (257, 5)])
def test_quantiles_of_sorted_draws_are_those_of_numpy(shape: tuple[int, ...]) -> None:
    ordered = np.sort(np.random.default_rng(1).lognormal(size=shape), axis=0)
    probabilities = [0.0, 0.025, 0.1, 0.5, 0.9, 0.975, 1.0]
    found = sorted_quantiles(ordered, probabilities)
    assert found == approx(np.quantile(ordered, probabilities, axis=0), rel=1e-14)
