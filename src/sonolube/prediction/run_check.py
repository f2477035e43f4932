"""Own runs of a rig against what was predicted before them, and each run against the others."""

from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from scipy.special import logsumexp, ndtr, stdtr

from sonolube.checks import Floats
from sonolube.prediction.evidence import TestedRig
from sonolube.prediction.rig_draws import RigDraws

_FREEDOM: Final = 4.0  # degrees of freedom of the errors of runs
_FEWEST: Final = 4  # runs from which each is checked against the others
_REPLICATES: Final = 256  # of runs drawn from the prediction
_CONTRADICTION: Final = 0.02  # probability below which runs contradict the prediction
_OUTLIER: Final = 0.05  # probability, over all runs, below which one disagrees with the others


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class RunCheck:
    """Own runs against the prediction before them, and against each other.

    Parameters
    ----------
    probability : float
        Of runs as improbable as these or more, before any was made.
    lows, highs : ndarray, shape (n,)
        95 % interval of each run as predicted before any.
    left_out : ndarray, shape (n,)
        Ratio of each run as predicted by the others; NaN for fewer than four runs.
    outlier_probability : ndarray, shape (n,)
        Two-sided, of each run given the others; 1 for fewer than four runs.
    """

    probability: float
    lows: Floats
    highs: Floats
    left_out: Floats
    outlier_probability: Floats

    @property
    def contradicted(self) -> bool:
        """Whether the runs contradict the prediction before them."""
        return self.probability < _CONTRADICTION

    @property
    def outliers(self) -> tuple[int, ...]:
        """Places of the runs that disagree with the others, by Bonferroni's bound over all runs."""
        limit = _OUTLIER / self.outlier_probability.size
        return tuple(int(place) for place in np.flatnonzero(self.outlier_probability < limit))


def student_weights(draws: RigDraws, own: TestedRig) -> Floats:
    """Weights (nu+1)/(nu+z^2) of the runs under Student's errors; 1 for fewer than four runs.

    Parameters
    ----------
    draws : RigDraws
        Conditioned on the runs.
    own : TestedRig
        The runs with their stated uncertainty.

    Returns
    -------
    ndarray, shape (n,)
    """
    if own.friction_ratio.size < _FEWEST:
        return np.ones(own.friction_ratio.size)
    middle, deviation = _left_out(replace(draws, own=own))
    z = (own.friction_ratio - middle) / deviation
    return np.asarray(np.minimum((_FREEDOM + 1) / (_FREEDOM + z**2), 1.0))


def checked_runs(before: RigDraws, after: RigDraws, own: TestedRig) -> RunCheck:
    """Check of runs by draws before and after them.

    Parameters
    ----------
    before : RigDraws
        Of the population.
    after : RigDraws
        Conditioned on the runs.
    own : TestedRig

    Returns
    -------
    RunCheck
    """
    count = own.friction_ratio.size
    seen = replace(before, own=own)
    means = seen.means(own.at.conditions)
    factors = np.linalg.cholesky(seen.covariance(means))
    left_out, outlier = np.full(count, np.nan), np.ones(count)
    if count >= _FEWEST:
        left_out, deviation = _left_out(after)
        inflated = np.hypot(deviation, 0.0)
        z = np.abs(own.friction_ratio - left_out) / inflated
        outlier = np.asarray(2 * stdtr(count - 1, -z))
    drawn = means + np.einsum("pij,pj->pi", factors, np.random.default_rng(3).standard_normal(means.shape))
    lows, highs = np.quantile(drawn, [0.025, 0.975], axis=0)
    return RunCheck(
        probability=_predictive_probability(means, factors, drawn, own.friction_ratio),
        lows=np.maximum(lows, 0.0),
        highs=highs,
        left_out=left_out,
        outlier_probability=outlier,
    )


def _predictive_probability(means: Floats, factors: Floats, drawn: Floats, measured: Floats) -> float:
    """Probability of outcomes as improbable as the measured ones: jointly, or one of them alone, whichever is less.

    The density of all runs, and the least tail of one run, are each compared with those of runs drawn from the prediction.
    """
    replicates = drawn[np.random.default_rng(4).permutation(len(drawn))[:_REPLICATES]]
    outcomes = np.vstack([measured, replicates])
    inverse = np.linalg.inv(factors)
    logs = np.log(np.diagonal(factors, axis1=1, axis2=2)).sum(axis=1)
    shifted = np.einsum("pij,pj->pi", inverse, means)
    joint = np.empty(len(outcomes))
    for place, outcome in enumerate(outcomes):
        scaled = inverse @ outcome - shifted
        joint[place] = logsumexp(-0.5 * np.sum(scaled**2, axis=1) - logs)
    deviations = np.sqrt(np.einsum("pij,pij->pi", factors, factors))
    below = np.stack([ndtr((outcome - means) / deviations).mean(axis=0) for outcome in outcomes])
    tail = np.minimum(below, 1 - below).min(axis=1)
    ranks = [float(np.mean(each[1:] <= each[0])) for each in (joint, tail)]
    return float(min(1.0, 2 * max(min(ranks), 0.5 / _REPLICATES)))


def _left_out(draws: RigDraws) -> tuple[Floats, Floats]:
    """Mean and standard deviation of each run by the others, over draws weighed without it.

    With the inverse Q of the covariance of all runs, run i deviates from its mean by the others by (Q r)_i/Q_ii, with
    the variance 1/Q_ii; a draw counts by the inverse of the density that it gives the run.
    """
    assert draws.own is not None
    measured = draws.own.friction_ratio
    seen = draws.means(draws.own.at.conditions)
    precision = np.linalg.inv(draws.covariance(seen))
    variance = 1 / np.diagonal(precision, axis1=1, axis2=2)
    gap = np.einsum("pij,pj->pi", precision, measured - seen) * variance
    logs = 0.5 * gap**2 / variance + 0.5 * np.log(variance)
    logs = np.minimum(logs, np.quantile(logs, 0.98, axis=0))  # truncated importance weights
    weights = np.exp(logs - logsumexp(logs, axis=0))
    middle = np.sum(weights * (measured - gap), axis=0)
    spread = np.sum(weights * (variance + (measured - gap - middle) ** 2), axis=0)
    return middle, np.sqrt(spread)
