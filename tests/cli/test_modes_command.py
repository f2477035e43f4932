"""The command on natural modes, in a process of its own."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from pytest import approx

pytest.importorskip("netgen.occ", reason="netgen-mesher is not installed")


def modes(*arguments: str) -> "subprocess.CompletedProcess[str]":
    code = "from sonolube.cli import main; main()"
    return subprocess.run(
        [sys.executable, "-c", code, "modes", *arguments], capture_output=True, text=True, check=False
    )


def test_a_steel_bar_is_answered_with_the_axial_mode_of_bar_theory_and_pictures(tmp_path: Path) -> None:
    sizes = ("--set", "length=60mm", "--set", "radius=6mm", "--count", "6", "--tolerance", "0.02")
    run = modes("cylinder", *sizes, "--material", "stainless_steel_304", "--out", str(tmp_path), "--json")
    assert run.returncode == 0, run.stderr
    answer = json.loads(run.stdout)
    found = {mode["name"]: mode["natural_frequency"]["value"] for mode in answer["modes"]}
    rayleigh = 1 - (np.pi * 0.29 * 0.1) ** 2 / 4
    assert answer["rigid_motions"] == 6
    assert found["axial 1"] == approx(np.sqrt(200e9 / 8000) / 0.12 * rayleigh, rel=3e-3)
    assert found["torsional 1"] == approx(np.sqrt(200e9 / 2.58 / 8000) / 0.12, rel=5e-3)
    assert all(Path(file).stat().st_size > 10_000 for file in answer["files"])
    assert len(answer["files"]) == 6


BLOCK = ("block", "--set", "length=60mm", "--set", "width=20mm", "--set", "thickness=10mm")


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (("blok",), "unknown part 'blok'; did you mean block?"),
        (("block", "--set", "length=1mm"), "a block needs width, thickness; give each as --set width=20mm"),
        (("block", "--set", "lenght=1mm"), "unknown size of a block 'lenght'; did you mean length?"),
        (("block", "--set", "length=3N"), "length=3N"),
        ((*BLOCK, "--material", "pzt_4"), "--material pzt_4: a piezoelectric ceramic needs its poling and electrodes"),
        ((*BLOCK, "--axis", "w"), "--axis must be x, y or z, got 'w'"),
        ((*BLOCK, "--toward", "xy"), "--toward must be x, y or z, got 'xy'"),
        ((*BLOCK, "--tolerance", "1e-12"), "relative_tolerance must be at least 1e-08, got 1e-12"),
        (("none.step",), "none.step: no such file"),
        (("block", "--set", "length=1e300m", "--set", "width=1mm"), "length 1e300m lies beyond any part"),
    ],
)
def test_what_is_no_part_is_refused_in_one_line(arguments: tuple[str, ...], line: str) -> None:
    run = modes(*arguments)
    assert (run.returncode, run.stdout) == (2, "")
    assert len(run.stderr.strip().splitlines()) == 1
    assert line.split("=")[0] in run.stderr


def test_a_damaged_step_file_is_refused_and_the_kernel_kept_quiet(tmp_path: Path) -> None:
    path = tmp_path / "horn.step"
    path.write_text("ISO-10303-21;\nHEADER;\n")
    run = modes(str(path))
    assert (run.returncode, run.stdout) == (2, "")
    assert "not a STEP file that can be read" in run.stderr
    assert len(run.stderr.strip().splitlines()) == 1


def test_every_frame_of_an_animation_shows_the_same_scale_of_colours(tmp_path: Path) -> None:
    image = pytest.importorskip("PIL.Image")
    run = modes(*BLOCK, "--count", "1", "--tolerance", "0.05", "--animate", "--out", str(tmp_path))
    assert run.returncode == 0, run.stderr
    (path,) = tmp_path.glob("*.gif")
    with image.open(path) as animation:
        frames = []
        for number in range(animation.n_frames):
            animation.seek(number)
            frames.append(np.asarray(animation.convert("RGB"), dtype=int))
    assert len(frames) == 16
    scale = slice(int(0.85 * frames[0].shape[1]), None)  # what stands to the right of the part
    assert all(np.abs(frame[:, scale] - frames[0][:, scale]).max() <= 2 for frame in frames)
    assert np.abs(frames[8] - frames[0]).max() > 50
