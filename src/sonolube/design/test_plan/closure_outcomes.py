"""Outcomes of tests of a rig under each closure of the prediction, before or after own runs."""

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np
from scipy.special import logsumexp

from sonolube.checks import Floats, Integers
from sonolube.design.test_plan.information import ModelOutcomes
from sonolube.prediction.closures import Conditions, UncertainConditions
from sonolube.prediction.evidence import TestedRig
from sonolube.prediction.hierarchy import (
    discrepancy_covariance,
    headroom,
    log_normal_density,
    squared_distances,
    standard_normals,
)
from sonolube.prediction.posterior import Posterior

_POOL: Final = 4096  # draws before they are weighed by own runs
_ROWS: Final = 256  # at a time, to bound memory
DRAWS: Final = 512
"""Draws of the parameters of each closure."""


def closure_outcomes(
    posteriors: Sequence[Posterior],
    at: UncertainConditions,
    *,
    weights: Mapping[str, float],
    own: TestedRig | None = None,
    seed: int = 0,
) -> list[ModelOutcomes]:
    """Outcomes of candidate tests of a rig under each closure.

    Parameters
    ----------
    posteriors : sequence of Posterior
    at : UncertainConditions
        Of the m candidates.
    weights : mapping of str to float
        Probability of each closure, after own runs.
    own : TestedRig, optional
        Tests of the rig's own, which weigh the draws and on which the discrepancy is conditioned.
    seed : int

    Returns
    -------
    list of ModelOutcomes

    Notes
    -----
    The model is that of `sonolube.prediction.hierarchy`: parameter and decay length of the rig drawn about those of the
    population, and a discrepancy correlated over amplitude and speed.
    """
    return [_outcomes(posterior, at, weights[posterior.closure.name], own, seed) for posterior in posteriors]


def _outcomes(
    posterior: Posterior, at: UncertainConditions, weight: float, own: TestedRig | None, seed: int
) -> ModelOutcomes:
    """Outcomes under one closure."""
    normals = standard_normals(_POOL, columns=2, seed=seed + 3)
    rows = np.random.default_rng(seed).permutation(np.arange(_POOL) % len(posterior.hyperparameters))
    hyper = posterior.hyperparameters[rows]
    parameter = hyper[:, 0] + np.exp(hyper[:, 2]) * normals[:, 0]
    factor = hyper[:, 1] + at.log_length_factor + at.length_spread * normals[:, 1]
    logs = np.zeros(_POOL)
    if own is not None:
        seen = _means(posterior, parameter, factor, own.at.conditions)
        logs = np.concatenate(
            [
                log_normal_density(own.friction_ratio - seen[each], _covariance_of_runs(hyper[each], seen[each], own))
                for each in (slice(start, start + _ROWS) for start in range(0, _POOL, _ROWS))
            ]
        )
    chosen = _resampled(logs, seed)
    hyper, parameter, factor = hyper[chosen], parameter[chosen], factor[chosen]
    means = _means(posterior, parameter, factor, at.conditions)
    room, updates = headroom(means), None
    if own is not None:
        seen = _means(posterior, parameter, factor, own.at.conditions)
        across = discrepancy_covariance(
            squared_distances(at.conditions, own.at.conditions), log_deviation=hyper[:, 3], log_length=hyper[:, 4]
        )
        across = across * room[:, :, None] * headroom(seen)[:, None, :]
        inverse = np.linalg.inv(np.linalg.cholesky(_covariance_of_runs(hyper, seen, own)))
        updates = across @ np.swapaxes(inverse, 1, 2)
        means = means + np.einsum("jmn,jn->jm", updates, np.einsum("jab,jb->ja", inverse, own.friction_ratio - seen))
    return ModelOutcomes(
        name=posterior.closure.name,
        weight=weight,
        means=means,
        deviations=np.exp(hyper[:, 3, None]) * room,
        squared_distances=squared_distances(at.conditions, at.conditions),
        lengths=np.exp(hyper[:, 4]),
        updates=updates,
    )


def _means(posterior: Posterior, parameter: Floats, factor: Floats, at: Conditions) -> Floats:
    """Friction ratios of a closure without discrepancy, shape (draws, m)."""
    return np.asarray(posterior.closure.ratio(parameter[:, None], at.scaled(decay_length=np.exp(factor)[:, None])))


def _covariance_of_runs(hyper: Floats, seen: Floats, own: TestedRig) -> Floats:
    """Covariance of measured ratios about those of the closure, for each draw."""
    room = headroom(seen)
    distances = squared_distances(own.at.conditions, own.at.conditions)
    correlated = discrepancy_covariance(distances, log_deviation=hyper[:, 3], log_length=hyper[:, 4])
    return np.asarray(correlated * room[:, :, None] * room[:, None, :] + np.diag(own.uncertainty**2))


def _resampled(logs: Floats, seed: int) -> Integers:
    """Rows of draws, systematically by weight, in random order."""
    cumulative = np.cumsum(np.exp(logs - logsumexp(logs)))
    rng = np.random.default_rng(seed)
    rows = np.searchsorted(cumulative, (np.arange(DRAWS) + rng.random()) / DRAWS)
    return np.asarray(rng.permutation(np.minimum(rows, logs.size - 1)))
