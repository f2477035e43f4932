"""Outcomes of tests of a rig under each closure of the prediction, before or after own runs."""

from collections.abc import Sequence
from typing import Final

import numpy as np
from scipy.special import logsumexp

from sonolube.design.test_plan.information import ModelOutcomes
from sonolube.prediction.closures import UncertainConditions
from sonolube.prediction.evidence import TestedRig
from sonolube.prediction.hierarchy import discrepancy_correlation, discrepancy_deviation, squared_distances
from sonolube.prediction.posterior import Posterior
from sonolube.prediction.rig_draws import RigDraws, rig_draws

DRAWS: Final = 512
"""Draws of the parameters of each closure."""


def closure_outcomes(
    posteriors: Sequence[Posterior], at: UncertainConditions, *, own: TestedRig | None = None, seed: int = 0
) -> list[ModelOutcomes]:
    """Outcomes of candidate tests of a rig under each closure.

    The model is that of `sonolube.prediction.hierarchy`: parameter and decay length of the rig drawn about those of the
    population, and a discrepancy correlated over amplitude and speed.
    """
    drawn = [rig_draws(posterior, at, count=DRAWS, seed=seed, own=own) for posterior in posteriors]
    evidence = np.array([each.log_evidence for each in drawn])
    weights = np.exp(evidence - logsumexp(evidence))
    return [_outcomes(each, at, weight=float(weight), seed=seed) for each, weight in zip(drawn, weights, strict=True)]


def _outcomes(drawn: RigDraws, at: UncertainConditions, *, weight: float, seed: int) -> ModelOutcomes:
    """Outcomes under one friction model."""
    chosen = np.random.default_rng(seed).permutation(drawn.rows.size)[:DRAWS]
    draws = drawn.taken(chosen)
    means, own, updates = draws.means(at.conditions), drawn.own, None
    scale, log_length = draws.parameters.log_discrepancy, draws.hyperparameters[:, 5]
    deviations = discrepancy_deviation(means, at.conditions, log_discrepancy=scale)
    if own is not None:
        tested = own.at.conditions
        seen = draws.means(tested)
        near = discrepancy_correlation(at.conditions, tested, log_length=log_length)
        sides = discrepancy_deviation(seen, tested, log_discrepancy=scale)
        inverse = np.linalg.inv(np.linalg.cholesky(draws.covariance(seen)))
        updates = near * deviations[:, :, None] * sides[:, None, :] @ np.swapaxes(inverse, 1, 2)
        means = means + np.einsum("jmn,jn->jm", updates, np.einsum("jab,jb->ja", inverse, own.friction_ratio - seen))
    return ModelOutcomes(
        name=draws.posterior.closure.name,
        weight=weight,
        means=means,
        deviations=deviations,
        squared_distances=squared_distances(at.conditions, at.conditions),
        lengths=np.exp(log_length),
        updates=updates,
    )
