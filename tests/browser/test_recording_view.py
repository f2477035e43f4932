"""Views of uploaded files: kinds, columns, recordings as extremes, and where measured numbers go."""

import asyncio
import json
import os
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, strategies as st
from pytest import approx, raises
from tests.tiers import examples

import sonolube as sl
from sonolube.browser.answers import answer_object
from sonolube.browser.measured_use import measured_table, measured_use, own_runs
from sonolube.browser.recording_view import file_view, recording_view
from sonolube.browser.requests import Places
from sonolube.browser.uploads import Uploads
from sonolube.browser.worker import encoded
from sonolube.errors import InvalidInput, SonolubeError
from sonolube.tasks.files import NamedBytes

SHARED = Path(__file__).parents[3] / "shared" / "data"
EXAMPLES = Path(__file__).parents[2] / "examples"
SAMPLES = 50_000
T = np.arange(SAMPLES) / 1000
RNG = np.random.default_rng(5)
FORCE = 1 + 0.1 * RNG.standard_normal(SAMPLES)
FORCE[RNG.integers(0, SAMPLES, 20)] += RNG.choice([-40.0, 40.0], 20)  # spikes of one sample
FORCE[1000:1200] = np.nan


@pytest.fixture(scope="module")
def places(tmp_path_factory: pytest.TempPathFactory) -> Places:
    return Places(rigs={}, uploads=str(tmp_path_factory.mktemp("uploads")))


def given_file(places: Places, name: str, content: bytes) -> dict[str, str]:
    """File as a request has it, of an upload with this content."""
    upload = os.urandom(16).hex()
    Path(places.uploads, upload).write_bytes(content)
    return {"name": name, "upload": upload}


@pytest.fixture(scope="module")
def long(places: Places) -> dict[str, str]:
    rows = "\n".join(f"{t:.9g},{'' if f != f else repr(float(f))}" for t, f in zip(T, FORCE, strict=True))
    return given_file(places, "long.csv", f"time (s),friction_force (N)\n{rows}\n".encode())


def test_a_recording_is_described_once_and_kept_beside_its_upload(long: dict[str, str], places: Places) -> None:
    view = file_view({"file": long}, places)
    assert (view["kind"], view["samples"], view["sample_rate"]) == ("recording", SAMPLES, approx(1000))
    assert [channel["name"] for channel in view["channels"]] == ["friction_force"]
    assert [each["statement"] for each in view["columns"]] == ["time s", "friction_force N"]
    kept = sorted(path.name for path in Path(places.uploads).glob(f"{long['upload']}.*"))
    assert [name.partition(".")[2][13:] for name in kept] == ["extremes.npy", "json", "samples.npy"]
    assert file_view({"file": long}, places) == view


@examples(60)
@given(ends=st.tuples(st.floats(-5, 55), st.floats(-5, 55)), points=st.integers(1, 9000))
def test_every_view_has_the_extremes_of_its_samples(
    ends: tuple[float, float], points: int, long: dict[str, str], places: Places
) -> None:
    begin, end = sorted(ends)
    file_view({"file": long}, places)
    view = recording_view({"file": long, "from": begin, "to": end, "points": points}, places)
    shown = np.array([np.nan if each is None else each for each in view["channels"][0]])
    assert shown.size == len(view["x"]) <= 4000
    inside = FORCE[np.searchsorted(T, begin) : np.searchsorted(T, end, side="right")]
    if np.isfinite(inside).any():
        assert np.nanmin(shown) <= np.nanmin(inside)
        assert np.nanmax(shown) >= np.nanmax(inside)
    around = FORCE[max(np.searchsorted(T, begin) - 1, 0) : np.searchsorted(T, end, side="right") + 1]
    assert view["samples"] == around.size
    if np.isfinite(around).any():
        assert (np.nanmin(shown), np.nanmax(shown)) == (np.nanmin(around), np.nanmax(around))


