"""Feasible points, least-squares estimates and posterior samples of bounded parameters, on a logarithmic scale.

Points are the natural logarithms of the parameters: a step is a relative change, and every parameter is positive.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq, differential_evolution, least_squares
from scipy.stats import qmc

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput
from sonolube.identification.fact import Bounds, Fact, ForwardModel, normalized_residuals

_GENERATIONS, _EVALUATIONS = 100, 60
_POPULATION_SPREAD = 0.05  # standard deviation over mean of the population's costs at which the evolution ends
_STEP = 1e-5  # of central differences, in the logarithm of a parameter
_TARGET = 0.99  # of the tolerance, so that a search that has only just converged still ends inside
_MIN_IMPROVEMENT = 1e-2  # relative, of a step of a search that has not yet reached the feasible set
_PRIOR_WEIGHT = 1e-3  # residual of a parameter at the end of its bounds, which fixes what no fact determines
_PENALTY = 30.0  # weight of a residual beyond the tolerance, over that within it


@dataclass(frozen=True, kw_only=True, slots=True)
class BoundedModel:
    """A forward model with bounds on its parameters.

    Parameters
    ----------
    model : callable
        Observables of n systems, by name, from arrays of shape (n,) of their parameters, by name.
    bounds : mapping of str to pair of float
        Lower and upper bound of each free parameter in SI, both positive.

    Raises
    ------
    InvalidInput
        If there is no parameter, or a bound is not positive or not below the other.
    """

    model: ForwardModel
    bounds: Bounds

    def __post_init__(self) -> None:
        if not self.bounds:
            raise InvalidInput("bounds must name at least one free parameter")
        for name, (lower, upper) in self.bounds.items():
            require_positive(**{name: [lower, upper]})
            if lower >= upper:
                raise InvalidInput(f"bounds of {name} must rise, got {lower:g} and {upper:g}")

    @property
    def lower(self) -> Floats:
        """Logarithms of the lower bounds, shape (parameters,)."""
        return np.log([lower for lower, _ in self.bounds.values()])

    @property
    def upper(self) -> Floats:
        """Logarithms of the upper bounds, shape (parameters,)."""
        return np.log([upper for _, upper in self.bounds.values()])

    def observables(self, points: Floats) -> Mapping[str, Floats]:
        """Observables at points of shape (n, parameters), each of shape (n,)."""
        return self.model(dict(zip(self.bounds, np.exp(points.T), strict=True)))

    def residuals(self, facts: Sequence[Fact], points: Floats) -> Floats:
        """Normalised residuals at points of shape (n, parameters), shape (n, facts)."""
        return normalized_residuals(facts, self.observables(points))


def find_feasible_point(bounded: BoundedModel, facts: Sequence[Fact], *, seed: int) -> Floats | None:
    """Point at which every fact holds within its tolerance, by global search over the bounds.

    Logarithms of the parameters; None where no feasible point was found, which does not prove that there is none.

    Differential evolution of the sum of constraint violations, then least squares from its best point.

    Source: R. Storn and K. Price, J. Glob. Optim. 11, 341 (1997). doi:10.1023/A:1008202821328
    """
    evolved = differential_evolution(
        lambda points: _violations(facts, bounded.observables(points.T)).sum(axis=1),
        list(zip(bounded.lower, bounded.upper, strict=True)),
        seed=seed,
        maxiter=_GENERATIONS,
        popsize=10,
        tol=_POPULATION_SPREAD,
        polish=False,
        vectorized=True,
        updating="deferred",
        callback=lambda intermediate_result: bool(intermediate_result.fun <= 0),
    )
    return find_feasible_point_near(bounded, facts, start=evolved.x)


def find_feasible_point_near(
    bounded: BoundedModel, facts: Sequence[Fact], *, start: Floats, fixed: Mapping[int, float] | None = None
) -> Floats | None:
    """Point at which every fact holds within its tolerance, by least squares from a starting point.

    Logarithms of the parameters; None where no feasible point was found.
    """
    found = _least_squares(
        bounded,
        start,
        lambda points: _violations(facts, bounded.observables(points)),
        fixed=fixed or {},
        ftol=_MIN_IMPROVEMENT,
    )
    return found if np.abs(bounded.residuals(facts, found[np.newaxis])).max() <= 1 else None


def least_squares_point(bounded: BoundedModel, facts: Sequence[Fact], *, starts: Sequence[Floats]) -> Floats:
    r"""Regularised least-squares estimate of the parameters, penalised outside the tolerances.

    Logarithms of the parameters of least cost over all starts.

    With the normalised residuals :math:`r_i`, the logarithms :math:`x_j` of the parameters, the middle
    :math:`\bar x_j` and half width :math:`h_j` of their bounds, the cost is

    .. math:: \sum_i r_i^2 + \sum_i \left(30 \max(|r_i| - 1, 0)\right)^2
        + \sum_j \left(10^{-3}\,\frac{x_j - \bar x_j}{h_j}\right)^2 .

    The last term leaves what no fact determines at the middle of its bounds.
    """
    middle, half_width = (bounded.upper + bounded.lower) / 2, (bounded.upper - bounded.lower) / 2

    def cost(points: Floats) -> Floats:
        residuals = bounded.residuals(facts, points)
        excess = np.maximum(np.abs(residuals) - 1, 0.0)
        return np.concatenate([residuals, _PENALTY * excess, _PRIOR_WEIGHT * (points - middle) / half_width], axis=1)

    found = [_least_squares(bounded, start, cost, fixed={}, ftol=1e-8) for start in starts]
    return min(found, key=lambda point: float(np.sum(cost(point[np.newaxis]) ** 2)))


def residual_jacobian(bounded: BoundedModel, facts: Sequence[Fact], point: Floats) -> Floats:
    """Jacobian of the normalised residuals with respect to the logarithms of the parameters, by central differences.

    Shape (facts, parameters).
    """
    return _central_differences(lambda points: bounded.residuals(facts, points), point, np.arange(len(point)))


def _violations(facts: Sequence[Fact], observed: Mapping[str, Floats]) -> Floats:
    """Distances of the logarithms of observables to the interval that agrees with each fact, shape (n, facts)."""
    logarithms = np.log(np.maximum(np.array([observed[fact.name] for fact in facts]), np.finfo(float).tiny)).T
    low, high = np.array([_agreeing_interval(fact) for fact in facts]).T
    return np.asarray(np.maximum(np.maximum(low - logarithms, logarithms - high), 0.0))


@cache
def _agreeing_interval(fact: Fact) -> tuple[float, float]:
    """Logarithms of the interval of an observable that agrees with a fact."""
    target = _TARGET * fact.tolerance
    low = math.log(fact.value - target) if fact.relation != "<=" and fact.value > target else -math.inf
    return low, math.log(fact.value + target) if fact.relation != ">=" else math.inf


def _least_squares(
    bounded: BoundedModel, start: Floats, cost: Callable[[Floats], Floats], *, fixed: Mapping[int, float], ftol: float
) -> Floats:
    """Bounded least-squares minimum of a vector of residuals over the parameters that are not fixed."""
    free = np.array([index for index in range(len(start)) if index not in fixed])
    point = start.copy()
    point[list(fixed)] = list(fixed.values())
    if not len(free):
        return point

    def full(part: Floats) -> Floats:
        whole = point.copy()
        whole[free] = part
        return whole

    margin = 1e-9 * (bounded.upper - bounded.lower)[free]
    lower, upper = bounded.lower[free], bounded.upper[free]
    found = least_squares(
        lambda part: cost(full(part)[np.newaxis])[0],
        np.clip(point[free], lower + margin, upper - margin),
        jac=lambda part: _central_differences(cost, full(part), free),
        bounds=(lower, upper),
        ftol=ftol,
        max_nfev=_EVALUATIONS,
    )
    return full(found.x)


def _central_differences(function: Callable[[Floats], Floats], point: Floats, indices: NDArray[np.intp]) -> Floats:
    """Jacobian of a vectorised function with respect to some coordinates of a point, shape (values, indices)."""
    steps = _STEP * np.eye(len(point))[indices]
    values = function(np.concatenate([point + steps, point - steps]))
    return np.asarray((values[: len(indices)] - values[len(indices) :]).T / (2 * _STEP))


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
