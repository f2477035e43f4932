"""Evidence of models with normal priors by importance sampling, and the posterior of changes in a run."""

import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import files
from itertools import product
from typing import Any, Final

import numpy as np
from scipy.special import gammaln, logsumexp

from sonolube.checks import Floats
from sonolube.identification.decay_length.run_model import PARAMETERS, Changes, Channel, RunModel
from sonolube.identification.decay_length.switch_table import SwitchConditions, SwitchTable

_STEPS: Final = 40
_DRAWS: Final = 1200  # of a round
_ROUNDS: Final = 12  # at most, beside one for each start
_ENOUGH: Final = 150.0  # effective draws that end them
_POWERS: Final = 0.7 ** np.arange(30)  # of weights that are tempered
_WIDENED: Final = 1.2  # scale matrix over covariance
_FREEDOM: Final = 6.0  # of the multivariate t distribution that is drawn from


Residuals = Callable[[Floats], Floats]
"""White residuals with unit variance, shape (n, readings), of standard normal deviates, shape (n, parameters)."""


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Evidence:
    """Marginal likelihood of a model and draws from its posterior.

    Parameters
    ----------
    log_evidence : float
        Natural logarithm, less a constant of the data.
    mode : ndarray, shape (parameters,)
        Deviates of the highest posterior density.
    draws : ndarray, shape (n, parameters)
        Deviates of all rounds of sampling.
    weights : ndarray, shape (n,)
        Of the draws, with the sum 1.
    effective_draws : float
        Draws of equal weight with the same error.
    """

    log_evidence: float
    mode: Floats
    draws: Floats
    weights: Floats
    effective_draws: float


def evidence(residuals: Residuals, *, starts: Floats, seed: int = 0) -> Evidence:
    """Marginal likelihood by adaptive importance sampling, beginning with t distributions at the modes.

    `starts` has shape (starts, parameters).

    Each round draws from a t distribution with mean and covariance of all draws before; the weight of a draw is its
    posterior density over the mean density of all rounds

    Source: J.-M. Cornuet, J.-M. Marin, A. Mira, C. P. Robert, Scand. J. Stat. 39, 798 (2012).
    doi:10.1111/j.1467-9469.2011.00756.x
    """
    parameters = starts.shape[1]
    found = [_mode(residuals, start) for start in starts]
    rng = np.random.default_rng(seed)
    proposals = [(at, np.linalg.cholesky(_WIDENED * np.linalg.inv(precision))) for at, precision, _ in found]
    draws = np.concatenate([_t_draws(rng, *proposal) for proposal in proposals])
    log_posterior = _log_posterior(residuals, draws)
    log_weights = log_posterior - _log_mixture(draws, proposals)
    for _ in range(_ROUNDS):
        if _effective(log_weights) >= _ENOUGH:
            break
        milder = _tempered(log_weights, 10.0 * parameters)
        mean = milder @ draws
        rest = draws - mean
        covariance = (milder[:, None] * rest).T @ rest + 1e-6 * np.eye(parameters)
        proposals.append((mean, np.linalg.cholesky(_WIDENED * covariance)))
        fresh = _t_draws(rng, *proposals[-1])
        draws = np.concatenate([draws, fresh])
        log_posterior = np.concatenate([log_posterior, _log_posterior(residuals, fresh)])
        log_weights = log_posterior - _log_mixture(draws, proposals)
    weights = np.exp(log_weights - log_weights.max())
    return Evidence(
        log_evidence=float(log_weights.max() + np.log(weights.mean())),
        mode=min(found, key=lambda each: each[2])[0],
        draws=draws,
        weights=weights / weights.sum(),
        effective_draws=_effective(log_weights),
    )


def _effective(log_weights: Floats) -> float:
    """Number of draws of equal weight with the same error."""
    weights = np.exp(log_weights - log_weights.max())
    return float(weights.sum() ** 2 / np.sum(weights**2))


def _tempered(log_weights: Floats, fewest: float) -> Floats:
    """Weights raised to the highest power of a sequence at which enough draws are effective; their sum is 1."""
    for power in _POWERS:
        weights = np.exp(power * (log_weights - log_weights.max()))
        weights /= weights.sum()
        if 1 / np.sum(weights**2) >= fewest:
            break
    return np.asarray(weights)


def _log_posterior(residuals: Residuals, deviates: Floats) -> Floats:
    """Logarithm of likelihood times prior density, less a constant of the data."""
    rest = residuals(deviates)
    prior = np.sum(deviates**2, axis=1) + deviates.shape[1] * np.log(2 * np.pi)
    return np.asarray(-0.5 * (np.sum(rest**2, axis=1) + prior))


