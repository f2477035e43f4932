"""Minimal conflicts and maximal consistent subsets, against their definitions by brute force."""

from itertools import chain, combinations

from hypothesis import given, strategies as st
from pytest import raises

from sonolube.errors import InvalidInput
from sonolube.identification import consistent_subsets

NAMES = "abcdef"


def subsets(names: str) -> list[frozenset[str]]:
    return [frozenset(some) for some in chain.from_iterable(combinations(names, n) for n in range(len(names) + 1))]


@given(st.lists(st.frozensets(st.sampled_from(NAMES), min_size=1, max_size=4), max_size=5))
def test_conflicts_and_consistent_subsets_are_those_of_the_definition(clashes: list[frozenset[str]]) -> None:
    def is_satisfiable(names: frozenset[str]) -> bool:
        return not any(clash <= names for clash in clashes)

    satisfiable = [some for some in subsets(NAMES) if is_satisfiable(some)]
    unsatisfiable = [some for some in subsets(NAMES) if not is_satisfiable(some)]
    found = consistent_subsets(NAMES, is_satisfiable)
    assert set(found.consistent) == {some for some in satisfiable if not any(some < other for other in satisfiable)}
    assert set(found.conflicts) == {some for some in unsatisfiable if not any(other < some for other in unsatisfiable)}


def test_constraints_without_conflict_are_tried_once() -> None:
    tried: list[frozenset[str]] = []

    def is_satisfiable(names: frozenset[str]) -> bool:
        tried.append(names)
        return True

    assert consistent_subsets(NAMES, is_satisfiable).consistent == (frozenset(NAMES),)
    assert len(tried) == 1


def test_a_conflict_of_two_among_sixteen_is_found_by_halving() -> None:
    tried: list[frozenset[str]] = []

    def is_satisfiable(names: frozenset[str]) -> bool:
        tried.append(names)
        return not {"g", "n"} <= names

    assert consistent_subsets("abcdefghijklmnop", is_satisfiable).conflicts == (frozenset("gn"),)
    assert len(tried) < 16  # one by one it takes 19


def test_more_constraints_than_can_be_enumerated_are_refused() -> None:
    with raises(InvalidInput, match="at most 16 facts can be checked for consistency, got 17"):
        consistent_subsets([str(number) for number in range(17)], lambda names: True)
