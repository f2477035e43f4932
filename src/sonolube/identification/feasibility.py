"""Consistency of facts under a model: a global search for a feasible point for each set of facts in question."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.identification.bounded_search import BoundedModel, find_feasible_point
from sonolube.identification.fact import Fact
from sonolube.identification.subsets import ConsistentSubsets, consistent_subsets

_ATTEMPTS, _CONFIRMING_ATTEMPTS = 2, 10  # searches for a set, and those that confirm a minimal conflict


def consistent_facts(
    bounded: BoundedModel, facts: Sequence[Fact], *, seed: int
) -> tuple[ConsistentSubsets, dict[frozenset[str], tuple[Floats, ...]]]:
    """Minimal conflicts and maximal consistent subsets of facts under a bounded model, and feasible points of these.

    The points are logarithms of parameters with which all facts of a subset hold.

    A search that fails proves nothing. So every minimal conflict is confirmed by ten more searches at the end, and
    where one of them finds a feasible point, the subsets are enumerated again with that knowledge.
    """
    oracle = _FeasibilityOracle(bounded=bounded, facts=facts, seed=seed)
    names = [fact.name for fact in facts]
    subsets = consistent_subsets(names, oracle.is_satisfiable)
    while oracle.refute(subsets.conflicts):
        subsets = consistent_subsets(names, oracle.is_satisfiable)
    for conflict in subsets.conflicts:
        if len(conflict) == 1:
            raise InvalidInput(
                f"fact {next(iter(conflict))} cannot be satisfied by any parameters within the bounds; widen the bounds"
                " or its tolerance"
            )
    return subsets, {
        names: tuple(point for satisfied, point in oracle.found if names <= satisfied) for names in subsets.consistent
    }


@dataclass(frozen=True, kw_only=True, slots=True)
class _FeasibilityOracle:
    """Memoised searches: feasible points with the facts that each satisfies, and the number of failures of a set."""

    bounded: BoundedModel
    facts: Sequence[Fact]
    seed: int
    found: list[tuple[frozenset[str], Floats]] = field(default_factory=list)
    failures: dict[frozenset[str], int] = field(default_factory=dict)

    def is_satisfiable(self, names: frozenset[str]) -> bool:
        """Whether a feasible point of these facts is known, or else found by a few searches of no refuted subset."""
        if not names or self._is_known(names):
            return True
        if any(refused <= names for refused in self.failures):
            return False
        return self._search(names, attempts=_ATTEMPTS)

    def refute(self, conflicts: Sequence[frozenset[str]]) -> bool:
        """Search each conflict again; where one is refuted, forget the failures on its subsets and return true."""
        refuted = [conflict for conflict in conflicts if self._search(conflict, attempts=_CONFIRMING_ATTEMPTS)]
        for names in [names for names in self.failures if self._is_known(names)]:
            del self.failures[names]
        return bool(refuted)

    def _is_known(self, names: frozenset[str]) -> bool:
        """Whether some feasible point of these facts has been found."""
        return any(names <= satisfied for satisfied, _ in self.found)

    def _search(self, names: frozenset[str], *, attempts: int) -> bool:
        """Whether one of several seeds finds a feasible point, which is then recorded; seeds that failed are over."""
        chosen = [fact for fact in self.facts if fact.name in names]
        for attempt in range(self.failures.get(names, 0), attempts):
            point = find_feasible_point(self.bounded, chosen, seed=self.seed + attempt)
            if point is not None:
                self.found.append((self._satisfied(point), point))
                return True
            self.failures[names] = attempt + 1
        return False

    def _satisfied(self, point: Floats) -> frozenset[str]:
        """Names of all facts that hold within their tolerance at a point."""
        residuals = self.bounded.residuals(self.facts, point[np.newaxis])[0]
        return frozenset(fact.name for fact, residual in zip(self.facts, residuals, strict=True) if abs(residual) <= 1)
