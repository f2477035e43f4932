"""Recorder: folders, blocks, notes, gaps, full disks, locks and clocks; documents by the schemas of the event model."""

import hashlib
import json
import time
from collections.abc import Callable
from contextlib import AbstractContextManager
from pathlib import Path

import event_model
import numpy as np
import pytest
import xarray as xr
from pytest import MonkeyPatch, approx, raises
from tests.laboratory.records.clock import Clock
from tests.laboratory.records.recorded import CHANNELS, RATE, begun, block_of, documents, recorded, values_of

from sonolube.errors import InvalidInput
from sonolube.laboratory.block import Block
from sonolube.laboratory.records import RunRecorder, new_run, read_run, recover_run, run_folders, run_summary
from sonolube.laboratory.records.documents import DocumentLog
from sonolube.laboratory.records.raw_blocks import RawPart, read_raw_blocks
from sonolube.laboratory.records.recovery import OpenPart
from sonolube.laboratory.records.run_folder import RunFacts, raw_path

LargestFile = Callable[[int], AbstractContextManager[None]]


def judge(folder: Path) -> dict[str, int]:
    """Hold all documents to the schemas and to the order of the event model, and count them by name."""
    counts: dict[str, int] = {}
    router = event_model.RunRouter([lambda name, document: ([], [])])
    for name, document in documents(folder):
        event_model.schema_validators[event_model.DocumentNames[name]].validate(document)
        router(name, document)
        counts[name] = counts.get(name, 0) + 1
    return counts


def append_until_refused(recorder: RunRecorder) -> int:
    """Append blocks of 20 samples until the disk is full, and return how many samples were kept."""
    for kept in range(0, 1000, 20):
        try:
            recorder.append(block_of(kept, 20))
        except InvalidInput as refusal:
            text = str(refusal)
            break
    assert text.endswith("blocks-1.bin: cannot be written: File too large")
    return kept


def test_a_run_keeps_what_it_was_given_and_what_was_recorded(tmp_path: Path) -> None:
    folder = recorded(tmp_path, normal_load=np.float64(5.0), operator="D")
    run = read_run(folder)
    assert run.caveats == ()
    assert run.protocol == 'title = "test"\n'
    assert dict(run.facts) == {"normal_load": 5.0, "operator": "D"}
    assert run.known.files["rig.toml"] == hashlib.sha256(b"a = 1\n").hexdigest()
    assert set(run.known.versions) == {"sonolube", "python", "numpy"}
    dataset = run.dataset()
    assert np.array_equal(dataset["friction_force"], values_of(0, 150)[:, 0])
    assert np.array_equal(dataset["temperature"], values_of(0, 150)[:, 1])
    assert np.allclose(dataset["time"], np.arange(150) / RATE, rtol=0, atol=1e-12)
    assert dataset["friction_force"].attrs["units"] == "N"


def test_a_file_changed_after_the_run_is_told(tmp_path: Path) -> None:
    folder = recorded(tmp_path)
    (folder / "rig.toml").write_text("a = 2\n")
    assert read_run(folder).caveats == ("rig.toml is missing or was changed since the run began",)


