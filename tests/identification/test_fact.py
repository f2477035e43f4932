"""Facts: numbers with a tolerance, or limits."""

import math

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput, UnknownName
from sonolube.identification import Fact, Relation, normalized_residuals

SEEN = {"resonance": np.array([21.0, 22.0, 23.0])}


def missed(relation: Relation) -> list[float]:
    fact = Fact(name="resonance", value=22.0, tolerance=0.5, rank=1, relation=relation)
    return [float(miss) for miss in normalized_residuals([fact], SEEN)[:, 0]]


def test_a_value_is_missed_by_tolerances_to_either_side() -> None:
    assert missed("=") == approx([-2, 0, 2])


def test_a_limit_is_missed_only_on_its_far_side() -> None:
    assert missed(">=") == approx([-2, 0, 0])
    assert missed("<=") == approx([0, 0, 2])


@pytest.mark.parametrize(("value", "tolerance"), [(-1.0, 1.0), (math.nan, 1.0), (1.0, 0.0), (1.0, math.inf)])
def test_a_fact_without_a_sound_number_is_refused_by_its_name(value: float, tolerance: float) -> None:
    with raises(InvalidInput, match=r"fact resonance: (value|tolerance) must be"):
        Fact(name="resonance", value=value, tolerance=tolerance, rank=1)


def test_a_rank_counts_from_one() -> None:
    with raises(InvalidInput, match="fact resonance: rank must be 1 or more, got 0"):
        Fact(name="resonance", value=1.0, tolerance=1.0, rank=0)


def test_an_unknown_relation_is_refused() -> None:
    with raises(InvalidInput, match="relation must be =, >= or <=, got '~'"):
        Fact(name="resonance", value=1.0, tolerance=1.0, rank=1, relation="~")  # type: ignore[arg-type]


def test_a_fact_of_nothing_observed_is_answered_with_the_closest() -> None:
    with raises(UnknownName, match=r"unknown observable 'resonanse'; did you mean resonance\?"):
        normalized_residuals([Fact(name="resonanse", value=1.0, tolerance=1.0, rank=1)], SEEN)
