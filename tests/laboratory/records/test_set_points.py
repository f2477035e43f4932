"""Set points as channels: in every file of a run by quantity and unit, and what the catalogue makes of them."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pytest import approx
from tests.laboratory.simulated_rig import SimulatedRig

from sonolube.errors import InvalidInput
from sonolube.facts.protocol import protocol_from, protocol_text
from sonolube.laboratory import Block, Devices, DriveSetting, run_protocol
from sonolube.laboratory.catalogue import catalogued_runs, index as catalogue_index, query_from, query_runs
from sonolube.laboratory.records import drop_raw_blocks, export_run, new_run, read_run, recover_run
from sonolube.measurement.recordings.reader import read_recording

SPEEDS = (0.02, 0.04, 0.06)
PROTOCOL = protocol_from(
    {
        "title": "Three speeds",
        "source": "test",
        "limits": {"voltage_maximum": "60 V", "duration_maximum": "1 h"},
        "metadata": {"normal_load": "3 N", "groove_diameter": "50 mm"},
        "steps": [
            {
                "kind": "repeat",
                "over": {"load": ["3 N", "6 N"]},
                "steps": [
                    {"kind": "prompt", "task": "load", "text": "Hang {load}.", "normal_load": "{load}"},
                    {"kind": "acquire", "channels": ["friction_force"], "sample_rate": "100 Hz", "duration": "19 s"},
                    {"kind": "wait", "duration": "1 s"},
                    {
                        "kind": "repeat",
                        "over": {"speed": ["20 mm/s", "40 mm/s", "60 mm/s"]},
                        "steps": [
                            {"kind": "motor_speed", "sliding_speed": "{speed}"},
                            {"kind": "drive", "voltage_peak_to_peak": "0 V"},
                            {"kind": "wait", "duration": "3 s"},
                            {"kind": "drive", "voltage_peak_to_peak": "50 V", "frequency": "22 kHz"},
                            {"kind": "wait", "duration": "3 s"},
                        ],
                    },
                    {"kind": "motor_speed", "sliding_speed": "0 mm/s"},
                    {"kind": "drive", "voltage_peak_to_peak": "0 V"},
                ],
            },
            {"kind": "prompt", "text": "Apply oil.", "lubricant": "oil"},
            {"kind": "acquire", "channels": ["friction_force"], "sample_rate": "100 Hz", "duration": "3 s"},
            {"kind": "motor_speed", "sliding_speed": "20 mm/s"},
            {"kind": "wait", "duration": "3 s"},
        ],
    }
)


class NoisyRig(SimulatedRig):
    """Simulated rig whose force has a little noise."""

    def read(self, samples: int) -> Block:
        block = super().read(samples)
        noise = 1e-3 * np.random.default_rng(self.total).standard_normal((samples, 1))
        return replace(block, values=block.values + noise)


class Drive(SimulatedRig):
    """Drive of a rig, whose `off` leaves the motor on."""

    def __init__(self, rig: SimulatedRig) -> None:
        super().__init__()
        self.rig = rig

    def drive(self, setting: DriveSetting) -> None:
        self.rig.setting = setting

    def off(self) -> None:
        self.rig.setting = None


def devices() -> Devices:
    """Devices of a noisy rig."""
    rig = NoisyRig()
    return replace(rig.devices(), drive=Drive(rig))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Run of two loads, three speeds and two voltages, then one with oil; the rig file has said 5 N."""
    facts = {"normal_load": 3.0, "groove_diameter": 0.05}
    recorder = new_run(tmp_path / "runs", title=PROTOCOL.title, protocol=protocol_text(PROTOCOL), facts=facts)
    result = run_protocol(PROTOCOL, devices(), recorder, operator=lambda prompt: True)
    assert result.outcome == "completed"
    return recorder.folder


