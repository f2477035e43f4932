"""Command `horn design` against thin-bar theory, and refusals of bad geometry."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pytest import approx

pytest.importorskip("netgen.occ", reason="netgen-mesher is not installed")

from sonolube.design.horns.shapes import horn_body
from sonolube.models.fem import cylinder, stepped_horn

Program = Callable[..., Any]


def test_a_slim_horn_has_the_length_and_gain_of_thin_bar_theory(sonolube: Program, tmp_path: Path) -> None:
    sizes = ("--set", "radius=10mm", "--set", "end_radius=5mm")
    run = sonolube(
        *("horn", "design", "exponential_horn", "--frequency", "20kHz", "--material", "titanium_6al4v"),
        *(*sizes, "--tool-mass", "1g", "--amplitude", "20um", "--out", str(tmp_path), "--json"),
    )
    answer = run.answer
    speed = np.sqrt(113.8e9 / 4430)
    assert answer["length"]["value"] == approx(speed / 40e3 * np.hypot(1, np.log(2) / np.pi), rel=3e-3)
    assert answer["displacement_gain"]["value"] == approx(2.0, rel=5e-3)
    assert answer["frequency"]["value"] == approx(20e3, rel=1e-3)
    assert answer["loaded_frequency"]["value"] < answer["frequency"]["value"]
    assert answer["face_uniformity"]["value"] == approx(1.0, abs=0.02)
    assert answer["amplitude_limits"]["fatigue_strength"]["value"] == approx(
        510e6 / answer["stress_per_displacement"]["value"]
    )
    assert answer["peak_stress"]["value"] == approx(20e-6 * answer["stress_per_displacement"]["value"])
    assert all(Path(file).stat().st_size > 5_000 for file in answer["files"])


@pytest.mark.parametrize("part", ["stepped_horn", "conical_horn", "exponential_horn", "booster"])
def test_the_end_of_a_thin_bar_is_chosen_by_its_gain(part: str) -> None:
    chosen = horn_body(part, sizes={"radius": 0.02}, gain=2.5, frequency=20e3, wave_speed=5068.0)
    assert chosen.thin is not None
    assert chosen.thin.displacement_gain == approx(2.5, rel=1e-9)
    if part == "stepped_horn":  # a step at the node of a quarter of the wavelength: the ratio of the areas
        assert chosen.sizes["end_radius"] == approx(0.02 / 2.5**0.5, rel=1e-9)


def test_a_step_file_is_tuned_by_cutting_its_end(sonolube: Program, tmp_path: Path) -> None:
    cylinder(radius=0.009, length=0.14).shape.WriteStep(str(tmp_path / "bar.step"))
    run = sonolube(
        *("horn", "design", "--frequency", "20kHz", "--material", "titanium_6al4v"),
        *(str(tmp_path / "bar.step"), "--out", str(tmp_path), "--json"),
    )
    assert run.answer["length"]["value"] == approx(np.sqrt(113.8e9 / 4430) / 40e3, rel=3e-3)


def test_bad_geometry_is_refused_in_one_line(sonolube: Program, tmp_path: Path) -> None:
    stepped_horn(radius=0.02, end_radius=0.01, length=0.06, end_length=0.06).shape.faces[0].WriteStep(
        str(tmp_path / "open.step")
    )
    (tmp_path / "torn.step").write_text("ISO-10303-21;\nHEADER;\n")
    design = ("horn", "design", "--frequency", "20kHz", "--material", "titanium_6al4v")
    calls = {
        ("modes", str(tmp_path / "open.step")): "no closed solid",
        ("modes", str(tmp_path / "torn.step")): "torn.step",
        (*design, str(tmp_path / "open.step")): "no closed solid",
        (*design, "stepped"): "unknown horn 'stepped'; did you mean stepped_horn?",
        (*design, "--shape", "stepped"): "--shape is now the argument PART, such as sonolube horn design stepped_horn",
        (*design, "--gain", "3", "--set", "end_radius=5mm"): "gain 3: is chosen by end_radius; give one of them",
        (*design, "cylinder", "--gain", "3"): "gain 3: cylinder has only gain 1",
        (*design, "conical_horn", "--gain", "9"): "gain 9: a conical_horn has 1 to ",
        (*design, "--set", "radius=0mm"): "radius must be positive, got 0.0 m",
        ("impedance", "compute", "stack", "--set", "inner_radius=6mm"): "the wall has no thickness",
        ("impedance", "compute", "tribometer"): "did you mean tribometer_actuator?",
    }
    for call, line in calls.items():
        assert line in sonolube(*call).refusal
