"""The examples in code, each run as a user would run it."""

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from sonolube.models.friction import drawing_stress, tool_contact_fraction, vibrated_drawing_stress

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
    page = (Path(__file__).parents[1] / "docs" / "applications.md").read_text(encoding="utf-8")
    (row,) = re.findall(rf"^\| {first} \|(.*)$", page, flags=re.MULTILINE)
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
