"""Commands `lab run` and `lab virtual`: a protocol on the virtual tribometer, its record, and every refusal."""

import os
import signal
from collections.abc import Callable
from pathlib import Path
from threading import Timer
from typing import Any

import numpy as np
import pytest
import xarray as xr
from pytest import approx
from tests.cli.lab.test_watch import LONG, folder_of, running
from tests.laboratory import rig_stand_ins
from tests.laboratory.rig_stand_ins import analogue_rig

from sonolube.cli.console import options as questions
from sonolube.facts.protocol import Prompt, protocol_names
from sonolube.laboratory import RunControl
from sonolube.laboratory.records import read_run

Program = Callable[..., Any]


def test_a_virtual_test_is_measured_as_a_real_one_and_returns_what_it_was_given(
    sonolube: Program, rigs: Path, tmp_path: Path
) -> None:
    made = sonolube("lab", "virtual", rigs / "power_map.toml", "--seed", "3", "--out", tmp_path, "--json").answer
    assert (made["outcome"], made["state"], made["samples"]) == ("completed", "safe", 13_000)
    (recording,) = made["recordings"]
    measured = sonolube("measure", "friction", recording, "--json").answer
    rows = measured["results"][0]["tables"]["steps"]["rows"]
    truth = xr.open_dataset(Path(made["folder"]) / "truth" / "truth.nc")
    sliding = truth.where(truth["sliding_speed"] > 0, drop=True)
    for row in rows:
        nearest = int(np.argmin(np.abs(sliding["voltage_peak_to_peak"].to_numpy() - row["voltage_peak_to_peak"])))
        known = float(sliding["friction_force"][nearest])
        assert row["friction_force"] == approx(known, abs=5 * row["friction_force_uncertainty"])
    assert [row["voltage_peak_to_peak"] for row in rows] == approx([0, 5.1, 10.3, 15.5, 20.7, 25.9])
    unseen = "voltage and current at 400 Hz do not resolve the drive (fewer than five samples a period)"
    assert made["caveats"][0] == unseen
    assert unseen in measured["caveats"]
    assert unseen in (Path(made["folder"]) / "run.json").read_text()
    assert made["caveats"][-1] == "friction is drawn from the prediction of the rig: no measurement"


def test_a_plan_is_run_measured_and_fitted(sonolube: Program, rigs: Path, tmp_path: Path) -> None:
    planned = sonolube("plan", rigs / "power_map.toml", "--out", tmp_path / "plan", "--json").answer
    (first, *_) = sorted(path for path in map(Path, planned["files"]) if path.suffix == ".toml")
    ran = sonolube("lab", "run", first, "--rig", rigs / "power_map.toml", "--out", tmp_path / "runs", "--json").answer
    assert ran["outcome"] == "completed"
    assert sonolube("measure", "friction", *ran["recordings"], "--json").code == 0


def test_a_test_that_a_dry_run_finds_impossible_is_refused_unless_it_is_to_be_run_anyway(
    sonolube: Program, rigs: Path, tmp_path: Path
) -> None:
    protocol = tmp_path / "hot.toml"
    protocol.write_text(SHORT.replace('"2 s"', '"2 s"\nfriction_force_maximum = "1 mN"'))
    words = ("lab", "run", protocol, "--rig", rigs / "power_map.toml", "--out", tmp_path / "runs")
    refusal = sonolube(*words).refusal
    assert "impossible by a dry run: step 2: reaches " in refusal
    assert "limits.friction_force_maximum of 1 mN ends the test; --anyway runs it all the same" in refusal
    assert not (tmp_path / "runs").exists()
    ran = sonolube(*words, "--anyway", "--json")
    assert ran.answer["outcome"] == "stopped"
    assert "its limit is 1 mN" in ran.answer["reason"]


