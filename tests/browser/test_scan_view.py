"""Scans as the page Data shows them, beside brute force and closed forms; bad files in one line."""

import json
import shutil
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, strategies as st
from tests.browser.scans import GROOVE_DEPTH, GROOVE_WIDTH, SPACING, groove_heights, write_groove
from tests.tiers import examples

from sonolube.browser.requests import Places
from sonolube.browser.scan_view import scan_view, section_view
from sonolube.browser.worker import encoded, reply
from sonolube.errors import InvalidInput, SonolubeError

MEASURED = Path(__file__).parents[3] / "shared" / "data" / "surfaces"
FIELD = 1e6 * SPACING * np.array([239, 159])  # um, between the centres of the outermost pixels


@pytest.fixture
def places(tmp_path: Path) -> Places:
    return Places(rigs={}, uploads=str(tmp_path))


def upload(path: Path, places: Places) -> dict[str, str]:
    """A file as an upload."""
    shutil.copy(path, Path(places.uploads, "00ff"))
    return {"name": path.name, "upload": "00ff"}


@pytest.fixture
def scan(tmp_path: Path, places: Places) -> dict[str, Any]:
    return {"file": upload(write_groove(tmp_path), places), "spacing": "5 um"}


def values(view: dict[str, Any]) -> np.ndarray:
    """Heights of the cells of a map in its unit."""
    (panel,) = view["chart"]["panels"]
    return np.array(panel["parts"][0]["values"], dtype=np.float64)


def section(from_x: float, from_y: float, to_x: float, to_y: float) -> dict[str, str]:
    """Ends of a section in um."""
    names = ("from_x", "from_y", "to_x", "to_y")
    return {name: f"{value} um" for name, value in zip(names, (from_x, from_y, to_x, to_y), strict=True)}


def test_heights_as_measured_are_those_of_the_file(scan: dict[str, Any], places: Places) -> None:
    view = scan_view(scan | {"shown": "measured"}, places)
    scale = view["metres"]["height"]
    np.testing.assert_allclose(scale * values(view), groove_heights(), rtol=1e-5)
    facts = dict(view["facts"])
    assert facts["pixels"] == "240 x 160, 5 um x 5 um"
    assert facts["not measured"] == f"{np.isnan(groove_heights()).mean():.2%}"
    assert facts["cells of the map"] == "single pixels"


def test_the_form_is_the_tilt_and_levelled_heights_are_those_less_the_form(
    scan: dict[str, Any], places: Places
) -> None:
    request = scan | {"robust": True}  # so that the groove does not count
    shown = {name: scan_view(request | {"shown": name}, places) for name in ("measured", "form", "levelled")}
    slopes = [float(text) for name, text in shown["form"]["facts"] if name.startswith("Mean slope")]
    assert slopes == pytest.approx([2e-3, 1e-3], rel=2e-2)
    measured, form, levelled = (view["metres"]["height"] * values(view) for view in shown.values())
    np.testing.assert_allclose(levelled, measured - form, atol=1e-11)


def test_a_large_scan_is_reduced_to_the_means_of_its_blocks(tmp_path: Path, places: Places) -> None:
    heights = np.random.default_rng(1).standard_normal((500, 1000)) * 1e-6
    np.save(tmp_path / "large.npy", heights)
    request = {"file": upload(tmp_path / "large.npy", places), "spacing": "1 um", "shown": "measured"}
    view = scan_view(request, places)
    blocks = [heights[0:3, 0:3].mean(), heights[498:500, 999:1000].mean()]
    cells = view["metres"]["height"] * values(view)
    assert cells.shape == (167, 334)
    assert [cells[0, 0], cells[-1, -1]] == pytest.approx(blocks, rel=1e-5)
    assert len(encoded(view)) < 1_000_000


def test_a_section_across_the_groove_is_its_parabola(scan: dict[str, Any], places: Places) -> None:
    request = scan | {"robust": True, "section": section(0, 400, FIELD[0], 400)}
    (panel,) = section_view(request, places)["chart"]["panels"]
    (line,) = panel["parts"]
    known = np.array([height is not None for height in line["y"]])
    x, z = (np.array(line[name], dtype=float)[known] for name in "xy")
    across = (1e-6 * x - SPACING * 239 / 2) / (GROOVE_WIDTH / 2)
    expected = -GROOVE_DEPTH * np.maximum(0.0, 1 - across**2)
    assert np.abs(1e-6 * z - expected).max() < 5 * 50e-9  # of the roughness


