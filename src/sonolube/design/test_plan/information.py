"""Expected information of tests about which of several models holds, and outcomes of tests under each closure."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import log
from typing import Final

import numpy as np
from scipy.special import logsumexp, ndtri

from sonolube.checks import Floats, Integers
from sonolube.design.statistics import sobol_sample
from sonolube.prediction.evidence import TestedRig, UncertainConditions
from sonolube.prediction.hierarchy import discrepancy_correlation, squared_distances
from sonolube.prediction.posterior import Posterior, RigDraws, rig_draws

_Information = Callable[[Iterable[int]], float]

_ROUNDS: Final = 5  # of exchanges, at most
_GAIN: Final = 1e-9  # bits, below which an exchange is none
_MIN_VARIANCE: Final = 1e-12
_NEGLIGIBLE: Final = -700.0  # logarithm of a share that changes no sum; below it, exp is many times slower


@dataclass(frozen=True, kw_only=True, slots=True)
class ModelOutcomes:
    """Outcomes of all candidate tests under one model, as draws of its parameters.

    Parameters
    ----------
    name : str
        Of the model.
    weight : float
        Its probability.
    means : ndarray, shape (j, m)
        Outcome of each of m candidates by each of j draws, without what follows.
    deviations : ndarray, shape (j, m)
        Standard deviation of the error of the model.
    squared_distances : ndarray, shape (m, m)
        Between candidates.
    lengths : ndarray, shape (j,)
        Length over which that error is correlated: exp(-distance^2/(2 length^2)).
    updates : ndarray, shape (j, m, n), optional
        Factors by which errors at candidates are known already: subtracted from their covariance as U U'.
    """

    name: str
    weight: float
    means: Floats
    deviations: Floats
    squared_distances: Floats
    lengths: Floats
    updates: Floats | None = None

    def covariance(self, points: Integers) -> Floats:
        """Covariance of the errors of the model at some candidates, shape (j, b, b)."""
        near = np.exp(-0.5 * self.squared_distances[np.ix_(points, points)] / self.lengths[:, None, None] ** 2)
        sides = self.deviations[:, points]
        found = near * sides[:, :, None] * sides[:, None, :]
        if self.updates is not None:
            known = self.updates[:, points]
            found = found - known @ np.swapaxes(known, 1, 2)
        return np.asarray(found)


def mutual_information(models: Sequence[ModelOutcomes], points: Integers, *, noise: Floats, seed: int = 0) -> float:
    r"""Expected information of a batch of tests about which model holds, in bits.

    From 0 to the entropy of the weights. The outcome y of a batch of tests under model k is a mixture of normal
    distributions over draws of its parameters,

    .. math:: p(y \mid k) = \frac1J \sum_j N(y;\, m_{kj},\, C_{kj} + D),

    with the noise D of the measurement. The mutual information of model and outcome,

    .. math:: I = \sum_k w_k\, \mathrm{E}_{y \mid k} \log_2 \frac{p(y \mid k)}{\sum_l w_l\, p(y \mid l)},

    is the expected fall of the entropy of the model's weights w by the tests.

    By two opposite, evenly spread samples for each draw; their own draw is left out of the mixture that they are
    compared with.
    """
    points = np.sort(points)  # so that the order of a batch changes nothing
    samples, mixtures = [], []
    for index, model in enumerate(models):
        covariance = model.covariance(points) + np.diag(noise[points] ** 2 + _MIN_VARIANCE)
        factor = np.asarray(np.linalg.cholesky(covariance), dtype=float)
        normals = _normals(len(model.means), len(points), seed + index)
        errors = np.einsum("jab,jb->ja", factor, normals)
        samples.append((model.means[:, points] + errors, model.means[:, points] - errors))
        mixtures.append(_Mixture.of(model.means[:, points], factor))
    logs = np.log([model.weight for model in models])
    total = 0.0
    for index, (model, pair) in enumerate(zip(models, samples, strict=True)):
        for outcomes in pair:
            terms = _terms(outcomes)
            each = np.stack([one.log_density(terms, own=place == index) for place, one in enumerate(mixtures)])
            total += model.weight * float(np.mean(each[index] - logsumexp(each + logs[:, None], axis=0))) / 2
    return max(total, 0.0) / log(2)


@lru_cache(64)
def _normals(count: int, columns: int, seed: int) -> Floats:
    """Standard normal numbers by a scrambled Sobol sequence, shape (count, columns)."""
    return np.asarray(ndtri(sobol_sample(columns, samples=count, seed=seed)[0][:count]))


@dataclass(frozen=True, slots=True)
class _Mixture:
    """Equally weighed normal distributions in b dimensions, whose logarithms are polynomials of second degree."""

    coefficients: Floats  # (b * b + b + 1, j), of the terms of `_terms`

    @classmethod
    def of(cls, means: Floats, factor: Floats) -> "_Mixture":
        """Mixture of its means, shape (j, b), and Cholesky factors, shape (j, b, b)."""
        inverse = np.linalg.inv(factor)
        precision = np.swapaxes(inverse, 1, 2) @ inverse
        linear = np.einsum("jab,jb->ja", precision, means)
        logs = np.log(np.diagonal(factor, axis1=1, axis2=2)).sum(axis=1) + 0.5 * means.shape[1] * np.log(2 * np.pi)
        constant = -0.5 * np.einsum("ja,ja->j", linear, means) - logs
        return cls(np.column_stack([-0.5 * precision.reshape(len(means), -1), linear, constant]).T)

    def log_density(self, terms: Floats, *, own: bool) -> Floats:
        """Logarithm of the density at the terms of n outcomes; those drawn from this mixture leave out their own part.

        Each outcome of its own is drawn from the part in the same place.
        """
        logs = terms @ self.coefficients
        parts = len(self.coefficients.T)
        if own:
            np.fill_diagonal(logs, -np.inf)
            parts -= 1
        highest = logs.max(axis=1, keepdims=True)
        logs -= highest
        shares = np.exp(np.clip(logs, _NEGLIGIBLE, 0.0, out=logs), out=logs)
        return np.asarray(np.log(shares.sum(axis=1)) + highest[:, 0] - np.log(parts))


def _terms(outcomes: Floats) -> Floats:
    """Products, values and one: terms of a polynomial of second degree of n outcomes, shape (n, b * b + b + 1)."""
    products = outcomes[:, :, None] * outcomes[:, None, :]
    return np.column_stack([products.reshape(len(outcomes), -1), outcomes, np.ones(len(outcomes))])


@dataclass(frozen=True, kw_only=True, slots=True)
class Batch:
    """Batch of tests with the most expected information that was found.

    Parameters
    ----------
    points : tuple of int
        Candidates, in the order in which they were chosen.
    information : tuple of float
        Of the first, of the first two, and so on, in bits.
    """

    points: tuple[int, ...]
    information: tuple[float, ...]


def best_batch(
    models: Sequence[ModelOutcomes],
    *,
    count: int,
    noise: Floats,
    allowed: Integers,
    first: Sequence[int] = (),
    seed: int = 0,
) -> Batch:
    """Batch of tests with the most expected information, by greedy choice and then by exchanges.

    Mutual information with errors that are correlated between candidates need not be submodular, so that no bound of
    the greedy choice is claimed; tests compare with all batches of small rigs. All batches are compared with the
    same random numbers.

    References
    ----------
    .. [1] G. E. P. Box and W. J. Hill, Technometrics 9, 57 (1967): discrimination among models by expected entropy.
    .. [2] V. V. Fedorov, Theory of Optimal Experiments, Academic Press 1972: exchanges.
    """
    known: dict[tuple[int, ...], float] = {}

    def information(points: Iterable[int]) -> float:
        batch = tuple(sorted(points))  # the search meets many of them again
        if batch not in known:
            known[batch] = mutual_information(models, np.array(batch), noise=noise, seed=seed)
        return known[batch]

    candidates = [int(each) for each in allowed]
    chosen, kept = list(first), len(first)
    for _ in range(count - kept):
        chosen.append(_best_addition(information, chosen, candidates))
    for _ in range(_ROUNDS):
        if not _exchanged(information, chosen, candidates, kept=kept):
            break
    rest, chosen = chosen[kept:], chosen[:kept]
    while rest:  # exchanges leave another order than that of the gains
        chosen.append(_best_addition(information, chosen, rest))
        rest = [each for each in rest if each not in chosen]
    return Batch(points=tuple(chosen), information=tuple(information(chosen[:size]) for size in range(1, count + 1)))


def _best_addition(information: _Information, fixed: Sequence[int], candidates: Sequence[int]) -> int:
    """Candidate with which some tests have the most information."""
    rest = [each for each in candidates if each not in fixed]
    return rest[int(np.argmax([information([*fixed, each]) for each in rest]))]


def _exchanged(information: _Information, chosen: list[int], candidates: Sequence[int], *, kept: int) -> bool:
    """Exchange each test after those that are kept for the best candidate in its place; whether any was."""
    changed = False
    for place in range(kept, len(chosen)):
        fixed = chosen[:place] + chosen[place + 1 :]
        best = _best_addition(information, fixed, candidates)
        if information([*fixed, best]) > information(chosen) + _GAIN:
            chosen[place], changed = best, True
    return changed


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
    log_length = draws.hyperparameters[:, 5]
    deviations = draws.deviation(means, at.conditions)
    if own is not None:
        tested = own.at.conditions
        seen = draws.means(tested)
        near = discrepancy_correlation(at.conditions, tested, log_length=log_length)
        sides = draws.deviation(seen, tested)
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