def test_what_is_kept_goes_with_its_upload() -> None:
    async def content(size: int) -> Any:
        yield b"0" * size

    uploads = Uploads()
    try:
        first = asyncio.run(uploads.keep(content(10), length=10))
        Path(uploads.folder, f"{first}.abc.json").write_text("{}")
        second = asyncio.run(uploads.keep(content(10), length=10))
        assert sorted(path.name for path in uploads.folder.iterdir()) == sorted([first, f"{first}.abc.json", second])
        os.truncate(uploads.folder / f"{first}.abc.json", 2**30)
        third = asyncio.run(uploads.keep(content(10), length=10))
        assert {path.name for path in uploads.folder.iterdir()} == {second, third}
    finally:
        uploads.end()


@pytest.mark.skipif(not SHARED.is_dir(), reason="files of instruments are not beside the project; see shared/data")
def test_an_export_by_cycles_opens_with_its_columns_stated(places: Places) -> None:
    file = given_file(places, "cof.csv", (SHARED / "friction" / "CoF-Measurements.csv").read_bytes())
    view = file_view({"file": file}, places)
    assert "no column or property gives the time" in view["reason"]
    asked = {each["label"]: each for each in view["columns"]}
    assert asked["CoF.mean"]["is_asked"]
    assert "Nanotribometer DragonSkin10" in asked["DataName"]["texts"]
    columns = {"CycleID": "revolutions", "CoF.mean": "friction_coefficient", "NominalLoad": "normal_load mN"}
    rows = {"DataName": "Nanotribometer DragonSkin10", "SequenceID": "1"}
    mapping = file_view({"file": file, "columns": columns, "rows": rows}, places)["mapping"]
    read = file_view({"file": file, "mapping": mapping}, places)
    assert (read["reason"], read["samples"], read["axis"]["name"]) == ("", 30, "revolutions")  # as the README counts
    stated = {each["label"]: each["statement"] for each in read["columns"]}
    assert (stated["CycleID"], stated["CoF.mean"]) == ("revolutions", "friction_coefficient")
    assert len(recording_view({"file": file, "mapping": mapping}, places)["x"]) == 30


@pytest.mark.parametrize(
    "payload",
    [
        {},
        {"file": None},
        {"file": {"name": "a.csv"}},
        {"file": {"name": "a.csv", "upload": "../../etc/passwd"}},
        {"file": {"name": "a.csv", "upload": ".."}},
        {"file": {"name": "a.csv", "upload": ""}},
        {"file": {"name": "a.csv", "upload": "0" * 32}},
    ],
)
def test_files_that_are_not_here_are_refused(payload: dict[str, Any], places: Places) -> None:
    for view in (file_view, recording_view):
        with raises(InvalidInput, match="file: "):
            view(payload, places)


@examples(60)
@given(
    content=st.one_of(st.binary(min_size=1, max_size=400), st.text(min_size=1, max_size=200).map(str.encode)),
    name=st.sampled_from(["a.csv", "a.tdms", "a.mat", "a.h5", "a.npy", "a.opd", "a.s1p", "a.lvm", "a.x3p", "a"]),
    mapping=st.sampled_from(["", "[axis", "title = 3", "[channels.friction_force]\ncolumn = 'a'\n"]),
)
def test_any_bytes_are_described_or_refused_in_one_line(
    content: bytes, name: str, mapping: str, places: Places
) -> None:
    file = given_file(places, name, content)
    try:
        view = file_view({"file": file, "mapping": mapping}, places)
    except SonolubeError as failure:
        reason = str(failure)
    else:
        json.loads(encoded(view))
        reason = view["reason"]
    assert "\n" not in reason
    assert "/tmp" not in reason


@pytest.mark.parametrize(
    "wrong", [{"from": "1"}, {"to": True}, {"points": [3]}, {"from": float("nan")}, {"from": {"a": 1}}]
)
def test_a_view_refuses_what_is_no_number(wrong: dict[str, Any], long: dict[str, str], places: Places) -> None:
    file_view({"file": long}, places)
    with raises(InvalidInput, match="must be a number"):
        recording_view({"file": long} | wrong, places)


