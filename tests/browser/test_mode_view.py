"""Parts and mode shapes that the page Modes is given: those of the tasks, and files that are refused in one line."""

import base64
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, strategies as st
from pytest import approx
from tests.tiers import examples

import sonolube as sl
from sonolube.browser.answers import answered, offered_task
from sonolube.browser.job import write_files
from sonolube.browser.mode_view import SHAPES_FILE, mode_files, mode_parts
from sonolube.browser.requests import Places
from sonolube.errors import InvalidInput, SonolubeError, UnknownName
from sonolube.models.fem import PARTS

NOWHERE = Places(rigs={})
RADIUS, LENGTH = 0.01, 0.12

pytestmark = pytest.mark.skipif(pytest.importorskip("netgen.occ") is None, reason="netgen-mesher is not installed")


def numbers(text: str, kind: str = "<f4") -> Any:
    """Array of a text in base 64."""
    return np.frombuffer(base64.b64decode(text), kind)


@pytest.fixture(scope="module")
def horn() -> Any:
    """A cylinder tuned to 20 kHz."""
    return sl.horn.design("cylinder", frequency="20 kHz", material="titanium_6al4v", tolerance=0.05)


@pytest.fixture(scope="module")
def shapes(horn: Any) -> dict[str, Any]:
    """Its modes as the page reads them."""
    found: dict[str, Any] = json.loads(mode_files(horn)[SHAPES_FILE])
    return found


def test_the_tuned_mode_has_the_numbers_of_the_task(horn: Any, shapes: dict[str, Any]) -> None:
    answer = horn.object()
    mode = next(each for each in shapes["modes"] if each["name"] == answer["mode"])
    assert mode["reference"] == "the displacement of the working face"
    assert mode["end_ratio"] == approx(answer["displacement_gain"]["value"], rel=1e-6)
    assert mode["nodal_planes"] == approx([1e3 * answer["node_position"]["value"]])
    assert mode["nodal_planes"] == approx([500 * answer["total_length"]["value"]], rel=1e-3)  # of a straight bar
    assert mode["peak_stress"] == approx(1e-12 * answer["stress_per_displacement"]["value"])
    assert 0.9 < numbers(mode["stress"]).max() / mode["peak_stress"] < 1  # the axis of a thick bar has the peak


def test_shapes_are_those_of_the_task(tmp_path: Path) -> None:
    found = sl.modes("cylinder", sizes={"radius": RADIUS, "length": LENGTH}, count=6, tolerance=0.05)
    shapes = json.loads(mode_files(found)[SHAPES_FILE])
    data = found.dataset()
    assert [each["name"] for each in shapes["modes"]] == list(data["mode"].values)
    assert [each["frequency"] for each in shapes["modes"]] == [each["text"] for each in found.object()["modes"]]
    own = data["mode_shape"].to_numpy()
    for row, mode in zip(own, shapes["modes"], strict=True):
        largest = np.linalg.norm(row, axis=1).max()
        assert numbers(mode["shape"]).reshape(-1, 3) == approx(row / largest, abs=1e-6)
    points, triangles = numbers(shapes["points"]).reshape(-1, 3), numbers(shapes["triangles"], "<u4").reshape(-1, 3)
    volume = np.abs(np.linalg.det(points[triangles].astype(float))).sum() / 6  # divergence theorem, seen from within
    assert volume == approx(np.pi * RADIUS**2 * LENGTH, rel=5e-3)  # of flat triangles
    assert write_files(mode_files(found), folder=tmp_path, line="made by a test") == [SHAPES_FILE]
    assert json.loads((tmp_path / SHAPES_FILE).read_text(encoding="utf-8"))["modes"] == shapes["modes"]


def test_a_transducer_has_shapes_without_a_stress_that_its_electric_fields_would_change() -> None:
    found = sl.impedance.compute("stack", lowest="1 kHz", highest="120 kHz", points=11, tolerance=0.1)
    modes = json.loads(mode_files(found)[SHAPES_FILE])["modes"]
    names = [each["name"] for each in found.object()["spectra"]["free"]["modes"]]
    assert [each["name"] for each in modes] == names
    assert {each["stress"] for each in modes} == {None}


def test_modes_of_another_program_have_no_solid_to_show(tmp_path: Path) -> None:
    table = tmp_path / "modes.csv"
    table.write_text(
        "natural_frequency [Hz],damping_ratio,drive_participation [N/V],contact_participation\n20000,0.002,0.5,1.2\n"
    )
    found = sl.modes(from_file=table, clamped_capacitance="4.2 nF")
    assert mode_files(found) == {}
    assert found.files()


def test_every_part_has_fields_that_make_it() -> None:
    known = mode_parts({}, NOWHERE)
    for part in known["parts"]:
        starts = {size["name"]: size["start"] for size in part["sizes"] if size["start"]}
        assert part["is_transducer"] or PARTS[part["name"]](**{name: _metres(text) for name, text in starts.items()})
    assert known["material"] in dict(known["materials"])
    assert not set(known["ceramics"]) & set(dict(known["materials"]))


def _metres(text: str) -> float:
    """Length of a text in mm."""
    return 1e-3 * float(text.removesuffix(" mm"))


def test_a_part_is_given_by_its_name_and_no_file_of_this_computer_is() -> None:
    sizes = {"length": "20 mm", "width": "5 mm", "thickness": "5 mm"}
    found = answered(offered_task("modes"), {"part": "block", "sizes": sizes, "count": 1}, NOWHERE)
    assert found["answer"]["modes"]
    with pytest.raises(UnknownName, match="unknown part 'blok'"):
        answered(offered_task("modes"), {"part": "blok"}, NOWHERE)
    for name in ("/etc/passwd", "part.step", "../part.stp"):
        with pytest.raises(InvalidInput, match=r"^part: give an object"):
            answered(offered_task("modes"), {"part": name}, NOWHERE)


STEP = b"ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n#1=CARTESIAN_POINT('',(0.,0.,0.));\nENDSEC;\nEND-ISO-10303-21;\n"


damaged = st.builds(lambda at, by: STEP[:at] + by + STEP[at:], st.integers(0, 120), st.binary(max_size=9))


@given(st.one_of(st.binary(max_size=200), damaged))
@examples(4)
def test_a_damaged_step_file_is_refused_in_one_line_without_a_folder(content: bytes) -> None:
    file = {"name": "own.step", "content": base64.b64encode(content).decode()}
    with pytest.raises(SonolubeError) as refused:
        answered(offered_task("modes"), {"part": file, "count": 1}, NOWHERE)
    text = str(refused.value)
    assert "\n" not in text
    assert "own.step" in text
    assert "/" not in text
