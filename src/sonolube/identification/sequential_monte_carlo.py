"""Posterior samples of parameters given facts, by sequential Monte Carlo with differential-evolution moves."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.stats import qmc

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.identification.bounded_search import BoundedModel
from sonolube.identification.fact import Bounds, Fact, ForwardModel

Advance = Callable[[int, int], None]
_LogLikelihood = Callable[[Floats], Floats]

_POPULATIONS = 4
_MOVES = 20  # of every sample at each temperature
_EFFECTIVE_FRACTION = 0.8  # effective over actual sample size after a step of the temperature
_SHORTEST, _LONGEST = 1e-3, 1.0  # moves, over the difference of two other samples
_CONVERGED = 1.1  # potential scale reduction
_UNINFORMED = 0.9  # posterior over prior standard deviation from which on the facts say nothing of a parameter


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Posterior:
    """Joint posterior samples of parameters.

    Parameters
    ----------
    draws : dict of str to ndarray, shape (n,)
        Samples of each parameter in SI; those of one index belong together.
    unidentified : tuple of str
        Parameters whose posterior is nearly as wide as the prior.
    potential_scale_reduction : float
        Standard deviation of all populations together over the mean of that within each (Gelman and Rubin's R-hat for
        the logarithms), the largest of any parameter; 1 where the populations agree.
    """

    draws: dict[str, Floats]
    unidentified: tuple[str, ...]
    potential_scale_reduction: float

    @property
    def has_converged(self) -> bool:
        """Whether the potential scale reduction is below 1.1."""
        return self.potential_scale_reduction < _CONVERGED


def posterior(
    model: ForwardModel,
    *,
    facts: Sequence[Fact],
    bounds: Bounds,
    draws: int = 4096,
    seed: int = 0,
    advance: Advance | None = None,
) -> Posterior:
    r"""Joint posterior samples of bounded parameters given facts.

    Parameters
    ----------
    model : callable
        Forward model: observables of n systems, by name, from arrays of shape (n,) of their parameters, by name.
    facts : sequence of Fact
        Facts taken for true, such as the satisfied ones of an identification.
    bounds : mapping of str to pair of float
        Lower and upper bound of each parameter in SI, both positive.
    draws : int
        Number of samples, a multiple of 4 of at least 256.
    seed : int
        Seed of the random numbers.
    advance : callable, optional
        Called with the number of populations done and their total.

    Returns
    -------
    Posterior

    Raises
    ------
    InvalidInput
        If there are no facts, or `draws` is not a multiple of 4 of at least 256.
    UnknownName
        If a fact names no observable of the model.

    See Also
    --------
    identify : Feasible intervals, and which facts hold together.

    Notes
    -----
    The prior is uniform in the logarithms of the parameters between the bounds. A tolerance counts as one standard
    deviation of a normal error, so that with the normalised residuals :math:`r_i`

    .. math:: \ln p(x \mid \text{facts}) = -\tfrac12 \sum_i r_i(x)^2 + \text{const.}

    Four independent populations start from Latin hypercube samples of the prior. The likelihood is raised to a power
    that grows from 0 to 1 in steps that keep the effective sample size at 80 % [1]_; at each step the samples are
    resampled systematically and moved along differences of two others [2]_, of lengths of all orders, so that they
    also cover narrow, bent or separate regions. Convergence is judged by the scale reduction between populations [3]_.

    References
    ----------
    .. [1] P. Del Moral, A. Doucet, A. Jasra, J. R. Stat. Soc. B 68, 411 (2006). doi:10.1111/j.1467-9868.2006.00553.x
    .. [2] C. J. F. ter Braak, Stat. Comput. 16, 239 (2006). doi:10.1007/s11222-006-8769-1
    .. [3] A. Gelman and D. B. Rubin, Stat. Sci. 7, 457 (1992). doi:10.1214/ss/1177011136
    """
    if not facts:
        raise InvalidInput("facts must not be empty")
    if draws < 256 or draws % _POPULATIONS:
        raise InvalidInput(f"draws must be a multiple of {_POPULATIONS} and at least 256, got {draws}")
    bounded = BoundedModel(model=model, bounds=bounds)

    def log_likelihood(points: Floats) -> Floats:
        """Logarithm of the likelihood at points of shape (n, parameters), up to a constant, shape (n,)."""
        return np.asarray(-0.5 * np.sum(bounded.residuals(facts, points) ** 2, axis=1))

    found = []
    for index in range(_POPULATIONS):
        found.append(_population(bounded, log_likelihood, draws // _POPULATIONS, np.random.default_rng([seed, index])))
        if advance is not None:
            advance(index + 1, _POPULATIONS)
    populations = np.stack(found)
    samples = populations.reshape(draws, -1)
    prior_deviation = (bounded.upper - bounded.lower) / np.sqrt(12)
    uninformed = samples.std(axis=0) > _UNINFORMED * prior_deviation
    return Posterior(
        draws={name: np.exp(column) for name, column in zip(bounds, samples.T, strict=True)},
        unidentified=tuple(name for name, wide in zip(bounds, uninformed, strict=True) if wide),
        potential_scale_reduction=float((samples.std(axis=0) / populations.std(axis=1).mean(axis=0)).max()),
    )


def _population(
    bounded: BoundedModel, log_likelihood: _LogLikelihood, count: int, random: np.random.Generator
) -> Floats:
    """Logarithms of the parameters of one population of samples, shape (count, parameters)."""
    unit = qmc.LatinHypercube(d=len(bounded.bounds), rng=random).random(count)
    samples = np.asarray(bounded.lower + (bounded.upper - bounded.lower) * unit)
    likelihoods, power = log_likelihood(samples), 0.0
    while power < 1:
        increment = _next_power(likelihoods, power) - power
        indices = _systematic_resampling(np.exp(increment * (likelihoods - likelihoods.max())), random)
        samples, likelihoods, power = samples[indices], likelihoods[indices], power + increment
        for _ in range(_MOVES):
            for own, proposal in _proposals(samples, random):
                inside = np.all((proposal >= bounded.lower) & (proposal <= bounded.upper), axis=1)
                proposed = log_likelihood(np.clip(proposal, bounded.lower, bounded.upper))
                accepted = inside & (np.log(random.random(own.size)) < power * (proposed - likelihoods[own]))
                samples[own[accepted]], likelihoods[own[accepted]] = proposal[accepted], proposed[accepted]
    return samples


def _next_power(log_likelihood: Floats, power: float) -> float:
    """Largest power of the likelihood that keeps the effective sample size at its fraction, 1 at most."""

    def surplus(increment: float) -> float:
        weights = np.exp(increment * (log_likelihood - log_likelihood.max()))
        return float(weights.sum() ** 2 / np.sum(weights**2) - _EFFECTIVE_FRACTION * weights.size)

    rest = 1 - power
    return 1.0 if surplus(rest) >= 0 else power + float(brentq(surplus, 0.0, rest, xtol=1e-12 * rest))


def _systematic_resampling(weights: Floats, random: np.random.Generator) -> NDArray[np.intp]:
    """Indices drawn in proportion to weights, at even steps of their cumulative sum from one random offset."""
    cumulative = np.cumsum(weights) / weights.sum()
    indices = np.searchsorted(cumulative, (np.arange(cumulative.size) + random.random()) / cumulative.size)
    return np.asarray(np.minimum(indices, cumulative.size - 1), dtype=np.intp)


def _proposals(samples: Floats, random: np.random.Generator) -> Iterator[tuple[NDArray[np.intp], Floats]]:
    """Yield the indices of either half of the samples, and these moved along differences of two of the other half."""
    one, two = np.array_split(random.permutation(len(samples)), 2)
    for own, others in ((one, two), (two, one)):
        first = random.integers(others.size, size=own.size)
        second = (first + random.integers(1, others.size, size=own.size)) % others.size
        length = np.exp(random.uniform(np.log(_SHORTEST), np.log(_LONGEST), (own.size, 1)))
        yield own, samples[own] + length * (samples[others[first]] - samples[others[second]])