@pytest.mark.parametrize(("typed", "why"), [("", "the input has ended"), ("n\n", "the operator did not confirm")])
def test_the_reason_of_an_end_in_a_prompt_is_the_true_one(
    typed: str, why: str, sonolube: Program, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(rig_stand_ins, "voltages", lambda terminal, numbers: 0.02 + 0 * numbers)
    monkeypatch.setattr(questions, "is_terminal", lambda: True)
    (tmp_path / "asking.toml").write_text(SHORT + ASKED)
    (tmp_path / "typed").write_text(typed)
    words = ("lab", "run", tmp_path / "asking.toml", "--device", tmp_path / "devices.toml", "--out", tmp_path / "runs")
    with analogue_rig(tmp_path), (tmp_path / "typed").open() as keyboard:
        monkeypatch.setattr("sys.stdin", keyboard)
        assert sonolube(*words, "--json").answer["reason"].startswith(why)


def test_a_second_run_has_a_folder_of_its_own(sonolube: Program, rigs: Path, tmp_path: Path) -> None:
    protocol = tmp_path / "short.toml"
    protocol.write_text(SHORT)
    options = (protocol, "--rig", rigs / "power_map.toml", "--out", tmp_path / "runs", "--json")
    folders = [sonolube("lab", "run", *options).answer["folder"] for _ in range(2)]
    assert len(set(folders)) == 2
    assert [read_run(Path(folder)).summary.outcome for folder in folders] == ["completed"] * 2


@pytest.mark.parametrize("name", protocol_names())
def test_a_dry_run_of_every_protocol_tells_time_and_data_and_touches_nothing(
    name: str, sonolube: Program, rigs: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    ran = sonolube("lab", "run", name, "--rig", rigs / "tribometer.toml", "--dry-run")
    assert ran.code == 0
    assert "duration " in ran.out
    assert not any(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (["lab", "run", "map_tst"], "unknown protocol 'map_tst'; did you mean map_test?"),
        (["lab", "run", "map_test"], "--device virtual needs --rig, whose friction"),
        (["lab", "virtual", "RIG", "--format", "xls"], "'xls' is not one of"),
        (["lab", "run", "map_test", "--rig", "RIG", "--dry-run", "--seed", "1"], "--seed"),
        (["lab", "virtual", "none.toml"], "none.toml: no such file"),
        (["lab", "run", "map_test", "--device", "none.toml"], "none.toml: no such file"),
        (["lab", "run", "map_test", "--device", "MAP"], "the driver NI-DAQmx is not installed: "),
        (["lab", "run", "map_test", "--device", "MAP", "--seed", "1"], "--seed"),
    ],
)
def test_bad_input_is_one_line_and_makes_no_folder(
    arguments: list[str], line: str, sonolube: Program, rigs: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    known = {"RIG": rigs / "power_map.toml", "MAP": rigs.parent / "lab" / "devices.toml"}
    words = [known.get(word, word) for word in arguments]
    assert line in sonolube(*words).refusal
    assert not any(tmp_path.iterdir())


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_a_run_in_order(number: signal.Signals, rigs: Path, tmp_path: Path) -> None:
    with running(tmp_path, rigs, duration=LONG) as run:
        run.send_signal(number)
        run.communicate(timeout=60)
    assert run.returncode == 1
    found = read_run(folder_of(tmp_path / "runs")).summary
    assert (found.outcome, found.reason) == ("stopped", "interrupted" if number == signal.SIGINT else "terminated")
    assert found.samples > 0


@pytest.mark.parametrize(
    ("typed", "outcome"), [("\n", "completed"), ("yes\n", "completed"), ("n\n", "stopped"), ("", "stopped")]
)
def test_a_person_at_the_terminal_confirms_prompts(
    typed: str, outcome: str, sonolube: Program, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(rig_stand_ins, "voltages", lambda terminal, numbers: 0.02 + 0 * numbers)  # V at every input
    monkeypatch.setattr(questions, "is_terminal", lambda: True)
    (tmp_path / "asking.toml").write_text(SHORT + ASKED)
    (tmp_path / "typed").write_text(typed)
    words = ("lab", "run", tmp_path / "asking.toml", "--device", tmp_path / "devices.toml", "--out", tmp_path / "runs")
    with analogue_rig(tmp_path) as rig, (tmp_path / "typed").open() as keyboard:
        monkeypatch.setattr("sys.stdin", keyboard)
        run = sonolube(*words, "--json")
        assert (rig.voltage(), rig.rotation_speed()) == (0.0, 0.0)
    assert "load: Add a weight.\n  done? [Y/n] " in run.err
    assert (run.answer["outcome"], run.code) == (outcome, int(outcome != "completed"))


def test_an_end_that_is_asked_for_is_heard_while_a_person_is_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    silent, end = os.pipe()
    control = RunControl()
    with os.fdopen(silent) as keyboard, os.fdopen(end, "w"):
        monkeypatch.setattr("sys.stdin", keyboard)
        Timer(0.2, control.stop, ["terminated"]).start()
        assert not questions.Operator(control)(Prompt(task="load", text="Add a weight."))


def test_a_protocol_with_prompts_is_refused_where_nobody_can_answer(sonolube: Program, tmp_path: Path) -> None:
    (tmp_path / "asking.toml").write_text(SHORT + ASKED)
    words = ("lab", "run", tmp_path / "asking.toml", "--device", tmp_path / "devices.toml", "--out", tmp_path / "runs")
    with analogue_rig(tmp_path) as rig:
        rig.was_on()
        assert "run it on a terminal, in Python with the argument operator, or take" in sonolube(*words).refusal
        assert rig.rotation_speed() > 0  # untouched
        assert not (tmp_path / "runs").exists()
        assert sonolube(*words, "--yes", "--json").answer["state"] == "safe"


ASKED = """
[[steps]]
kind = "prompt"
task = "load"
text = "Add a weight."
"""
SHORT = """title = "short"
source = "none"

[limits]
voltage_maximum = "30 V"
duration_maximum = "2 s"

[[steps]]
kind = "acquire"
channels = ["friction_force"]
sample_rate = "400 Hz"
duration = "1 s"

[[steps]]
kind = "motor_speed"
sliding_speed = "50 mm/s"
"""