def test_a_second_run_of_the_same_second_has_a_folder_of_its_own(tmp_path: Path, monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setattr(time, "time", lambda: 1795398130.0)
    names = [recorded(tmp_path).name for _ in range(3)]
    assert names == [f"20261123T014210Z-map-test{end}" for end in ("", "-2", "-3")]
    assert [run_summary(folder).outcome for folder in run_folders(tmp_path)] == ["completed"] * 3


def test_documents_are_those_of_the_event_model(tmp_path: Path) -> None:
    recorder = begun(tmp_path, **{"device.serial": "12/3"})
    recorder.note("drive", sample=0, voltage_peak_to_peak=5.0, frequency=22e3)
    recorder.append(block_of(0, 10))
    recorder.end()
    recorder.begin(CHANNELS[:1], sample_rate=10.0)
    recorder.append(Block(first_sample=0, sample_rate=10.0, values=values_of(0, 4)[:, :1]))
    recorder.note("trip", reason="friction_force 9 N", value=np.float64(9.0))
    folder = recorder.finish("stopped", reason="a limit").folder
    counts = judge(folder)
    assert counts == {"start": 1, "descriptor": 3, "event": 2, "stream_resource": 3, "stream_datum": 3, "stop": 1}
    stop = documents(folder)[-1][1]
    assert (stop["exit_status"], stop["reason"]) == ("abort", "a limit")
    assert stop["num_events"] == {"notes": 2, "recording-1": 10, "recording-2": 4}


def test_notes_come_back_with_sample_and_facts(tmp_path: Path) -> None:
    recorder = begun(tmp_path)
    recorder.append(block_of(0, 10))
    recorder.note("motor", sample=10, rotation_speed=1.5, state="running")
    (note,) = read_run(recorder.finish("completed").folder).notes
    assert (note.kind, note.sample, note.facts) == ("motor", 10, {"rotation_speed": 1.5, "state": "running"})


def test_parts_of_a_recording_are_files_that_join_on_one_axis(tmp_path: Path) -> None:
    with Clock.installed() as clock:
        recorder = begun(tmp_path)
        recorder.append(block_of(0, 100))
        recorder.end()
        clock.pass_by(0.15)
        recorder.begin(CHANNELS, sample_rate=RATE)
        recorder.append(block_of(0, 40))
        run = read_run(recorder.finish("completed").folder)
    assert [path.name for path in run.recordings] == ["recording.nc", "recording-2.nc"]
    assert run.dataset(2).sizes["time"] == 40
    joined = run.dataset()
    assert float(joined["time"][-1]) > 0.15 + 0.038
    with pytest.raises(InvalidInput, match="1 to 2"):
        run.dataset(3)


def test_missing_samples_are_an_event_a_caveat_and_a_gap_in_time(tmp_path: Path) -> None:
    recorder = begun(tmp_path)
    recorder.append(block_of(0, 10))
    recorder.append(block_of(17, 5))
    run = read_run(recorder.finish("completed").folder)
    assert [(note.kind, note.sample, note.facts) for note in run.notes] == [("gap", 10, {"missing": 7})]
    dataset = run.dataset()
    assert dataset.attrs["dropped_samples"] == 7
    assert "7 samples are missing in a gap, the first at 0.01 s" in dataset.attrs["caveats"]
    assert np.array_equal(dataset["friction_force"], np.r_[values_of(0, 10)[:, 0], values_of(17, 5)[:, 0]])
    assert run.summary.gaps == 1


@pytest.mark.parametrize(
    ("block", "reason"),
    [
        (block_of(5, 10), "10 was expected"),
        (Block(first_sample=10, sample_rate=RATE, values=np.zeros((4, 3))), "2 channels"),
        (Block(first_sample=10, sample_rate=RATE, values=np.zeros((0, 2))), "2 channels"),
    ],
)
def test_a_block_that_does_not_fit_is_refused_and_the_rest_kept(tmp_path: Path, block: Block, reason: str) -> None:
    recorder = begun(tmp_path)
    recorder.append(block_of(0, 10))
    with pytest.raises(InvalidInput, match=reason):
        recorder.append(block)
    recorder.append(block_of(10, 2))
    assert read_run(recorder.finish("completed").folder).dataset().sizes["time"] == 12


def test_the_drive_voltage_that_was_set_is_a_variable_of_the_recording(tmp_path: Path) -> None:
    recorder = begun(tmp_path)
    recorder.note("drive", sample=0, voltage_peak_to_peak=0.0)
    recorder.append(block_of(0, 10))
    recorder.note("drive", sample=10, voltage_peak_to_peak=8.0)
    recorder.append(block_of(10, 10))
    recorder.end()
    recorder.note("pause")
    recorder.note("drive", sample=0, voltage_peak_to_peak=3.0)
    recorder.begin(CHANNELS, sample_rate=RATE)
    recorder.append(block_of(0, 5))
    run = read_run(recorder.finish("completed").folder)
    assert np.array_equal(run.dataset(1)["voltage_peak_to_peak"], [0.0] * 10 + [8.0] * 10)
    assert np.array_equal(run.dataset(2)["voltage_peak_to_peak"], [3.0] * 5)


def test_a_full_disk_ends_the_run_as_failed_with_all_that_was_kept_readable(
    tmp_path: Path, largest_file: LargestFile
) -> None:
    recorder = begun(tmp_path)
    path = recorder.folder / "raw" / "blocks-1.bin"
    with largest_file(5000):
        kept = append_until_refused(recorder)
        size = path.stat().st_size
        recorder.note("stop", reason="disk full")
        summary = recorder.finish("completed")
    assert (summary.outcome, summary.samples) == ("failed", kept)
    assert "File too large" in summary.reason
    assert path.stat().st_size == size < 5000
    assert judge(recorder.folder)["stop"] == 1
    assert not (recorder.folder / "recording.nc").exists()
    recovery = recover_run(recorder.folder)
    assert recovery.done == ("recording.nc written",)
    assert np.array_equal(read_run(recorder.folder).dataset()["friction_force"], values_of(0, kept)[:, 0])


def test_a_run_whose_last_document_does_not_fit_is_let_go_and_can_be_recovered(
    tmp_path: Path, largest_file: LargestFile
) -> None:
    recorder = begun(tmp_path, rig="tribometer")
    recorder.append(block_of(0, 20))
    with largest_file((recorder.folder / "documents.jsonl").stat().st_size + 100):
        assert recorder.finish("completed").outcome == "unfinished"
    assert recover_run(recorder.folder).summary.outcome == "interrupted"
    assert read_run(recorder.folder).dataset().sizes["time"] == 20
    recorded(tmp_path, rig="tribometer")


def test_times_do_not_follow_a_clock_that_jumps_and_the_jump_is_noted(tmp_path: Path) -> None:
    with Clock.installed() as clock:
        recorder = begun(tmp_path)
        recorder.append(block_of(0, 10))
        for offset in (-3600.0, 3600.0):
            clock.pass_by(0.01)
            clock.offset = offset
            recorder.append(block_of(10 if offset < 0 else 20, 10))
        run = read_run(recorder.finish("completed").folder)
    assert [note.facts["seconds"] for note in run.notes] == approx([-3600, 7200], abs=1e-5)
    assert [note.time - run.summary.begun for note in run.notes] == approx([0.01, 0.02], abs=1e-5)
    assert np.allclose(np.diff(run.dataset()["time"]), 1 / RATE)
    assert run.caveats == ("the clock of the computer was set 2 times during the run; times are by sample counters",)


def test_a_process_that_is_held_up_between_two_clocks_notes_no_jump(tmp_path: Path) -> None:
    with Clock.installed() as clock:
        clock.delay = 3.0
        recorder = begun(tmp_path)
        for first in (0, 10, 20):
            recorder.append(block_of(first, 10))
            clock.delay = 3.0
        run = read_run(recorder.finish("completed").folder)
    assert run.notes == ()
    assert run.caveats == ()


def test_finish_is_once_and_nothing_follows_it(tmp_path: Path) -> None:
    recorder = begun(tmp_path)
    recorder.append(block_of(0, 10))
    summary = recorder.finish("completed")
    before = (recorder.folder / "documents.jsonl").read_bytes()
    assert recorder.finish("failed") is summary
    assert (recorder.folder / "documents.jsonl").read_bytes() == before
    with pytest.raises(InvalidInput, match="has ended"):
        recorder.note("late")
    with pytest.raises(InvalidInput, match="has ended"):
        recorder.begin(CHANNELS, sample_rate=RATE)


def test_blocks_outside_a_part_and_unknown_outcomes_are_refused(tmp_path: Path) -> None:
    recorder = begun(tmp_path)
    with pytest.raises(InvalidInput, match="begun already"):
        recorder.begin(CHANNELS, sample_rate=RATE)
    recorder.end()
    recorder.end()
    with pytest.raises(InvalidInput, match="begin it"):
        recorder.append(block_of(0, 1))
    with pytest.raises(InvalidInput, match="outcome must be one of"):
        recorder.finish("perfect")
    assert recorder.finish("completed").samples == 0


@pytest.mark.parametrize("name", ["../rig.toml", "run.json", "documents.jsonl", "recording.nc", "", "a/b.toml"])
def test_files_of_a_run_stay_in_its_folder(tmp_path: Path, name: str) -> None:
    with pytest.raises(InvalidInput, match="plain name"):
        new_run(tmp_path, title="x", protocol="", files={name: "x"})
    assert list(tmp_path.iterdir()) == []


def test_facts_are_plain_values(tmp_path: Path) -> None:
    with pytest.raises(InvalidInput, match="fact 'load' must be a text"):
        new_run(tmp_path, title="x", protocol="", facts={"load": [1.0]})  # type: ignore[dict-item]


def test_truth_lies_where_measure_does_not_read(tmp_path: Path) -> None:
    recorder = begun(tmp_path)
    path = recorder.store_truth(xr.Dataset({"friction_coefficient": ("time", [0.2])}))
    recorder.finish("completed")
    assert path.parent.parent == recorder.folder
    assert path.name == "truth.nc"


def test_a_block_is_in_the_file_when_append_returns(tmp_path: Path) -> None:
    recorder = begun(tmp_path)
    path = recorder.folder / "raw" / "blocks-1.bin"
    for number in range(3):
        before = path.stat().st_size
        recorder.append(block_of(10 * number, 10))
        assert path.stat().st_size == before + 32 + 8 * 2 * 10
    recorder.finish("completed")


def test_damaged_facts_of_one_run_leave_the_others_listed(tmp_path: Path) -> None:
    folder = recorded(tmp_path)
    recorded(tmp_path, sizes=(5,))
    (folder / "run.json").write_text(json.dumps([1]))
    assert sorted(run_summary(folder).outcome for folder in run_folders(tmp_path)) == ["completed", "failed"]
    with pytest.raises(InvalidInput, match="is damaged"):
        read_run(folder)


def test_a_run_has_room_for_its_last_documents_until_it_is_finished(tmp_path: Path) -> None:
    recorder = begun(tmp_path)
    reserve = recorder.folder / ".reserve"
    assert reserve.stat().st_size == 64 * 1024
    recorder.append(block_of(0, 50))
    assert reserve.exists()
    recorder.finish("completed")
    assert not reserve.exists()


def test_blocks_of_a_part_are_counted_with_their_samples(tmp_path: Path) -> None:
    log = DocumentLog(tmp_path)
    log.start(RunFacts(title="", begun=1.8e9, facts={}, versions={}, files={}))
    raw_path(tmp_path, 1).parent.mkdir()
    part = OpenPart(tmp_path, 1, RawPart(channels=CHANNELS, sample_rate=RATE, begun=1.8e9), log)
    gaps: list[tuple[int, object]] = []
    for first, size in ((0, 3), (3, 1), (6, 2)):
        part.append(block_of(first, size), lambda sample, known: gaps.append((sample, known)))
    part.close()
    part.close()
    assert (part.part.blocks, part.part.samples) == (3, 6)
    assert gaps == [(4, {"missing": 2})]
    assert [block.first_sample for block in read_raw_blocks(raw_path(tmp_path, 1))] == [0, 3, 6]
    with raises(InvalidInput, match="block begins at sample 5, but 8 was expected"):
        part.require_fitting(block_of(5, 1))
    part.require_fitting(block_of(8, 1))
