"""Draws of what a rig has of its own under one closure, from the population and weighed by tests of the rig."""

from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from scipy.special import logsumexp

from sonolube.checks import Floats, Integers
from sonolube.prediction.closures import Conditions, UncertainConditions
from sonolube.prediction.evidence import TestedRig
from sonolube.prediction.hierarchy import discrepancy_covariance, headroom, squared_distances, standard_normals
from sonolube.prediction.posterior import Posterior

_POOL: Final = 4096  # draws of each closure before they are weighed
_ROWS: Final = 256  # weighed at a time, to bound memory


@dataclass(frozen=True, slots=True, eq=False)
class RigDraws:
    """Draws of one closure for one rig, with their weights by its own tests.

    Parameters
    ----------
    posterior : Posterior
    hyperparameters : ndarray, shape (p, 5)
    log_parameter : ndarray, shape (p,)
        Of the closure.
    log_factor : ndarray, shape (p,)
        On decay length over amplitude.
    log_weights : ndarray, shape (p,)
    deviation : ndarray, shape (p,)
        Of the tests, squared and normalised.
    """

    posterior: Posterior
    hyperparameters: Floats
    log_parameter: Floats
    log_factor: Floats
    log_weights: Floats
    deviation: Floats

    def means(self, at: Conditions, rows: Integers | slice = slice(None)) -> Floats:
        """Return the friction ratios of the closure without discrepancy, shape (rows, m). []"""
        scaled = at.scaled(decay_length=np.exp(self.log_factor[rows])[:, None])
        return np.asarray(self.posterior.closure.ratio(self.log_parameter[rows][:, None], scaled))

    def resampled(self, count: int, rng: np.random.Generator) -> Integers:
        """Return rows, drawn systematically by weight, in their order."""
        cumulative = np.cumsum(np.exp(self.log_weights - logsumexp(self.log_weights)))
        rows = np.searchsorted(cumulative, (np.arange(count) + rng.random()) / count)
        return np.minimum(rows, self.log_weights.size - 1)


def rig_draws(posterior: Posterior, at: UncertainConditions, *, seed: int, own: TestedRig | None) -> RigDraws:
    """Return draws of a closure for a rig, weighed by the likelihood of its own tests.

    Parameters
    ----------
    posterior : Posterior
    at : UncertainConditions
        Whose spreads are those of the rig.
    seed : int
    own : TestedRig or None
        Equal weights without tests.

    Returns
    -------
    RigDraws
        4096 of them.
    """
    normals = standard_normals(_POOL, columns=2, seed=seed + 3)
    rows = np.random.default_rng(seed).permutation(np.arange(_POOL) % len(posterior.hyperparameters))
    hyper = posterior.hyperparameters[rows]
    log_parameter = hyper[:, 0] + np.exp(hyper[:, 2]) * normals[:, 0]
    log_factor = hyper[:, 1] + at.log_length_factor + at.length_spread * normals[:, 1]
    equal = np.full(_POOL, -np.log(_POOL))
    free = RigDraws(posterior, hyper, log_parameter, log_factor, equal, np.zeros(_POOL))
    if own is None:
        return free
    weighed = [_weighed(free, own, slice(start, start + _ROWS)) for start in range(0, _POOL, _ROWS)]
    density, deviation = (np.concatenate(parts) for parts in zip(*weighed, strict=True))
    return replace(free, log_weights=density - np.log(_POOL), deviation=deviation)


def discrepancies(hyper: Floats, one: Conditions, other: Conditions) -> Floats:
    """Return the covariance of the discrepancy between two sets of conditions, for each row of hyperparameters."""
    return discrepancy_covariance(squared_distances(one, other), log_deviation=hyper[:, 3], log_length=hyper[:, 4])


def covariance_of_tests(hyper: Floats, ratio: Floats, own: TestedRig) -> Floats:
    """Return the covariance of measured ratios about those of the closure, for each row of hyperparameters."""
    room = headroom(ratio)
    correlated = discrepancies(hyper, own.at.conditions, own.at.conditions) * room[:, :, None] * room[:, None, :]
    return np.asarray(correlated + np.diag(own.uncertainty**2))


def _weighed(free: RigDraws, own: TestedRig, rows: slice) -> tuple[Floats, Floats]:
    """Return the logarithm of the density of the tests under some draws, and their normalised squared deviation."""
    ratio = free.means(own.at.conditions, rows)
    residual, covariance = own.friction_ratio - ratio, covariance_of_tests(free.hyperparameters[rows], ratio, own)
    deviation = np.einsum("pn,pnm,pm->p", residual, np.linalg.inv(covariance), residual)
    return -0.5 * (deviation + np.linalg.slogdet(2 * np.pi * covariance)[1]), deviation
