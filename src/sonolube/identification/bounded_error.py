"""Bounded-error (set-membership) identification of parameters from facts that may contradict each other.

Every set of facts in question is searched for a feasible point; the search over all subsets gives the minimal conflicts
and the maximal consistent subsets, and the most reliable of these the estimates.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.identification.bounded_search import (
    BoundedModel,
    find_feasible_point,
    find_feasible_point_near,
    least_squares_point,
    residual_jacobian,
)
from sonolube.identification.fact import (
    Bounds,
    ConsistentFit,
    Fact,
    ForwardModel,
    Identification,
    ParameterEstimate,
    SingularDirection,
)

_MAX_CONSTRAINTS = 16  # the search enumerates all 2^16 subsets


@dataclass(frozen=True, kw_only=True, slots=True)
class ConsistentSubsets:
    """Minimal conflicts and maximal consistent subsets of a set of constraints.

    Parameters
    ----------
    conflicts : tuple of frozenset of str
        Minimal unsatisfiable subsets: not satisfiable together, but satisfiable once any one member is left out.
    consistent : tuple of frozenset of str
        Maximal satisfiable subsets, larger first: satisfiable together, but not with any further constraint.
    """

    conflicts: tuple[frozenset[str], ...]
    consistent: tuple[frozenset[str], ...]


def consistent_subsets(names: Sequence[str], is_satisfiable: Callable[[frozenset[str]], bool]) -> ConsistentSubsets:
    """All minimal conflicts and all maximal consistent subsets of a set of constraints.

    Parameters
    ----------
    names : sequence of str
        Names of the constraints, at most 16.
    is_satisfiable : callable
        Whether the constraints of a set can be satisfied together. It must be monotonic: every subset of a satisfiable
        set is satisfiable.

    Returns
    -------
    ConsistentSubsets

    Raises
    ------
    InvalidInput
        If there are more than 16 constraints.

    Notes
    -----
    Subsets are enumerated from the largest down. Subsets of a known consistent set and supersets of a known conflict
    are skipped; an unsatisfiable set is reduced to a minimal conflict by deletion of one member after another. The
    number of calls of `is_satisfiable` is therefore about the number of conflicts and consistent subsets times the
    number of constraints, not the number of subsets.

    References
    ----------
    .. [1] M. H. Liffiton and K. A. Sakallah, J. Autom. Reason. 40, 1 (2008). doi:10.1007/s10817-007-9084-z
    """
    if len(names) > _MAX_CONSTRAINTS:
        raise InvalidInput(
            f"at most {_MAX_CONSTRAINTS} facts can be checked for consistency, got {len(names)}; leave out the least"
            " reliable ones"
        )
    conflicts: list[frozenset[str]] = []
    consistent: list[frozenset[str]] = []
    for candidate in _subsets_by_decreasing_size(names):
        if any(candidate <= known for known in consistent) or any(known <= candidate for known in conflicts):
            continue
        if is_satisfiable(candidate):
            consistent.append(candidate)
        else:
            conflicts.append(_minimal_conflict(candidate, names, is_satisfiable))
    return ConsistentSubsets(conflicts=tuple(conflicts), consistent=tuple(consistent))


def _subsets_by_decreasing_size(names: Sequence[str]) -> list[frozenset[str]]:
    """All subsets, the largest first, those of one size in the order of their bit masks."""
    masks = sorted(range(2 ** len(names)), key=lambda mask: (-mask.bit_count(), mask))
    return [frozenset(name for bit, name in enumerate(names) if mask >> bit & 1) for mask in masks]


def _minimal_conflict(
    unsatisfiable: frozenset[str], names: Sequence[str], is_satisfiable: Callable[[frozenset[str]], bool]
) -> frozenset[str]:
    """Minimal unsatisfiable subset of an unsatisfiable set, by deletion in the order of `names`.

    Members up to the next that must stay are deleted at once, and that one is found by halving.
    """
    undecided = [name for name in names if name in unsatisfiable]
    while undecided:
        deleted, stays = 0, len(undecided) + 1  # so many can be deleted, so many cannot
        while stays - deleted > 1:
            middle = (deleted + stays) // 2
            if is_satisfiable(unsatisfiable.difference(undecided[:middle])):
                stays = middle
            else:
                deleted = middle
        unsatisfiable = unsatisfiable.difference(undecided[:deleted])
        undecided = undecided[stays:]
    return unsatisfiable


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


_STARTS = 10  # of the least-squares fit to the most reliable consistent subset
_BISECTIONS = 14  # between the estimate and a bound, for one end of a feasible interval


def identify(model: ForwardModel, *, facts: Sequence[Fact], bounds: Bounds, seed: int = 0) -> Identification:
    r"""Parameters, their feasible intervals, and the consistency of facts, by bounded-error estimation.

    Parameters
    ----------
    model : callable
        Forward model: observables of n systems, by name, from arrays of shape (n,) of their parameters, by name.
    facts : sequence of Fact
        At most 16, each of an observable of the model; the more reliable first among equals of rank.
    bounds : mapping of str to pair of float
        Lower and upper bound of each free parameter in SI, both positive.
    seed : int
        Seed of the searches; the same seed gives the same result.

    Returns
    -------
    Identification

    Raises
    ------
    InvalidInput
        If there are no facts or more than 16, two of one name, a fact that no parameters within the bounds satisfy, or
        bounds that are not positive and rising.
    UnknownName
        If a fact names no observable of the model.

    See Also
    --------
    posterior : Joint samples of the parameters from the facts that hold.

    Notes
    -----
    A compromise between contradicting facts would satisfy none of them. So all maximal consistent subsets S of the
    facts, those for which the feasible set

    .. math:: \Theta_S = \{p : |r_i(p)| \le 1 \text{ for all } i \in S\}

    with the normalised residuals :math:`r_i` is not empty, are found first. The subset with the most facts of rank 1,
    then of rank 2 and so on, is taken, and the parameters are the least-squares fit to it alone; what no fact
    determines stays at the middle of its bounds on a logarithmic scale. The feasible interval of a parameter is the
    projection of :math:`\Theta_S`, bisected from the estimate outwards on the assumption that it has no gap. Limits
    that are satisfied with a margin do not enter the singular directions.

    References
    ----------
    .. [1] M. Milanese and A. Vicino, Automatica 27, 997 (1991). doi:10.1016/0005-1098(91)90134-N
    """
    _require_distinct_names(facts)
    bounded = BoundedModel(model=model, bounds=bounds)
    bounded.residuals(facts, bounded.lower[np.newaxis])  # refuses an unknown observable before the long search
    subsets, points = consistent_facts(bounded, facts, seed=seed)
    first, *others = sorted(points, key=lambda names: _reliability(names, facts), reverse=True)
    satisfied = [fact for fact in facts if fact.name in first]
    starts = [find_feasible_point(bounded, satisfied, seed=seed + i) for i in range(_STARTS)]
    fits = [
        _consistent_fit(bounded, facts, first, (*points[first], *(start for start in starts if start is not None))),
        *(_consistent_fit(bounded, facts, names, points[names]) for names in others),
    ]
    point = np.log(list(fits[0].parameters.values()))
    observed = bounded.observables(point[np.newaxis])
    return Identification(
        facts=tuple(facts),
        observed=MappingProxyType({fact.name: float(observed[fact.name][0]) for fact in facts}),
        estimates=MappingProxyType(
            {name: _estimate(bounded, satisfied, point, index) for index, name in enumerate(bounded.bounds)}
        ),
        directions=_singular_directions(bounded, satisfied, point),
        consistent_fits=tuple(fits),
        conflicts=subsets.conflicts,
    )


def _require_distinct_names(facts: Sequence[Fact]) -> None:
    """Refuse no facts at all, and two facts of one name."""
    if not facts:
        raise InvalidInput("facts must not be empty")
    names = [fact.name for fact in facts]
    for name in names:
        if names.count(name) > 1:
            raise InvalidInput(f"facts must differ in name, got {name} twice")


def _consistent_fit(
    bounded: BoundedModel, facts: Sequence[Fact], names: frozenset[str], starts: Sequence[Floats]
) -> ConsistentFit:
    """Least-squares fit to the facts of these names, with the residuals of all."""
    point = least_squares_point(bounded, [fact for fact in facts if fact.name in names], starts=starts)
    residuals = bounded.residuals(facts, point[np.newaxis])[0]
    return ConsistentFit(
        satisfied=names,
        parameters=MappingProxyType(dict(zip(bounded.bounds, np.exp(point).tolist(), strict=True))),
        residuals=MappingProxyType(dict(zip((fact.name for fact in facts), residuals.tolist(), strict=True))),
    )


def _reliability(names: frozenset[str], facts: Sequence[Fact]) -> tuple[list[int], list[bool]]:
    """Sorting key of a subset: number of its facts of each rank, the best first, then which facts, in their order."""
    ranks = sorted({fact.rank for fact in facts})
    counts = [sum(fact.name in names for fact in facts if fact.rank == rank) for rank in ranks]
    return counts, [fact.name in names for fact in facts]


def _estimate(bounded: BoundedModel, facts: Sequence[Fact], point: Floats, index: int) -> ParameterEstimate:
    """Estimate and feasible interval of the parameter of an index."""
    lower, lower_is_bound = _interval_end(bounded, facts, point, index, float(bounded.lower[index]))
    upper, upper_is_bound = _interval_end(bounded, facts, point, index, float(bounded.upper[index]))
    return ParameterEstimate(
        value=float(np.exp(point[index])),
        lower=float(np.exp(lower)),
        upper=float(np.exp(upper)),
        lower_is_bound=lower_is_bound,
        upper_is_bound=upper_is_bound,
    )


def _interval_end(
    bounded: BoundedModel, facts: Sequence[Fact], point: Floats, index: int, bound: float
) -> tuple[float, bool]:
    """End of a feasible interval towards a bound by bisection, and whether it is the bound; others are adapted."""
    near, far = float(point[index]), bound
    start = point
    for bisection in range(_BISECTIONS + 1):
        trial = far if bisection == 0 else (near + far) / 2
        found = find_feasible_point_near(bounded, facts, start=start, fixed={index: trial})
        if found is None:
            far = trial
        elif bisection == 0:
            return bound, True
        else:
            near, start = trial, found
    return near, False


def _singular_directions(bounded: BoundedModel, facts: Sequence[Fact], point: Floats) -> tuple[SingularDirection, ...]:
    """Right singular vectors of the Jacobian of the residuals, the smallest singular value first."""
    jacobian = residual_jacobian(bounded, facts, point)
    padding = np.zeros((len(point), len(point)))  # as many singular values as parameters
    _, singular, rows = np.linalg.svd(np.vstack([jacobian, padding]))
    largest = np.take_along_axis(rows, np.abs(rows).argmax(axis=1)[:, np.newaxis], axis=1)
    return tuple(
        SingularDirection(
            exponents=MappingProxyType(dict(zip(bounded.bounds, row.tolist(), strict=True))), sensitivity=float(value)
        )
        for value, row in zip(singular[::-1], (rows * np.sign(largest))[::-1], strict=True)
    )
