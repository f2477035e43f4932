"""Parameters of a model sought within bounds, on a logarithmic scale."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import differential_evolution, least_squares

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput
from sonolube.identification.fact import Fact, Observe, misses

Bounds = Mapping[str, tuple[float, float]]

_GENERATIONS, _EVALUATIONS = 100, 60
_SPREAD = 0.05  # of a population, over its mean, at which it has settled
_STEP = 1e-5  # of central differences, in the logarithm of a parameter
_AIM = 0.99  # of the tolerance, so that a search that only just converges still ends within
_GIVE_UP = 1e-2  # share by which a step must better a search that has not yet met its facts
_PULL = 1e-3  # of the middle of the bounds, in tolerances; it settles what no fact does
_WALL = 30.0  # times as much as within its tolerance counts a miss beyond


@dataclass(frozen=True, kw_only=True, slots=True)
class Search:
    """What is sought: the parameters of a model, within bounds.

    Parameters
    ----------
    observe : callable
        Takes parameters, each an array of shape (n,), and returns what n such systems show, by name.
    bounds : mapping of str to pair of float
        Lowest and highest value of each parameter, both positive.

    Raises
    ------
    InvalidInput
        If there is no parameter, or a bound is not positive or not below the other.
    """

    observe: Observe
    bounds: Bounds

    def __post_init__(self) -> None:
        if not self.bounds:
            raise InvalidInput("bounds must name at least one free parameter")
        for name, (lowest, highest) in self.bounds.items():
            require_positive(**{name: [lowest, highest]})
            if lowest >= highest:
                raise InvalidInput(f"bounds of {name} must rise, got {lowest:g} and {highest:g}")

    @property
    def lowest(self) -> Floats:
        """Logarithms of the lower bounds."""
        return np.log([lowest for lowest, _ in self.bounds.values()])

    @property
    def highest(self) -> Floats:
        """Logarithms of the upper bounds."""
        return np.log([highest for _, highest in self.bounds.values()])

    def observed(self, logarithms: Floats) -> Mapping[str, Floats]:
        """Return what systems show whose parameters have these logarithms, shape (n, parameters)."""
        return self.observe(dict(zip(self.bounds, np.exp(logarithms.T), strict=True)))


def meet(search: Search, facts: Sequence[Fact], *, seed: int) -> Floats | None:
    """Look over all of the bounds for parameters with which every fact holds within its tolerance.

    Parameters
    ----------
    search : Search
    facts : sequence of Fact
    seed : int
        Seed of the random numbers; where the region sought is small another may succeed where one fails.

    Returns
    -------
    ndarray, shape (parameters,), or None
        Logarithms of the parameters; None where none were found.

    Notes
    -----
    Differential evolution, then least squares from where that ends.
    """
    evolved = differential_evolution(
        lambda points: _outside(facts, search.observed(points.T)).sum(axis=1),
        list(zip(search.lowest, search.highest, strict=True)),
        seed=seed,
        maxiter=_GENERATIONS,
        popsize=10,
        tol=_SPREAD,
        polish=False,
        vectorized=True,
        updating="deferred",
        callback=lambda intermediate_result: bool(intermediate_result.fun <= 0),
    )
    return meet_near(search, facts, start=evolved.x)


def meet_near(
    search: Search, facts: Sequence[Fact], *, start: Floats, held: Mapping[int, float] | None = None
) -> Floats | None:
    """Look from one place on for parameters with which every fact holds within its tolerance.

    Parameters
    ----------
    search : Search
    facts : sequence of Fact
    start : ndarray, shape (parameters,)
        Logarithms of parameters to start from.
    held : mapping of int to float, optional
        Logarithms of parameters that are not sought, by their place.

    Returns
    -------
    ndarray, shape (parameters,), or None
        Logarithms of the parameters; None where none were found.
    """
    found = _least_squares(
        search, start, lambda points: _outside(facts, search.observed(points)), held=held or {}, ftol=_GIVE_UP
    )
    return found if np.abs(_misses(search, facts, found[np.newaxis])).max() <= 1 else None


def best(search: Search, facts: Sequence[Fact], *, starts: Sequence[Floats]) -> Floats:
    """Return logarithms of the parameters closest to the facts, within all tolerances where the starts are.

    Parameters
    ----------
    search : Search
    facts : sequence of Fact
    starts : sequence of ndarray, shape (parameters,)
        Logarithms of parameters to start from.

    Returns
    -------
    ndarray, shape (parameters,)
    """
    middle, half = (search.highest + search.lowest) / 2, (search.highest - search.lowest) / 2

    def cost(points: Floats) -> Floats:
        miss = _misses(search, facts, points)
        beyond = np.maximum(np.abs(miss) - 1, 0.0)
        return np.concatenate([miss, _WALL * beyond, _PULL * (points - middle) / half], axis=1)

    found = [_least_squares(search, start, cost, held={}, ftol=1e-8) for start in starts]
    return min(found, key=lambda point: float(np.sum(cost(point[np.newaxis]) ** 2)))


def sensitivities(search: Search, facts: Sequence[Fact], logarithms: Floats) -> Floats:
    """Return how fast each miss grows with the logarithm of each parameter, shape (facts, parameters)."""
    return _slopes(lambda points: _misses(search, facts, points), logarithms, np.arange(len(logarithms)))


def _misses(search: Search, facts: Sequence[Fact], points: Floats) -> Floats:
    return misses(facts, search.observed(points))


def _outside(facts: Sequence[Fact], observed: Mapping[str, Floats]) -> Floats:
    """Return how far, on a logarithmic scale, observed numbers lie outside what agrees with each fact."""
    columns = []
    for fact in facts:
        shown = np.log(np.maximum(observed[fact.name], np.finfo(float).tiny))
        reach = _AIM * fact.tolerance
        low = math.log(fact.value - reach) if fact.relation != "<=" and fact.value > reach else -math.inf
        high = math.log(fact.value + reach) if fact.relation != ">=" else math.inf
        columns.append(np.maximum(np.maximum(low - shown, shown - high), 0.0))
    return np.stack(columns, axis=-1)


def _least_squares(
    search: Search, start: Floats, cost: Callable[[Floats], Floats], *, held: Mapping[int, float], ftol: float
) -> Floats:
    sought = np.array([place for place in range(len(start)) if place not in held])
    point = start.copy()
    point[list(held)] = list(held.values())
    if not len(sought):
        return point

    def whole(part: Floats) -> Floats:
        full = point.copy()
        full[sought] = part
        return full

    inside = 1e-9 * (search.highest - search.lowest)[sought]
    lowest, highest = search.lowest[sought], search.highest[sought]
    found = least_squares(
        lambda part: cost(whole(part)[np.newaxis])[0],
        np.clip(point[sought], lowest + inside, highest - inside),
        jac=lambda part: _slopes(cost, whole(part), sought),
        bounds=(lowest, highest),
        ftol=ftol,
        max_nfev=_EVALUATIONS,
    )
    return whole(found.x)


def _slopes(function: Callable[[Floats], Floats], point: Floats, places: NDArray[np.intp]) -> Floats:
    steps = _STEP * np.eye(len(point))[places]
    values = function(np.concatenate([point + steps, point - steps]))
    return np.asarray((values[: len(places)] - values[len(places) :]).T / (2 * _STEP))
