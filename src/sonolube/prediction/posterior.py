"""Posterior given the published tests, shipped as draws, and draws of the parameters of one rig from it.

Tests of a rig weigh the draws. Where few of them would be left, sequential Monte Carlo conditions them: the likelihood
is raised step by step to its full power, and after each step the draws are resampled and moved by Metropolis steps.
Deviates are standard normal before the tests, so that a step costs one evaluation of the likelihood.

References
----------
P. Del Moral, A. Doucet and A. Jasra, J. R. Stat. Soc. B 68, 411 (2006). doi:10.1111/j.1467-9868.2006.00553.x
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from hashlib import sha256
from importlib.resources import files
from pathlib import Path
from typing import Any, Final

import numpy as np

from sonolube.checks import Floats, Integers
from sonolube.prediction.evidence import (
    CLOSURES,
    REFERENCE_DECAY_LENGTH,
    Closure,
    Conditions,
    TestedRig,
    UncertainConditions,
    published_rigs,
)
from sonolube.prediction.hierarchy import (
    HYPERPARAMETERS,
    OWN_DEVIATES,
    POPULATION_PRIOR,
    OwnParameters,
    Prior,
    RigLikelihood,
    covariance_of_tests,
    discrepancy_correlation,
    discrepancy_deviation,
    log_normal_density,
    standard_normals,
)
from sonolube.prediction.wear import WEAR_HYPERPARAMETERS, WearPosterior, published_wear
from sonolube.storage.files import write_atomically

LEARNED_FILE: Final = "learned.json"
"""Name of the data in this package."""

PRIOR_DRAWS: Final = 16384
"""Evenly spread draws from the prior, with which rigs are left out."""


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Posterior:
    """Posterior of one friction model.

    Parameters
    ----------
    closure : Closure
    hyperparameters : ndarray, shape (h, 6)
        Draws, equally probable: logarithms, in the order of `HYPERPARAMETERS`.
    """

    closure: Closure
    hyperparameters: Floats

    def decay_length(self) -> tuple[float, float]:
        """Median of the decay length of a worn contact on a further rig, in m, and the deviation of its logarithm."""
        kappa, tau_l = self.hyperparameters[:, 1], self.hyperparameters[:, 3]
        median = REFERENCE_DECAY_LENGTH * float(np.exp(np.median(kappa)))
        return median, float(np.sqrt(np.var(kappa) + np.mean(np.exp(2 * tau_l))))


@dataclass(frozen=True, kw_only=True, slots=True)
class Learned:
    """Posterior distribution given the published tests.

    Parameters
    ----------
    friction : Posterior
        Of the friction model that predicts.
    compared : tuple of Posterior
        Of all friction models that a test plan tells apart.
    wear : WearPosterior
    """

    friction: Posterior
    compared: tuple[Posterior, ...]
    wear: WearPosterior


@cache
def learned() -> Learned:
    """Posterior as shipped with the package.

    Returns
    -------
    Learned
    """
    content = json.loads(files(__package__).joinpath(LEARNED_FILE).read_text(encoding="utf-8"))
    known = {closure.name: closure for closure in CLOSURES}
    compared = tuple(
        Posterior(
            closure=known[name], hyperparameters=np.column_stack([entry["draws"][each] for each in HYPERPARAMETERS])
        )
        for name, entry in content["friction"].items()
    )
    wear = np.column_stack([content["wear"]["draws"][each] for each in WEAR_HYPERPARAMETERS])
    return Learned(friction=compared[0], compared=compared, wear=WearPosterior(hyperparameters=wear))


def write_learned(path: Path, *, friction: Mapping[str, Floats], wear: Floats) -> None:
    """Write the draws of each friction model, and those for wear, with the fingerprint of the tests."""
    content = {
        "evidence": evidence_fingerprint(),
        "friction": {name: {"draws": _columns(HYPERPARAMETERS, draws)} for name, draws in friction.items()},
        "wear": {"draws": _columns(WEAR_HYPERPARAMETERS, wear)},
    }
    write_atomically(path, json.dumps(content).replace("], ", "],\n") + "\n")  # one column a line


def evidence_fingerprint(further: Sequence[TestedRig] = (), *, laws: Sequence[Closure] = ()) -> str:
    """Hash of the shipped tests, further ones and the priors of all laws, by which stale data are recognised."""
    known = (*CLOSURES, *laws)
    numbers: list[Any] = [[closure.name, *np.round(np.ravel(POPULATION_PRIOR.of(closure)), 6)] for closure in known]
    numbers += [[rig.name, *rig_digits(rig)] for rig in (*published_rigs(), *further)]
    numbers += [[pair.name, *np.round(pair.wear_rate_ratio, 6), pair.uncertainty] for pair in published_wear()]
    return sha256(repr([list(map(str, row)) for row in numbers]).encode()).hexdigest()[:16]


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Population:
    """Draws from the prior of one friction model with their likelihoods, by which rigs are left out at no cost.

    Parameters
    ----------
    closure : Closure
    draws : ndarray, shape (h, 6)
        From the prior, evenly spread.
    log_likelihoods : ndarray, shape (h, r)
        Of each draw and each rig.
    """

    closure: Closure
    draws: Floats
    log_likelihoods: Floats

    @classmethod
    def of(cls, closure: Closure, rigs: Sequence[TestedRig], *, prior: Prior = POPULATION_PRIOR) -> "Population":
        """Population of some rigs under a prior."""
        means, deviations = prior.of(closure)
        draws = means + deviations * standard_normals(PRIOR_DRAWS, columns=len(HYPERPARAMETERS), seed=2)
        population = cls(closure=closure, draws=draws, log_likelihoods=np.zeros((len(draws), 0)))
        for rig in rigs:
            population = population.with_rig(rig)
        return population

    def with_rig(self, rig: TestedRig) -> "Population":
        """Population with the likelihood of a further rig, the last."""
        return self.with_likelihood(RigLikelihood(self.closure, rig)(self.draws))

    def with_likelihood(self, logs: Floats) -> "Population":
        """Population with the likelihood of a further rig, the last, where that is known."""
        return replace(self, log_likelihoods=np.column_stack([self.log_likelihoods, logs]))

    def of_first(self, count: int) -> "Population":
        """Population of the first rigs alone."""
        return replace(self, log_likelihoods=self.log_likelihoods[:, :count])

    def shares(self, *, without: tuple[int, ...] = ()) -> Floats:
        """Posterior probability of each draw by all rigs but some, shape (h,)."""
        total = np.delete(self.log_likelihoods, without, axis=1).sum(axis=1)
        return np.asarray(np.exp(total - np.logaddexp.reduce(total)))

    def posterior(self, *, without: tuple[int, ...] = ()) -> Posterior:
        """Posterior by all rigs but some, by importance resampling of the draws."""
        share = self.shares(without=without)
        rows = np.random.default_rng(0).choice(share.size, size=share.size, p=share)
        return Posterior(closure=self.closure, hyperparameters=self.draws[rows])


@cache
def published_population() -> Population:
    """Population of the published rigs under the friction model that predicts."""
    population = Population.of(CLOSURES[0], ())
    for place in range(len(published_rigs())):
        population = population.with_likelihood(published_likelihood(place))
    return population


@cache
def published_likelihood(place: int) -> Floats:
    """Logarithm of the likelihood of a published rig by each draw from the prior of the model that predicts."""
    return RigLikelihood(CLOSURES[0], published_rigs()[place])(Population.of(CLOSURES[0], ()).draws)


def _columns(names: Sequence[str], draws: Floats) -> dict[str, list[float]]:
    """Columns of draws by name, to four decimals of the logarithm."""
    return {name: np.round(column, 4).tolist() for name, column in zip(names, draws.T, strict=True)}


def rig_digits(rig: TestedRig) -> list[Any]:
    """Numbers of a rig without its name, rounded to what a rounding error of another processor leaves the same."""
    at = rig.at.conditions
    arrays = (at.vibration_amplitude, at.frequency, at.sliding_speed, at.decay_length, rig.friction_ratio)
    logs = [f"{value:.6g}" for array in (*arrays, rig.uncertainty) for value in array]
    return [*logs, rig.at.decay_length_spread, rig.at.amplitude_spread, rig.at.amplitude_factor]


_POOL: Final = 8192  # draws that are weighed
_ENOUGH: Final = 1000  # effective draws from which weighing alone does
_MOVED: Final = 2048  # draws that are moved, for up to some tens of tests
_MIN_MOVED: Final = 256  # for very many
_ENTRIES: Final = 4e6  # of all covariances of the tests, to bound time and memory
_KEPT: Final = 0.5  # effective share of the draws that a step keeps
_MOVES: Final = 4  # of each kind after each step
_LAST_MOVES: Final = 8
_STRIDE: Final = 1.2  # of a move, in standard deviations of the draws


@dataclass(frozen=True, slots=True, eq=False)
class RigDraws:
    """Equally probable draws of one friction model for one rig.

    Parameters
    ----------
    posterior : Posterior
    at : UncertainConditions
        Whose spreads are those of the rig.
    rows : ndarray of int, shape (p,)
        Of the hyperparameters.
    deviates : ndarray, shape (p, 3)
        What the rig has of its own.
    own : TestedRig or None
        Tests on which the draws, and the discrepancy, are conditioned.
    log_evidence : float
        Logarithm of the density of these tests.
    """

    posterior: Posterior
    at: UncertainConditions
    rows: Integers
    deviates: Floats
    own: TestedRig | None = None
    log_evidence: float = 0.0

    @property
    def hyperparameters(self) -> Floats:
        """Hyperparameters of each draw, shape (p, 6)."""
        return self.posterior.hyperparameters[self.rows]

    @property
    def parameters(self) -> OwnParameters:
        """Parameters of each draw."""
        return OwnParameters(self.hyperparameters, self.deviates, self.at)

    def means(self, conditions: Conditions) -> Floats:
        """Friction ratios of the friction model without discrepancy, shape (p, m). []"""
        own = self.parameters
        scaled = conditions.scaled(decay_length=np.exp(own.log_factor)[:, None])
        return np.asarray(self.posterior.closure.ratio(own.log_parameter[:, None], scaled))

    def normals(self, conditions: Conditions) -> tuple[Floats, Floats]:
        """Means and standard deviations of the normal distribution of the ratio by each draw, each of shape (p, m)."""
        mean = self.means(conditions)
        side = self.deviation(mean, conditions)
        if self.own is None:
            return mean, side
        tested = self.own.at.conditions
        seen = self.means(tested)
        near = discrepancy_correlation(conditions, tested, log_length=self.hyperparameters[:, 5])
        across = near * side[:, :, None] * self.deviation(seen, tested)[:, None, :]
        gain = np.swapaxes(np.linalg.solve(self.covariance(seen), np.swapaxes(across, 1, 2)), 1, 2)
        mean = mean + np.einsum("pmn,pn->pm", gain, self.own.friction_ratio - seen)
        return mean, np.sqrt(np.maximum(side**2 - np.einsum("pmn,pmn->pm", gain, across), 0.0))

    def deviation(self, ratio: Floats, conditions: Conditions) -> Floats:
        """Standard deviation of the discrepancy about ratios of the friction model by each draw, shape (p, m)."""
        own = self.parameters
        scaled = conditions.scaled(decay_length=np.exp(own.log_factor)[:, None])
        effect = self.posterior.closure.effect(own.log_parameter[:, None], scaled)
        return discrepancy_deviation(ratio, conditions, log_discrepancy=own.log_discrepancy, effect=effect)

    def covariance(self, seen: Floats) -> Floats:
        """Covariance of the rig's own tests about the ratios of the friction model, shape (p, n, n)."""
        assert self.own is not None
        deviation = self.deviation(seen, self.own.at.conditions)
        return covariance_of_tests(deviation, self.own, log_length=self.hyperparameters[:, 5])

    def bounds(self, conditions: Conditions) -> tuple[Floats, Floats]:
        """Lowest and highest mean ratio at conditions by each draw, shapes (p, m).

        Own tests that lie beyond a bound by twice their uncertainty, in any of the draws, lift it: to 0, or altogether.
        """
        low, high = self._admitted(conditions)
        if self.own is not None:
            least, most = self._admitted(self.own.at.conditions)
            measured, margin = self.own.friction_ratio, 2 * self.own.uncertainty
            low = np.zeros_like(low) if np.any(measured + margin < least) else low
            high = np.full_like(high, np.inf) if np.any(measured - margin > most) else high
        return low, high

    def _admitted(self, conditions: Conditions) -> tuple[Floats, Floats]:
        """Bounds of the friction ratio by the closure, by each draw."""
        scaled = conditions.scaled(decay_length=np.exp(self.parameters.log_factor)[:, None])
        shape = scaled.decay_length.shape
        low, high = (np.broadcast_to(each, shape) for each in self.posterior.closure.bounds(scaled))
        return np.asarray(low, dtype=np.float64), np.asarray(high, dtype=np.float64)

    def log_density(self) -> Floats:
        """Logarithm of the density of the rig's own tests by each draw, shape (p,)."""
        assert self.own is not None
        seen = self.means(self.own.at.conditions)
        return log_normal_density(self.own.friction_ratio - seen, self.covariance(seen))

    def taken(self, rows: Integers) -> "RigDraws":
        """Some of the draws, with repetition."""
        return replace(self, rows=self.rows[rows], deviates=self.deviates[rows])


