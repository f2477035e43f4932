"""The commands `optimise`, `efficiency` and `actuators`: what they write, tell and refuse."""

import json
from pathlib import Path

import pytest
import xarray as xr
from pytest import CaptureFixture, approx, raises

from sonolube.cli import main

EXAMPLES = Path(__file__).parents[2] / "examples"
TRIBOMETER, POWER_MAP = (str(EXAMPLES / "rigs" / f"{name}.toml") for name in ("tribometer", "power_map"))
RUNS = str(EXAMPLES / "efficiency-runs.csv")


def answer(capsys: CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    with raises(SystemExit) as end:
        main(arguments)
    out, err = capsys.readouterr()
    return int(str(end.value.code)), out, err


def test_the_rig_file_of_a_design_gives_the_friction_it_was_asked_for(
    tmp_path: Path, capsys: CaptureFixture[str]
) -> None:
    asked = ("--target-friction", "0.45N", "--set", "contact.normal_load=4N", "--over", "drive.frequency=18kHz:24kHz")
    chosen = ("--actuator", "own", "--actuator", "nac2023", "--current-limit", "20A", "--samples", "2")
    code, out, _ = answer(capsys, "optimise", TRIBOMETER, *asked, *chosen, "--json", "--out", str(tmp_path))
    assert code == 0
    told = json.loads(out)
    best = told["designs"][0]
    assert {design["actuator"] for design in told["designs"]} == {"own", "nac2023"}
    assert best["limits_used"]["current"] <= 1
    written = tmp_path / "tribometer-optimum.toml"
    code, out, _ = answer(capsys, "simulate", str(written), "--json", "--out", str(tmp_path))
    assert code == 0
    simulated = json.loads(out)
    assert simulated["friction_force"]["value"] == approx(0.45, rel=2e-4)
    assert simulated["actuator_power"]["value"] == approx(best["actuator_power"]["value"], rel=1e-9)
    assert simulated["vibration_amplitude"]["value"] == approx(best["vibration_amplitude"]["value"], rel=1e-5)
    with xr.open_dataset(tmp_path / "tribometer-optimum.nc") as designs:
        assert int(designs["feasible"].sum()) == told["feasible"]
        assert designs.sizes["design"] == told["screened"]


def test_a_front_of_tolerant_designs_is_drawn(tmp_path: Path, capsys: CaptureFixture[str]) -> None:
    asked = ("--target-friction", "0.2", "--over", "drive.frequency=21kHz:23kHz", "--robust", "0.02")
    pressed = ("--bolt", "M10x60mm", "--preload", "12kN", "--source-resistance", "50ohm")
    code, out, _ = answer(
        capsys, "optimise", TRIBOMETER, *asked, *pressed, "--pareto", "voltage", "--out", str(tmp_path)
    )
    assert code == 0
    assert "at every corner of 2 %" in out
    assert "L network" in out
    assert (tmp_path / "tribometer-optimum-front.png").is_file()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--target-friction", "0.9"), "must lie between nought and friction without vibration, 0.341"),
        (("--target-friction", "2N"), "must lie between nought and friction without vibration, 1.023 N"),
        (("--target-friction", "0.1", "--actuator", "sa0505"), "unknown actuator 'sa0505'; did you mean"),
        (("--target-friction", "0.1", "--over", "contact.normal_load=1N:2N"), "choose over drive.frequency"),
        (("--target-friction", "0.1", "--over", "drive.waveform=saw"), "none of sine, square"),
        (("--target-friction", "0.1", "--bolt", "M6x40mm"), "--bolt and --preload belong together"),
        (("--target-friction", "0.1", "--bolt", "6mm", "--preload", "1kN"), "must look like M6x40mm"),
        (("--target-friction", "0.1", "--horn", "m50"), "--horn and --horn-limit belong together"),
        (("--target-friction", "0.1", "--temperature-limit", "40K"), "needs --conductance"),
        (("--target-friction", "0.1", "--quantile", "0.9"), "--quantile needs --robust"),
        (("--target-friction", "0.1", "--voltage-limit", "1V"), "out of reach: no design"),
    ],
)
def test_what_makes_no_design_is_refused_in_one_line(
    arguments: tuple[str, ...], said: str, tmp_path: Path, capsys: CaptureFixture[str]
) -> None:
    code, _, err = answer(capsys, "optimise", TRIBOMETER, *arguments, "--out", str(tmp_path / "none"))
    assert code == 2
    assert said in err
    assert "\n" not in err.strip()
    assert not (tmp_path / "none").exists()


def test_runs_drawn_about_the_published_line_give_it_back_within_its_errors(
    tmp_path: Path, capsys: CaptureFixture[str]
) -> None:
    wanted = ("--target-friction", "0.4N", "--speed", "65.5mm/s")
    code, out, _ = answer(capsys, "efficiency", RUNS, "--rig", POWER_MAP, *wanted, "--json", "--out", str(tmp_path))
    assert code == 0
    told = json.loads(out)
    for name, truth in (("slope", -2.93e-9), ("intercept", 0.672e-9)):
        assert told[name]["value"] == approx(truth, abs=2.1 * told[f"{name}_uncertainty"]["value"])
    power = (0.89 - 0.4) * 0.0655 * 0.126e-6 / (5 * (0.672e-9 - 2.93e-9 * 0.0655))  # D 4.3
    assert told["lowest_power"]["value"] < power < told["highest_power"]["value"]
    assert {Path(path).suffix for path in told["files"]} == {".html", ".png", ".svg", ".nc"}


def test_a_speed_beyond_the_runs_is_refused(tmp_path: Path, capsys: CaptureFixture[str]) -> None:
    wanted = ("--target-friction", "0.4N", "--speed", "0.3m/s")
    code, _, err = answer(capsys, "efficiency", RUNS, "--rig", POWER_MAP, *wanted, "--out", str(tmp_path))
    assert code == 2
    assert "must lie within the runs, 0.04 to 0.17 m/s" in err


def test_runs_without_power_are_refused_by_column(tmp_path: Path, capsys: CaptureFixture[str]) -> None:
    path = tmp_path / "runs.csv"
    path.write_text("sliding_speed [mm/s],friction_reduction [%]\n40,50\n50,40\n60,30\n")
    code, _, err = answer(capsys, "efficiency", str(path), "--rig", POWER_MAP, "--out", str(tmp_path))
    assert code == 2
    assert "need a column actuator_power" in err


def test_actuators_are_listed_with_their_sources(capsys: CaptureFixture[str]) -> None:
    code, out, _ = answer(capsys, "actuators", "--json")
    assert code == 0
    listed = json.loads(out)
    assert listed["apa40sm"]["source"] == "Dissertation (D), section 2.2.2"
    assert "blocked_force" not in listed["apa40sm"]
    code, out, _ = answer(capsys, "actuators")
    assert "not printed" in out
    code, _, err = answer(capsys, "actuators", "sa05051")
    assert code == 2
    assert "did you mean sa050510?" in err
