"""Command `identify rig`: a rig file on standard output or in a file, and the facts as JSON."""

import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pytest import MonkeyPatch, approx
from tests.identified import identified_tribometer
from tests.pin_on_disc import pin_on_disc_model, tribometer_test
from tests.same import same

from sonolube.identification import Identification
from sonolube.identification.fact import ForwardModel
from sonolube.rig import facts_file
from sonolube.validation.tribometer import tribometer_problem

Program = Callable[..., Any]


@pytest.fixture(scope="module")
def identification() -> Identification:
    return identified_tribometer()


@pytest.fixture
def once(identification: Identification, monkeypatch: MonkeyPatch) -> None:
    """Identify once for all tests, which takes twenty seconds."""
    place = "sonolube.tasks.identify.rig_of_facts.tribometer_identification"
    monkeypatch.setattr(place, lambda *, seed: identification)


@pytest.mark.usefixtures("once")
def test_the_file_written_is_a_rig_that_simulates(tmp_path: Path, sonolube: Program, rigs: Path) -> None:
    path = tmp_path / "identified.toml"
    run = sonolube("identify", "rig", rigs / "tribometer.toml", "--out", path)
    assert run.code == 0
    assert run.out.splitlines()[-1] == f"  {path}"
    assert any(line.split()[:3] == ["tip_mass", "109", "g"] for line in run.out.splitlines())
    assert any(line.startswith("  facts that do not hold: ") for line in run.out.splitlines())
    simulated = sonolube("simulate", path, "--out", tmp_path, "--json").answer
    assert simulated["vibration_amplitude"]["value"] == approx(2.5e-6, rel=0.02)


@pytest.mark.usefixtures("once")
def test_standard_output_without_a_file_is_toml_and_nothing_else(sonolube: Program) -> None:
    tables = tomllib.loads(sonolube("identify", "rig").out)
    assert set(tables) == {"stack", "structure"}


@pytest.mark.usefixtures("once")
def test_json_holds_parameters_with_their_ranges_and_facts_with_their_fate(
    tmp_path: Path, sonolube: Program, identification: Identification
) -> None:
    path = tmp_path / "identified.toml"
    answer = sonolube("identify", "rig", "--out", path, "--json").answer
    assert answer["files"] == [str(path)]
    for name, entry in answer["parameters"].items():
        assert entry["lower"] <= entry["value"] <= entry["upper"], name
    assert {fact["name"] for fact in answer["facts"] if fact["satisfied"]} == identification.satisfied
    assert answer["stack"]["stack_stiffness"]["unit"] == "N/m"


@pytest.mark.slow
def test_facts_of_a_file_identify_the_same_structure(
    tmp_path: Path, sonolube: Program, rigs: Path, identification: Identification, monkeypatch: MonkeyPatch
) -> None:
    def identify(model: ForwardModel, **problem: object) -> Identification:
        """Identification of the published facts, which tests/rig/test_facts_file.py finds from the file."""
        expected = tribometer_problem()
        same(problem, {"facts": expected.facts, "bounds": expected.bounds, "seed": 0})
        point = {name: np.array([lower, upper]) for name, (lower, upper) in expected.bounds.items()}
        known = pin_on_disc_model(tribometer_test())(point)
        for name, values in model(point).items():
            same(values, known[name], place=name)
        return identification

    monkeypatch.setattr(facts_file, "identify", identify)
    facts, path = rigs.parent / "facts" / "tribometer.toml", tmp_path / "identified.toml"
    answer = sonolube("identify", "rig", rigs / "tribometer.toml", "--facts", facts, "--out", path, "--json").answer
    assert {fact["name"] for fact in answer["facts"] if fact["satisfied"]} == identification.satisfied
    for name, known in identification.estimates.items():
        assert answer["parameters"][name]["value"] == approx(known.value, rel=1e-3), name
    assert sonolube("simulate", path, "--out", tmp_path).code == 0


def test_facts_without_their_rig_are_refused(sonolube: Program, rigs: Path) -> None:
    facts = rigs.parent / "facts" / "tribometer.toml"
    assert "--facts needs the rig they are of" in sonolube("identify", "rig", "--facts", facts).refusal
