"""Observation: a run as it is now, from its folder alone, whatever is being written there."""

import threading
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from pytest import approx
from tests.laboratory.records.clock import Clock
from tests.laboratory.records.recorded import RATE, begun, block_of, contents, recorded, values_of
from tests.laboratory.records.test_recovery import unfinished
from tests.laboratory.simulated_rig import SimulatedRig

from sonolube.errors import InvalidInput
from sonolube.facts.protocol import Protocol, protocol_from, protocol_text
from sonolube.laboratory import RunControl, run_protocol
from sonolube.laboratory.records import (
    Observation,
    RunObserver,
    latest_samples,
    new_run,
    read_raw_blocks,
    read_run,
    recover_run,
    run_to_watch,
)
from sonolube.laboratory.virtual_tribometer import virtual_tribometer
from sonolube.rig import read_rig

RIG = Path(__file__).parents[3] / "examples" / "rigs" / "power_map.toml"
STEPS: list[Mapping[str, object]] = [
    {"kind": "acquire", "channels": ["friction_force", "temperature"], "sample_rate": "1 kHz", "duration": "4 s"},
    {"kind": "motor_speed", "sliding_speed": "50 mm/s"},
    {"kind": "wait", "duration": "1 s"},
    {"kind": "voltage_steps", "voltages": ["10 V", "20 V"], "step_duration": "1 s", "frequency": "22 kHz"},
    {"kind": "prompt", "task": "mounting", "text": "Turn the specimen."},
    {"kind": "wait", "duration": "2 s"},
]


def protocol(*steps: Mapping[str, object], **limits: str) -> Protocol:
    bounds = {"voltage_maximum": "30 V", "duration_maximum": "40 s"} | limits
    return protocol_from({"title": "watched", "source": "none", "limits": bounds, "steps": list(steps or STEPS)})


def looks(test: Protocol, parent: Path, rig: SimulatedRig) -> list[tuple[int, str, Observation]]:
    """Time in ms and doing that the runner tells, and what is observed at that moment, block by block."""
    with Clock.installed() as clock:
        recorder = new_run(parent, title="watched", protocol=protocol_text(test))
        observer, told = RunObserver(recorder.folder), list[tuple[int, str, Observation]]()

        def look(doing: str, done: int, whole: int) -> None:
            clock.pass_by(0.01)
            told.append((done, doing, observer.look()))

        run_protocol(test, rig.devices(), recorder, operator=lambda prompt: True, advance=look)
        told.append((0, "", observer.look()))
    return told


def test_time_and_step_are_those_that_the_runner_tells_at_every_block(tmp_path: Path) -> None:
    *running, (_, _, last) = looks(protocol(), tmp_path, SimulatedRig())
    for done, doing, seen in running:
        assert (seen.outcome, seen.state) == ("running", "running")
        if done < 4000:
            assert seen.protocol_time == approx(1e-3 * done, abs=1e-3)
        else:  # nothing is recorded any more: by the clock on the wall
            assert 4.0 <= seen.protocol_time <= 5.0
        assert seen.time_left == approx(5.0 - seen.protocol_time)
        at_a_set_point = any(abs(1e-3 * done - edge) < 1e-6 for edge in (1.0, 2.0, 3.0, 4.0))
        assert at_a_set_point or doing.startswith(f"step {seen.step}, {seen.step_kind.replace('_', ' ')}")
    assert (last.outcome, last.state, last.step, last.set_points) == ("completed", "safe", "5", {})


def test_means_are_those_of_the_last_second_and_set_points_those_in_force(tmp_path: Path) -> None:
    by_time = {done: seen for done, _, seen in looks(protocol(), tmp_path, SimulatedRig())}
    means = by_time[950].means
    assert {name: unit for name, (_, unit) in means.items()} == {"friction_force": "N", "temperature": "K"}
    assert [value for value, _ in means.values()] == approx([1.0, 293.0])
    assert by_time[950].set_points["sliding_speed"] == approx(0.05)
    assert "voltage_peak_to_peak" not in by_time[950].set_points
    assert by_time[1500].means["friction_force"][0] == approx(0.7)  # half a second at 1 N, half at 0.4 N
    assert by_time[2500].set_points["voltage_peak_to_peak"] == 20.0
    assert by_time[2500].set_points["frequency"] == 22e3
    assert by_time[3500].means["friction_force"][0] == approx(0.4)  # of the second part alone
    assert by_time[4950].means == {}  # the recording has ended, the run has not


