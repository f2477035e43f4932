"""Command `efficiency`: line, power and refusals."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from pytest import approx

Program = Callable[..., Any]


@pytest.fixture
def call(rigs: Path, tmp_path: Path) -> tuple[object, ...]:
    return (rigs.parent / "efficiency-runs.csv", "--rig", rigs / "power_map.toml", "--out", tmp_path)


def test_runs_drawn_about_the_published_line_give_it_back_within_its_errors(
    call: tuple[object, ...], sonolube: Program
) -> None:
    target = ("--target-friction", "0.4N", "--speed", "65.5mm/s", "--json")
    answer = sonolube("efficiency", *call, *target).answer
    for name, truth in (("slope", -2.93e-9), ("intercept", 0.672e-9)):
        assert answer[name]["value"] == approx(truth, abs=2.1 * answer[f"{name}_uncertainty"]["value"])
    power = (0.89 - 0.4) * 0.0655 * 0.126e-6 / (5 * (0.672e-9 - 2.93e-9 * 0.0655))  # D 4.3
    assert answer["lowest_power"]["value"] < power < answer["highest_power"]["value"]
    assert {Path(path).suffix for path in answer["files"]} == {".html", ".png", ".svg", ".pdf", ".nc"}


def test_a_speed_beyond_the_runs_is_refused(call: tuple[object, ...], sonolube: Program) -> None:
    target = ("--target-friction", "0.4N", "--speed", "0.3m/s")
    assert "must lie within the runs, 0.04 to 0.17 m/s" in sonolube("efficiency", *call, *target).refusal


def test_runs_without_power_are_refused_by_column(tmp_path: Path, sonolube: Program, rigs: Path) -> None:
    path = tmp_path / "runs.csv"
    path.write_text("sliding_speed [mm/s],friction_reduction [%]\n40,50\n50,40\n60,30\n")
    run = sonolube("efficiency", path, "--rig", rigs / "power_map.toml", "--out", tmp_path)
    assert "need a column actuator_power" in run.refusal
