"""Identified parameters, and causes of the decay length: ranges, conflicts, probabilities and factors in words."""

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np
from pytest import approx, mark

from sonolube.identification.decay_length.posterior import HYPOTHESES
from sonolube.report.results import identification as results


@dataclass
class Fact:
    name: str
    value: float = 1.0


@dataclass
class Estimate:
    value: float
    lower: float
    upper: float


@dataclass
class Stack:
    free_capacitance: float = 1e-6
    stack_damping: float = 0.0
    note: str = "of the sheet"


def identification(satisfied: set[str]) -> Any:
    return SimpleNamespace(
        estimates={"tip_mass": Estimate(0.05, 0.04, 0.07), "stack_stiffness": Estimate(2e9, 1e9, 3e9)},
        facts=[Fact("first"), Fact("second"), Fact("third")],
        satisfied=satisfied,
        observed={"first": 1.0, "second": 2.0, "third": 3.0},
        conflicts=[{"third", "first"}],
        unidentifiable_directions=[SimpleNamespace(exponents={"tip_mass": 1.234, "stack_stiffness": -0.5})],
    )


def test_parameters_have_value_and_both_ends_in_their_units() -> None:
    assert results.parameter_rows(identification(set())) == [
        ["tip_mass", "50 g", "40 g", "70 g"],
        ["stack_stiffness", "2 GN/m", "1 GN/m", "3 GN/m"],
    ]


def test_facts_are_said_by_whether_they_hold_with_conflicts_and_what_is_left_open() -> None:
    last = ["  contradict each other: first, third", "  not determined: tip_mass^1.2 stack_stiffness^-0.5"]
    assert results.fact_lines(identification({"first", "third"})) == [
        "  facts that hold: first, third", "  facts that do not hold: second", *last,
    ]  # fmt: skip
    assert results.fact_lines(identification({"first", "second", "third"})) == [
        "  facts that hold: first, second, third", *last,
    ]  # fmt: skip
    assert results.fact_lines(identification(set()))[0] == "  facts that hold: none"


def test_an_identification_in_json_has_the_quantities_of_the_stack_that_are_not_zero() -> None:
    found = results.identification_object(identification({"second"}), Stack())  # type: ignore[arg-type]
    assert found["stack"] == {"free_capacitance": {"value": approx(1e-6), "unit": "F"}}
    assert found["parameters"]["tip_mass"] == {"value": 0.05, "unit": "kg", "lower": 0.04, "upper": 0.07}
    assert [each["satisfied"] for each in found["facts"]] == [False, True, False]
    assert [each["observed"] for each in found["facts"]] == approx([1.0, 2.0, 3.0])
    assert found["conflicts"] == [["first", "third"]]
    assert found["unidentifiable_directions"] == [{"tip_mass": 1.234, "stack_stiffness": -0.5}]


def interval(median: float, lower: float, upper: float) -> Any:
    return SimpleNamespace(median=median, lower=lower, upper=upper)


def decision(effective_draws: float = 400.0) -> Any:
    first, second = list(HYPOTHESES)[:2]
    return SimpleNamespace(
        probabilities={first: 0.2, second: 0.8},
        growth=interval(1.5, 1.1, 2.25), fall=interval(2.0, 1.5, 3.0), zero_factor=interval(1.01, 0.99, 1.02),
        length_at_start=interval(1e-6, 0.5e-6, 2e-6), length_at_end=interval(1.5e-6, 0.75e-6, 3e-6),
        verdict="grows", decided=True, leading=second, advice="measure roughness", misfits={first: 3.0},
        effective_draws=effective_draws,
    )  # fmt: skip


def table(*, missing: tuple[str, ...] = (), caveats: tuple[str, ...] = ()) -> Any:
    return SimpleNamespace(
        title="Run 7", sliding_distance=np.array([0.5, 20.0, 120.0]), missing=missing, caveats=caveats
    )


def conditions(natural_frequency: float | None = 21e3) -> Any:
    return SimpleNamespace(
        normal_load=3.0, vibration_amplitude=2.5e-6, frequency=22e3, sliding_speed=0.02,
        natural_frequency=natural_frequency,
    )  # fmt: skip


def test_a_run_is_named_with_its_switches_its_whole_distance_and_conditions() -> None:
    assert results.run_line(table(), conditions()) == "Run 7: 3 switches over 120 m; 3 N, 2.5 um, 22 kHz, 20 mm/s"


def test_the_likeliest_cause_stands_first_with_factors_and_lengths_in_micrometres() -> None:
    first, second = (HYPOTHESES[name].title for name in list(HYPOTHESES)[:2])
    assert results.rows(decision()) == [
        (second, "80.0 %"),
        (first, "20.0 %"),
        ("decay length grows", "by a factor of 1.50 (80 %: 1.10 to 2.25)"),
        ("amplitude falls", "by a factor of 2.00 (80 %: 1.50 to 3.00)"),
        ("zero, if not subtracted", "makes the decay length wrong by a factor of 1.01 (80 %: 0.99 to 1.02)"),
        ("decay length", "1.00 um (80 %: 0.50 to 2.00) at first, 1.50 um (80 %: 0.75 to 3.00) at last"),
    ]


def test_a_decision_in_json_has_pure_factors_and_lengths_in_metres() -> None:
    found = results.decision_object(decision(), table())
    assert {name: found[name] for name in ("verdict", "decided", "advice")} == {
        "verdict": "grows", "decided": True, "advice": "measure roughness",
    }  # fmt: skip
    assert found["growth"] == {"value": 1.5, "lower": 1.1, "upper": 2.25, "unit": ""}
    assert found["fall"]["value"] == approx(2.0)
    assert found["zero_factor"]["upper"] == approx(1.02)
    assert found["decay_length_at_start"] == {"value": 1e-6, "lower": 0.5e-6, "upper": 2e-6, "unit": "m"}
    assert found["decay_length_at_end"]["value"] == approx(1.5e-6)
    assert (found["effective_draws"], found["switches"]) == (400.0, 3)


SHIFTS = ("small_drive_shift", "large_drive_shift")
FEW = "is read at fewer than eight switches and does not enter"
COUNTED = "the free frequency is not stated: shifts count as small against the frequency of the mode"


@mark.parametrize(
    ("missing", "frequency", "draws", "more"),
    [
        ((), 21e3, 30.0, []),
        ((), 21e3, 29.9, ["few effective draws: probabilities are coarse; try another seed"]),
        ((), None, 400.0, [COUNTED]),
        (SHIFTS[:1], None, 400.0, [f"small_drive_shift {FEW}", COUNTED]),
        (SHIFTS, None, 400.0,
         [f"{name} {FEW}" for name in SHIFTS]),
    ],
)  # fmt: skip
def test_caveats_name_what_a_run_lacks_and_what_the_analysis_rests_on(
    missing: tuple[str, ...], frequency: float | None, draws: float, more: list[str]
) -> None:
    found = results.decision_caveats(table(missing=missing, caveats=("a gap",)), conditions(frequency), decision(draws))
    assert found == [
        "a gap",
        *more,
        "a zero that is off only under load is not seen with the pin lifted",
        "decay lengths rest on asperity stick-slip",
    ]
