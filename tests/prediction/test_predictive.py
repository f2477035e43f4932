"""Predictive draws: limits, the update by own tests against closed forms, and tests that no closure explains."""

from dataclasses import replace

import numpy as np
from pytest import approx
from scipy.stats import multivariate_normal, norm
from tests.prediction.linear_rigs import LINEAR, conditions, measured_rig

from sonolube.prediction.closures import UncertainConditions
from sonolube.prediction.evidence import published_rigs
from sonolube.prediction.hierarchy import log_normal_density, squared_distances
from sonolube.prediction.posterior import Posterior, learned
from sonolube.prediction.predictive import RatioDraws, ratio_draws

MU, TAU, SIGMA, LENGTH = 0.4, 0.06, 0.08, 0.7
KNOWN = Posterior(
    closure=LINEAR,
    weight=1.0,
    hyperparameters=np.tile([MU, 0.0, np.log(TAU), np.log(SIGMA), np.log(LENGTH)], (1024, 1)),
)


def uncertain(amplitudes: list[float], speeds: list[float]) -> UncertainConditions:
    return UncertainConditions(
        conditions=conditions(amplitudes, speeds), decay_length_spread=0.1, amplitude_spread=0.05
    )


def spread(draws: RatioDraws) -> float:
    low, high = np.quantile(draws.friction_ratio[:, 0], [0.1, 0.9])
    return float(high - low)


def test_without_own_tests_the_scatter_between_rigs_and_the_discrepancy_add_up() -> None:
    draws = ratio_draws([KNOWN], uncertain([2e-6], [0.02]), count=4000).friction_ratio[:, 0]
    assert draws.mean() == approx(MU, abs=0.005)
    assert draws.std() == approx(np.hypot(TAU, SIGMA), rel=0.05)


def test_own_tests_update_a_linear_closure_as_a_normal_distribution_is_conditioned() -> None:
    own = measured_rig([0.55, 0.5], conditions([1.5e-6, 2e-6], [0.02, 0.03]))
    draws = ratio_draws([KNOWN], uncertain([2e-6], [0.02]), count=4000, own=own).friction_ratio[:, 0]
    at = conditions([2e-6, 1.5e-6, 2e-6], [0.02, 0.02, 0.03])
    covariance = TAU**2 + SIGMA**2 * np.exp(-squared_distances(at, at) / (2 * LENGTH**2))
    covariance += np.diag([0.0, *own.uncertainty**2])
    gain = covariance[0, 1:] @ np.linalg.inv(covariance[1:, 1:])
    assert draws.mean() == approx(MU + gain @ (own.friction_ratio - MU), abs=0.005)
    assert draws.std() == approx(np.sqrt(covariance[0, 0] - gain @ covariance[1:, 0]), rel=0.06)


def test_closures_are_weighed_anew_by_the_density_of_the_own_tests() -> None:
    higher = KNOWN.hyperparameters + np.array([0.2, 0, 0, 0, 0])
    other = replace(KNOWN, closure=replace(LINEAR, name="other"), hyperparameters=higher)
    own = measured_rig([0.45], conditions([2e-6], [0.02]))
    draws = ratio_draws(
        [replace(KNOWN, weight=0.5), replace(other, weight=0.5)], uncertain([2e-6], [0.02]), count=1000, own=own
    )
    density = [norm(middle, np.sqrt(TAU**2 + SIGMA**2 + 0.05**2)).pdf(0.45) for middle in (MU, MU + 0.2)]
    assert draws.weights["linear"] == approx(density[0] / sum(density), abs=0.01)


def test_more_own_tests_narrow_the_interval_and_repeats_of_one_do_so_less_than_others() -> None:
    at = uncertain([2.5e-6], [0.02])
    none = spread(ratio_draws(learned().friction, at, count=4000))
    one = spread(ratio_draws(learned().friction, at, count=4000, own=measured_rig([0.4], conditions([2.5e-6], [0.08]))))
    several = measured_rig([0.4, 0.35, 0.3], conditions([2.5e-6, 2e-6, 2.5e-6], [0.08, 0.02, 0.02]))
    assert none > one > spread(ratio_draws(learned().friction, at, count=4000, own=several))


def test_a_sharp_own_test_at_the_asked_conditions_is_believed() -> None:
    at = uncertain([2.5e-6], [0.02])
    own = replace(measured_rig([0.5], at.conditions), uncertainty=np.array([0.005]))
    draws = ratio_draws(learned().friction, at, count=2000, own=own).friction_ratio[:, 0]
    assert np.quantile(draws, [0.05, 0.95]) == approx([0.5, 0.5], abs=0.015)


def test_without_vibration_friction_is_unchanged_and_certain() -> None:
    draws = ratio_draws(learned().friction, uncertain([1e-11], [0.02]), count=1000).friction_ratio
    assert draws.min() > 0.999


def test_beyond_the_critical_speed_friction_is_unchanged() -> None:
    draws = ratio_draws(learned().friction, uncertain([0.2e-6], [3.0]), count=1000).friction_ratio
    assert np.quantile(draws, 0.05) > 0.98


def test_own_tests_that_rise_with_the_amplitude_are_explained_by_no_closure() -> None:
    own = measured_rig([0.3, 0.7, 1.3], conditions([0.5e-6, 1.5e-6, 4e-6], [0.02, 0.02, 0.02]))
    assert not ratio_draws(learned().friction, uncertain([2e-6], [0.02]), count=500, own=own).explained


def test_published_tests_are_explained_as_own_tests() -> None:
    for rig in published_rigs():
        assert ratio_draws(learned().friction, rig.at, count=500, own=rig).explained


def test_the_same_seed_gives_the_same_draws() -> None:
    at = uncertain([2e-6], [0.02])
    one, other = (ratio_draws(learned().friction, at, count=300, seed=7).friction_ratio for _ in range(2))
    assert np.array_equal(one, other)


def test_the_density_of_own_tests_is_that_of_a_multivariate_normal_distribution() -> None:
    covariance = np.array([[0.02, 0.01], [0.01, 0.03]])
    found = log_normal_density(np.array([0.1, -0.2]), covariance)
    assert found == approx(multivariate_normal([0, 0], covariance).logpdf([0.1, -0.2]))
