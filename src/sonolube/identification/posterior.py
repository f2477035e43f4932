"""What facts leave of parameters: joint draws, of those that no fact settles too, for uncertainty to be carried on."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.stats import qmc

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.identification.fact import Fact, Observe, misses
from sonolube.identification.fit import Bounds, Search

Advance = Callable[[int, int], None]

_POPULATIONS = 4
_MOVES = 20  # between two temperatures
_EFFECTIVE = 0.8  # share of a population that still counts after a step of the temperature
_SHORTEST, _LONGEST = 1e-3, 1.0  # moves, in differences between two others
_SETTLED = 1.1
_FREE = 0.9  # of the width that the bounds alone would give


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Posterior:
    """Joint draws of parameters.

    Parameters
    ----------
    draws : dict of str to ndarray, shape (n,)
        Values of each parameter; those of one place belong together.
    free : tuple of str
        Parameters nearly as wide as their bounds: the facts say next to nothing of them.
    scale_reduction : float
        Spread of independent populations together over that of each, the largest of any parameter; near 1 where they
        agree.
    """

    draws: dict[str, Floats]
    free: tuple[str, ...]
    scale_reduction: float

    @property
    def has_settled(self) -> bool:
        """Whether independent populations agree."""
        return self.scale_reduction < _SETTLED


def posterior(
    observe: Observe,
    *,
    facts: Sequence[Fact],
    bounds: Bounds,
    draws: int = 4096,
    seed: int = 0,
    advance: Advance | None = None,
) -> Posterior:
    """Return draws of the parameters as facts leave them.

    Parameters
    ----------
    observe : callable
        The model: takes a mapping of each parameter to an array of shape (n,), returns what n such systems show.
    facts : sequence of Fact
        Those that are believed, such as the kept ones of an identification. A tolerance counts as one standard
        deviation of a normal error; a limit costs nothing where it is kept.
    bounds : mapping of str to pair of float
        Lowest and highest value of each parameter, both positive: before any fact each is taken for as likely at every
        logarithm between.
    draws : int
        How many draws to return, a multiple of 4 of at least 256.
    seed : int
        Of the random numbers.
    advance : callable, optional
        Told how many populations are done, and of how many.

    Returns
    -------
    Posterior

    Raises
    ------
    InvalidInput
        If there are no facts, or `draws` is none that can be had.
    UnknownName
        If a fact is of something not observed.

    Notes
    -----
    Four independent populations begin all over the bounds and follow the facts as these are made to count little by
    little (sequential Monte Carlo [1]_), each time resampled and then moved along differences of other members [2]_, at
    lengths of all orders: so they come to lie along a narrow and bent valley, or in several, that one chain would take
    very long to walk through.

    References
    ----------
    .. [1] P. Del Moral, A. Doucet, A. Jasra, J. R. Stat. Soc. B 68, 411 (2006). doi:10.1111/j.1467-9868.2006.00553.x
    .. [2] C. J. F. ter Braak, Stat. Comput. 16, 239 (2006). doi:10.1007/s11222-006-8769-1
    """
    if not facts:
        raise InvalidInput("facts must not be empty")
    if draws < 256 or draws % _POPULATIONS:
        raise InvalidInput(f"draws must be a multiple of {_POPULATIONS} and at least 256, got {draws}")
    search = Search(observe=observe, bounds=bounds)
    found = []
    for each in range(_POPULATIONS):
        found.append(_population(search, facts, draws // _POPULATIONS, np.random.default_rng([seed, each])))
        if advance is not None:
            advance(each + 1, _POPULATIONS)
    populations = np.stack(found)
    drawn = populations.reshape(draws, -1)
    width = (search.highest - search.lowest) / np.sqrt(12)
    return Posterior(
        draws={name: np.exp(column) for name, column in zip(bounds, drawn.T, strict=True)},
        free=tuple(name for name, free in zip(bounds, drawn.std(axis=0) > _FREE * width, strict=True) if free),
        scale_reduction=float((drawn.std(axis=0) / populations.std(axis=1).mean(axis=0)).max()),
    )


def _population(search: Search, facts: Sequence[Fact], count: int, random: np.random.Generator) -> Floats:
    """Return the logarithms of the parameters of one population, shape (count, parameters)."""
    members = qmc.LatinHypercube(d=len(search.bounds), rng=random).random(count)
    members = np.asarray(search.lowest + (search.highest - search.lowest) * members)
    log_likelihood, weight = _log_likelihood(search, facts, members), 0.0
    while weight < 1:
        more = _next_weight(log_likelihood, weight) - weight
        places = _resampled(np.exp(more * (log_likelihood - log_likelihood.max())), random)
        members, log_likelihood, weight = members[places], log_likelihood[places], weight + more
        for _ in range(_MOVES):
            _move(search, facts, members, log_likelihood, weight, random)
    return members


def _log_likelihood(search: Search, facts: Sequence[Fact], members: Floats) -> Floats:
    return np.asarray(-0.5 * np.sum(misses(facts, search.observed(members)) ** 2, axis=1))


def _next_weight(log_likelihood: Floats, weight: float) -> float:
    """Return how much the facts may count so that most of the population still does."""

    def surplus(more: float) -> float:
        each = np.exp(more * (log_likelihood - log_likelihood.max()))
        return float(each.sum() ** 2 / np.sum(each**2) - _EFFECTIVE * each.size)

    whole = 1 - weight
    return 1.0 if surplus(whole) >= 0 else weight + float(brentq(surplus, 0.0, whole, xtol=1e-12 * whole))


def _resampled(weights: Floats, random: np.random.Generator) -> NDArray[np.intp]:
    """Return places in proportion to weights, at even steps of their sum."""
    ends = np.cumsum(weights) / weights.sum()
    places = np.searchsorted(ends, (np.arange(ends.size) + random.random()) / ends.size)
    return np.asarray(np.minimum(places, ends.size - 1), dtype=np.intp)


def _move(
    search: Search,
    facts: Sequence[Fact],
    members: Floats,
    log_likelihood: Floats,
    weight: float,
    random: np.random.Generator,
) -> None:
    """Let every member try a move along a difference between two of the other half; accept by Metropolis's rule."""
    one, two = np.array_split(random.permutation(len(members)), 2)
    for own, others in ((one, two), (two, one)):
        first = random.integers(others.size, size=own.size)
        second = (first + random.integers(1, others.size, size=own.size)) % others.size
        length = np.exp(random.uniform(np.log(_SHORTEST), np.log(_LONGEST), (own.size, 1)))
        tried = members[own] + length * (members[others[first]] - members[others[second]])
        inside = np.all((tried >= search.lowest) & (tried <= search.highest), axis=1)
        there = _log_likelihood(search, facts, np.clip(tried, search.lowest, search.highest))
        taken = inside & (np.log(random.random(own.size)) < weight * (there - log_likelihood[own]))
        members[own[taken]], log_likelihood[own[taken]] = tried[taken], there[taken]
