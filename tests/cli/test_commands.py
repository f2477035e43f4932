"""The command line as its users meet it: in a process of its own."""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from pytest import approx

from sonolube.vocabulary import quantity

ROOT = Path(__file__).parents[2]
RIGS = ROOT / "examples" / "rigs"


def sonolube(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [Path(sys.executable).parent / "sonolube", *arguments], capture_output=True, text=True, check=False, cwd=ROOT
    )


def answer(*arguments: str) -> dict[str, Any]:
    run = sonolube(*arguments, "--json")
    assert run.returncode == 0, run.stderr
    content: dict[str, Any] = json.loads(run.stdout)
    return content


@pytest.mark.parametrize(
    ("command", "names"),
    [
        (
            "contact",
            ["separation", "real_contact_area", "contact_count", "normal_stiffness", "tangential_stiffness"],
        ),
        (
            "friction",
            [
                "friction_force",
                "friction_coefficient",
                "friction_ratio",
                "friction_reduction",
                "vibration_amplitude",
                "actuator_power",
            ],
        ),
        ("wear", ["wear_rate", "vibration_amplitude"]),
    ],
)
def test_a_command_answers_in_words_of_the_vocabulary_and_si(command: str, names: list[str]) -> None:
    result = answer(command, str(RIGS / "tribometer.toml"))
    for name in names:
        assert result[name]["unit"] == quantity(name).unit
        assert result[name]["value"] > 0


def test_the_published_separation_of_18_um_is_one_command_away() -> None:
    result = answer("contact", str(RIGS / "poisson_al_steel.toml"), "--load", "40N")
    assert result["separation"]["value"] == approx(18.11e-6, abs=0.005e-6)
    assert result["normal_load"] == {"value": 40.0, "unit": "N"}


def test_friction_force_and_coefficient_belong_together() -> None:
    result = answer("friction", str(RIGS / "power_map.toml"), "--set", "contact.normal_load=7N")
    assert result["friction_force"]["value"] == approx(7 * result["friction_coefficient"]["value"])
    assert result["friction_reduction"]["value"] == approx(1 - result["friction_ratio"]["value"])


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (
            ["contact", "RIG", "--load", "40mm"],
            "sonolube contact: --load 40mm is a length; expected a force, such as 40N",
        ),
        (["contact", "RIG", "--load", "40"], "sonolube contact: --load 40 has no unit; expected a force, such as 40N"),
        (["contact", "RIG", "--load", "-3N"], "normal_load must be positive, got -3.0 N"),
        (["contact", "RIG", "--load", "1e9N"], "leaves no separation"),
        (["friction", "RIG", "--set", "drive.frequenzy=1kHz"], "drive.frequenzy: unknown key; did you mean frequency?"),
        (["friction", "RIG", "--set", "drive"], "change 'drive' must look like drive.frequency=22kHz"),
        (["wear", "none.toml"], "sonolube wear: none.toml: no such file"),
        (["materials", "unobtainium"], "sonolube materials: unknown material 'unobtainium'"),
        (["published", "9.9"], "sonolube published: unknown table '9.9'"),
        (["reproduce", "--chapter", "7"], "sonolube reproduce:"),
        (["study", "RIG", "--of", "voltage", "--to", "3kHz"], "--to 3kHz is a frequency; expected a voltage"),
        (["study", "RIG", "--of", "load", "--from", "0N"], "--from 0N must lie above 0 N and must lie below --to 9N"),
        (
            ["study", "RIG", "--of", "speed", "--from", "2m/s"],
            "--from 2m/s must lie above 0 m/s and must lie",
        ),
        (["study", "RIG", "--of", "waveform", "--points", "5"], "have no meaning for --of waveform"),
        (["study", "RIG", "--of", "load", "--voltage", "5V"], "--voltage has no meaning for --of load"),
        (["study", "RIG", "--of", "colour"], "sonolube study: Invalid value for '--of'"),
        (["study", "RIG"], "sonolube study: Missing option '--of'"),
        (
            ["thermal", "RIG", "--pin", "m50", "--disc", "powder_coating"],
            "powder_coating has no thermal_conductivity",
        ),
        (
            ["regime", "RIG", "--film-coefficient", "0.1", "--asperity-pressure", "10mm"],
            "--asperity-pressure 10mm is a length",
        ),
        (
            ["regime", "RIG", "--film-coefficient", "0.1", "--asperity-pressure", "10MPa", "--pin", "m50"],
            "--pin and --disc belong together",
        ),
        (["contact"], "sonolube contact: Missing argument 'RIG.toml'"),
        (["fricton", "RIG"], "sonolube fricton: No such command 'fricton'. Did you mean 'friction'?"),
    ],
)
def test_bad_input_gets_one_clear_line_and_exit_code_2(arguments: list[str], complaint: str) -> None:
    run = sonolube(*[str(RIGS / "tribometer.toml") if word == "RIG" else word for word in arguments])
    assert run.returncode == 2
    assert run.stdout == ""
    assert complaint in run.stderr
    assert len(run.stderr.splitlines()) == 1


