"""Command `modes`: frequencies against bar theory, files for other programs, and refusals."""

import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pytest import approx

pytest.importorskip("netgen.occ", reason="netgen-mesher is not installed")

from sonolube.measurement.vibration import modal_assurance_criterion
from sonolube.models.fem.results.part_modes import frequency_text
from sonolube.rig import read_rig
from sonolube.rig.driven_rig import driven_rig

Program = Callable[..., Any]


def test_a_steel_bar_has_the_axial_mode_of_bar_theory(tmp_path: Path, sonolube: Program) -> None:
    sizes = ("--set", "length=60mm", "--set", "radius=6mm", "--count", "6", "--tolerance", "0.02")
    call = ("modes", "cylinder", *sizes, "--material", "stainless_steel_304", "--out", tmp_path, "--json")
    answer = sonolube(*call).answer
    found = {mode["name"]: mode["natural_frequency"]["value"] for mode in answer["modes"]}
    rayleigh = 1 - (np.pi * 0.29 * 0.1) ** 2 / 4
    assert answer["rigid_motions"] == 6
    assert found["axial 1"] == approx(np.sqrt(200e9 / 8000) / 0.12 * rayleigh, rel=3e-3)
    assert found["torsional 1"] == approx(np.sqrt(200e9 / 2.58 / 8000) / 0.12, rel=5e-3)
    assert all(Path(file).stat().st_size > 10_000 for file in answer["files"])
    assert len(answer["files"]) == 6


def test_free_elastic_constants_replace_those_of_the_material(tmp_path: Path, sonolube: Program) -> None:
    sizes = ("--set", "length=60mm", "--set", "radius=6mm", "--count", "6", "--tolerance", "0.02")
    free = ("--young-modulus", "50GPa", "--poisson-ratio", "0.2", "--density", "2000kg/m3")
    answer = sonolube("modes", "cylinder", *sizes, *free, "--out", tmp_path, "--json").answer
    found = {mode["name"]: mode for mode in answer["modes"]}
    assert found["torsional 1"]["natural_frequency"]["value"] == approx(np.sqrt(50e9 / 2.4 / 2000) / 0.12, rel=5e-3)
    assert "youngs modulus 50 GPa, poisson ratio 0.2, density 2000 kg/m3" in answer["material"]
    for mode in found.values():
        frequency, error = mode["natural_frequency"]["value"], mode["uncertainty"]["value"]
        number, _, rest = mode["text"].partition(" kHz ± ")
        assert abs(1e3 * float(number) - frequency) <= max(error, 0.05)
        assert float(rest.removesuffix(" Hz")) == approx(error, rel=0.5, abs=0.05)


@pytest.mark.parametrize(
    ("frequency", "relative", "text"),
    [
        (20012.3, 3e-4, "20.01 kHz ± 6 Hz"),
        (20000.4, 3e-4, "20.00 kHz ± 6 Hz"),
        (20012.34, 6e-5, "20.012 kHz ± 1 Hz"),
        (812.34, 1e-3, "812 Hz ± 0.8 Hz"),
        (20012.3, 0.2, "20 kHz ± 4 kHz"),
    ],
)
def test_a_frequency_has_the_digits_that_its_error_leaves(frequency: float, relative: float, text: str) -> None:
    assert frequency_text(frequency=frequency, relative_error=relative) == text


BLOCK = ("block", "--set", "length=60mm", "--set", "width=20mm", "--set", "thickness=10mm")


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (("blok",), "unknown part 'blok'; did you mean block?"),
        (("block", "--set", "length=1mm"), "a block needs width, thickness; give each by --set, such as width=20mm"),
        (("block", "--set", "lenght=1mm"), "unknown size of a block 'lenght'; did you mean length?"),
        (("block", "--set", "length=3N"), "length=3N"),
        ((*BLOCK, "--material", "pzt_4"), "--material pzt_4: a piezoelectric ceramic needs its poling and electrodes"),
        (("stack", "--density", "8000kg/m3"), "--density has no meaning for stack, which has its own"),
        ((*BLOCK, "--poisson-ratio", "0.7"), "poisson_ratio"),
        ((*BLOCK, "--axis", "w"), "'w' is not one of 'x', 'y', 'z'"),
        ((*BLOCK, "--toward", "xy"), "'xy' is not one of 'x', 'y', 'z'"),
        ((*BLOCK, "--tolerance", "1e-12"), "relative_tolerance must be at least 1e-08, got 1e-12"),
        (("none.step",), "none.step: no such file"),
        (("block", "--set", "length=1e300m", "--set", "width=1mm"), "length 1e300m lies beyond any part"),
    ],
)
def test_a_part_that_cannot_be_made_is_refused_in_one_line(
    arguments: tuple[str, ...], line: str, sonolube: Program
) -> None:
    assert line.split("=")[0] in sonolube("modes", *arguments).refusal


