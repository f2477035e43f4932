"""The commands on horns and impedance, and the files of modes."""

import json
import xml.etree.ElementTree as ElementTree
from collections.abc import Callable
from pathlib import Path
from subprocess import CompletedProcess

import numpy as np
import pytest
from PIL import Image
from pytest import CaptureFixture, approx, raises

pytest.importorskip("netgen.occ", reason="netgen-mesher is not installed")

from sonolube.cli import main
from sonolube.fem import cylinder, stepped_horn
from sonolube.measurement.impedance.reader import read_impedance
from sonolube.measurement.vibration import modal_assurance_criterion

Command = Callable[..., CompletedProcess[str]]


@pytest.fixture
def sonolube(capfd: CaptureFixture[str]) -> Command:
    """Run a command and return its code and all that it writes, the kernels' own lines too."""

    def run(*arguments: str) -> CompletedProcess[str]:
        with raises(SystemExit) as end:
            main(arguments)
        out, err = capfd.readouterr()
        return CompletedProcess(arguments, int(end.value.code or 0), out, err)

    return run


def test_a_slim_horn_comes_out_as_thin_bars_say(sonolube: Command, tmp_path: Path) -> None:
    sizes = ("--set", "radius=10mm", "--set", "end_radius=5mm", "--shape", "exponential")
    run = sonolube(
        *("horn", "design", "--frequency", "20kHz", "--material", "titanium_6al4v"),
        *(*sizes, "--tool-mass", "1g", "--out", str(tmp_path), "--json"),
    )
    assert run.returncode == 0, run.stderr
    answer = json.loads(run.stdout)
    speed = np.sqrt(113.8e9 / 4430)
    assert answer["length"]["value"] == approx(speed / 40e3 * np.hypot(1, np.log(2) / np.pi), rel=3e-3)
    assert answer["displacement_gain"]["value"] == approx(2.0, rel=5e-3)
    assert answer["frequency"]["value"] == approx(20e3, rel=1e-3)
    assert answer["loaded_frequency"]["value"] < answer["frequency"]["value"]
    assert answer["face_uniformity"]["value"] == approx(1.0, abs=0.02)
    assert answer["amplitude_limits"]["fatigue_strength"]["value"] == approx(
        510e6 / answer["stress_per_displacement"]["value"]
    )
    assert all(Path(file).stat().st_size > 5_000 for file in answer["files"])


def test_a_step_file_is_tuned_by_cutting_its_end(sonolube: Command, tmp_path: Path) -> None:
    cylinder(radius=0.009, length=0.14).shape.WriteStep(str(tmp_path / "bar.step"))
    run = sonolube(
        *("horn", "design", "--frequency", "20kHz", "--material", "titanium_6al4v"),
        *("--shape", str(tmp_path / "bar.step"), "--out", str(tmp_path), "--json"),
    )
    assert run.returncode == 0, run.stderr
    assert json.loads(run.stdout)["length"]["value"] == approx(np.sqrt(113.8e9 / 4430) / 40e3, rel=3e-3)


def test_the_impedance_of_a_ring_reads_back_as_a_measured_one(sonolube: Command, tmp_path: Path) -> None:
    sizes = ("--set", "outer_radius=5mm", "--set", "inner_radius=2.5mm", "--set", "length=12mm")
    common = ("--from", "10kHz", "--to", "105kHz", "--points", "191", "--tolerance", "0.05", "--out", str(tmp_path))
    run = sonolube("impedance", "compute", "stack", *sizes, *common, "--clamp", "ring1.-z", "--vtu", "--json")
    assert run.returncode == 0, run.stderr
    answer = json.loads(run.stdout)
    free, clamped = (answer["spectra"][name]["modes"][0] for name in ("free", "clamped"))
    assert free["parallel_frequency"]["value"] > free["series_frequency"]["value"]
    assert clamped["series_frequency"]["value"] < free["series_frequency"]["value"]  # a quarter against half a wave
    table = tmp_path / "stack-impedance-free.csv"
    spectrum = read_impedance(table)
    least = spectrum.frequency[np.argmin(np.abs(spectrum.impedance))]
    assert least == approx(free["series_frequency"]["value"], rel=0.02)
    grid = ElementTree.parse(tmp_path / "stack-modes-free.vtu").getroot()
    assert grid.attrib["type"] == "UnstructuredGrid"
    again = sonolube("impedance", "compute", "stack", *sizes, *common, "--measured", str(table))
    assert again.returncode == 0, again.stderr
    assert "measured: least impedance" in again.stdout


def test_modes_come_as_animations_grids_and_shapes_at_points(sonolube: Command, tmp_path: Path) -> None:
    points = tmp_path / "points.csv"
    points.write_text("".join(f"0,0,{z}\n" for z in (0, 15, 30, 45, 60)))
    sizes = ("--set", "length=60mm", "--set", "radius=6mm", "--tolerance", "0.03")
    more = ("--vtu", "--points", str(points), "--toward", "z", "--out", str(tmp_path), "--json")
    run = sonolube("modes", "cylinder", *sizes, *more)
    assert run.returncode == 0, run.stderr
    names = [mode["name"] for mode in json.loads(run.stdout)["modes"]]
    shapes = np.loadtxt(tmp_path / "cylinder-shapes.csv", delimiter=",")
    axial = shapes[:, names.index("axial 1")]
    half_wave = np.cos(np.pi * np.arange(5) / 4)
    assert np.abs(axial) == approx(np.abs(half_wave), abs=0.02)
    measured = half_wave + 0.02 * np.random.default_rng(1).standard_normal(5)  # as a vibrometer sees it
    assert int(np.argmax(modal_assurance_criterion(measured, shapes)[0])) == names.index("axial 1")
    assert modal_assurance_criterion(measured, axial)[0, 0] > 0.99
    moving = sonolube("modes", "cylinder", *sizes, "--count", "1", "--animate", "--out", str(tmp_path))
    assert moving.returncode == 0, moving.stderr
    with Image.open(next(tmp_path.glob("*.gif"))) as animation:
        assert animation.n_frames > 8  # type: ignore[attr-defined]


def test_bad_geometry_is_refused_in_one_line(sonolube: Command, tmp_path: Path) -> None:
    stepped_horn(radius=0.02, end_radius=0.01, length=0.06, end_length=0.06).shape.faces[0].WriteStep(
        str(tmp_path / "open.step")
    )
    (tmp_path / "torn.step").write_text("ISO-10303-21;\nHEADER;\n")
    design = ("horn", "design", "--frequency", "20kHz", "--material", "titanium_6al4v")
    calls = {
        ("modes", str(tmp_path / "open.step")): "no closed solid",
        ("modes", str(tmp_path / "torn.step")): "torn.step",
        (*design, "--shape", str(tmp_path / "open.step")): "no closed solid",
        (*design, "--shape", "step"): "unknown horn shape 'step'; did you mean stepped?",
        (*design, "--set", "radius=0mm"): "radius must be positive, got 0.0 m",
        ("impedance", "compute", "stack", "--set", "inner_radius=6mm"): "the wall has no thickness",
        ("impedance", "compute", "tribometer"): "did you mean tribometer_actuator?",
    }
    for call, line in calls.items():
        run = sonolube(*call)
        assert run.returncode == 2, (call, run.stdout)
        assert len(run.stderr.strip().splitlines()) == 1, run.stderr
        assert line in run.stderr
