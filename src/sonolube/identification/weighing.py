"""Which facts hold together: for every set in question, a search for a system that shows them all."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.identification.compatibility import Compatibility, compatibility
from sonolube.identification.fact import Fact, misses
from sonolube.identification.fit import Search, meet

_TRIES, _MANY_TRIES = 2, 10  # of a search, and where its failure decides


@dataclass(frozen=True, kw_only=True, slots=True)
class Weighed:
    """Which facts hold together, and systems that show it.

    Parameters
    ----------
    compatibility : Compatibility
        Of the facts' names.
    systems : mapping of frozenset of str to tuple of ndarray
        For each largest compatible set, logarithms of parameters with which its facts hold.
    """

    compatibility: Compatibility
    systems: Mapping[frozenset[str], tuple[Floats, ...]]


def weigh(search: Search, facts: Sequence[Fact], *, seed: int) -> Weighed:
    """Find out which facts hold together.

    Parameters
    ----------
    search : Search
    facts : sequence of Fact
    seed : int
        Seed of the searches.

    Returns
    -------
    Weighed

    Raises
    ------
    InvalidInput
        If there are more than 16 facts, or one that cannot be met even alone.

    Notes
    -----
    A search that finds nothing proves nothing. So each conflict is searched once more and harder at the end, and
    where that finds a system after all, everything is weighed anew in its light.
    """
    trials = _Trials(search=search, facts=facts, seed=seed)
    names = [fact.name for fact in facts]
    weighed = compatibility(names, trials.can_be_met)
    while trials.disprove(weighed.conflicts):
        weighed = compatibility(names, trials.can_be_met)
    for conflict in weighed.conflicts:
        if len(conflict) == 1:
            raise InvalidInput(f"fact {next(iter(conflict))} cannot be met by any parameters within the bounds")
    return Weighed(
        compatibility=weighed,
        systems={kept: tuple(point for held, point in trials.found if kept <= held) for kept in weighed.compatible},
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class _Trials:
    """Searches made so far: systems found with the facts that hold in each, and sets of facts that met with none."""

    search: Search
    facts: Sequence[Fact]
    seed: int
    found: list[tuple[frozenset[str], Floats]] = field(default_factory=list)
    failed: set[frozenset[str]] = field(default_factory=set)

    def can_be_met(self, names: frozenset[str]) -> bool:
        if not names or any(names <= held for held, _ in self.found):
            return True
        if names in self.failed or not self._find(names, tries=_TRIES):
            self.failed.add(names)
            return False
        return True

    def disprove(self, conflicts: Sequence[frozenset[str]]) -> bool:
        """Search harder; where a conflict falls, forget the failures that it stood for."""
        fallen = [conflict for conflict in conflicts if self._find(conflict, tries=_MANY_TRIES)]
        self.failed.difference_update({names for names in self.failed if any(names <= known for known in fallen)})
        return bool(fallen)

    def _find(self, names: frozenset[str], *, tries: int) -> bool:
        chosen = [fact for fact in self.facts if fact.name in names]
        for attempt in range(tries):
            point = meet(self.search, chosen, seed=self.seed + attempt)
            if point is not None:
                self.found.append((self._held(point), point))
                return True
        return False

    def _held(self, point: Floats) -> frozenset[str]:
        missed = misses(self.facts, self.search.observed(point[np.newaxis]))[0]
        return frozenset(fact.name for fact, miss in zip(self.facts, missed, strict=True) if abs(miss) <= 1)