def _mode(residuals: Residuals, start: Floats) -> tuple[Floats, Floats, float]:
    """Mode of the posterior by damped Gauss-Newton steps, its precision, and the sum of squares there."""
    at, damping = start, 1e-2
    count = start.size
    pushes = 1e-4 * np.eye(count)
    jacobian, rest = np.zeros((0, count)), np.zeros(0)
    cost = np.inf
    for _ in range(_STEPS):
        batch = residuals(np.vstack([at, at + pushes]))
        rest = batch[0]
        jacobian = (batch[1:] - rest).T / 1e-4
        cost = float(rest @ rest + at @ at)
        gradient = jacobian.T @ rest + at
        normal = jacobian.T @ jacobian + np.eye(count)
        dampings = damping * np.array([0.01, 0.1, 1.0, 10.0, 100.0])
        steps = np.stack([np.linalg.solve(normal + each * np.diag(np.diag(normal)), -gradient) for each in dampings])
        steps *= np.minimum(1.0, 3.0 / np.linalg.norm(steps, axis=1, keepdims=True))
        tried = at + steps
        costs = np.sum(residuals(tried) ** 2, axis=1) + np.sum(tried**2, axis=1)
        best = int(np.argmin(costs))
        damping = float(np.clip(dampings[best], 1e-8, 1e8))
        if costs[best] >= cost - 1e-7:
            if costs[best] >= cost:
                damping *= 100
                if damping > 1e6:
                    break
                continue
            at = tried[best]
            break
        at = tried[best]
    return at, jacobian.T @ jacobian + np.eye(count), cost


def _t_draws(rng: np.random.Generator, mean: Floats, factor: Floats) -> Floats:
    """Draws from a multivariate t distribution by the Cholesky factor of its scale matrix."""
    normal = rng.standard_normal((_DRAWS, mean.size))
    stretch = np.sqrt(_FREEDOM / rng.chisquare(_FREEDOM, (_DRAWS, 1)))
    return np.asarray(mean + normal * stretch @ factor.T)


def _log_mixture(draws: Floats, proposals: Sequence[tuple[Floats, Floats]]) -> Floats:
    """Logarithm of the mean density of multivariate t distributions at draws."""
    count = draws.shape[1]
    constant = gammaln((_FREEDOM + count) / 2) - gammaln(_FREEDOM / 2) - 0.5 * count * np.log(_FREEDOM * np.pi)
    logs = []
    for mean, factor in proposals:
        deviates = (draws - mean) @ np.linalg.inv(factor).T
        squares = np.sum(deviates**2, axis=1)
        bend = 0.5 * (_FREEDOM + count) * np.log1p(squares / _FREEDOM)
        logs.append(constant - np.log(np.diag(factor)).sum() - bend)
    return np.asarray(logsumexp(logs, axis=0) - np.log(len(logs)))


@dataclass(frozen=True, kw_only=True, slots=True)
class Hypothesis:
    """What sets the decay length: in two words, in a sentence, and how its change is measured."""

    title: str
    meaning: str = ""
    change: str = ""


DECISION_TEXTS: Final[Mapping[str, Any]] = tomllib.loads(
    files("sonolube.identification.decay_length").joinpath("hypotheses.toml").read_text(encoding="utf-8")
)
"""Hypotheses, names of readings, and what tells two hypotheses apart."""

HYPOTHESES: Final = {name: Hypothesis(**entry) for name, entry in DECISION_TEXTS["hypotheses"].items()}
"""Hypotheses about what sets the decay length by name."""

_SEVERAL: Final = 0.1  # prior probability of more than one change, shared by four combinations
_OTHER: Final = 0.05  # prior probability that the friction ratio changes by itself
_DRIFT: Final = PARAMETERS.index("drift")
_DISTANCES: Final = tuple(PARAMETERS.index(name) for name in ("growth_distance", "fall_distance", "drift_distance"))
_TURNED: Final = PARAMETERS.index("turned_share")
_STARTS: Final = ((0.0, 0.0), (-2.0, 0.0), (1.0, 1.0), (0.0, -1.0))  # deviates of the distances, and of that share
_COUNT: Final = 4000  # draws from all models together
_MATTERS: Final = 0.01  # posterior probability from which a model matters