def test_a_trip_is_told_with_its_reason_and_the_outcome(tmp_path: Path) -> None:
    *_, (_, _, last) = looks(protocol(friction_force_maximum="0.9 N"), tmp_path, SimulatedRig())
    assert last.trips == ("channel friction_force is 1 N; its limit is 900 mN",)
    assert (last.outcome, last.reason) == ("stopped", last.trips[0])


def test_a_pause_for_the_operator_is_told_with_what_is_asked_and_everything_off(tmp_path: Path) -> None:
    test = protocol()
    recorder = new_run(tmp_path, title="watched", protocol=protocol_text(test))
    observer, told = RunObserver(recorder.folder), list[Observation]()

    def confirm(prompt: object) -> bool:
        told.append(observer.look())
        return True

    run_protocol(test, SimulatedRig().devices(), recorder, operator=confirm)
    (seen,) = told
    assert (seen.state, seen.reason, seen.set_points, seen.means) == ("paused", "mounting: Turn the specimen.", {}, {})
    assert seen.protocol_time == approx(3.0)


def test_without_a_recording_the_clock_on_the_wall_tells_the_time_up_to_the_next_set_point(tmp_path: Path) -> None:
    steps = [{"kind": "wait", "duration": "0.3 s"}, {"kind": "motor_speed", "sliding_speed": "50 mm/s"}]
    with Clock.installed() as clock:
        recorder = new_run(tmp_path, title="waits", protocol=protocol_text(protocol(*steps)))
        recorder.note("prepared", sample=None, protocol_time=0.0, reason="", state="running")
        observer = RunObserver(recorder.folder)
        times = []
        for _ in range(4):
            times.append(observer.look().protocol_time)
            clock.pass_by(0.125)
        recorder.finish("completed")
    assert times == approx([0.0, 0.125, 0.25, 0.3], abs=1e-6)


