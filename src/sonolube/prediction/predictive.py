"""Draws of the friction ratio of a rig from the posterior of the population, and after tests of its own."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from scipy.special import chdtrc, logsumexp

from sonolube.checks import Floats, Integers
from sonolube.prediction.closures import Conditions, UncertainConditions
from sonolube.prediction.evidence import TestedRig
from sonolube.prediction.hierarchy import headroom, standard_normals
from sonolube.prediction.posterior import Posterior
from sonolube.prediction.rig_draws import RigDraws, covariance_of_tests, discrepancies, rig_draws

_SURPRISE: Final = 0.01  # probability below which own tests are called unexplained
_INFLATION: Final = 1.5  # of the uncertainty of unexplained tests, until they are explained
_USELESS: Final = 10.0  # uncertainty of a ratio with which a test says nothing


@dataclass(frozen=True, kw_only=True, slots=True)
class RatioDraws:
    """Equally probable draws of friction ratios.

    Parameters
    ----------
    friction_ratio : ndarray, shape (draws, m)
        At each of the conditions. []
    weights : dict of str to float
        Probability of each closure, after the tests of the rig's own.
    surprise : float
        Probability of own tests that deviate as much or more, under the closure that explains them best; 1 without
        tests.
    """

    friction_ratio: Floats
    weights: dict[str, float]
    surprise: float

    @property
    def explained(self) -> bool:
        """Whether a closure explains the tests of the rig's own."""
        return self.surprise >= _SURPRISE


def ratio_draws(
    posteriors: Sequence[Posterior], at: UncertainConditions, *, count: int, seed: int = 0, own: TestedRig | None = None
) -> RatioDraws:
    """Draws of the friction ratio of a rig that is none of those learned from.

    Parameters
    ----------
    posteriors : sequence of Posterior
    at : UncertainConditions
    count : int
    seed : int
    own : TestedRig, optional
        Tests of the rig's own, whose spreads are those of `at`.

    Returns
    -------
    RatioDraws

    Notes
    -----
    Draws from the population are weighed by the likelihood of the rig's own tests and resampled; the discrepancy
    follows from its conditional distribution. A draw has one standard normal deviate at all conditions, so that
    quantiles at each of them are right and curves are smooth. Ratios are limited to 0 to 1. Where no closure explains
    the own tests, their uncertainty is raised until one does: they must not make a wrong closure certain.
    """
    pools, surprise = _pools(posteriors, at, seed, own)
    while surprise < _SURPRISE and own is not None and own.uncertainty.min() < _USELESS:
        own = replace(own, uncertainty=_INFLATION * own.uncertainty)
        pools, reduced = _pools(posteriors, at, seed, own)
        if reduced >= _SURPRISE:
            break
    log_shares = np.array([np.log(each.posterior.weight) + logsumexp(each.log_weights) for each in pools])
    shares = np.exp(log_shares - logsumexp(log_shares))
    rng = np.random.default_rng(seed)
    counts = np.diff(np.round(np.cumsum([0.0, *shares]) * count).astype(int))
    draws = [
        _ratios(pool, pool.resampled(number, rng), at.conditions, own)
        for pool, number in zip(pools, counts, strict=True)
        if number
    ]
    return RatioDraws(
        friction_ratio=np.concatenate(draws),
        weights={pool.posterior.closure.name: float(share) for pool, share in zip(pools, shares, strict=True)},
        surprise=surprise,
    )


def _pools(
    posteriors: Sequence[Posterior], at: UncertainConditions, seed: int, own: TestedRig | None
) -> tuple[list[RigDraws], float]:
    """Draws of every closure, and the probability of the own tests under the one that explains them best."""
    pools = [rig_draws(posterior, at, seed=seed, own=own) for posterior in posteriors]
    surprise = 1.0 if own is None else max(_surprise(pool, own.friction_ratio.size) for pool in pools)
    return pools, surprise


def _ratios(pool: RigDraws, rows: Integers, at: Conditions, own: TestedRig | None) -> Floats:
    """Friction ratios of rows of a pool at conditions, shape (rows, m)."""
    hyper = pool.hyperparameters[rows]
    ratio = pool.means(at, rows)
    deviation = np.exp(hyper[:, 3, None]) * headroom(ratio)
    if own is not None:
        seen = pool.means(own.at.conditions, rows)
        across = discrepancies(hyper, at, own.at.conditions) * headroom(ratio)[:, :, None] * headroom(seen)[:, None, :]
        gain = across @ np.linalg.inv(covariance_of_tests(hyper, seen, own))
        ratio = ratio + np.einsum("pmn,pn->pm", gain, own.friction_ratio - seen)
        deviation = np.sqrt(np.maximum(deviation**2 - np.einsum("pmn,pmn->pm", gain, across), 0.0))
    # deviates are drawn anew: after resampling, equal rows would share theirs
    count = pool.log_weights.size
    fresh = standard_normals(count, columns=1, seed=5)[np.random.default_rng(6).permutation(count)[: rows.size], 0]
    return np.asarray(np.clip(ratio + deviation * fresh[:, None], 0.0, 1.0))


def _surprise(pool: RigDraws, tests: int) -> float:
    """Probability of deviations as large as those of the tests, by the draws that explain them best."""
    weights = np.exp(pool.log_weights - logsumexp(pool.log_weights))
    return float(chdtrc(tests, weights @ pool.deviation))
