"""What an observer makes of notes and samples that are written by hand: time, set points, gaps, means and silence."""

import os
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from pytest import MonkeyPatch
from tests.laboratory.records.clock import Clock
from tests.laboratory.records.recorded import CHANNELS, RATE, begun, block_of
from tests.same import approx

from sonolube.facts.protocol import protocol_from, protocol_text
from sonolube.laboratory import Block, Channel
from sonolube.laboratory.records import Observation, RunObserver, RunRecorder, new_run

STEPS: list[Mapping[str, object]] = [
    {"kind": "acquire", "channels": ["friction_force"], "sample_rate": "1 kHz", "duration": "5 s"},
    {"kind": "motor_speed", "sliding_speed": "50 mm/s"},
    {"kind": "wait", "duration": "2 s"},
    {"kind": "motor_speed", "rotation_speed": "3 1/s"},
    {"kind": "wait", "duration": "2 s"},
    {"kind": "drive", "voltage_peak_to_peak": "9 V", "frequency": "22 kHz"},
    {"kind": "wait", "duration": "4 s"},
]
LIMITS = {"voltage_maximum": "30 V", "duration_maximum": "40 s"}
PROTOCOL = protocol_text(protocol_from({"title": "t", "source": "s", "limits": LIMITS, "steps": STEPS}))


def started(parent: Path) -> RunRecorder:
    recorder = new_run(parent, title="t", protocol=PROTOCOL)
    recorder.note("prepared", protocol_time=0.0, reason="", state="running")
    return recorder


def look(recorder: RunRecorder) -> Observation:
    return RunObserver(recorder.folder).look()


def test_a_run_that_has_written_nothing_prepares_and_the_whole_time_is_left(tmp_path: Path) -> None:
    recorder = new_run(tmp_path, title="t", protocol=PROTOCOL)
    seen = look(recorder)
    assert (seen.outcome, seen.state, seen.reason, seen.step, seen.step_kind) == ("running", "preparing", "", "", "")
    assert (seen.protocol_time, seen.duration, seen.time_left) == (0.0, 8.0, 8.0)
    assert (seen.set_points, seen.means, seen.trips, seen.gaps, seen.is_running) == ({}, {}, (), 0, True)
    recorder.finish("completed")
    ended = look(recorder)
    assert (ended.outcome, ended.is_running, ended.step_kind) == ("completed", False, "")
    bare = new_run(tmp_path, title="t", protocol="x = ")
    assert (look(bare).duration, look(bare).time_left) == (None, None)
    bare.finish("completed")


def test_set_points_are_those_noted_last_and_a_zero_takes_them_away(tmp_path: Path) -> None:
    recorder = started(tmp_path)
    recorder.note("motor", protocol_time=0.0, step="2", rotation_speed=0.3, sliding_speed=0.06)
    seen = look(recorder)
    # the protocol states 50 mm/s: that is what was meant
    assert seen.set_points == {"rotation_speed": 0.3, "sliding_speed": 0.05}
    recorder.note("drive", protocol_time=4.0, step="6", voltage_peak_to_peak=9.0, frequency=22e3)
    driven = look(recorder)
    assert driven.set_points == {
        "rotation_speed": 0.3,
        "sliding_speed": 0.06,  # it states turns by now
        "voltage_peak_to_peak": 9.0,
        "frequency": 22e3,
    }
    recorder.note("drive", protocol_time=5.0, voltage_peak_to_peak=0.0, frequency=float("nan"))
    assert look(recorder).set_points == {"rotation_speed": 0.3, "sliding_speed": 0.06}
    recorder.note("pause", protocol_time=5.0, reason="on request", state="paused")
    paused = look(recorder)
    assert (paused.set_points, paused.state, paused.reason) == ({}, "paused", "on request")
    assert paused.protocol_time == 5.0
    recorder.note("resume", protocol_time=5.0, reason="", state="running")
    assert (look(recorder).state, look(recorder).reason) == ("running", "")
    recorder.finish("completed")


def test_gaps_and_trips_are_counted_and_a_reason_stays_until_the_run_goes_on(tmp_path: Path) -> None:
    recorder = started(tmp_path)
    for kind in ("gap", "gap", "clock jump"):
        recorder.note(kind, missing=2)
    recorder.note("trip", protocol_time=1.0, reason="too hot", state="stopping")
    recorder.note("off", protocol_time=1.0, reason="", state="safe")
    seen = look(recorder)
    assert (seen.gaps, seen.trips, seen.state, seen.reason) == (2, ("too hot",), "safe", "too hot")
    recorder.finish("stopped", reason="a limit")
    assert look(recorder).reason == "a limit"


