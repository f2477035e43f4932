"""Parameters identified from facts that need not all hold together."""

from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.identification.fact import Fact, Observe, misses
from sonolube.identification.fit import Bounds, Search, best, meet, meet_near, sensitivities
from sonolube.identification.record import Direction, Estimate, Identification, Reading
from sonolube.identification.weighing import weigh

_STARTS = 10  # of the search for the best parameters under the reading that is believed
_HALVINGS = 14  # of the way from the estimate to a bound, in search of an interval's end


def identify(observe: Observe, *, facts: Sequence[Fact], bounds: Bounds, seed: int = 0) -> Identification:
    """Identify parameters from facts, and say which facts hold together and which parameters stay free.

    Parameters
    ----------
    observe : callable
        The model: takes a mapping of each parameter to an array of shape (n,), returns what n such systems show.
    facts : sequence of Fact
        At most 16, each of something observed, the more trusted first among equals of rank.
    bounds : mapping of str to pair of float
        Lowest and highest value of each parameter sought, both positive.
    seed : int
        Seed of the searches; the same seed gives the same answer.

    Returns
    -------
    Identification

    Raises
    ------
    InvalidInput
        If there are no facts or more than 16, two of one name, a fact that no system within the bounds can meet, or
        bounds that are not positive and rising.
    UnknownName
        If a fact is of something not observed.

    Notes
    -----
    A compromise between facts that contradict each other would meet none of them. So all largest sets of facts that can
    be met together, each within its tolerance, are found first; the one that keeps most facts of rank 1, then most of
    rank 2 and so on, is believed, and the parameters are the least-squares fit to it alone. What no fact settles is
    left at the middle of its bounds on a logarithmic scale. Directions are those of the singular values of the fit's
    Jacobian; limits that are kept with room to spare do not enter them. An interval is sought from the estimate
    outwards and takes for granted that it has no gap.
    """
    _require_distinct(facts)
    search = Search(observe=observe, bounds=bounds)
    misses(facts, search.observed(search.lowest[np.newaxis]))  # refuses what is not observed before the long search
    weighed = weigh(search, facts, seed=seed)
    first, *others = sorted(weighed.systems, key=lambda kept: _trust(kept, facts), reverse=True)
    believed = [fact for fact in facts if fact.name in first]
    more = [meet(search, believed, seed=seed + i) for i in range(_STARTS)]
    readings = [
        _reading(search, facts, first, (*weighed.systems[first], *(point for point in more if point is not None))),
        *(_reading(search, facts, kept, weighed.systems[kept]) for kept in others),
    ]
    point = np.log(list(readings[0].parameters.values()))
    return Identification(
        facts=tuple(facts),
        observed=_only(search.observed(point[np.newaxis]), facts),
        estimates=MappingProxyType(
            {name: _estimate(search, believed, point, place) for place, name in enumerate(search.bounds)}
        ),
        directions=_directions(search, believed, point),
        readings=tuple(readings),
        conflicts=weighed.compatibility.conflicts,
    )


def _require_distinct(facts: Sequence[Fact]) -> None:
    if not facts:
        raise InvalidInput("facts must not be empty")
    names = [fact.name for fact in facts]
    for name in names:
        if names.count(name) > 1:
            raise InvalidInput(f"facts must differ in name, got {name} twice")


def _reading(search: Search, facts: Sequence[Fact], kept: frozenset[str], starts: Sequence[Floats]) -> Reading:
    believed = [fact for fact in facts if fact.name in kept]
    point = best(search, believed, starts=starts)
    miss = misses(facts, search.observed(point[np.newaxis]))[0]
    return Reading(
        kept=kept,
        parameters=MappingProxyType(dict(zip(search.bounds, np.exp(point).tolist(), strict=True))),
        misses=MappingProxyType(dict(zip((fact.name for fact in facts), miss.tolist(), strict=True))),
    )


def _trust(kept: frozenset[str], facts: Sequence[Fact]) -> tuple[list[int], list[bool]]:
    ranks = sorted({fact.rank for fact in facts})
    counts = [sum(fact.name in kept for fact in facts if fact.rank == rank) for rank in ranks]
    return counts, [fact.name in kept for fact in facts]


def _only(observed: Mapping[str, Floats], facts: Sequence[Fact]) -> Mapping[str, float]:
    return MappingProxyType({fact.name: float(observed[fact.name][0]) for fact in facts})


def _estimate(search: Search, facts: Sequence[Fact], point: Floats, place: int) -> Estimate:
    lower, lower_is_bound = _reach(search, facts, point, place, float(search.lowest[place]))
    upper, upper_is_bound = _reach(search, facts, point, place, float(search.highest[place]))
    return Estimate(
        value=float(np.exp(point[place])),
        lower=float(np.exp(lower)),
        upper=float(np.exp(upper)),
        lower_is_bound=lower_is_bound,
        upper_is_bound=upper_is_bound,
    )


def _reach(search: Search, facts: Sequence[Fact], point: Floats, place: int, bound: float) -> tuple[float, bool]:
    """Return how far towards a bound one parameter can go, the others adapting, and whether the bound stops it."""
    near, far = float(point[place]), bound
    start = point
    for halving in range(_HALVINGS + 1):
        trial = far if halving == 0 else (near + far) / 2
        found = meet_near(search, facts, start=start, held={place: trial})
        if found is None:
            far = trial
        elif halving == 0:
            return bound, True
        else:
            near, start = trial, found
    return near, False


def _directions(search: Search, facts: Sequence[Fact], point: Floats) -> tuple[Direction, ...]:
    slopes = sensitivities(search, facts, point)
    _, singular, rows = np.linalg.svd(np.vstack([slopes, np.zeros((len(point), len(point)))]))
    largest = np.take_along_axis(rows, np.abs(rows).argmax(axis=1)[:, np.newaxis], axis=1)
    return tuple(
        Direction(
            exponents=MappingProxyType(dict(zip(search.bounds, row.tolist(), strict=True))), sensitivity=float(value)
        )
        for value, row in zip(singular[::-1], (rows * np.sign(largest))[::-1], strict=True)
    )