@dataclass(frozen=True, slots=True)
class Combination:
    """Which quantities change in a run.

    Parameters
    ----------
    changes : Changes
        Those on which the readings beside the zero depend.
    off : bool
        Whether the zero is off.
    """

    changes: Changes
    off: bool

    @property
    def parts(self) -> tuple[str, ...]:
        """Names of the hypotheses whose changes it has."""
        grows, falls, drifts, _ = self.changes
        flags = {"long_sliding": grows, "zero_error": self.off, "detuning": falls, "other": drifts}
        return tuple(name for name, flag in flags.items() if flag)

    @property
    def hypothesis(self) -> str:
        """Name of the hypothesis that it belongs to."""
        parts = self.parts
        return "none" if not parts else parts[0] if len(parts) == 1 else "several"

    @property
    def prior(self) -> float:
        """Prior probability."""
        alone = _OTHER if self.changes.drifts else (1 - _SEVERAL - _OTHER) / 4
        own = _SEVERAL / 4 if len(self.parts) > 1 else alone
        return own / 2 if self.changes.falls else own


COMBINATIONS: Final = (
    *(
        Combination(Changes(grows, falls, False, follows), off)
        for grows, falls, off, follows in product((False, True), repeat=4)
        if falls or follows
    ),
    Combination(Changes(False, False, True, True), False),
)
"""All combinations of changes; where the amplitude does not fall, that at large drive follows it by convention."""


class RunPosterior:
    """Evidence of every combination, with the posterior draws of their parameters.

    Parameters
    ----------
    table : SwitchTable
    conditions : SwitchConditions
    channels : tuple of Channel
    zero_log_ratio : float
        Logarithm of the evidence of a zero that is off over that of a good one.
    seed : int
        Of the random numbers.
    """

    def __init__(
        self,
        table: SwitchTable,
        conditions: SwitchConditions,
        *,
        channels: tuple[Channel, ...],
        zero_log_ratio: float,
        seed: int,
    ) -> None:
        self._seed = seed
        self.models: dict[Changes, tuple[RunModel, Evidence]] = {}
        for each in COMBINATIONS:
            if each.changes not in self.models:
                model = RunModel(table, conditions, each.changes, channels=channels)
                self.models[each.changes] = model, evidence(model.residuals, starts=_starts(), seed=seed)
        logs = np.array(
            [
                np.log(each.prior) + self._log_evidence(each) + (zero_log_ratio if each.off else 0.0)
                for each in COMBINATIONS
            ]
        )
        self.weights: Mapping[Combination, float] = dict(
            zip(COMBINATIONS, np.exp(logs - logsumexp(logs)).tolist(), strict=True)
        )

    def fit_of(self, combination: Combination) -> tuple[RunModel, Evidence]:
        """Model of a combination with its evidence."""
        return self.models[combination.changes]

    def _log_evidence(self, combination: Combination) -> float:
        """Logarithm of the evidence; a friction ratio that changes by itself has a moment prior."""
        found = self.fit_of(combination)[1]
        moment = float(found.weights @ found.draws[:, _DRIFT] ** 2) if combination.changes.drifts else 1.0
        return found.log_evidence + float(np.log(moment))

    @property
    def probabilities(self) -> dict[str, float]:
        """Posterior probability of each hypothesis."""
        found = dict.fromkeys(HYPOTHESES, 0.0)
        for combination, weight in self.weights.items():
            found[combination.hypothesis] += weight
        return found

    def best(self, hypothesis: str) -> Combination:
        """Most probable combination of a hypothesis."""
        return max((each for each in COMBINATIONS if each.hypothesis == hypothesis), key=self.weights.__getitem__)

    @property
    def effective_draws(self) -> float:
        """Least number of effective draws of a model whose posterior probability is at least 0.01."""
        return min(self.fit_of(each)[1].effective_draws for each, weight in self.weights.items() if weight >= _MATTERS)

    def draws(self) -> tuple[Floats, Floats]:
        """Decay length and amplitude at each switch, shape (n, switches) each, drawn from all combinations."""
        rng = np.random.default_rng(self._seed)
        shares = dict.fromkeys(self.models, 0.0)
        for each, weight in self.weights.items():
            shares[each.changes] += weight
        lengths, amplitudes = [], []
        for changes, share in shares.items():
            model, found = self.models[changes]
            rows = rng.choice(len(found.weights), size=round(share * _COUNT), p=found.weights)
            length, amplitude = model.courses(found.draws[rows])
            lengths.append(length)
            amplitudes.append(amplitude)
        return np.concatenate(lengths), np.concatenate(amplitudes)


def _starts() -> Floats:
    """Deviates from which modes are sought, a row each."""
    starts = np.zeros((len(_STARTS), len(PARAMETERS)))
    for row, (distances, turned) in zip(starts, _STARTS, strict=True):
        row[list(_DISTANCES)], row[_TURNED] = distances, turned
    return starts
