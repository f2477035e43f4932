"""Command `fit`: one example table for every command that reads runs, what a user reads, and refusals."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import xarray as xr
from pytest import approx

Program = Callable[..., Any]
RUNS = Path(__file__).parents[3] / "examples" / "tribometer-runs.csv"
CONTACTLESS = "vibration_amplitude [um],frequency [kHz],sliding_speed [mm/s],friction_ratio\n"


def test_the_fit_ranks_models_names_those_that_miss_an_input_and_says_what_to_measure(
    tmp_path: Path, sonolube: Program, rigs: Path
) -> None:
    answer = sonolube("fit", RUNS, "--rig", rigs / "tribometer.toml", "--json", "--out", tmp_path).answer
    errors = [model["rms_unseen"] for model in answer["models"] if model["conditions_in_range"] == 4]
    assert errors == sorted(errors)
    assert answer["decided"] is False
    assert "4 conditions are too few" in answer["verdict"]
    assert "vibration_direction [deg]" in answer["not_applicable"]["coulomb-in-plane"]
    assert answer["measure_next"][0]["contrast"] > 1
    assert {Path(path).suffix for path in answer["files"]} == {".png", ".svg", ".pdf", ".nc"}
    with xr.open_dataset(tmp_path / "tribometer-runs-fit.nc") as found:
        assert found.sizes["condition"] == 4
        assert found.attrs["verdict"] == answer["verdict"]


def test_the_next_condition_of_runs_by_voltage_is_told_in_volts(tmp_path: Path, sonolube: Program, rigs: Path) -> None:
    models = ("--model", "kinematic-fitted", "--model", "asperity-stick-slip-fitted")
    run = sonolube("fit", RUNS, "--rig", rigs / "tribometer.toml", *models, "--out", tmp_path)
    found = re.search(r"measure next: ([\d.]+) (um|nm), .* \(([\d.]+) V peak to peak\)", run.out)
    assert found is not None
    amplitude = float(found[1]) * {"um": 1e-6, "nm": 1e-9}[found[2]]
    assert float(found[3]) == approx(28 * amplitude / 2.5e-6, rel=0.01)  # the rig has 2.5 um at 28 V


def test_without_a_rig_models_without_contact_apply_and_the_others_name_the_rig_file(
    tmp_path: Path, sonolube: Program
) -> None:
    runs = tmp_path / "runs.csv"
    runs.write_text(CONTACTLESS + "1,22,20,0.6\n2,22,20,0.4\n2,22,60,0.7\n1,22,60,0.8\n")
    run = sonolube("fit", runs, "--out", tmp_path)
    assert "kinematic-fitted" in run.out
    assert "needs a rig file (roughness and materials)" in run.out
    assert "measure next:" in run.out


@pytest.mark.parametrize("command", ["predict", "compare", "map"])
def test_one_table_of_runs_serves_every_command(command: str, tmp_path: Path, sonolube: Program, rigs: Path) -> None:
    rig = rigs / "tribometer.toml"
    more = {
        "predict": (),
        "compare": ("--model", "kinematic"),
        "map": ("--over", "drive.voltage_peak_to_peak=10V,20V,30V", "--over", "sliding.sliding_speed=20mm/s,60mm/s"),
    }[command]
    answer = sonolube(command, rig, "--runs", RUNS, *more, "--json", "--out", tmp_path).answer
    assert answer["files"]


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("sliding_speed [mm/s],friction_ratio\n20,0.5\n", "1 run under one condition (20 mm/s) rank no models"),
        ("sliding_speed [mm/s]\n20\n", "needs a column friction_reduction [%]"),
        ("sliding_speed [N],friction_ratio\n20,0.5\n", "line 1: sliding_speed"),
        ("sliding_speed [mm/s],friction_ratio\n20,\n30,\n", "no run has a result yet: fill in"),
        ("sliding_speed [mm/s],friction_ratio\n20,7\n30,0.5\n", "friction ratio of 7"),
        ("voltage_peak_to_peak [V],friction_ratio\n20,0.7\n30,0.5\n", "or a rig file that scales them (--rig)"),
    ],
)
def test_runs_that_cannot_be_fitted_are_refused_in_one_line(
    text: str, line: str, tmp_path: Path, sonolube: Program
) -> None:
    runs = tmp_path / "runs.csv"
    runs.write_text(text)
    refusal = sonolube("fit", runs, "--out", tmp_path / "none").refusal
    assert line in refusal
    assert refusal.strip().count("\n") == 0


def test_changes_without_a_rig_are_refused(sonolube: Program) -> None:
    assert "--set needs a rig; name its file" in sonolube("fit", RUNS, "--set", "contact.normal_load=2N").refusal