def test_statements_are_refused_by_their_columns(long: dict[str, str], places: Places) -> None:
    given_wrong: tuple[dict[str, Any], ...] = (
        {"columns": []},
        {"columns": {"a": 1}},
        {"columns": {}, "rows": 3},
        {"columns": {"time (s)": "N"}},
    )
    for wrong in given_wrong:
        with raises(InvalidInput) as refused:
            file_view({"file": long} | wrong, places)
        assert refused.value.key in ("columns", "rows", "time (s)")


@pytest.fixture(scope="module")
def staircase() -> dict[str, Any]:
    t = np.arange(0, 60, 0.01)
    volts = 10.0 * np.floor(t / 20)
    force = 1 - 0.02 * volts + 0.03 * np.random.default_rng(2).standard_normal(t.size)
    rows = [f"{a},{b},{c}" for a, b, c in zip(t, volts, force, strict=True)]
    text = "\n".join(["time (s),voltage_peak_to_peak (V),friction_force (N)", *rows])
    answer: dict[str, Any] = answer_object(sl.measure.friction(NamedBytes("stairs.csv", text.encode())))["answer"]
    return answer


def test_steps_become_runs_that_predictions_read(staircase: dict[str, Any], places: Places, tmp_path: Path) -> None:
    conditions = {"sliding_speed": "20.3 mm/s", "normal_load": "3 N"}
    found = measured_use({"results": staircase["results"], "conditions": conditions}, places)
    (tmp_path / "runs.csv").write_text(found["csv"])
    runs = sl.read_runs(tmp_path / "runs.csv")
    assert found["added"] == runs.sizes["run"] == 2
    assert runs["voltage_peak_to_peak"].values == approx([10.0, 20.0])
    assert runs["friction_reduction"].values == approx([0.2, 0.4], abs=0.005)
    assert runs["sliding_speed"].values == approx(0.0203)
    entries = {each["key"]: each["text"] for each in found["entries"]}
    assert float(entries["friction.friction_coefficient"]) == approx(1 / 3, abs=0.002)
    assert entries["contact.normal_load"] == "3 N"
    assert not any(key.startswith("uncertainty.") for key in entries)
    assert "friction_reduction_uncertainty" not in runs
    narrowed = sl.predict(EXAMPLES / "rigs" / "tribometer.toml", runs=tmp_path / "runs.csv", draws=2000)
    assert any("0.05 is taken for each ratio" in caveat for caveat in narrowed.caveats())


def test_rows_are_appended_to_a_table_of_runs(staircase: dict[str, Any], places: Places, tmp_path: Path) -> None:
    own = given_file(places, "own.csv", (EXAMPLES / "tribometer-runs.csv").read_bytes())
    found = measured_use({"results": staircase["results"], "runs": own}, places)
    (tmp_path / "runs.csv").write_text(found["csv"])
    runs = sl.read_runs(tmp_path / "runs.csv")
    before = sl.read_runs(EXAMPLES / "tribometer-runs.csv")
    assert runs["friction_force"].values[:4] == approx(before["friction_force"].values)
    assert (found["runs"], runs.sizes["run"]) == (6, 6)
    alone = measured_use({"table": own}, places)
    assert (alone["added"], alone["entries"]) == (4, [])


def test_what_is_added_twice_is_added_once(staircase: dict[str, Any], places: Places) -> None:
    first = measured_use({"results": staircase["results"]}, places)
    own = given_file(places, "own.csv", first["csv"].encode())
    again = measured_use({"results": staircase["results"], "runs": own}, places)
    assert (again["added"], again["runs"]) == (0, 2)