def test_a_damaged_step_file_is_refused_without_lines_of_the_cad_kernel(tmp_path: Path, sonolube: Program) -> None:
    path = tmp_path / "horn.step"
    path.write_text("ISO-10303-21;\nHEADER;\n")
    assert "not a STEP file that can be read" in sonolube("modes", path).refusal


def test_every_frame_of_an_animation_shows_the_same_scale_of_colours(tmp_path: Path, sonolube: Program) -> None:
    image = pytest.importorskip("PIL.Image")
    run = sonolube("modes", *BLOCK, "--count", "1", "--tolerance", "0.05", "--animate", "--out", tmp_path)
    assert run.code == 0, run.err
    (path,) = tmp_path.glob("*.gif")
    with image.open(path) as animation:
        frames = []
        for number in range(animation.n_frames):
            animation.seek(number)
            frames.append(np.asarray(animation.convert("RGB"), dtype=int))
    assert len(frames) == 16
    scale = slice(int(0.88 * frames[0].shape[1]), None)  # what stands to the right of the part
    assert all(np.abs(frame[:, scale] - frames[0][:, scale]).max() <= 2 for frame in frames)
    assert np.abs(frames[8] - frames[0]).max() > 50


def test_modes_come_as_animations_grids_and_shapes_at_points(sonolube: Program, tmp_path: Path) -> None:
    points = tmp_path / "points.csv"
    points.write_text("".join(f"0,0,{z}\n" for z in (0, 15, 30, 45, 60)))
    sizes = ("--set", "length=60mm", "--set", "radius=6mm", "--tolerance", "0.03")
    more = ("--vtu", "--points", str(points), "--toward", "z", "--out", str(tmp_path), "--json")
    run = sonolube("modes", "cylinder", *sizes, *more)
    names = [mode["name"] for mode in run.answer["modes"]]
    shapes = np.loadtxt(tmp_path / "cylinder-shapes.csv", delimiter=",")
    axial = shapes[:, names.index("axial 1")]
    half_wave = np.cos(np.pi * np.arange(5) / 4)
    assert np.abs(axial) == approx(np.abs(half_wave), abs=0.02)
    measured = half_wave + 0.02 * np.random.default_rng(1).standard_normal(5)  # as a vibrometer sees it
    assert int(np.argmax(modal_assurance_criterion(measured, shapes)[0])) == names.index("axial 1")
    assert modal_assurance_criterion(measured, axial)[0, 0] > 0.99
    moving = sonolube("modes", "cylinder", *sizes, "--count", "1", "--animate", "--out", str(tmp_path))
    assert moving.code == 0, moving.err
    image = pytest.importorskip("PIL.Image")
    with image.open(next(tmp_path.glob("*.gif"))) as animation:
        assert animation.n_frames > 8


def test_a_file_of_modes_is_written_and_read_by_the_rig_that_names_it(
    tmp_path: Path, sonolube: Program, rigs: Path
) -> None:
    call = ("modes", "stack", "--count", "1", "--tolerance", "0.5", "--contact", "tip", "--body-mass", "1kg")
    answer = sonolube(*call, "--body-stiffness", "4kN/m", "--body-damping", "20N*s/m", "--out", tmp_path, "--json")
    (path,) = (Path(name) for name in answer.answer["files"] if name.endswith(".toml"))
    stated = tomllib.loads(path.read_text(encoding="utf-8"))
    assert stated["command"].startswith("sonolube modes stack --count 1 --tolerance 0.5 --contact tip --body-mass 1kg")
    assert stated["natural_frequency"][-1] == approx(np.sqrt(4e3) / (2 * np.pi))
    assert stated["damping_ratio"][-1] == approx(20 / (2 * np.sqrt(4e3)))
    text = (rigs / "collar.toml").read_text(encoding="utf-8").replace("modes/collar-modes.toml", path.name)
    (tmp_path / "rig.toml").write_text(text, encoding="utf-8")
    assert driven_rig(read_rig(tmp_path / "rig.toml")).structure.coordinates == len(stated["natural_frequency"])
    assert "has no drive" in sonolube("modes", "cylinder", "--set", "radius=1mm", "--contact", "tip").refusal
    assert "unknown output of stack 'tp'; did you mean tip?" in sonolube("modes", "stack", "--contact", "tp").refusal
