"""Bounded-error identification of a single oscillator, whose results are known in closed form."""

import math
from collections.abc import Mapping

import numpy as np
from pytest import approx, raises
from tests.same import same

from sonolube.checks import Floats
from sonolube.errors import InvalidInput, UnknownName
from sonolube.identification import Fact, Identification, identify

BOUNDS = {"tip_mass": (0.01, 10.0), "arm_stiffness": (1.0, 1e6), "arm_damping": (1e-3, 1e3)}
MASS, STIFFNESS, DAMPING = 0.4, 1000.0, 0.5


def oscillator(parameters: Mapping[str, Floats]) -> Mapping[str, Floats]:
    m, k, c = parameters["tip_mass"], parameters["arm_stiffness"], parameters["arm_damping"]
    omega = np.sqrt(k / m)
    return {
        "rate": omega,
        "quality": np.sqrt(k * m) / c,
        "impedance": np.sqrt(k * m),
        "weight": m,
        "half_rate": omega / 2,
    }


def fact(name: str, value: float | None = None, *, within: float = 0.01, rank: int = 1) -> Fact:
    truth = oscillator(
        {"tip_mass": np.array(MASS), "arm_stiffness": np.array(STIFFNESS), "arm_damping": np.array(DAMPING)}
    )
    number = float(truth[name]) if value is None else value
    return Fact(name=name, value=number, tolerance=within * number, rank=rank)


def identified(*facts: Fact, seed: int = 0) -> Identification:
    return identify(oscillator, facts=facts, bounds=BOUNDS, seed=seed)


def test_parameters_that_the_facts_determine_are_recovered() -> None:
    found = identified(fact("rate"), fact("quality"), fact("weight"))
    values = [estimate.value for estimate in found.estimates.values()]
    assert values == approx([MASS, STIFFNESS, DAMPING], rel=1e-4)
    assert found.conflicts == ()
    assert found.unidentifiable_directions == ()


def test_feasible_intervals_are_those_of_worst_case_error_propagation() -> None:
    # k = m omega^2: extremes at the ends of both tolerances
    stiffness = identified(fact("rate"), fact("quality"), fact("weight")).estimates["arm_stiffness"]
    assert stiffness.lower == approx(STIFFNESS * 0.99**3, rel=2e-3)
    assert stiffness.upper == approx(STIFFNESS * 1.01**3, rel=2e-3)
    assert not stiffness.lower_is_bound
    assert not stiffness.upper_is_bound


def test_a_frequency_alone_determines_only_the_ratio_of_stiffness_to_mass() -> None:
    found = identified(fact("rate"))
    free = np.array([list(direction.exponents.values()) for direction in found.unidentifiable_directions])
    assert len(free) == 2
    # both the common scale of mass and stiffness, and damping, lie in the free plane
    for wanted in (np.array([1, 1, 0]) / math.sqrt(2), np.array([0, 0, 1])):
        assert np.linalg.norm(free @ wanted) == approx(1, abs=1e-6)
    assert found.estimates["arm_damping"].lower_is_bound
    assert found.estimates["arm_damping"].upper_is_bound
    assert found.estimates["arm_stiffness"].value / found.estimates["tip_mass"].value == approx(
        STIFFNESS / MASS, rel=1e-4
    )


def test_a_parameter_that_no_fact_determines_stays_at_the_middle_of_its_bounds() -> None:
    assert identified(fact("rate")).estimates["arm_damping"].value == approx(1.0, rel=1e-2)


def test_contradicting_facts_are_named_and_the_rank_decides() -> None:
    wrong = fact("half_rate", 50.0, rank=2)  # the rate is 50/s, so half of it is not
    found = identified(wrong, fact("rate"), fact("weight"))
    assert found.conflicts == (frozenset({"rate", "half_rate"}),)
    assert found.satisfied == {"rate", "weight"}
    assert [fit.satisfied for fit in found.consistent_fits] == [{"rate", "weight"}, {"half_rate", "weight"}]
    assert found.consistent_fits[0].residuals["half_rate"] == approx(-50, rel=1e-2)
    assert found.estimates["arm_stiffness"].value == approx(STIFFNESS, rel=1e-3)


