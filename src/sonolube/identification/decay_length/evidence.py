"""Evidence of a model with normal priors: its modes by least squares, then importance sampling."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from sonolube.checks import Floats

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
    from scipy.special import gammaln, logsumexp

    count = draws.shape[1]
    constant = gammaln((_FREEDOM + count) / 2) - gammaln(_FREEDOM / 2) - 0.5 * count * np.log(_FREEDOM * np.pi)
    logs = []
    for mean, factor in proposals:
        deviates = (draws - mean) @ np.linalg.inv(factor).T
        squares = np.sum(deviates**2, axis=1)
        bend = 0.5 * (_FREEDOM + count) * np.log1p(squares / _FREEDOM)
        logs.append(constant - np.log(np.diag(factor)).sum() - bend)
    return np.asarray(logsumexp(logs, axis=0) - np.log(len(logs)))