def test_the_table_of_own_runs_is_changed_row_by_row(places: Places) -> None:
    pasted = own_runs({"text": "Amplitude [um]\tmu\tmu0\n2,5\t0,2\t0,4\n1,0\t0,3\t0,4\n"}, places)
    assert (pasted["added"], pasted["runs"], pasted["used"]) == (2, 2, [True, True])
    own = given_file(places, "own.csv", pasted["csv"].encode())
    more = own_runs({"runs": own, "text": "4,0\t0,1\t0,4"}, places)
    assert more["rows"][2][: len(more["names"]) - 1] == ("4.0", "0.1", "0.4")
    edited = own_runs({"runs": own, "edit": {"row": 0, "name": "vibration_amplitude", "text": "2 um"}}, places)
    assert edited["rows"][0][0] == "2"
    off = own_runs({"runs": own, "switch": {"row": 1, "used": False}}, places)
    assert (off["used"], off["switched_off"]) == ([True, False], 1)
    (left,) = own_runs({"runs": own, "remove": 0}, places)["rows"]
    assert left[0] == "1.0"
    nothing = own_runs({}, places)
    assert (nothing["rows"], nothing["csv"], nothing["runs"]) == ((), "", 0)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"remove": "first"}, "row: give a whole number, got 'first'"),
        ({"switch": {"used": True}}, "row: give a whole number"),
        ({"edit": {"row": 3, "name": "note", "text": "a"}}, "row must be one of the 2"),
        ({"text": "only words"}, "pasted.txt"),
    ],
)
def test_a_change_of_own_runs_that_makes_no_sense_is_refused(change: dict[str, Any], said: str, places: Places) -> None:
    own = given_file(places, "own.csv", b"friction_ratio\n0.5\n0.6\n")
    with raises(InvalidInput, match=said):
        own_runs({"runs": own, **change}, places)


def test_a_table_of_unknown_headings_becomes_runs_by_its_mapping(places: Places, tmp_path: Path) -> None:
    own = given_file(places, "eigene.csv", b"v;F mit;F ohne\n20;0,5;1,0\n40;0,8;1,0\n")
    columns = {"v": "sliding_speed mm/s", "F mit": "friction_force N", "F ohne": "intrinsic_friction_force N"}
    mapping = file_view({"file": own, "columns": columns}, places)["mapping"]
    found = measured_use({"table": own, "mapping": mapping}, places)
    (tmp_path / "runs.csv").write_text(found["csv"])
    runs = sl.read_runs(tmp_path / "runs.csv")
    assert runs["friction_reduction"].values == approx([0.5, 0.2])
    assert runs["sliding_speed"].values == approx([0.02, 0.04])


def test_conditions_are_refused_by_name(staircase: dict[str, Any], places: Places) -> None:
    for name, text in (("normal_load", "3 m"), ("sliding_speed", "fast")):
        with raises(InvalidInput) as refused:
            measured_use({"results": staircase["results"], "conditions": {name: text}}, places)
        assert refused.value.key == name


anything = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8),
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.dictionaries(st.sampled_from(["values", "tables", "steps", "rows", "units", "value", "title"]), inner)
    ),
    max_leaves=20,
)


@examples(100)
@given(results=anything)
def test_any_json_is_taken_or_refused(results: Any, places: Places) -> None:
    for view, payload in (
        (measured_use, {"results": results}),
        (measured_use, {"results": [results]}),
        (measured_table, {"answers": results}),
        (measured_table, {"answers": [{"answer": {"results": [results]}}]}),
    ):
        with suppress(InvalidInput):
            json.loads(encoded(view(payload, places)))


def test_a_table_has_the_numbers_of_all_answers(staircase: dict[str, Any], places: Places) -> None:
    answers = [{"name": name, "task": "measure friction", "answer": staircase} for name in ("a.csv", "b.csv")]
    first, heads, *rows = measured_table({"answers": answers}, places)["csv"].splitlines()
    assert first == f"# sonolube {sl.__version__}: measure friction"
    assert heads == "file,part,quantity,value,standard uncertainty,unit"
    step = next(row for row in rows if row.startswith("b.csv,steps 2,friction_reduction,"))
    table = staircase["results"][0]["tables"]["steps"]["rows"]
    assert float(step.split(",")[3]) == table[1]["friction_reduction"]
