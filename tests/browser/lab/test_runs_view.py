"""Runs on disk: which folders are runs, parts of recordings, and runs compared."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from pytest import MonkeyPatch, approx, raises

from sonolube.browser.lab import runs_view
from sonolube.browser.requests import Places
from sonolube.errors import InvalidInput


@pytest.fixture
def places(tmp_path: Path) -> Places:
    for name in ("0715", "0716", "none"):
        (tmp_path / "runs" / name).mkdir(parents=True)
        if name != "none":
            (tmp_path / "runs" / name / "run.json").write_text("{}")
    return Places(rigs={}, runs=str(tmp_path / "runs"))


@pytest.mark.parametrize("name", ["none", "", "..", ".hidden", "a/b", "../runs/0715", "0715\0", 3, None])
def test_only_the_name_of_a_folder_of_a_run_is_one(name: Any, places: Places) -> None:
    assert runs_view.run_folder("0715", places) == Path(places.runs, "0715")
    with raises(InvalidInput, match=r"^runs: there is no run ") as refused:
        runs_view.run_folder(name, places)
    assert refused.value.key == "id"


def test_no_folder_of_runs_has_no_runs(tmp_path: Path) -> None:
    assert runs_view.runs({}, Places(rigs={}, runs=str(tmp_path / "none"))) == {
        "runs": [], "folder": "none", "caveats": [],
    }  # fmt: skip


def entry(name: str, **facts: Any) -> tuple[Any, Any]:
    summary = SimpleNamespace(
        folder=Path("runs", name), title=f"Test {name}", begun=1e9, outcome="stopped", reason="by hand", duration=2.5
    )
    known = SimpleNamespace(
        facts=facts, recordings=("a",) if facts else (), referenced=("b", "c"), versions={"sonolube": "1.2"}
    )
    return SimpleNamespace(summary=summary, tags=("tried",)), known


def test_runs_are_listed_latest_first_with_their_device(places: Places, monkeypatch: MonkeyPatch) -> None:
    made = {
        "0715": entry("0715", device_device="Acme", device_rig="x", rig="y", rig_title="Own", protocol="short", seed=3),
        "0716": entry("0716"),
        "0717": entry("0717", rig="tribometer.toml"),
    }
    found = SimpleNamespace(entries=tuple(one for one, _ in made.values()), caveats=("a gap",))
    monkeypatch.setattr(runs_view, "query_runs", lambda parent: found)
    monkeypatch.setattr(runs_view, "read_run_facts", lambda folder: made[folder.name][1])
    listed = runs_view.runs({}, places)
    assert (listed["folder"], listed["caveats"]) == ("runs", ["a gap"])
    assert [each["id"] for each in listed["runs"]] == ["0717", "0716", "0715"]
    assert listed["runs"][2] == {
        "id": "0715", "title": "Test 0715", "created": 1e9, "state": "stopped", "reason": "by hand", "device": "Acme",
        "rig": "Own", "protocol": "short", "seed": 3, "recordings": 1, "duration": 2.5, "tags": ["tried"],
        "version": "1.2",
    }  # fmt: skip
    assert (listed["runs"][1]["device"], listed["runs"][1]["recordings"], listed["runs"][1]["seed"]) == ("", 2, None)
    assert listed["runs"][0]["device"] == "tribometer.toml"


@pytest.mark.parametrize(
    ("parts", "part", "name"), [(1, 1, "0715.nc"), (2, 1, "0715-part-1.nc"), (2, 2, "0715-part-2.nc")]
)
def test_a_part_of_a_recording_is_uploaded_under_the_name_of_its_run(
    parts: int, part: int, name: str, places: Places, monkeypatch: MonkeyPatch
) -> None:
    paths = tuple(Path(f"part-{number}.nc") for number in range(1, parts + 1))
    monkeypatch.setattr(runs_view, "read_run", lambda folder: SimpleNamespace(recordings=paths))
    assert runs_view.recording({"id": "0715", "part": part}, places) == {
        "path": f"part-{part}.nc", "name": name, "part": part, "parts": parts,
    }  # fmt: skip
    assert runs_view.recording({"id": "0715"}, places)["part"] == 1
    for wrong in (0, parts + 1, True, "1", 1.0):
        with raises(InvalidInput, match=rf"^part: must be one of 1 to {parts}$") as refused:
            runs_view.recording({"id": "0715", "part": wrong}, places)
        assert refused.value.key == "part"
    monkeypatch.setattr(runs_view, "read_run", lambda folder: SimpleNamespace(recordings=()))
    with raises(InvalidInput, match=r"^0715: has no recording; recover the run where it was killed$"):
        runs_view.recording({"id": "0715"}, places)


ROWS = [
    ["run", "normal_load [N]", "sliding_speed [m/s]", "voltage_peak_to_peak [V]", "frequency [Hz]",
     "friction_force [N]", "friction_force_uncertainty [N]", "friction_reduction", "friction_reduction_uncertainty"],
    ["0715", "3", "0.02", "20", "22000", "1.5", "0.1", "0.5", "0.05"],
]  # fmt: skip


def test_runs_are_compared_once_each_with_caveats_table_and_chart(places: Places, monkeypatch: MonkeyPatch) -> None:
    asked: list[list[str]] = []

    def levels(folders: list[Path]) -> Any:
        asked.append([folder.name for folder in folders])
        return ROWS, ["0716: no levels"]

    monkeypatch.setattr(runs_view, "level_rows", levels)
    facts = {"0715": {"simulated": True}, "0716": {}}
    monkeypatch.setattr(
        runs_view, "read_run", lambda folder: SimpleNamespace(facts=facts[folder.name], caveats=("a gap",))
    )
    found = runs_view.compared({"runs": ["0715", "0716", "0715"]}, places)
    assert asked == [["0715", "0716"]]
    assert found["caveats"] == [
        "0716: no levels", "0715: a gap", "0715: a virtual tribometer's friction is no measurement", "0716: a gap",
    ]  # fmt: skip
    assert found["answer"]["levels"][0]["friction_force"] == approx(1.5)
    assert found["answer"]["caveats"] == found["caveats"]
    text, table = found["blocks"]
    assert text == {"kind": "text", "text": "1 levels of 2 runs"}
    assert (table["kind"], table["heads"][0], table["rows"][0][0]) == ("table", "run", "0715")
    assert found["table"].splitlines()[1] == "0715,3,0.02,20,22000,1.5,0.5"
    (chart,) = found["charts"]
    assert (chart["name"], found["name"]) == ("compared-runs", "compared-runs.csv")
    assert chart["chart"]["panels"]
    assert chart["tables"]


@pytest.mark.parametrize("ids", [None, [], "0715", ["0715"] * 51])
def test_one_to_fifty_runs_are_compared(ids: Any, places: Places) -> None:
    with raises(InvalidInput, match=r"^runs: give 1 to 50 runs$") as refused:
        runs_view.compared({"runs": ids}, places)
    assert refused.value.key == "runs"


@pytest.mark.parametrize(("left_out", "why"), [([], "the runs have no levels"), (["a", "b"], "b")])
def test_runs_without_levels_are_refused_with_the_last_reason(
    left_out: list[str], why: str, places: Places, monkeypatch: MonkeyPatch
) -> None:
    monkeypatch.setattr(runs_view, "level_rows", lambda folders: (ROWS[:1], left_out))
    with raises(InvalidInput, match=rf"^no friction can be measured: {why}$"):
        runs_view.compared({"runs": ["0715"] * 50}, places)


def test_a_run_without_a_record_has_nothing_to_recover_and_another_says_what_was_mended(
    places: Places, monkeypatch: MonkeyPatch
) -> None:
    nothing = {"text": "the run was killed before it had a record", "done": [], "run": ""}
    for folder in ("", str(Path(places.runs, "none"))):
        assert runs_view.recovered({"folder": folder}, places) == nothing
    mended = SimpleNamespace(summary=SimpleNamespace(outcome="interrupted", samples=400), done=("samples", "end"))
    answer = SimpleNamespace(refused={}, recovered={"0715": mended})
    monkeypatch.setattr("sonolube.tasks.lab.run_folders.recover", lambda folder: answer)
    asked = {"folder": str(Path(places.runs, "0715"))}
    assert runs_view.recovered(asked, places) == {
        "text": "recovered: interrupted, 400 samples", "done": ["samples", "end"], "run": "0715",
    }  # fmt: skip
    answer.refused = {"0715": "is at work"}
    with raises(InvalidInput, match=r"^is at work$"):
        runs_view.recovered(asked, places)