def rig_draws(
    posterior: Posterior, at: UncertainConditions, *, count: int, seed: int = 0, own: TestedRig | None = None
) -> RigDraws:
    """Draws of a friction model for a rig that is none of those learned from, conditioned on its own tests.

    Of `count` draws without own tests, else of as many as are moved: from 256 to 2048.
    """
    if own is None:
        return _from_population(posterior, at, count=count, seed=seed)
    moved = int(np.clip(_ENTRIES / own.friction_ratio.size**2, _MIN_MOVED, _MOVED))
    pool = replace(_from_population(posterior, at, count=_POOL * moved // _MOVED, seed=seed), own=own)
    density = pool.log_density()
    if _effective(density) * _MOVED >= _ENOUGH * moved:
        rows = systematic_rows(density, moved, np.random.default_rng(seed + 11))
        return replace(pool.taken(rows), log_evidence=float(np.logaddexp.reduce(density) - np.log(density.size)))
    return _conditioned(pool.taken(np.arange(moved)), density[:moved], seed=seed)


def _from_population(posterior: Posterior, at: UncertainConditions, *, count: int, seed: int) -> RigDraws:
    """Draws before any test of the rig."""
    rows = np.random.default_rng(seed).permutation(np.arange(count) % len(posterior.hyperparameters))
    return RigDraws(posterior, at, rows, standard_normals(count, columns=OWN_DEVIATES, seed=seed + 3))


def _conditioned(draws: RigDraws, density: Floats, *, seed: int) -> RigDraws:
    """Draws conditioned on the own tests by sequential Monte Carlo, with the density of these."""
    rng = np.random.default_rng(seed + 11)
    power, evidence = 0.0, 0.0
    while power < 1.0:
        step = _step(density, power)
        weights = step * density
        evidence += float(np.logaddexp.reduce(weights) - np.log(weights.size))
        chosen = systematic_rows(weights, weights.size, rng)
        draws, density, power = draws.taken(chosen), density[chosen], min(power + step, 1.0)
        for _ in range(_MOVES if power < 1.0 else _LAST_MOVES):
            draws, density = _moved(draws, density, power, rng)
    return replace(draws, log_evidence=evidence)


def _step(density: Floats, power: float) -> float:
    """Largest rise of the power of the likelihood that keeps the effective number of draws."""

    def kept(step: float) -> float:
        return _effective(step * density) / density.size

    low, high = 0.0, 1.0 - power
    if kept(high) >= _KEPT:
        return high
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if kept(middle) >= _KEPT else (low, middle)
    return max(low, 1e-6)


def _moved(draws: RigDraws, density: Floats, power: float, rng: np.random.Generator) -> tuple[RigDraws, Floats]:
    """Draws after a Metropolis step of the deviates, and one of the hyperparameters."""
    count = density.size
    spread = np.linalg.cholesky(np.cov(draws.deviates.T) + 1e-9 * np.eye(OWN_DEVIATES))
    stride = _STRIDE * rng.choice([0.3, 1.0], size=(count, 1))
    nearby = replace(draws, deviates=draws.deviates + stride * rng.standard_normal((count, OWN_DEVIATES)) @ spread.T)
    prior = 0.5 * np.sum(draws.deviates**2 - nearby.deviates**2, axis=1)
    draws, density = _accepted(draws, nearby, density, prior, power, rng)
    other = replace(draws, rows=rng.integers(0, len(draws.posterior.hyperparameters), count))
    return _accepted(draws, other, density, np.zeros(count), power, rng)


def _accepted(
    draws: RigDraws, tried: RigDraws, density: Floats, prior: Floats, power: float, rng: np.random.Generator
) -> tuple[RigDraws, Floats]:
    """Draws with those of a proposal that Metropolis's rule accepts."""
    found = tried.log_density()
    taken = np.log(rng.random(density.size)) < prior + power * (found - density)
    rows = np.where(taken, tried.rows, draws.rows)
    deviates = np.where(taken[:, None], tried.deviates, draws.deviates)
    return replace(draws, rows=rows, deviates=deviates), np.where(taken, found, density)


def _effective(log_weights: Floats) -> float:
    """Effective number of draws by their weights."""
    return float(np.exp(2 * np.logaddexp.reduce(log_weights) - np.logaddexp.reduce(2 * log_weights)))


def systematic_rows(log_weights: Floats, count: int, rng: np.random.Generator) -> Integers:
    """Rows drawn systematically by weight, in their order, shape (count,)."""
    cumulative = np.cumsum(np.exp(log_weights - np.logaddexp.reduce(log_weights)))
    rows = np.searchsorted(cumulative, (np.arange(count) + rng.random()) / count)
    return np.minimum(rows, log_weights.size - 1)