@pytest.mark.parametrize(
    "command", ["reproduce", "contact", "friction", "wear", "study", "materials", "published", "schema"]
)
def test_help_of_every_command_shows_an_example(command: str) -> None:
    run = sonolube(command, "--help")
    assert run.returncode == 0
    assert f"Example: sonolube {command}" in " ".join(run.stdout.split())


def test_every_material_is_listed_with_its_sources() -> None:
    listed = answer("materials")
    assert "aluminium_2024" in listed
    assert all(entry["source"] for entry in listed["m50"]["properties"].values())


def test_a_published_table_is_shown_as_printed_with_its_corrections() -> None:
    shown = answer("published", "2.5")
    assert "2.237" in json.dumps(shown)
    assert any(correction["erratum"] == "E27" for correction in shown["corrections"])


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_completion_can_be_had_for_every_shell(shell: str) -> None:
    run = subprocess.run(
        [Path(sys.executable).parent / "sonolube"],
        capture_output=True,
        text=True,
        check=False,
        env=os.environ | {"_SONOLUBE_COMPLETE": f"source_{shell}"},
    )
    assert run.returncode == 0
    assert "_SONOLUBE_COMPLETE" in run.stdout


@pytest.mark.parametrize("command", ["simulate", "response", "transient"])
def test_a_command_on_motion_answers_with_status_or_files_and_writes_them_whole(command: str, tmp_path: Path) -> None:
    extra = ["--out", str(tmp_path), *(["--duration", "0.01s"] if command == "transient" else [])]
    result = answer(command, str(RIGS / "tribometer.toml"), *extra)
    files = [Path(name) for name in result.get("files", [])]
    assert sorted(files) == sorted(tmp_path.iterdir())
    assert all(path.stat().st_size > 1000 for path in files)
    assert sorted(path.suffix for path in files) == [".nc", ".png", ".svg"]


def test_a_study_tells_its_least_friction_and_writes_figure_and_netcdf(tmp_path: Path) -> None:
    range_ = ["--from", "10V", "--to", "30V", "--points", "3"]
    result = answer("study", str(RIGS / "tribometer.toml"), "--of", "voltage", *range_, "--out", str(tmp_path))
    assert sorted(Path(name).suffix for name in result["files"]) == [".nc", ".png", ".svg"]
    assert sorted(Path(name) for name in result["files"]) == sorted(tmp_path.iterdir())
    (best,) = result["least_friction"]
    assert best["voltage_peak_to_peak"] == {"value": 30.0, "unit": "V"}
    assert (result["points"], result["without_result"]) == (3, [])


def test_a_study_keeps_a_reason_for_what_the_stack_does_not_bear(tmp_path: Path) -> None:
    limit = ["--set", "stack.highest_voltage=50V", "--points", "5"]
    run = sonolube("study", str(RIGS / "tribometer.toml"), "--of", "voltage", *limit, "--out", str(tmp_path))
    assert run.returncode == 0, run.stderr
    assert "the highest admissible voltage is 50 V" in run.stdout
    assert "least friction       ratio 0.154 at 50 V" in run.stdout


def test_what_identify_writes_is_a_rig_that_simulates(tmp_path: Path) -> None:
    path = tmp_path / "identified.toml"
    run = sonolube("identify", "rig", str(RIGS / "tribometer.toml"), "--out", str(path))
    assert run.returncode == 0, run.stderr
    simulated = answer("simulate", str(path), "--out", str(tmp_path))
    assert simulated["vibration_amplitude"]["value"] == approx(2.5e-6, rel=0.02)


def test_heat_and_regime_answer_with_the_figure_they_wrote(tmp_path: Path) -> None:
    solids = ["--pin", "stainless_steel_316", "--disc", "aluminium_2024", "--out", str(tmp_path)]
    heat = answer("thermal", str(RIGS / "tribometer.toml"), *solids)
    assert heat["temperature_rise_ratio"]["value"] == approx(heat["friction_ratio"]["value"])
    lubricant = ["--film-coefficient", "0.25", "--asperity-pressure", "10MPa"]
    regime = answer("regime", str(RIGS / "tribometer.toml"), *lubricant, *solids)
    assert regime["best"] == "ultrasonic"
    assert regime["wear"]["kind"] == "abrasive"
    assert sorted(map(Path, [*heat["files"], *regime["files"]])) == sorted(tmp_path.iterdir())
