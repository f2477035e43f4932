"""The command `compare` as its users meet it: in a process of its own."""

import json
import subprocess
import sys
from pathlib import Path

import pytest
from pytest import approx

ROOT = Path(__file__).parents[3]
RIG = "examples/rigs/tribometer.toml"
QUICK = ("--model", "stick-slip", "--model", "kinematic", "--model", "dahl-driven")


def compare(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [Path(sys.executable).parent / "sonolube", "compare", *arguments],
        capture_output=True,
        text=True,
        check=False,
        cwd=ROOT,
    )


def test_models_are_compared_on_the_tests_and_on_a_rig_for_programs(tmp_path: Path) -> None:
    run = compare(RIG, *QUICK, "--json", "--out", str(tmp_path))
    assert run.returncode == 0, run.stderr
    answer = json.loads(run.stdout)
    stick_slip, kinematic, driven = answer["models"]
    assert (stick_slip["name"], kinematic["name"], driven["errors"]) == ("stick-slip", "kinematic", None)
    (memory,) = stick_slip["fitted"]
    assert memory["bounds"][0] <= memory["interval"][0] < memory["value"] < memory["interval"][1]
    said = {one["model"]: one for one in answer["rig"]["predictions"]}
    assert said["kinematic"]["uncertainty"] == approx(kinematic["errors"]["rms_unseen"])
    assert "the stiffness of the holder" in said["dahl-driven"]["reason"]
    assert {Path(file).suffix for file in answer["files"]} == {".png", ".svg", ".csv", ".nc"}
    assert all(Path(file).stat().st_size > 0 for file in answer["files"])


def test_people_read_errors_what_was_fitted_and_what_was_not(tmp_path: Path) -> None:
    run = compare(*QUICK, "--out", str(tmp_path))
    assert run.returncode == 0, run.stderr
    assert "memory_length 3.4" in run.stdout
    assert "not fitted: set H" in run.stdout
    assert "not reached: dahl-driven: needs the amplitude along the sliding" in run.stdout


def test_a_model_that_no_test_suits_is_listed_and_not_drawn(tmp_path: Path) -> None:
    run = compare("--model", "dahl-driven", "--out", str(tmp_path))
    assert run.returncode == 0, run.stderr
    assert "not reached: dahl-driven" in run.stdout
    assert sorted(file.name for file in tmp_path.iterdir()) == ["models.csv", "models.nc"]


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["--model", "stickslip"], "did you mean stick-slip"),
        (["--set", "contact.normal_load=4N"], "--set changes a rig"),
        ([RIG, "--set", "sliding.sliding_speed=0mm/s", *QUICK], "sliding_speed is 0"),
    ],
)
def test_what_cannot_be_compared_is_told_in_one_line(arguments: list[str], complaint: str, tmp_path: Path) -> None:
    run = compare(*arguments, "--out", str(tmp_path))
    assert run.returncode == 2
    assert complaint in run.stderr
    assert len(run.stderr.strip().splitlines()) == 1
    assert not list(tmp_path.iterdir())
