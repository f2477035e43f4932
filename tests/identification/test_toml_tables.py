"""An identification as tables of a rig file."""

import tomllib
from collections.abc import Mapping

import pytest
from pytest import approx

from sonolube.actuator import PiezoStack
from sonolube.checks import Floats
from sonolube.identification import Fact, Identification, identify, rig_tables
from sonolube.units import to_si
from sonolube.vocabulary import unit_of

STACK = PiezoStack(
    free_capacitance=360e-9, free_stroke_per_volt=8.68e-9, stack_stiffness=2e9, stack_mass=0.07, stack_damping=30.0
)


def masses(parameters: Mapping[str, Floats]) -> Mapping[str, Floats]:
    tip, reaction = parameters["tip_mass"], parameters["reaction_mass"]
    return {"sum": tip + reaction, "double": 2 * (tip + reaction), "tip": tip}


@pytest.fixture(scope="module")
def found() -> Identification:
    facts = [
        Fact(name="sum", value=0.5, tolerance=0.01, rank=1, unit="kg", source="scales"),
        Fact(name="double", value=3.0, tolerance=0.01, rank=2, unit="kg", source="hearsay"),
    ]
    bounds = {"tip_mass": (0.01, 1.0), "reaction_mass": (0.01, 1.0), "arm_stiffness": (1e3, 1e6)}
    return identify(masses, facts=facts, bounds=bounds)


def test_tables_hold_what_was_identified_and_the_stack(found: Identification) -> None:
    tables = tomllib.loads(rig_tables(found, STACK))
    assert set(tables) == {"stack", "structure"}
    read = {
        name: to_si(text, unit=unit_of(name), name=name) for table in tables.values() for name, text in table.items()
    }
    for name, estimate in found.estimates.items():
        assert read[name] == approx(estimate.value, rel=1e-4)
    for name in ("free_capacitance", "free_stroke_per_volt", "stack_stiffness", "stack_mass", "stack_damping"):
        assert read[name] == approx(getattr(STACK, name))


def test_comments_tell_how_each_fact_fares_and_what_stays_free(found: Identification) -> None:
    text = rig_tables(found, STACK)
    assert "# - sum: 0.5 kg for 0.5 kg +- 0.01 kg, kept at" in text
    assert "given up at -200.00 tolerances; rank 2, hearsay" in text
    assert "# Not to be had together: sum, double." in text
    assert "# not limited by any fact from 1000 N/m to 1e+06 N/m" in text
    assert "# Left free to a factor of e and more: " in text