def test_every_set_point_is_a_channel_of_every_file(folder: Path, tmp_path: Path) -> None:
    paths = [read_run(folder).recordings[1]]
    paths += [export_run(folder, file_format=name, out=tmp_path / name)[1] for name in ("netcdf", "tdms", "csv")]
    for path in paths:
        recording = read_recording(path)
        time = recording["time"].to_numpy()
        turned = [0.0] + [speed for speed in SPEEDS for _ in range(6)]  # a second each
        second = np.minimum((time + 1e-9).astype(int), 18)
        assert recording["sliding_speed_set"].to_numpy() == pytest.approx(np.array(turned)[second])
        assert np.array_equal(recording["motor_on"].to_numpy(), (np.array(turned)[second] > 0).astype(float))
        driven = np.array([0.0] + [0.0, 0.0, 0.0, 50.0, 50.0, 50.0] * 3)[second]
        assert np.array_equal(recording["voltage_peak_to_peak_set"].to_numpy(), driven)
        assert np.array_equal(recording["frequency_set"].to_numpy(), np.where(driven > 0, 22e3, 0.0))
        assert np.all(recording["normal_load_set"] == 6.0)
        assert np.all(recording["recording_part"] == 2)
        assert np.all(recording["lubricant_set"] == 0)
        units = [recording[name].attrs["units"] for name in ("sliding_speed_set", "normal_load_set", "frequency_set")]
        assert units == ["m/s", "N", "Hz"]
        assert recording["sliding_speed_set"].attrs["long_name"] == "Sliding speed, set"


def test_set_points_take_a_small_part_of_the_file(folder: Path) -> None:
    import h5netcdf

    with h5netcdf.File(read_run(folder).recordings[0], "r") as file:
        stored = {name: variable._h5ds.id.get_storage_size() for name, variable in file.variables.items()}
    assert sum(size for name, size in stored.items() if name.endswith(("_set", "_on", "_part"))) < stored["time"] / 10


def test_lubricants_have_numbers_and_names(folder: Path) -> None:
    import h5netcdf

    path = read_run(folder).recordings[2]
    assert np.all(read_recording(path)["lubricant_set"] == 1)
    with h5netcdf.File(path, "r") as file:
        assert json.loads(file.attrs["lubricants"]) == ["oil"]


def test_the_catalogue_has_a_row_for_each_load_speed_and_voltage(folder: Path) -> None:
    runs = catalogued_runs(f"catalogue:in={folder.parent}")
    found = {
        (float(load), round(float(speed), 4))
        for load, speed in zip(runs["normal_load"], runs["sliding_speed"], strict=True)
    }
    assert found == {(load, speed) for load in (3.0, 6.0) for speed in SPEEDS}
    assert np.allclose(runs["friction_reduction"], 0.6, atol=5e-3)  # 1 N falls to 0.4 N
    assert "part 3 of the recording left out: lubricated" in runs.attrs["caveats"]


@pytest.mark.parametrize(
    ("condition", "value", "finds"),
    [("speed", "20mm/s", 1), ("speed", "60mm/s", 1), ("speed", "50mm/s", 0), ("load", "6N", 1), ("load", "5N", 0)],
)
def test_a_run_is_found_by_each_of_its_loads_and_speeds(folder: Path, condition: str, value: str, finds: int) -> None:
    assert len(query_runs(folder.parent, query_from({condition: [value]})).entries) == finds


def test_a_changed_recording_is_said_so_on_reading(folder: Path) -> None:
    import h5netcdf

    assert not any("changed" in caveat for caveat in read_run(folder).caveats)
    path = read_run(folder).recordings[0]
    with h5netcdf.File(path, "r+") as file:
        file["friction_force"][5] = 7.0
    assert f"{path.name} was changed after the run wrote it" in read_run(folder).caveats
    assert "was changed after its run wrote it" in str(read_recording(path).attrs["caveats"])
    recover_run(folder)  # takes no change for the recording
    assert f"{path.name} was changed after the run wrote it" in read_run(folder).caveats


