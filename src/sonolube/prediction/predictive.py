"""Draws of the friction ratio of a rig from the posterior of the population, and after tests of its own."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from scipy.special import chdtrc, logsumexp

from sonolube.checks import Floats, Integers
from sonolube.prediction.closures import Conditions, UncertainConditions
from sonolube.prediction.evidence import TestedRig
from sonolube.prediction.hierarchy import discrepancy_covariance, headroom, squared_distances, standard_normals
from sonolube.prediction.posterior import Posterior

_POOL: Final = 4096  # draws of each closure before they are weighed
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


@dataclass(frozen=True, slots=True)
class _Pool:
    """Draws of one closure for one rig, with their weights by its own tests."""

    posterior: Posterior
    hyperparameters: Floats  # (p, 5)
    log_parameter: Floats  # (p,)
    log_factor: Floats  # (p,), on decay length over amplitude
    log_weights: Floats  # (p,)
    deviation: Floats  # (p,), of the tests, squared and normalised


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
        _ratios(pool, _resampled(pool, number, rng), at.conditions, own)
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
) -> tuple[list[_Pool], float]:
    """Draws of every closure, and the probability of the own tests under the one that explains them best."""
    pools = [_pool(posterior, at, seed, own) for posterior in posteriors]
    surprise = 1.0 if own is None else max(_surprise(pool, own.friction_ratio.size) for pool in pools)
    return pools, surprise


def _pool(posterior: Posterior, at: UncertainConditions, seed: int, own: TestedRig | None) -> _Pool:
    """Draws of one closure, and what the own tests say of each."""
    normals = standard_normals(_POOL, columns=2, seed=seed + 3)
    rows = np.random.default_rng(seed).permutation(np.arange(_POOL) % len(posterior.hyperparameters))
    hyper = posterior.hyperparameters[rows]
    log_parameter = hyper[:, 0] + np.exp(hyper[:, 2]) * normals[:, 0]
    log_factor = hyper[:, 1] + at.log_length_factor + at.length_spread * normals[:, 1]
    free = _Pool(posterior, hyper, log_parameter, log_factor, np.zeros(_POOL), np.zeros(_POOL))
    if own is None:
        return replace(free, log_weights=np.full(_POOL, -np.log(_POOL)))
    ratio = _means(free, slice(None), own.at.conditions)
    residual, covariance = own.friction_ratio - ratio, _covariance_of_tests(hyper, ratio, own)
    deviation = np.einsum("pn,pnm,pm->p", residual, np.linalg.inv(covariance), residual)
    log_weights = -0.5 * (deviation + np.linalg.slogdet(2 * np.pi * covariance)[1]) - np.log(_POOL)
    return replace(free, log_weights=log_weights, deviation=deviation)


def _resampled(pool: _Pool, count: int, rng: np.random.Generator) -> Integers:
    """Rows of a pool, drawn systematically by weight."""
    cumulative = np.cumsum(np.exp(pool.log_weights - logsumexp(pool.log_weights)))
    rows = np.searchsorted(cumulative, (np.arange(count) + rng.random()) / count)
    return np.minimum(rows, _POOL - 1)


def _ratios(pool: _Pool, rows: Integers, at: Conditions, own: TestedRig | None) -> Floats:
    """Friction ratios of rows of a pool at conditions, shape (rows, m)."""
    hyper = pool.hyperparameters[rows]
    ratio = _means(pool, rows, at)
    deviation = np.exp(hyper[:, 3, None]) * headroom(ratio)
    if own is not None:
        seen = _means(pool, rows, own.at.conditions)
        across = _covariance(hyper, at, own.at.conditions) * headroom(ratio)[:, :, None] * headroom(seen)[:, None, :]
        gain = across @ np.linalg.inv(_covariance_of_tests(hyper, seen, own))
        ratio = ratio + np.einsum("pmn,pn->pm", gain, own.friction_ratio - seen)
        deviation = np.sqrt(np.maximum(deviation**2 - np.einsum("pmn,pmn->pm", gain, across), 0.0))
    # deviates are drawn anew: after resampling, equal rows would share theirs
    fresh = standard_normals(_POOL, columns=1, seed=5)[np.random.default_rng(6).permutation(_POOL)[: rows.size], 0]
    return np.asarray(np.clip(ratio + deviation * fresh[:, None], 0.0, 1.0))


def _means(pool: _Pool, rows: Integers | slice, at: Conditions) -> Floats:
    """Friction ratios of the closure without discrepancy, shape (rows, m)."""
    scaled = at.scaled(decay_length=np.exp(pool.log_factor[rows])[:, None])
    return np.asarray(pool.posterior.closure.ratio(pool.log_parameter[rows][:, None], scaled))


def _covariance(hyper: Floats, one: Conditions, other: Conditions) -> Floats:
    """Covariance of the discrepancy between two sets of conditions, for each row of hyperparameters."""
    return discrepancy_covariance(squared_distances(one, other), log_deviation=hyper[:, 3], log_length=hyper[:, 4])


def _covariance_of_tests(hyper: Floats, ratio: Floats, own: TestedRig) -> Floats:
    """Covariance of measured ratios about those of the closure, for each row of hyperparameters."""
    room = headroom(ratio)
    correlated = _covariance(hyper, own.at.conditions, own.at.conditions) * room[:, :, None] * room[:, None, :]
    return np.asarray(correlated + np.diag(own.uncertainty**2))


def _surprise(pool: _Pool, tests: int) -> float:
    """Probability of deviations as large as those of the tests, by the draws that explain them best."""
    weights = np.exp(pool.log_weights - logsumexp(pool.log_weights))
    return float(chdtrc(tests, weights @ pool.deviation))
