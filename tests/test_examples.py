"""The examples in code, each run as a user would run it."""

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import sonolube as sl
from sonolube.models.friction import (
    drawing_stress,
    feed_contact_fraction,
    tool_contact_fraction,
    vibrated_drawing_stress,
)
from sonolube.rig import friction_point, read_rig

PAGE = Path(__file__).parents[1] / "docs" / "applications.md"
EXAMPLES = sorted((Path(__file__).parents[1] / "examples").glob("*.py"))


def run(example: Path, folder: Path) -> list[str]:
    done = subprocess.run(
        [sys.executable, example, folder / "out"], capture_output=True, text=True, check=False, cwd=folder
    )
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    return done.stdout.splitlines()


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_runs_and_says_something(example: Path, tmp_path: Path) -> None:
    assert run(example, tmp_path)


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_is_a_page_with_its_call_at_the_top(example: Path) -> None:
    lines = example.read_text(encoding="utf-8").splitlines()
    assert len(lines) <= 45
    assert f"Run: python examples/{example.name}" in lines[2]


def test_the_figure_lands_in_the_folder_asked_for(tmp_path: Path) -> None:
    example = next(path for path in EXAMPLES if path.stem == "friction_against_amplitude")
    written = [Path(line) for line in run(example, tmp_path)]
    assert {path.suffix for path in written} == {".png", ".svg"}
    assert all(path.parent == tmp_path / "out" and path.stat().st_size > 1000 for path in written)


def test_the_wear_table_holds_the_published_rates_at_three_newton(tmp_path: Path) -> None:
    example = next(path for path in EXAMPLES if path.stem == "wear_with_and_without")
    row = next(line.split() for line in run(example, tmp_path) if line.split()[0] == "3.0")
    # D Table 3.4: 2.566e-2 and 1.355e-2 mm3/m
    assert float(row[1]) == pytest.approx(25.66, abs=0.015)
    assert float(row[2]) == pytest.approx(13.55, abs=0.015)


def test_the_wire_has_the_stress_of_the_worked_example(tmp_path: Path) -> None:
    lines = run(next(path for path in EXAMPLES if path.stem == "wire_drawing"), tmp_path)
    assert lines[0].split()[-2:] == ["240.4", "MPa"]  # G. E. Dieter, Mechanical Metallurgy, example 19.1
    assert lines[2].split()[3] == "1.26"
    assert float(lines[2].split()[-2]) == pytest.approx(0.57 * 240.4, rel=2e-3)
    assert Path(lines[-2]).suffix == ".png"


def test_the_tool_cuts_always_above_its_critical_speed_only(tmp_path: Path) -> None:
    lines = run(next(path for path in EXAMPLES if path.stem == "vibrated_turning"), tmp_path)
    assert "cuts for 24 %, 68 %, 100 %" in lines[0]  # 0.63 m/s
    assert "cuts for 16 %, 41 %, 68 %" in lines[1]  # 1.26 m/s


def row_of_the_page(first: str) -> list[float]:
    """Numbers in a row of a table on the page of worked cases."""
    (row,) = re.findall(rf"^\| {first} \|(.*)$", PAGE.read_text(encoding="utf-8"), flags=re.MULTILINE)
    return [float(number) for number in re.findall(r"(\d+(?:\.\d+)?) (?:%|m/s)", row)]


def test_the_drawing_table_of_the_page_is_computed() -> None:
    die = {"yield_strength": 1.0, "area_reduction": 0.2, "friction_coefficient": 0.09}
    angle, peak = np.radians(6), 2 * np.pi * 20e3 * 10e-6
    stress = vibrated_drawing_stress(
        **die, die_half_angle=angle, drawing_speed=row_of_the_page("Drawing speed"), vibration_velocity=peak
    )
    reduction = 100 * (1 - stress / drawing_stress(**die, die_half_angle=angle))
    assert row_of_the_page("Reversal of friction") == reduction.round().tolist()


@pytest.mark.parametrize("micrometres", [5, 10, 20])
def test_the_turning_table_of_the_page_is_computed(micrometres: int) -> None:
    critical, *shares = row_of_the_page(f"{micrometres} µm")
    assert critical == pytest.approx(2 * np.pi * 20e3 * micrometres * 1e-6, abs=0.005)
    found = tool_contact_fraction(
        cutting_speed=[0.1, 0.5, 1.0], vibration_velocity=2 * np.pi * 20e3 * micrometres * 1e-6
    )
    assert shares == (100 * found).round().tolist()


def test_the_drill_cuts_with_interruptions_and_its_flank_presses_under_ultrasound(tmp_path: Path) -> None:
    lines = run(next(path for path in EXAMPLES if path.stem == "vibrated_drilling"), tmp_path)
    assert "cuts for  71 %   1.4 deg, flank clear" in lines[0]  # 1 - arccos(50/80)/pi; 40 um, 50 Hz, 0.52 m/s
    assert "cuts for 100 %  67.4 deg, flank presses" in lines[1]


