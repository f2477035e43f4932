r"""Feasible points and least-squares estimates of bounded parameters, on a logarithmic scale.

Points are the natural logarithms of the parameters: a step is a relative change, and every parameter is positive.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import differential_evolution, least_squares

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
