"""Facts, values with a tolerance or limits, and residuals against them."""

import math

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput, UnknownName
from sonolube.identification import Fact, Relation, normalized_residuals

OBSERVED = {"resonance": np.array([21.0, 22.0, 23.0])}


def residuals(relation: Relation) -> list[float]:
    fact = Fact(name="resonance", value=22.0, tolerance=0.5, rank=1, relation=relation)
    return [float(residual) for residual in normalized_residuals([fact], OBSERVED)[:, 0]]


def test_the_residual_of_a_value_counts_tolerances_to_either_side() -> None:
    assert residuals("=") == approx([-2, 0, 2])


def test_the_residual_of_a_limit_is_zero_where_it_is_not_violated() -> None:
    assert residuals(">=") == approx([-2, 0, 0])
    assert residuals("<=") == approx([0, 0, 2])


@pytest.mark.parametrize(("value", "tolerance"), [(-1.0, 1.0), (math.nan, 1.0), (1.0, 0.0), (1.0, math.inf)])
def test_a_number_that_is_not_positive_and_finite_is_refused_by_name(value: float, tolerance: float) -> None:
    with raises(InvalidInput, match=r"fact resonance: (value|tolerance) must be"):
        Fact(name="resonance", value=value, tolerance=tolerance, rank=1)


def test_a_rank_below_one_is_refused() -> None:
    with raises(InvalidInput, match="fact resonance: rank must be 1 or more, got 0"):
        Fact(name="resonance", value=1.0, tolerance=1.0, rank=0)


def test_an_unknown_relation_is_refused() -> None:
    with raises(InvalidInput, match="relation must be =, >= or <=, got '~'"):
        Fact(name="resonance", value=1.0, tolerance=1.0, rank=1, relation="~")  # type: ignore[arg-type]


def test_a_fact_of_an_unknown_observable_is_refused_with_the_closest_name() -> None:
    with raises(UnknownName, match=r"unknown observable 'resonanse'; did you mean resonance\?"):
        normalized_residuals([Fact(name="resonanse", value=1.0, tolerance=1.0, rank=1)], OBSERVED)
