"""Command `compare`: errors, predictions of a rig, files and refusals."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from pytest import approx

Program = Callable[..., Any]
QUICK = ("--model", "asperity-stick-slip-fitted", "--model", "kinematic", "--model", "dahl-driven")


def test_errors_fits_and_predictions_of_a_rig_are_in_the_answer(tmp_path: Path, sonolube: Program, rigs: Path) -> None:
    answer = sonolube("compare", rigs / "tribometer.toml", *QUICK, "--json", "--out", tmp_path).answer
    stick_slip, kinematic, driven = answer["models"]
    assert (stick_slip["name"], kinematic["name"], driven["errors"]) == (
        "asperity-stick-slip-fitted",
        "kinematic",
        None,
    )
    (memory,) = stick_slip["fitted"]
    assert memory["bounds"][0] <= memory["interval"][0] < memory["value"] < memory["interval"][1]
    predicted = {one["model"]: one for one in answer["rig"]["predictions"]}
    assert predicted["kinematic"]["uncertainty"] == approx(kinematic["errors"]["rms_cross_validated"])
    assert "the stiffness of the holder" in predicted["dahl-driven"]["reason"]
    assert {Path(file).suffix for file in answer["files"]} == {".png", ".svg", ".pdf", ".csv", ".nc"}
    assert all(Path(file).stat().st_size > 0 for file in answer["files"])


def test_the_lines_have_errors_fitted_parameters_and_tests_out_of_reach(tmp_path: Path, sonolube: Program) -> None:
    run = sonolube("compare", *QUICK, "--out", tmp_path)
    assert run.code == 0, run.err
    assert "memory_length 1.67" in run.out
    assert "not fitted: set H" in run.out
    assert "not reached: dahl-driven: needs the amplitude along the sliding" in run.out


def test_a_model_that_suits_no_test_is_listed_and_not_drawn(tmp_path: Path, sonolube: Program) -> None:
    run = sonolube("compare", "--model", "dahl-driven", "--out", tmp_path)
    assert run.code == 0, run.err
    assert "not reached: dahl-driven" in run.out
    assert sorted(file.name for file in tmp_path.iterdir()) == ["models.csv", "models.nc"]


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (("--model", "stickslip"), "did you mean asperity-stick-slip"),
        (("--set", "contact.normal_load=4N"), "--set needs a rig"),
        (("RIG", "--set", "sliding.sliding_speed=0mm/s", *QUICK), "sliding_speed is 0"),
    ],
)
def test_a_comparison_without_meaning_is_refused_in_one_line(
    arguments: tuple[str, ...], line: str, tmp_path: Path, sonolube: Program, rigs: Path
) -> None:
    words = [rigs / "tribometer.toml" if word == "RIG" else word for word in arguments]
    assert line in sonolube("compare", *words, "--out", tmp_path).refusal
    assert not list(tmp_path.iterdir())