def test_the_last_second_is_that_of_the_whole_file_wherever_reading_begins(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = recorded(tmp_path, sizes=(50, 70, 30) * 20)
    path = folder / "raw" / "blocks-1.bin"
    for reach in (3000, 20_000, 1 << 26):
        monkeypatch.setattr("sonolube.laboratory.records.raw_blocks._MAX_READ", reach)
        part, latest = latest_samples(path, duration=1.0)
        assert latest is not None
        assert part.sample_rate == RATE
        assert latest.next_sample == 3000
        assert np.array_equal(latest.values, values_of(latest.first_sample, latest.samples))
        assert latest.samples == min(1000, latest.next_sample - latest.first_sample)
    assert latest is not None
    assert latest.samples == 1000


def test_a_block_in_flight_is_left_out_at_every_length(tmp_path: Path) -> None:
    folder = recorded(tmp_path, sizes=(20, 20))
    path = folder / "raw" / "blocks-1.bin"
    whole = path.read_bytes()
    record = 32 + 20 * 2 * 8
    for length in range(len(whole) - record, len(whole)):
        path.write_bytes(whole[:length])
        _, latest = latest_samples(path, duration=1.0)
        assert latest is not None
        assert latest.next_sample == 20
    path.write_bytes(whole[: len(whole) - 2 * record])
    assert latest_samples(path, duration=1.0)[1] is None
    path.write_bytes(whole[:10])
    with pytest.raises(InvalidInput, match="header is damaged"):
        latest_samples(path, duration=1.0)


def test_every_state_of_a_folder_on_the_way_is_observed(tmp_path: Path) -> None:
    folder = unfinished(tmp_path)
    for name in ("documents.jsonl", "raw/blocks-1.bin"):
        path = folder / name
        whole = path.read_bytes()
        for length in range(0, len(whole), 7):
            path.write_bytes(whole[:length])
            assert RunObserver(folder).look().known.title == "Map test"
        path.write_bytes(whole)


def test_a_document_in_flight_is_read_at_the_next_look(tmp_path: Path) -> None:
    recorder = begun(tmp_path)
    observer = RunObserver(recorder.folder)
    observer.look()
    recorder.note("trip", sample=3, reason="too hot", state="stopping", protocol_time=1.0)
    path = recorder.folder / "documents.jsonl"
    whole = path.read_bytes()
    path.write_bytes(whole[:-20])
    assert observer.look().trips == ()
    path.write_bytes(whole)
    assert observer.look().trips == ("too hot",)
    assert observer.look().trips == ("too hot",)
    recorder.finish("stopped")


def test_a_dead_writer_is_told_and_a_recovered_run_is_interrupted(tmp_path: Path) -> None:
    folder = unfinished(tmp_path)
    observer = RunObserver(folder)
    assert observer.look().outcome == "unfinished"
    recover_run(folder)
    assert observer.look().outcome == "interrupted"


def test_the_newest_run_at_work_is_watched_else_the_newest(tmp_path: Path) -> None:
    folders = [recorded(tmp_path)]
    recorder = begun(tmp_path)
    folders += [recorder.folder, recorded(tmp_path)]
    names = [folder.rename(tmp_path / f"2026112{number}T000000Z-run") for number, folder in enumerate(folders)]
    assert run_to_watch(tmp_path) == names[1]
    assert run_to_watch(names[0]) == names[0]
    recorder.folder = names[1]
    recorder.finish("completed")
    unfinished(tmp_path).rename(tmp_path / "20261123T000000Z-run")
    assert run_to_watch(tmp_path).name == "20261123T000000Z-run"
    with pytest.raises(InvalidInput, match="holds no run; name a run, or a folder of runs"):
        run_to_watch(names[0] / "raw")


def recorded_virtually(parent: Path, *, is_watched: bool) -> Path:
    """Folder of a virtual run that threads observe without rest, or of the same run that nobody observes."""
    test = protocol(STEPS[0], *STEPS[1:4])
    recorder = new_run(parent, title="watched", protocol=protocol_text(test), facts={"rig": parent.name})
    ended, has_means = threading.Event(), threading.Event()

    def watch() -> None:
        observer = RunObserver(recorder.folder)
        while not ended.is_set():
            if observer.look().means:
                has_means.set()

    def hold(doing: str, done: int, whole: int) -> None:
        assert not is_watched or done < 2000 or has_means.wait(60.0)

    threads = [threading.Thread(target=watch) for _ in range(2 if is_watched else 0)]
    for thread in threads:
        thread.start()
    devices = virtual_tribometer(read_rig(RIG), seed=3).devices
    result = run_protocol(test, devices, recorder, operator=lambda prompt: True, control=RunControl(), advance=hold)
    ended.set()
    for thread in threads:
        thread.join()
    assert result.outcome == "completed"
    return recorder.folder


def test_a_watched_run_is_the_one_that_nobody_watches_byte_by_byte(tmp_path: Path) -> None:
    watched, alone = (recorded_virtually(tmp_path / str(each), is_watched=each) for each in (True, False))
    raw = [list(read_raw_blocks(folder / "raw" / "blocks-1.bin")) for folder in (watched, alone)]
    assert [block.values.tobytes() for block in raw[0]] == [block.values.tobytes() for block in raw[1]]
    assert sum(block.samples for block in raw[0]) == 4000
    files = [contents(folder) for folder in (watched, alone)]
    assert files[0].keys() == files[1].keys()
    notes = [[(note.kind, note.sample, note.facts) for note in read_run(folder).notes] for folder in (watched, alone)]
    assert notes[0] == notes[1]
    assert read_run(watched).caveats == ()


def test_looking_changes_no_file(tmp_path: Path) -> None:
    recorder = begun(tmp_path)
    recorder.append(block_of(0, 50))
    folder = recorder.folder
    before = {path: (path.stat().st_mtime_ns, path.stat().st_size) for path in folder.rglob("*")}
    RunObserver(folder).look()
    run_to_watch(tmp_path)
    assert {path: (path.stat().st_mtime_ns, path.stat().st_size) for path in folder.rglob("*")} == before
    recorder.finish("completed")