def test_raw_blocks_are_dropped_once_the_recording_holds_them(folder: Path, tmp_path: Path) -> None:
    before = [path.read_bytes() for path in export_run(folder, file_format="csv", out=tmp_path / "before")]
    assert len(drop_raw_blocks(folder)) == 3
    assert not list((folder / "raw").iterdir())
    assert [path.read_bytes() for path in export_run(folder, file_format="csv", out=tmp_path / "after")] == before
    run = read_run(folder)
    assert run.dataset(1).sizes["time"] == 1900
    assert [caveat for caveat in run.caveats if "missing" in caveat or "raw" in caveat] == []
    run.recordings[1].unlink()
    assert "recording-2.nc is missing" in read_run(folder).caveats


def test_raw_blocks_are_kept_where_the_recording_was_changed_or_is_missing(folder: Path) -> None:
    kept = sorted((folder / "raw").iterdir())
    path = read_run(folder).recordings[1]
    content = path.read_bytes()
    for damage in (content + b"x", None):
        path.unlink()
        if damage is not None:
            path.write_bytes(damage)
        with pytest.raises(InvalidInput, match=r"changed after the run wrote it|is missing"):
            drop_raw_blocks(folder)
        assert sorted((folder / "raw").iterdir()) == kept


def test_a_run_without_its_facts_is_mended(folder: Path) -> None:
    facts = json.loads((folder / "run.json").read_text())
    (folder / "run.json").unlink()
    assert "run.json written from the first document" in recover_run(folder).done
    mended = json.loads((folder / "run.json").read_text())
    assert {name: mended[name] for name in ("title", "facts", "files", "recordings")} == {
        name: facts[name] for name in ("title", "facts", "files", "recordings")
    }


@pytest.mark.parametrize("content", [b"", b"{", b"null", b"[]", b'{"title": 3}', b"\0\0\0", b"\xff\xfe", b"[" * 5000])
def test_damaged_facts_are_mended_also_of_a_folder_that_was_renamed(
    content: bytes, folder: Path, tmp_path: Path
) -> None:
    known = read_run(folder).summary
    renamed = tmp_path / "specimen 7"
    shutil.copytree(folder, renamed)
    (renamed / "run.json").write_bytes(content)
    with pytest.raises(InvalidInput, match=r"is damaged; `sonolube lab recover` writes it from the other files"):
        read_run(renamed)
    recover_run(renamed)
    found = read_run(renamed).summary
    assert (found.title, found.outcome) == (known.title, known.outcome)
    assert found.begun == approx(known.begun, abs=1e-3)


def test_a_run_that_was_killed_before_its_facts_were_written_is_mended(folder: Path) -> None:
    killed = folder.parent / "20260101T000000Z-killed"
    (killed / "raw").mkdir(parents=True)
    (killed / "protocol.toml").write_text(protocol_text(PROTOCOL))
    assert [run.summary.folder for run in query_runs(folder.parent).entries] == [folder]
    recovery = recover_run(killed)
    assert (recovery.summary.outcome, recovery.summary.title) == ("interrupted", "Three speeds")
    assert len(query_runs(folder.parent).entries) == 2
    assert recover_run(killed).done == ()


def test_a_folder_that_holds_no_run_is_not_made_one(tmp_path: Path) -> None:
    with pytest.raises(InvalidInput, match="holds no run"):
        recover_run(tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_runs_are_listed_without_an_index_where_it_cannot_be_written(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import sqlite3
    from collections.abc import Iterator
    from contextlib import contextmanager

    database = catalogue_index.database  # type: ignore[attr-defined]

    @contextmanager
    def full(path: Path | None) -> Iterator[sqlite3.Connection]:
        with database(path) as connection:
            if path is not None:
                connection.execute("PRAGMA max_page_count=1")  # as a full disk: "database or disk is full"
            yield connection

    monkeypatch.setattr(catalogue_index, "database", full)
    found = query_runs(folder.parent)
    assert [entry.summary.folder for entry in found.entries] == [folder]
    assert "listed without an index" in found.caveats[0]