def test_three_facts_can_be_inconsistent_though_any_two_are_consistent() -> None:
    # sqrt(k m) and m fix the rate to half of the stated one
    found = identified(fact("impedance"), fact("weight"), fact("rate", 100.0))
    assert found.conflicts == (frozenset({"impedance", "weight", "rate"}),)
    assert {fit.satisfied for fit in found.consistent_fits} == {
        frozenset({"impedance", "weight"}),
        frozenset({"impedance", "rate"}),
        frozenset({"weight", "rate"}),
    }


def test_a_limit_ends_a_feasible_interval() -> None:
    light = Fact(name="weight", value=5.0, tolerance=0.1, rank=1, relation="<=")
    found = identified(fact("rate"), fact("quality"), light)
    assert found.estimates["tip_mass"].upper == approx(5.1, rel=1e-2)
    assert found.conflicts == ()


def test_the_same_seed_gives_the_same_result_and_another_agrees() -> None:
    facts = fact("rate"), fact("weight"), fact("half_rate", 50.0)
    same(identified(*facts, seed=3), identified(*facts, seed=3))
    other = identified(*facts, seed=4)
    assert other.conflicts == identified(*facts, seed=3).conflicts
    assert other.estimates["arm_stiffness"].value == approx(STIFFNESS, rel=1e-3)


def test_a_fact_that_no_parameters_satisfy_is_refused() -> None:
    with raises(InvalidInput, match="fact weight cannot be satisfied by any parameters within the bounds"):
        identified(fact("rate"), fact("weight", 50.0))


def test_no_facts_or_two_of_one_name_are_refused() -> None:
    with raises(InvalidInput, match="facts must not be empty"):
        identified()
    with raises(InvalidInput, match="facts must differ in name, got rate twice"):
        identified(fact("rate"), fact("rate"))


def test_a_fact_of_an_unknown_observable_is_refused_before_any_search() -> None:
    with raises(UnknownName, match="unknown observable 'colour'"):
        identified(Fact(name="colour", value=1.0, tolerance=0.1, rank=1))


def test_bounds_have_to_rise_and_be_positive() -> None:
    with raises(InvalidInput, match="bounds of tip_mass must rise, got 2 and 1"):
        identify(oscillator, facts=[fact("rate")], bounds={**BOUNDS, "tip_mass": (2.0, 1.0)})
    with raises(InvalidInput, match=r"tip_mass must be positive, got 0\.0 kg"):
        identify(oscillator, facts=[fact("rate")], bounds={**BOUNDS, "tip_mass": (0.0, 1.0)})
    with raises(InvalidInput, match="bounds must name at least one free parameter"):
        identify(oscillator, facts=[fact("rate")], bounds={})


def test_what_no_fact_determines_lies_as_near_to_the_middle_of_its_bounds_as_the_facts_allow() -> None:
    # of the rate alone: damping in the geometric middle, and mass and stiffness, whose logarithms differ by that of
    # 2500, at the least sum of squares of their distances from it over their half widths
    estimates = identified(fact("rate")).estimates
    assert estimates["arm_damping"].value == approx(1.0, rel=1e-3)
    middle, half = (
        {name: (math.log(high) + sign * math.log(low)) / 2 for name, (low, high) in BOUNDS.items()} for sign in (1, -1)
    )
    weights = half["tip_mass"] ** -2, half["arm_stiffness"] ** -2
    apart = middle["arm_stiffness"] - math.log(2500)
    mass = (weights[0] * middle["tip_mass"] + weights[1] * apart) / sum(weights)
    assert estimates["tip_mass"].value == approx(math.exp(mass), rel=1e-3)
    assert estimates["arm_stiffness"].value == approx(2500 * math.exp(mass), rel=1e-3)
