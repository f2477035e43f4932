"""Rigs as `new` writes them, by an amplitude and by an actuator, through every task that takes a rig alone."""

from collections.abc import Sequence
from pathlib import Path

import pytest
from pytest import CaptureFixture, MonkeyPatch
from tests.cli.option_uses import RUNS

from sonolube.cli import main

KNOWN = ("--pin", "brass", "--disc", "304", "--load", "5N", "--speed", "0.2m/s", "--frequency", "20kHz")
FIRST = {
    "amplitude": (*KNOWN, "--amplitude", "3um", "--finish", "ground N6"),
    "actuator": (*KNOWN, "--actuator", "sa050510", "--voltage", "50V", "--finish", "ground N6"),
}
ANSWERED = {
    "predict": (),
    "contact": (),
    "friction": (),
    "wear": (),
    "simulate": (),
    "thermal": ("--pin", "brass_c36000", "--disc", "stainless_steel_304"),
    "regime": ("--film-coefficient", "0.25", "--asperity-pressure", "10MPa"),
    "sweep": ("--over", "vibration.vibration_amplitude=1um:5um:3"),
    "plan": ("--points", "2", "--speed", "50:200:2mm/s"),
    "uncertainty": ("--samples", "32"),
    "literature": (),
}
VOLTAGE = {
    "map": ("--over", "sliding.sliding_speed=20mm/s,50mm/s"),
    "control": (),
    "sweep": ("--of", "speed", "--points", "3"),
}
STRUCTURE = {
    "response": (),
    "transient": (),
    "sweep": ("--of", "frequency", "--points", "3"),
    "optimise": ("--target-friction", "0.2"),
}


@pytest.fixture(scope="module")
def rigs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("first")
    for name, options in FIRST.items():
        with pytest.raises(SystemExit):
            main(["new", str(folder / f"{name}.toml"), *options])
    return {name: folder / f"{name}.toml" for name in FIRST}


@pytest.fixture(autouse=True)
def pictures(monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setattr("sonolube.report.page.drawn", lambda drawing, *, forms: dict.fromkeys(forms, b""))


def run(folder: Path, *words: str) -> int:
    with pytest.raises(SystemExit) as end:
        main([*words, *(() if words[0] in ("contact", "friction", "wear") else ("--out", str(folder)))])
    return int(end.value.code or 0)


@pytest.mark.parametrize("name", FIRST)
@pytest.mark.parametrize("task", ANSWERED)
def test_a_first_rig_has_an_answer(name: str, task: str, rigs: dict[str, Path], tmp_path: Path) -> None:
    options: Sequence[str] = ANSWERED[task]
    if name == "actuator" and task == "sweep":
        options = ("--over", "drive.voltage_peak_to_peak=10V:50V:3")
    assert run(tmp_path, task, str(rigs[name]), *options) == 0


@pytest.mark.parametrize("task", VOLTAGE)
def test_what_needs_a_voltage_answers_with_one_and_names_it_without(
    task: str, rigs: dict[str, Path], tmp_path: Path, capsys: CaptureFixture[str]
) -> None:
    assert run(tmp_path, task, str(rigs["actuator"]), *VOLTAGE[task]) == 0
    capsys.readouterr()
    assert run(tmp_path, task, str(rigs["amplitude"]), *VOLTAGE[task]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "drive.voltage_peak_to_peak is missing" in line
    assert "vibration.vibration_amplitude" in line


@pytest.mark.parametrize("name", FIRST)
@pytest.mark.parametrize("task", STRUCTURE)
def test_what_needs_a_structure_names_its_tables(
    name: str, task: str, rigs: dict[str, Path], tmp_path: Path, capsys: CaptureFixture[str]
) -> None:
    assert run(tmp_path, task, str(rigs[name]), *STRUCTURE[task]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "the tables stack and structure are missing" in line or "drive.voltage_peak_to_peak is missing" in line


def test_a_map_without_a_capacitance_names_it(
    rigs: dict[str, Path], tmp_path: Path, capsys: CaptureFixture[str]
) -> None:
    volts = ("--set", "drive.voltage_peak_to_peak=50V")
    assert run(tmp_path, "map", str(rigs["amplitude"]), *volts) == 2
    assert "actuator.capacitance is missing" in capsys.readouterr().err
    assert run(tmp_path, "map", str(rigs["amplitude"]), "--kind", "frequency-voltage", *volts) == 0


def test_own_runs_fit_a_first_rig(rigs: dict[str, Path], tmp_path: Path) -> None:
    assert run(tmp_path, "fit", RUNS, "--rig", str(rigs["actuator"]), "--model", "kinematic") == 0