@pytest.mark.parametrize("waves", [1.5, 1.25, 1.1])
def test_the_drilling_table_of_the_page_is_computed(waves: float) -> None:
    found = feed_contact_fraction(
        feed_per_edge=1.0, vibration_amplitude=[0.5, 0.6, 0.8, 1.0, 2.0], phase_per_edge=2 * np.pi * waves
    )
    assert row_of_the_page(f"{waves} waves") == (100 * found).round().tolist()


SPEED, AMPLITUDE = "sliding.sliding_speed", "vibration.vibration_amplitude"
MODULUS, FOLLOWING = "contact.softer.youngs_modulus", "friction.following_fraction"


def reductions(name: str, key: str, values: list[str], *changes: str) -> list[float]:
    """Friction reductions of an example rig over one entry, rounded. [%]"""
    rig = Path(__file__).parents[1] / "examples" / "rigs" / f"{name}.toml"
    points = (friction_point(read_rig(rig, changes=[*changes, f"{key}={value}"])) for value in values)
    return [round(100 * point.friction_reduction) for point in points]


@pytest.mark.parametrize("amplitude", ["0.1", "0.2", "0.5", "1"])
def test_the_table_of_the_guide_is_computed(amplitude: str) -> None:
    found = reductions("pom_on_steel", SPEED, [f"{v}mm/s" for v in (1, 5, 20, 50, 100)], f"{AMPLITUDE}={amplitude}um")
    assert row_of_the_page(f"POM, {amplitude} µm") == found


@pytest.mark.parametrize(
    ("amplitude", "modulus"), [("1", "30"), ("2.17", "30"), ("4", "30"), ("2.17", "100"), ("2.17", "10")]
)
def test_the_table_of_the_belt_is_computed(amplitude: str, modulus: str) -> None:
    changes = (f"{AMPLITUDE}={amplitude}um", f"{MODULUS}={modulus}MPa")
    found = reductions("webbing_on_ring", SPEED, [f"{v}mm/s" for v in (5, 20, 50, 100, 200)], *changes)
    assert row_of_the_page(f"Belt, {amplitude} µm, {modulus} MPa") == found


@pytest.mark.parametrize(("row", "following"), [("nothing", 0), ("a half", 0.5), ("0.8", 0.8)])
def test_the_table_of_the_finger_is_computed(row: str, following: float) -> None:
    sizes = [f"{a}um" for a in (0.1, 0.25, 0.5, 1, 1.5, 2.5)]
    found = reductions("finger_on_glass", AMPLITUDE, sizes, f"{FOLLOWING}={following}")
    assert row_of_the_page(f"Finger follows {row}") == found


def test_what_the_page_says_of_the_belt_and_the_finger_beyond_their_tables() -> None:
    assert reductions("webbing_on_ring", "contact.normal_load", ["670N"]) == [1]  # D 1.3.1: up to 60 % up to 670 N
    assert reductions("webbing_on_ring", FOLLOWING, ["0.25", "0.5"]) == [19, 4]
    assert reductions("webbing_on_ring", MODULUS, ["3MPa"]) == [96]
    one = f"{AMPLITUDE}=1um"
    thin = ["101325Pa", "50662Pa", "2026Pa"]
    assert reductions("finger_on_glass", "friction.ambient_pressure", thin, one) == [62, 40, 2]
    assert reductions("finger_on_glass", "contact.decay_length", ["0.75um", "3um"], one) == [98, 13]
    assert reductions("finger_on_glass", "contact.normal_load", ["0.1N", "2N"], f"{AMPLITUDE}=0.5um") == [45, 19]
    assert reductions("pom_on_steel", "friction.friction_coefficient", ["0.1", "0.35"]) == [6, 57]


def test_the_belt_vibrates_as_the_collar_does() -> None:
    rigs = Path(__file__).parents[1] / "examples" / "rigs"
    belt, collar = (friction_point(read_rig(rigs / f"{name}.toml")) for name in ("webbing_on_ring", "collar"))
    assert belt.vibration_amplitude == pytest.approx(collar.vibration_amplitude, rel=2e-3)


def test_the_gaps_under_the_finger_are_those_of_the_page() -> None:
    rig = Path(__file__).parents[1] / "examples" / "rigs" / "finger_on_glass.toml"
    (printed,) = re.findall(r"^\| Mean gap \|(.*)$", PAGE.read_text(encoding="utf-8"), flags=re.MULTILINE)
    for gap, size in zip(re.findall(r"[\d.]+", printed), (0.1, 0.25, 0.5, 1, 1.5, 2.5), strict=True):
        text = sl.friction(read_rig(rig, changes=[f"{AMPLITUDE}={size}um"])).object()["mechanism"]
        assert float(gap) == pytest.approx(float(re.findall(r"gap of ([\d.]+) um", text)[0]), abs=0.051)
