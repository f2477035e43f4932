"""Tasks on recorded runs by stand-ins: facts, queries, recovery run by run, exports, and devices that are checked."""

from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import xarray as xr
from pytest import MonkeyPatch, approx, raises
from tests.names import names_of

from sonolube.errors import InvalidInput
from sonolube.report.blocks import Rows, Table
from sonolube.tasks.lab import device_check, run_folders
from sonolube.tasks.lab.device_check import CheckedDevices, check
from sonolube.tasks.lab.run_folders import ExportedRecording, FoundRunsAnswer, RecoveredRuns, ShownRun, facts_of


def test_facts_are_numbers_where_they_can_be_and_need_a_name() -> None:
    assert facts_of({"load": "5", "humidity": 45, "operator": "Ann"}) == {
        "load": 5.0, "humidity": 45.0, "operator": "Ann",
    }  # fmt: skip
    with raises(InvalidInput, match=r"^fact a b=3 must be NAME=VALUE, such as normal_load=5$"):
        facts_of({"a b": 3})


def test_runs_that_were_found_are_counted_and_listed(monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setattr(names_of(run_folders).results, "found_row", lambda entry: [entry])
    monkeypatch.setattr(names_of(run_folders).results, "found_object", lambda entry: {"id": entry})
    found: Any = SimpleNamespace(entries=("a", "b"), of=7, caveats=("index renewed",))
    answer = FoundRunsAnswer(place=Path("runs"), found=found)
    head, table = answer.blocks()
    assert head == "2 of 7 runs in runs"
    assert isinstance(table, Table)
    assert table.rows == [["a"], ["b"]]
    assert answer.object() == {"runs": [{"id": "a"}, {"id": "b"}], "of": 7}
    assert answer.caveats() == ("index renewed",)
    found.entries = ()
    assert answer.blocks() == ["0 of 7 runs in runs"]


def test_a_search_hands_on_what_was_given_and_takes_in_what_is_added(monkeypatch: MonkeyPatch) -> None:
    asked: list[Any] = []
    monkeypatch.setattr(run_folders, "query_from", lambda given: given)
    monkeypatch.setattr(run_folders, "query_runs", lambda place, query: asked.append((place, query)))
    monkeypatch.setattr(run_folders, "take_in", lambda place, source, *, facts: asked.append((source, facts)))
    run_folders.runs("all", load="5N", tag=["a"], add=["x.csv"], fact={"load": 5})
    assert asked == [
        (Path("x.csv"), {"load": 5.0}),
        (Path("all"), {"load": ["5N"], "material": (), "tag": ["a"], "text": ()}),
    ]
    with raises(InvalidInput, match="fact has no meaning without add, whose recordings it describes"):
        run_folders.runs("all", fact={"load": 5})


@dataclass(frozen=True)
class Mended:
    summary: Any
    done: tuple[str, ...]


def mended(*done: str) -> Any:
    return Mended(SimpleNamespace(outcome="interrupted", samples=400), done)


def test_recovered_runs_are_said_with_what_was_done_and_whole_ones_only_counted() -> None:
    answer = RecoveredRuns(
        recovered={Path("runs/1"): mended("samples", "end"), Path("runs/2"): mended()}, refused={"3": "is at work"}
    )
    assert answer.blocks() == [
        "1 of 2 runs recovered", "  1: interrupted, 400 samples", "    samples", "    end",
    ]  # fmt: skip
    assert answer.object()["runs"][1] == {
        "folder": str(Path("runs/2")), "outcome": "interrupted", "samples": 400, "done": [],
    }  # fmt: skip
    assert answer.refusals() == {"3": "is at work"}


def test_each_run_of_a_folder_is_recovered_and_refused_by_itself(monkeypatch: MonkeyPatch, tmp_path: Path) -> None:
    def recover(path: Path) -> Any:
        if path.name == "2":
            raise InvalidInput("is at work")
        return mended("end")

    monkeypatch.setattr(run_folders, "run_folders", lambda folder: [folder / "1", folder / "2"])
    monkeypatch.setattr(run_folders, "recover_run", recover)
    monkeypatch.setattr(run_folders, "drop_raw_blocks", lambda path: ("blocks",))
    found = run_folders.recover(tmp_path, drop_blocks=True)
    assert found.recovered[tmp_path / "1"].done == ("end", "blocks")
    assert found.refused == {str(tmp_path / "2"): "is at work"}
    assert run_folders.recover(tmp_path).recovered[tmp_path / "1"].done == ("end",)
    monkeypatch.setattr(run_folders, "run_folders", lambda folder: [])
    assert list(run_folders.recover(tmp_path).recovered) == [tmp_path]
    with raises(InvalidInput, match=r"^is at work$"):
        run_folders.recover(tmp_path / "2")


def test_an_export_counts_its_parts_and_names_their_files() -> None:
    one = ExportedRecording(paths=[Path("out/a.csv")])
    two = ExportedRecording(paths=[Path("out/a.csv"), Path("out/b.csv")])
    assert (one.blocks(), two.blocks()) == (["the recording"], ["2 parts of the recording"])
    assert (two.object(), list(two.files())) == ({"parts": 2}, ["a.csv", "b.csv"])


def test_a_run_without_a_recording_has_no_figure_and_one_with_clocks_a_figure_each() -> None:
    run: Any = SimpleNamespace(
        recordings=(), clocks={"slow": ()}, folder=Path("runs/7"), caveats=("gap",),
        summary=SimpleNamespace(title="Brass", folder=Path("runs/7")), dataset=lambda: xr.Dataset({"a": 1.0}),
    )  # fmt: skip
    answer = ShownRun(run=run)
    assert answer.figures() == {}
    run.recordings = ("a.nc",)
    drawings = answer.figures()
    assert list(drawings) == ["7-channels", "7-channels-slow"]
    assert drawings["7-channels"].caption == "Brass: the range of the samples of each channel over time."
    assert drawings["7-channels-slow"].caption.endswith("over time, by the clock slow.")
    assert answer.dataset().attrs["caveats"] == "gap"


DEVICES: Any = SimpleNamespace(devices=lambda: SimpleNamespace(description={"rig": "Own rig", "motor": "Acme"}))


def checked(**more: Any) -> CheckedDevices:
    values: dict[str, Any] = {"device_map": DEVICES, "missing": (), "protocol": None, "beyond": (), "readings": None}
    return CheckedDevices(**(values | more))


def test_devices_say_what_is_missing_what_is_beyond_them_and_what_they_read() -> None:
    bare = checked()
    assert bare.blocks() == ["Own rig", Rows([("motor", "Acme")]), "all packages and drivers are installed"]
    assert not bare.is_failure
    full = checked(missing=["needs x"], protocol="map_test", beyond=["too fast"], readings={"force": (0.5e-3, "N")})
    assert full.blocks()[2:] == [
        "missing: needs x", "impossible: too fast", "readings with motor and drive off", Rows([("force", "500 uN")]),
    ]  # fmt: skip
    assert full.is_failure
    assert checked(missing=["x"]).is_failure
    assert checked(protocol="p", beyond=["x"]).is_failure
    assert checked(protocol="map_test").blocks()[-1] == "map_test can be run"
    assert full.object()["readings"] == {"force": {"value": 0.5e-3, "unit": "N"}}
    assert bare.object()["readings"] is None
    assert full.dataset()["force"].attrs == {"units": "N", "long_name": "force"}
    assert dict(bare.dataset().data_vars) == {}
    assert len(bare.caveats()) == 2


@pytest.mark.parametrize(("rate", "used"), [(10e3, 1000.0), (1500.0, 500.0)])
def test_first_readings_are_at_a_kilohertz_or_what_the_inputs_share(
    rate: float, used: float, monkeypatch: MonkeyPatch
) -> None:
    asked: list[float] = []
    channels = {name: SimpleNamespace(unit="V") for name in "abc"}
    found = SimpleNamespace(
        entries=SimpleNamespace(acquisition=SimpleNamespace(total_rate_maximum=rate)),
        devices=lambda: SimpleNamespace(channels=channels, acquisition=SimpleNamespace(channels=channels)),
    )

    def readings(devices: Any, *, sample_rate: float) -> dict[str, float]:
        asked.append(sample_rate)
        return {"a": 1.5}

    monkeypatch.setattr(device_check, "read_device_map", lambda path: found)
    monkeypatch.setattr(device_check, "missing_parts", lambda read: ())
    monkeypatch.setattr(device_check, "first_readings", readings)
    assert check("map.toml").readings is None
    answer = check("map.toml", connect=True)
    assert answer.readings == {"a": (1.5, "V")}
    assert asked == [approx(used)]
    assert (answer.protocol, answer.beyond) == (None, ())

    def refuse(*_: object, **__: object) -> None:
        raise InvalidInput("no device")

    monkeypatch.setattr(device_check, "first_readings", refuse)
    with raises(InvalidInput, match=r"^connect: no device$"):
        check("map.toml", connect=True)
