"""Command `sweep --of`: friction over one quantity, with its figure and dataset."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

Program = Callable[..., Any]


def test_the_point_of_least_friction_is_in_the_answer_and_all_points_are_in_the_dataset(
    tmp_path: Path, sonolube: Program, rigs: Path
) -> None:
    ends = ["--from", "10V", "--to", "30V", "--points", "3"]
    answer = sonolube("sweep", rigs / "tribometer.toml", "--of", "voltage", *ends, "--json", "--out", tmp_path).answer
    assert sorted(Path(name).suffix for name in answer["files"]) == [".nc", ".pdf", ".png", ".svg"]
    assert sorted(Path(name) for name in answer["files"]) == sorted(tmp_path.iterdir())
    (best,) = answer["least_friction"]
    assert best["voltage_peak_to_peak"] == {"value": 30.0, "unit": "V"}
    assert (answer["points"], answer["without_result"]) == (3, [])


def test_voltages_beyond_the_limit_of_the_stack_have_a_reason(tmp_path: Path, sonolube: Program, rigs: Path) -> None:
    limit = ["--set", "stack.highest_voltage=50V", "--points", "5"]
    run = sonolube("sweep", rigs / "tribometer.toml", "--of", "voltage", *limit, "--out", tmp_path)
    assert run.code == 0, run.err
    assert "the highest admissible voltage is 50 V" in run.out
    assert "least friction   ratio 0.154 at 50 V" in run.out


def test_every_voltage_is_a_curve_over_speed(tmp_path: Path, sonolube: Program, rigs: Path) -> None:
    curves = ("--voltage", "14V", "--voltage", "28V", "--points", "3")
    answer = sonolube("sweep", rigs / "tribometer.toml", "--of", "speed", *curves, "--json", "--out", tmp_path).answer
    assert [best["voltage_peak_to_peak"]["value"] for best in answer["least_friction"]] == [14, 28]


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (("voltage", "--to", "3kHz"), "--to 3kHz is a frequency; expected a voltage"),
        (("load", "--from", "0N"), "--from 0N must lie above 0 N and must lie below --to 9N"),
        (("speed", "--from", "2m/s"), "--from 2m/s must lie above 0 m/s and must lie"),
        (("waveform", "--points", "5"), "have no meaning for --of waveform"),
        (("load", "--voltage", "5V"), "--voltage has no meaning for --of load"),
        (("load", "--points", "1"), "--points 1 must lie between 2 and 10000 for --of load"),
        (("load", "--workers", "3"), "--workers has no meaning for --of"),
        (("colour",), "sonolube sweep: Invalid value for '--of'"),
        (("speed", "--points", "3", "--set", "contact.normal_load=1MN"), "no point has a result: normal_load 1e+06 N"),
    ],
)
def test_a_study_without_meaning_is_refused_in_one_line(
    arguments: tuple[str, ...], line: str, tmp_path: Path, sonolube: Program, rigs: Path
) -> None:
    run = sonolube("sweep", rigs / "tribometer.toml", "--of", *arguments, "--out", tmp_path / "none")
    assert line in run.refusal
    assert not (tmp_path / "none").exists()
