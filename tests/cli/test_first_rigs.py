"""Rigs as `new` writes them, by an amplitude and by an actuator, through every task that takes a rig alone."""

import json
from collections.abc import Sequence
from pathlib import Path

import pytest
from pytest import CaptureFixture, MonkeyPatch, approx
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
COMMANDED = {
    "map": ("--over", "sliding.sliding_speed=20mm/s,50mm/s"),
    "control": ("--stick-slip",),
    "sweep of speed": ("--of", "speed", "--points", "3"),
    "sweep of load": ("--of", "load", "--points", "3"),
}
BY_AMPLITUDE = {
    "map": ("--kind", "frequency-amplitude", "--over", "vibration.vibration_amplitude=1um,3um"),
    "sweep": ("--of", "amplitude", "--points", "3"),
}
BY_VOLTAGE = {
    ("map", "--kind", "velocity-power"): "take --kind velocity-amplitude, velocity-stress or frequency-amplitude",
    ("map", "--kind", "frequency-voltage"): "take --kind velocity-amplitude, velocity-stress or frequency-amplitude",
    ("sweep", "--of", "voltage"): "take --of amplitude",
    ("sweep", "--of", "speed", "--voltage", "3V"): "give --vibration of each curve",
    ("control", "--voltage-limit", "30V"): "--voltage-limit has no meaning for an amplitude that is commanded",
    ("control", "--warming", "40K"): "--warming has no meaning for an amplitude that is commanded",
    ("control", "--feed-forward", "efficiency"): "take model",
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


@pytest.mark.parametrize("name", FIRST)
@pytest.mark.parametrize("task", COMMANDED)
def test_a_first_rig_is_commanded_by_what_it_has(name: str, task: str, rigs: dict[str, Path], tmp_path: Path) -> None:
    assert run(tmp_path, task.partition(" ")[0], str(rigs[name]), *COMMANDED[task]) == 0


@pytest.mark.parametrize("task", BY_AMPLITUDE)
def test_a_rig_without_a_voltage_names_its_amplitude_alone(
    task: str, rigs: dict[str, Path], tmp_path: Path, capsys: CaptureFixture[str]
) -> None:
    assert run(tmp_path, task, str(rigs["amplitude"]), *BY_AMPLITUDE[task], "--json") == 0
    found = json.loads(capsys.readouterr().out)
    written = json.dumps({name: value for name, value in found.items() if name != "files"})
    assert "vibration_amplitude" in written
    assert "voltage" not in written
    assert "power" not in written


def test_files_of_a_controller_without_a_voltage_speak_of_amplitude_alone(
    rigs: dict[str, Path], tmp_path: Path, capsys: CaptureFixture[str]
) -> None:
    assert run(tmp_path, "control", str(rigs["amplitude"]), "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert found["amplitude_maximum"]["value"] == approx(3e-6)
    assert "electrical_energy" not in found
    assert "amplitude limit" in found["assumptions"]
    source = (tmp_path / "amplitude-control.c").read_text(encoding="utf-8")
    table = (tmp_path / "amplitude-control.csv").read_text(encoding="utf-8")
    assert "#define SONOLUBE_HIGHEST_AMPLITUDE (3e-06) /* m zero to peak */" in source
    assert table.splitlines()[0].startswith("friction_force [N],vibration_amplitude [m],lowest_predicted_force [N],")
    assert "volt" not in source.lower() + table.lower()


@pytest.mark.parametrize("words", BY_VOLTAGE, ids=" ".join)
def test_what_is_of_a_voltage_alone_names_the_option_that_helps(
    words: tuple[str, ...], rigs: dict[str, Path], tmp_path: Path, capsys: CaptureFixture[str]
) -> None:
    assert run(tmp_path, words[0], str(rigs["amplitude"]), *words[1:]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert BY_VOLTAGE[words] in line
    assert not list(tmp_path.iterdir())


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
