"""Identified parameters as tables of a rig file."""

import re
import tomllib
from collections.abc import Mapping
from dataclasses import replace

import pytest
from pytest import approx

from sonolube.checks import Floats
from sonolube.identification import Fact, Identification, identify, rig_tables
from sonolube.models.actuator import PiezoStack
from sonolube.text.units import to_si
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


def test_tables_hold_the_estimates_and_the_stack(found: Identification) -> None:
    tables = tomllib.loads(rig_tables(found, STACK))
    assert set(tables) == {"stack", "structure"}
    read = {
        name: to_si(text, unit=unit_of(name), name=name) for table in tables.values() for name, text in table.items()
    }
    for name, estimate in found.estimates.items():
        assert read[name] == approx(estimate.value, rel=1e-4)
    for name in ("free_capacitance", "free_stroke_per_volt", "stack_stiffness", "stack_mass", "stack_damping"):
        assert read[name] == approx(getattr(STACK, name))


def test_comments_state_residuals_conflicts_and_undetermined_directions(found: Identification) -> None:
    text = rig_tables(found, STACK)
    assert "# - sum: 0.5 kg for 0.5 kg +- 0.01 kg, satisfied at" in text
    assert "rejected at -200.00 tolerances; rank 2, hearsay" in text
    assert "# Mutually inconsistent: sum, double." in text
    assert "# not limited by any fact from 1000 N/m to 1e+06 N/m" in text
    assert "# Not determined within a factor of e: " in text


def test_entries_that_were_not_identified_keep_their_values_in_their_order(found: Identification) -> None:
    stiff = replace(STACK, preload=800.0, stack_stiffness=2.123456789e9)
    structure = {"tip_damping": 1 / 3, "tip_mass": 9.0, "reaction_mass": 9.0, "arm_stiffness": 9.0}
    tables = tomllib.loads(rig_tables(found, stiff, structure=structure))
    assert list(tables["structure"]) == list(structure)
    assert to_si(tables["structure"]["tip_damping"], unit="N s/m", name="") == approx(1 / 3, rel=1e-11)
    assert to_si(tables["structure"]["tip_mass"], unit="kg", name="") == approx(
        found.estimates["tip_mass"].value, rel=1e-4
    )
    assert to_si(tables["stack"]["stack_stiffness"], unit="N/m", name="") == approx(2.123456789e9, rel=1e-11)
    assert tables["stack"]["preload"] == "800 N"


def test_an_identified_entry_of_the_stack_stands_in_its_table_with_its_interval() -> None:
    facts = [Fact(name="stiffness", value=1.5e9, tolerance=1e7, rank=1, unit="N/m", source="pull test")]
    found = identify(
        lambda parameters: {"stiffness": parameters["stack_stiffness"]},
        facts=facts,
        bounds={"stack_stiffness": (1e8, 1e10)},
    )
    text = rig_tables(found, STACK, structure={"tip_mass": 0.1})
    assert re.search(r'^stack_stiffness = "1.5e\+09 N/m"  # 1.490\de\+09 N/m to 1.509\de\+09 N/m$', text, re.MULTILINE)
    assert set(tomllib.loads(text)["structure"]) == {"tip_mass"}