def test_a_long_section_keeps_its_extremes_within_four_thousand_points(tmp_path: Path, places: Places) -> None:
    heights = np.zeros((2, 50_000))
    heights[:, 31_234], heights[:, 7] = 3e-6, -2e-6
    np.save(tmp_path / "long.npy", heights)
    request = {"file": upload(tmp_path / "long.npy", places), "spacing": "1 um", "shown": "measured"}
    view = section_view(request | {"section": section(0, 0, 49_999, 0)}, places)
    (line,) = view["chart"]["panels"][0]["parts"]
    assert len(line["x"]) <= 4000
    scale = view["metres"]["height"]
    assert (scale * min(line["y"]), scale * max(line["y"])) == pytest.approx((-2e-6, 3e-6))
    assert dict(view["facts"])["Points"] == "50000"


def test_a_file_without_its_distances_asks_for_them_by_their_field(scan: dict[str, Any], places: Places) -> None:
    with pytest.raises(InvalidInput, match=r"^groove\.npy: the distance of pixels is not in the file") as refusal:
        scan_view(scan | {"spacing": ""}, places)
    assert refusal.value.key == "spacing"


@pytest.mark.parametrize(
    ("more", "key", "text"),
    [
        ({"spacing": "5"}, "spacing", "spacing 5 has no unit"),
        ({"spacing": "5 V"}, "spacing", "spacing 5 V is a voltage"),
        ({"degree": 13}, "degree", "a whole number from 0 to 12"),
        ({"degree": "2"}, "degree", "a whole number"),
        ({"shown": "deep"}, "", "deep"),
        ({"file": {"name": "a", "upload": "../rig"}}, "file", "no longer here"),
        ({"file": None}, "file", "give an object"),
        ({"section": section(0, 0, 0, 0)}, "", "the same point"),
        ({"section": section(0, 0, 5000, 0)}, "", "x = 5000 um is outside the field, -2.5 um to 1198 um"),
        ({"section": {}}, "from_x", "from_x '' is not a number with a unit"),
        ({"section": None}, "section", "give from_x, from_y, to_x, to_y"),
    ],
)
def test_what_is_wrong_is_refused_in_one_line(
    more: dict[str, Any], key: str, text: str, scan: dict[str, Any], places: Places
) -> None:
    with pytest.raises(SonolubeError) as refusal:
        (section_view if "section" in more else scan_view)(scan | more, places)
    assert text in str(refusal.value)
    assert "\n" not in str(refusal.value)
    assert getattr(refusal.value, "key", "") == key


ENDINGS = (".npy", ".opd", ".nms", ".xyz", ".sur", ".x3p", ".al3d", ".dat", ".opdx", ".csv")
STARTS = (
    b"",
    b"\x93NUMPY\x01\x00",
    b"\x01\x00Directory",
    b"PK\x03\x04",
    b"AliconaImaging\x00",
    b"DIGITAL SURF",
    b"1 2 3\n",
)


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")  # files left open by readers of others
@given(content=st.binary(max_size=400), ending=st.sampled_from(ENDINGS), start=st.sampled_from(STARTS))
@examples(60, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_bad_files_get_one_line_without_the_folders_of_the_workbench(
    content: bytes, ending: str, start: bytes, places: Places
) -> None:
    name = sha256(start + content).hexdigest()  # uploads do not change
    Path(places.uploads, name).write_bytes(start + content)
    request = {"file": {"name": f"bad{ending}", "upload": name}, "spacing": "1 um", "section": section(0, 0, 1, 1)}
    for kind in ("scan", "section"):
        status, body = reply(kind, request, places)
        assert status in (200, 422)
        text = "" if status == 200 else json.loads(body)["text"]
        assert [word for word in ("\n", places.uploads, "sonolube-bytes-") if word in text] == []


@pytest.mark.skipif(not MEASURED.is_dir(), reason="the measured files are not beside the project; see shared/data")
def test_every_measured_file_is_shown_with_its_section(places: Places) -> None:
    for path in sorted(MEASURED.iterdir()):
        request = {"file": upload(path, places)}
        view = scan_view(request, places)
        if view["is_profile"]:
            continue
        cells = values(view)
        assert max(cells.shape) <= 400
        assert np.isfinite(cells).mean() > 0.99
        panel = view["chart"]["panels"][0]
        assert panel["has_equal_scales"]
        ends = section(0, 0, panel["parts"][0]["x"][-1], panel["parts"][0]["y"][-1])
        (line,) = section_view(request | {"section": ends}, places)["chart"]["panels"][0]["parts"]
        assert len(line["x"]) > 200, path.name
