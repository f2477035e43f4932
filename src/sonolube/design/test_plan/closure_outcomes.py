"""Outcomes of tests of a rig under each closure of the prediction, before or after own runs."""

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from sonolube.design.test_plan.information import ModelOutcomes
from sonolube.prediction.closures import UncertainConditions
from sonolube.prediction.evidence import TestedRig
from sonolube.prediction.hierarchy import headroom, squared_distances
from sonolube.prediction.posterior import Posterior
from sonolube.prediction.rig_draws import covariance_of_tests, discrepancies, rig_draws

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
    pool, rng = rig_draws(posterior, at, seed=seed, own=own), np.random.default_rng(seed)
    chosen = rng.permutation(pool.resampled(DRAWS, rng))
    hyper, means = pool.hyperparameters[chosen], pool.means(at.conditions, chosen)
    room, updates = headroom(means), None
    if own is not None:
        seen = pool.means(own.at.conditions, chosen)
        across = discrepancies(hyper, at.conditions, own.at.conditions)
        across = across * room[:, :, None] * headroom(seen)[:, None, :]
        inverse = np.linalg.inv(np.linalg.cholesky(covariance_of_tests(hyper, seen, own)))
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
