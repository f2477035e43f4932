"""Smallest conflicts and largest compatible sets, against their definitions by brute force."""

from itertools import chain, combinations

from hypothesis import given
from hypothesis import strategies as st
from pytest import raises

from sonolube.errors import InvalidInput
from sonolube.identification import consistent_subsets

NAMES = "abcdef"


def subsets(names: str) -> list[frozenset[str]]:
    return [frozenset(some) for some in chain.from_iterable(combinations(names, n) for n in range(len(names) + 1))]


@given(st.lists(st.frozensets(st.sampled_from(NAMES), min_size=1, max_size=4), max_size=5))
def test_conflicts_and_compatible_sets_are_those_of_the_definition(clashes: list[frozenset[str]]) -> None:
    def can_be_met(names: frozenset[str]) -> bool:
        return not any(clash <= names for clash in clashes)

    met = [some for some in subsets(NAMES) if can_be_met(some)]
    unmet = [some for some in subsets(NAMES) if not can_be_met(some)]
    found = consistent_subsets(NAMES, can_be_met)
    assert set(found.compatible) == {some for some in met if not any(some < other for other in met)}
    assert set(found.conflicts) == {some for some in unmet if not any(other < some for other in unmet)}


def test_demands_without_conflict_are_tried_once() -> None:
    tried: list[frozenset[str]] = []

    def can_be_met(names: frozenset[str]) -> bool:
        tried.append(names)
        return True

    assert consistent_subsets(NAMES, can_be_met).compatible == (frozenset(NAMES),)
    assert len(tried) == 1


def test_more_demands_than_can_be_looked_through_are_refused() -> None:
    with raises(InvalidInput, match="at most 16 facts can be weighed against each other, got 17"):
        consistent_subsets([str(number) for number in range(17)], lambda names: True)
