"""Minimal conflicts and maximal consistent subsets of a set of constraints, by search over all subsets."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from sonolube.errors import InvalidInput

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
