"""Tasks `horn design` and `horn face` in Python: numbers of the commands, quantities in SI, bytes, and refusals."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pytest import approx, mark, raises
from tests.same import same

import sonolube as sl
from sonolube.errors import InvalidInput, UnknownName
from sonolube.tasks.files import NamedBytes

Program = Callable[..., Any]

needs_mesher = mark.usefixtures("mesher")


@pytest.fixture
def mesher() -> None:
    """Skip without the mesher."""
    pytest.importorskip("netgen.occ", reason="netgen-mesher is not installed")


def test_a_face_in_python_has_the_numbers_of_the_command(sonolube: Program, tmp_path: Path) -> None:
    options = ("--frequency", "20.5kHz", "--amplitude", "5um", "--sliding-speed", "20mm/s")
    command = sonolube("horn", "face", "steel", *options, "--out", tmp_path, "--json").answer
    found = sl.horn.face("steel", frequency="20.5 kHz", amplitude="5 um", sliding_speed="20 mm/s")
    same(found.json_object(), {key: value for key, value in command.items() if key != "files"})
    ratio = found["friction_ratio"]
    in_si = sl.horn.face("steel", frequency=20.5e3, amplitude=5e-6, sliding_speed=0.02)
    assert in_si["friction_ratio"].to_numpy() == approx(ratio.to_numpy(), abs=1e-9)
    assert ratio.dims == ("position",)
    assert found.plot().axes


def test_a_face_is_refused_in_the_words_of_python() -> None:
    with raises(UnknownName, match="unknown horn 'brass'; known: aluminium, steel"):
        sl.horn.face("brass")
    with raises(InvalidInput, match=r"^amplitude must be positive"):
        sl.horn.face("steel", amplitude=0.0)


@needs_mesher
def test_a_horn_in_python_has_the_numbers_of_the_command(sonolube: Program, tmp_path: Path) -> None:
    sizes = ("--set", "radius=10mm", "--set", "end_radius=5mm")
    call = ("horn", "design", "exponential_horn", "--frequency", "20kHz", "--material", "titanium_6al4v", *sizes)
    more = ("--tool-mass", "1g", "--amplitude", "20um", "--tolerance", "0.05")
    command = sonolube(*call, *more, "--out", tmp_path, "--json").answer
    arguments: dict[str, Any] = {"tool_mass": 1e-3, "amplitude": "20 um", "tolerance": 0.05}
    found = sl.horn.design(
        "exponential_horn",
        frequency=20e3,
        material="titanium_6al4v",
        sizes={"radius": 0.01, "end_radius": "5mm"},
        **arguments,
    )
    same(found.json_object(), {key: value for key, value in command.items() if key != "files"})
    data = found.dataset()
    same(float(data["displacement_gain"]), found.object()["displacement_gain"]["value"])
    ratio = data["displacement_ratio"]
    assert float(ratio[-1]) == approx(1.0, abs=0.05)
    assert float(data["position"][-1]) < found.object()["length"]["value"]
    assert found.object()["total_length"] == {"value": approx(found.object()["length"]["value"], rel=1e-6), "unit": "m"}
    assert {path.name.partition(".")[2] for path in tmp_path.glob("*-drawing.*")} == {"dxf", "pdf", "png", "svg"}
    stress = np.asarray(found.plot("axis").axes[2].lines[0].get_ydata(), dtype=float).max()
    assert 1e12 * stress == approx(found.object()["stress_per_displacement"]["value"], rel=1e-9)
    motion = np.asarray(found.plot("axis").axes[1].lines[0].get_ydata(), dtype=float)
    assert abs(motion[-1] / motion[0]) == approx(float(data["displacement_gain"]))
    assert abs(float(ratio[0] / ratio[-1])) == approx(1 / float(data["displacement_gain"]), rel=0.05)


@needs_mesher
def test_a_step_file_may_be_bytes(tmp_path: Path) -> None:
    from sonolube.models.fem import cylinder

    path = tmp_path / "bar.step"
    cylinder(radius=0.009, length=0.14).shape.WriteStep(str(path))
    stages: list[str] = []
    found = sl.horn.design(
        NamedBytes("bar.step", path.read_bytes()),
        frequency="20 kHz",
        material="titanium_6al4v",
        tolerance=0.05,
        progress=lambda stage, done, total: stages.append(stage),
    )
    by_path = sl.horn.design(path, frequency=20e3, material="titanium_6al4v", tolerance=0.05)
    same(found.object(), by_path.object())
    assert list(found.figures()) == ["bar-axis", "bar-mode"]
    assert stages[0].startswith("tuning")


@needs_mesher
@mark.parametrize(
    ("arguments", "line"),
    [
        ({"frequency": "20 N"}, "^frequency 20 N is a force"),
        ({"axis": "x"}, "^axis has no meaning for stepped_horn; it is for STEP files"),
        ({"gain": 3, "sizes": {"end_radius": 5e-3}}, "^gain 3: is chosen by end_radius"),
        ({"sizes": {"radius": 0.0}}, r"^radius must be positive, got 0\.0 m"),
        ({"part": "x.step", "tune": "length"}, "^tune has no meaning for a STEP file"),
    ],
)
def test_a_horn_is_refused_in_the_words_of_python(arguments: dict[str, Any], line: str) -> None:
    with raises(InvalidInput, match=line):
        sl.horn.design(**{"frequency": 20e3, "material": "titanium_6al4v", **arguments})
