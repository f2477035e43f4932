"""Hierarchical model: its likelihood against closed forms, its posterior against another sampler."""

import json
from importlib.resources import files

import numpy as np
from pytest import approx, mark
from scipy.stats import multivariate_normal
from tests.prediction.linear_rigs import LINEAR, conditions, measured_rig

from sonolube.prediction.closures import CLOSURES, Closure, Conditions
from sonolube.prediction.evidence import published_rigs
from sonolube.prediction.hierarchy import RigLikelihood, squared_distances
from sonolube.prediction.learning import sampled_hyperparameters
from sonolube.prediction.posterior import evidence_fingerprint, learned, posteriors_without, published_log_likelihoods
from sonolube.prediction.stacking import importance_weights, stacking_weights, unseen_log_densities


def test_of_a_linear_closure_the_likelihood_is_that_of_a_normal_distribution() -> None:
    rig = measured_rig([0.3, 0.42, 0.5], conditions([1e-6, 2e-6, 2e-6], [0.02, 0.02, 0.06]))
    mu, tau, sigma, length = 0.38, 0.06, 0.1, 0.8
    found = RigLikelihood.of(LINEAR, rig)(np.array([[mu, 0.0, np.log(tau), np.log(sigma), np.log(length)]]))
    distances = squared_distances(rig.at.conditions, rig.at.conditions)
    covariance = tau**2 + sigma**2 * np.exp(-distances / (2 * length**2)) + 0.05**2 * np.eye(3)
    assert found[0] == approx(multivariate_normal([mu] * 3, covariance).logpdf(rig.friction_ratio), abs=0.02)


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
    (posterior,) = posteriors_without(published_log_likelihoods(), closures=(closure,))
    deviation = posterior.hyperparameters.std(axis=0)
    assert np.all(np.abs(draws.mean(axis=0) - posterior.hyperparameters.mean(axis=0)) < 0.35 * deviation)
    assert draws.std(axis=0) == approx(deviation, rel=0.4)


def test_the_shipped_posterior_is_that_of_the_published_tests() -> None:
    content = json.loads(files("sonolube.prediction").joinpath("learned.json").read_text(encoding="utf-8"))
    assert content["evidence"] == evidence_fingerprint()
    log_likelihoods = published_log_likelihoods()
    densities = [unseen_log_densities(log_likelihoods[closure.name]) for closure in CLOSURES]
    assert [one.weight for one in learned().friction] == approx(stacking_weights(np.array(densities)), abs=1e-3)
    for one, other in zip(learned().friction, posteriors_without(log_likelihoods), strict=True):
        scatter = other.hyperparameters.std(axis=0)
        assert np.all(np.abs(one.hyperparameters.mean(axis=0) - other.hyperparameters.mean(axis=0)) < 0.2 * scatter)
        assert one.hyperparameters.std(axis=0) == approx(scatter, rel=0.15)


def test_stacking_prefers_the_closure_that_predicts_unseen_rigs_and_keeps_equal_ones_equal() -> None:
    better = stacking_weights(np.array([[2.0, 1.5, 2.2, 1.9], [0.0, -0.5, 0.1, 0.2]]))
    assert better[0] > 0.75
    assert stacking_weights(np.zeros((2, 5))) == approx([0.5, 0.5], abs=0.01)


def test_weights_of_draws_are_those_of_the_likelihoods_of_the_rigs_that_count() -> None:
    log_likelihoods = np.log(np.array([[1.0, 5.0], [3.0, 7.0]]))
    assert importance_weights(log_likelihoods, left_out=(1,)) == approx([0.25, 0.75])
    assert unseen_log_densities(log_likelihoods) == approx(np.log([(5 * 1 + 7 * 3) / 12, (1 * 5 + 3 * 7) / 4]))