def test_the_sample_counter_tells_the_time_since_the_last_note_that_has_one(tmp_path: Path) -> None:
    recorder = started(tmp_path)
    recorder.begin(CHANNELS, sample_rate=RATE)
    recorder.note("acquire", sample=0, protocol_time=0.0, step="1")
    recorder.append(block_of(0, 1500))
    assert look(recorder).protocol_time == approx(1.5)
    recorder.note("drive", sample=1500, protocol_time=3.0, voltage_peak_to_peak=1.0, frequency=1e3)
    recorder.note("gap", sample=1500, missing=1)  # which tells no time
    assert look(recorder).protocol_time == approx(3.0)
    recorder.append(block_of(1500, 250))
    seen = look(recorder)
    assert (seen.protocol_time, seen.time_left) == (approx(3.25), approx(4.75))
    assert (seen.step, seen.step_kind) == ("5", "wait")
    recorder.finish("completed")


def test_the_step_is_that_of_the_protocol_at_the_time_up_to_its_end(tmp_path: Path) -> None:
    recorder = started(tmp_path)
    for time, step, kind in ((0.0, "3", "wait"), (2.0, "5", "wait"), (3.999, "5", "wait"), (4.0, "7", "wait")):
        recorder.note("check", protocol_time=time)
        with Clock.installed() as clock:
            clock.pass_by(-1e3)  # no time goes by
            seen = look(recorder)
        assert (seen.step, seen.step_kind) == (step, kind)
    recorder.note("check", protocol_time=8.0, step="7")
    assert (look(recorder).step, look(recorder).step_kind) == ("7", "")
    recorder.finish("completed")


def test_channels_that_give_no_number_have_no_mean_and_those_of_other_clocks_theirs(tmp_path: Path) -> None:
    recorder = begun(tmp_path)
    values = np.stack([np.full(10, np.nan), np.linspace(290.0, 299.0, 10)], axis=1)
    recorder.append(Block(first_sample=0, sample_rate=RATE, values=values))
    slow = [Channel(name="oil", quantity="temperature"), Channel(name="ae", quantity="emission", free_unit="V")]
    recorder.begin_beside("slow", slow, sample_rate=10.0, first=3, ago=0.2, uncertainty=0.1)
    beside = np.stack([np.arange(20.0), np.full(20, 2.0)], axis=1)
    recorder.append(Block(first_sample=3, sample_rate=10.0, values=beside), clock="slow")
    assert look(recorder).means == {
        "friction_force": (None, "N"),
        "temperature": (approx(294.5), "K"),
        "oil": (approx(14.5), "K"),  # of the last ten samples, 10 to 19
        "ae": (approx(2.0), "V"),
    }
    recorder.end(clock="slow")
    assert set(look(recorder).means) == {"friction_force", "temperature"}
    recorder.finish("completed")


def test_the_silence_is_the_time_since_the_newest_of_the_files_was_written(
    tmp_path: Path, monkeypatch: MonkeyPatch
) -> None:
    recorder = begun(tmp_path)
    recorder.append(block_of(0, 10))
    folder = recorder.folder
    now = 1.9e9
    with Clock.installed() as clock:
        monkeypatch.setattr(clock, "time", lambda: now)
        for newest in ("run.json", "documents.jsonl", "raw/blocks-1.bin"):
            for name in ("run.json", "documents.jsonl", "raw/blocks-1.bin"):
                age = 7.5 if name == newest else 60.0
                os.utime(folder / name, (now - age, now - age))
            assert RunObserver(folder).look().silence == approx(7.5)
        os.utime(folder / "run.json", (now + 5.0, now + 5.0))
        assert RunObserver(folder).look().silence == 0.0
    recorder.finish("completed")


def test_a_run_without_documents_begins_for_ten_seconds_and_is_unfinished_after_them(tmp_path: Path) -> None:
    recorder = begun(tmp_path)
    folder = recorder.folder
    recorder.finish("completed")
    (folder / "documents.jsonl").unlink()
    with Clock.installed() as clock:
        for later, outcome in ((0.0, "running"), (9.0, "running"), (2.0, "unfinished")):
            clock.pass_by(later)
            assert RunObserver(folder).look().outcome == outcome
