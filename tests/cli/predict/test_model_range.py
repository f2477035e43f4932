"""Commands on friction outside the range of its model: null beside a status and a reason."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

Program = Callable[..., Any]
FAST = "sliding.sliding_speed=1m/s"
PRINTED = "friction.model=dong_2015_full_period"
OUTSIDE = "outside_model_range"


def friction_of(answer: dict[str, Any]) -> list[float | None]:
    names = ("friction_ratio", "friction_force", "friction_coefficient", "friction_reduction")
    return [answer[name]["value"] for name in names]


@pytest.mark.parametrize("command", ["friction", "simulate"])
def test_friction_without_meaning_is_null_with_a_reason(
    sonolube: Program, rigs: Path, tmp_path: Path, command: str
) -> None:
    volts = ["--set", "drive.voltage_peak_to_peak=100V", "--out", tmp_path] if command == "simulate" else []
    rig = rigs / "tribometer.toml"
    answer = sonolube(command, rig, "--set", FAST, "--set", PRINTED, *volts, "--json").answer
    assert answer["status"] == OUTSIDE
    assert answer["reason"].startswith(OUTSIDE)
    assert friction_of(answer) == [None] * 4
    assert answer["raw_friction_ratio"]["value"] > 1
    assert answer["intrinsic_friction_force"]["value"] > 0


def test_the_text_has_no_number_for_it_but_the_range_of_the_models_that_hold(sonolube: Program, rigs: Path) -> None:
    lines = sonolube("friction", rigs / "tribometer.toml", "--set", FAST, "--set", PRINTED).out.splitlines()
    assert [line.split()[-1] for line in lines if line.startswith("  Friction reduction")] == ["none"]
    assert not any("also outside its range" in line for line in lines)
    assert any("use asperity_stick_slip" in line for line in lines)
    assert any("the friction models that hold give ratios from" in line for line in lines)


def test_within_the_range_the_text_has_the_ratio_once(sonolube: Program, rigs: Path) -> None:
    out = sonolube("friction", rigs / "tribometer.toml").out
    assert "also outside its range" not in out
    assert "none" not in out


def test_the_map_of_studies_has_no_point_for_it(sonolube: Program, rigs: Path, tmp_path: Path) -> None:
    options = ("--set", FAST, "--set", PRINTED, "--out", tmp_path)
    assert sonolube("literature", rigs / "tribometer.toml", *options, "--json").answer["rig"]["friction_reduction"] == {
        "value": None,
        "unit": "",
    }
    assert "use asperity_stick_slip" in sonolube("literature", rigs / "tribometer.toml", *options).out


def test_compared_on_a_rig_formulae_beyond_mu_times_the_load_are_raw(
    sonolube: Program, rigs: Path, tmp_path: Path
) -> None:
    options = ("--set", FAST, "--model", "dong-2015-full-period", "--model", "kinematic", "--out", tmp_path)
    answer = sonolube("compare", rigs / "tribometer.toml", *options, "--json").answer
    found = {one["model"]: one for one in answer["rig"]["predictions"]}
    printed = found["dong-2015-full-period"]
    assert printed["friction_ratio"] is None
    assert printed["raw_friction_ratio"] > 1
    assert printed["reason"].startswith(OUTSIDE)
    assert found["kinematic"]["friction_ratio"] == found["kinematic"]["raw_friction_ratio"]


def test_a_sweep_counts_the_points_outside(sonolube: Program, rigs: Path, tmp_path: Path) -> None:
    options = ("--over", "sliding.sliding_speed=0.01m/s,3m/s", "--set", "drive.voltage_peak_to_peak=100V")
    answer = sonolube("sweep", rigs / "tribometer.toml", "--set", PRINTED, *options, "--out", tmp_path, "--json").answer
    assert answer["statuses"] == {"periodic": 1, OUTSIDE: 1}
    assert answer["without_result"][0]["reason"].startswith(OUTSIDE)


BRASS_ON_STEEL = """
title = "Brass pin on 304 disc"
source = "data sheets"

[contact]
normal_load = "5 N"
nominal_area = "1 mm2"
roughness = { rms_height = "0.8 um", summit_radius = "5 um", summit_density = "2e10 /m2" }
softer = { youngs_modulus = "100 GPa", poisson_ratio = 0.34, yield_strength = "300 MPa" }
harder = { youngs_modulus = "200 GPa", poisson_ratio = 0.29 }

[friction]
friction_coefficient = 0.3

[sliding]
sliding_speed = "200 mm/s"

[drive]
frequency = "20 kHz"

[vibration]
vibration_amplitude = "3 um"
"""


def test_beyond_the_gap_at_rest_wear_is_by_the_model_that_holds_and_friction_within_what_is_predicted(
    sonolube: Program, tmp_path: Path
) -> None:
    rig = tmp_path / "brass.toml"
    rig.write_text(BRASS_ON_STEEL, encoding="utf-8")
    ratio = sonolube("friction", rig, "--json").answer["friction_ratio"]["value"]
    low, high = sonolube("predict", rig, "--out", tmp_path, "--json").answer["friction_ratio"]["interval_80"]
    assert 0.02 < low < high < 1.2
    assert 0 < ratio < high
    wear = sonolube("wear", rig, "--json").answer
    assert 0 < wear["wear_reduction"]["value"] < 1
    assert wear["wear_model"] == "dong_2015_load_balanced"
    assert "exceeds the gap at rest" in " ".join(wear["caveats"])


def test_a_prediction_tells_its_inputs_intervals_and_what_was_measured(
    sonolube: Program, rigs: Path, tmp_path: Path
) -> None:
    ran = sonolube("predict", rigs / "tribometer.toml", "--out", tmp_path, "--full")
    lines = ran.out.splitlines()
    assert lines[1].startswith("This point is within the range of the friction model and of the published tests.")
    assert lines[2].startswith("Friction falls by about ")
    assert lines[2].endswith(" and none of yours. The vibration is along the normal of the contact.")
    assert any(line.startswith("  measured A-1: friction ratio 0.37") for line in lines)
    (amplitude,) = (line.split("  ") for line in lines if line.startswith("  amplitude "))
    words = [word.strip() for word in amplitude if word]
    assert words[:3] == ["amplitude", "2.5 um within 5 %", "100 % and 100 %"]
    assert words[3].startswith("measured, 2.5 um at 28 V")
    assert any(line.startswith("  one run at this point ") for line in lines)
    assert {path.name for path in tmp_path.iterdir()} == {
        f"tribometer-prediction.{ending}" for ending in ("nc", "png", "svg", "pdf")
    }
