"""Acquisitions with clocks of their own: recorded each on its own time base, and each ends a run with outputs off."""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from threading import Event

import numpy as np
import pytest
import xarray as xr
from pytest import MonkeyPatch, approx, raises
from tests.laboratory.simulated_rig import MemoryRecord, SimulatedRig

from sonolube.errors import InvalidInput, UnknownName
from sonolube.facts.protocol import Prompt, Protocol, protocol_from
from sonolube.laboratory import (
    Block,
    Channel,
    DeviceError,
    DeviceLost,
    Devices,
    RunControl,
    RunState,
    State,
    impossibilities,
    own_clocks,
    run_protocol,
    supervision,
)
from sonolube.laboratory.interlocks import recorded_channels
from sonolube.laboratory.records import RunObserver, drop_raw_blocks, export_run, new_run, read_run, recover_run
from sonolube.laboratory.run_plan import planned_run
from sonolube.measurement import read_recording
from sonolube.measurement.measured_files import selected_files

RATE, SLOW = 400.0, 50.0  # Hz, of the run and of the other clock


class PacedRig(SimulatedRig):
    """Rig whose samples take their time, so that other clocks run beside it."""

    began = 0.0

    def start(self, channels: Sequence[str], *, sample_rate: float) -> float:
        self.began = self.began or time.monotonic()  # of the run; it starts anew to see its outputs off
        return super().start(channels, sample_rate=sample_rate)

    def read(self, samples: int) -> Block:
        time.sleep(samples / self.rate)
        return super().read(samples)


@dataclass
class Inputs:
    """Acquisition with a clock of its own, whose values are the times of its samples; it can fail, jump or hang."""

    channels: Mapping[str, Channel]
    name: str = "slow inputs"
    rate: float = SLOW
    at: float = float("inf")  # s since the start, from when on something happens
    happens: Callable[[], None] = lambda: None
    value_then: float | None = None
    skips: bool = False
    calls: list[str] = field(default_factory=list)
    is_missing: bool = False
    taken: int = 0
    began: float = 0.0
    names: tuple[str, ...] = ()

    def connect(self) -> None:
        self.calls.append("connect")
        if self.is_missing:
            raise DeviceLost("slow inputs: does not answer")

    def start(self, channels: Sequence[str], *, sample_rate: float) -> float:
        assert sample_rate == next(iter(self.channels.values())).sample_rate
        self.names, self.taken, self.began = tuple(channels), 0, time.monotonic()
        return self.rate

    def read(self, samples: int) -> Block:
        first, self.taken = self.taken, self.taken + samples
        time.sleep(max(self.began + self.taken / self.rate - time.monotonic(), 0.0))
        elapsed = self.taken / self.rate
        times = (first + np.arange(samples)) / self.rate
        values = np.tile(times[:, None], (1, len(self.names)))
        if elapsed > self.at:
            self.happens()
            if self.value_then is not None:
                values[:] = self.value_then
            first += self.skips
        return Block(first_sample=first, sample_rate=self.rate, values=values)

    def stop(self) -> None:
        self.calls.append("stop")

    def close(self) -> None:
        self.calls.append("close")


def temperature(limit: float = 60.0) -> Channel:
    return Channel(name="pin_temperature", quantity="temperature", limit=limit, sample_rate=SLOW)


def inputs(**settings: object) -> Inputs:
    emission = Channel(name="emission", quantity="acoustic_emission", free_unit="V", sample_rate=SLOW)
    return Inputs({"pin_temperature": temperature(), "emission": emission}, **settings)  # type: ignore[arg-type]


def devices(rig: SimulatedRig, slow: Inputs) -> Devices:
    return replace(rig.devices(), simulated=False, further={"slow": slow})


def protocol(
    *more: dict[str, str], channels: Sequence[str] = ("friction_force", "pin_temperature", "emission")
) -> Protocol:
    return protocol_from(
        {
            "title": "Two clocks",
            "source": "test",
            "limits": {"voltage_maximum": "60 V", "duration_maximum": "1 min"},
            "steps": [
                {"kind": "motor_speed", "rotation_speed": "1 Hz"},
                {"kind": "drive", "voltage_peak_to_peak": "10 V", "frequency": "22 kHz"},
                {"kind": "acquire", "channels": list(channels), "sample_rate": "400 Hz", "duration": "0.6 s"},
                {"kind": "wait", "duration": "0.3 s"},
                *more,
                {"kind": "drive", "voltage_peak_to_peak": "20 V", "frequency": "22 kHz"},
                {"kind": "wait", "duration": "0.3 s"},
            ],
        }
    )


@pytest.fixture(autouse=True)
def prompt_supervisor(monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setattr(supervision, "LATE", 5.0)


@pytest.fixture
def release() -> Iterator[Event]:
    event = Event()
    yield event
    event.set()


def run(slow: Inputs, read: Protocol | None = None, rig: SimulatedRig | None = None) -> tuple[RunState, SimulatedRig]:
    rig, record = rig or PacedRig(), MemoryRecord()
    result = run_protocol(read or protocol(), devices(rig, slow), record, operator=lambda _: True)
    assert (record.outcome, record.reason) == (result.outcome, result.reason)
    assert not record.open_beside
    return result, rig


def recorded(folder: Path, slow: Inputs, read: Protocol | None = None) -> Path:
    recorder = new_run(folder, title="Two clocks", protocol="")
    result = run_protocol(read or protocol(), devices(PacedRig(), slow), recorder, operator=lambda _: True)
    assert (result.state, result.outcome, result.reason) == (State.SAFE, "completed", "")
    return recorder.folder


def test_each_clock_is_recorded_on_its_own_time_base_with_the_offset_and_its_uncertainty(tmp_path: Path) -> None:
    slow = inputs()
    found = read_run(recorded(tmp_path, slow))
    main, beside = found.dataset(), found.dataset(clock="slow")
    assert slow.calls == ["connect", "stop", "close"]
    assert [float(1 / np.diff(each["time"]).mean()) for each in (main, beside)] == approx([RATE, SLOW])
    assert main.sizes["time"] == 240
    assert beside.sizes["time"] > 5
    # the value of a sample is its time by its own clock
    assert np.diff(beside["pin_temperature"]) == approx(1 / SLOW)
    assert set(found.clocks) == {"slow"}
    assert found.summary.channels == ("friction_force", "pin_temperature", "emission")
    assert found.summary.samples == 240
    assert found.summary.duration == approx(0.6)


def test_the_offset_of_a_clock_is_right_within_its_uncertainty(tmp_path: Path) -> None:
    slow, rig = inputs(), PacedRig()
    recorder = new_run(tmp_path, title="Two clocks", protocol="")
    run_protocol(protocol(), devices(rig, slow), recorder, operator=lambda _: True)
    found = read_run(recorder.folder)
    told = xr.open_dataset(found.clocks["slow"][0])
    first = slow.began + float(told["pin_temperature"][0])  # its value is its time by its own clock
    error = told.attrs["clock_offset"] - (first - rig.began)
    assert abs(error) < told.attrs["clock_uncertainty"]
    assert (told.attrs["clock_name"], told.attrs["clock_part"]) == ("slow", 1)
    assert "clock slow: time 0 is " in found.dataset(clock="slow").attrs["caveats"]


def test_set_points_lie_on_the_time_base_of_each_clock(tmp_path: Path) -> None:
    beside = read_run(recorded(tmp_path, inputs())).dataset(clock="slow")
    volts = beside["voltage_peak_to_peak_set"].to_numpy()
    assert set(volts) == {10.0, 20.0}
    assert float(beside["time"][int(np.argmax(volts == 20.0))]) > 0.2


def test_quantity_and_unit_of_a_free_channel_are_read_back_from_every_format(tmp_path: Path) -> None:
    folder = recorded(tmp_path, inputs())
    beside = read_run(folder).dataset(clock="slow")
    assert (beside["emission"].attrs["units"], beside["pin_temperature"].attrs["units"]) == ("V", "K")
    name = f"{folder.name}-2-slow"
    for kind, ending in (("netcdf", ".nc"), ("csv", ".csv"), ("tdms", ".tdms")):
        paths = export_run(folder, file_format=kind, out=tmp_path / kind)
        assert [path.name for path in paths] == [f"{folder.name}{ending}", f"{name}{ending}"]
        again = read_recording(paths[1])
        assert again["emission"].attrs["units"] == "V"
        assert again["pin_temperature"].to_numpy() == approx(beside["pin_temperature"].to_numpy())
    drop_raw_blocks(folder)
    (path,) = export_run(folder, file_format="csv", out=tmp_path / "converted")[1:]
    assert path.name == f"{name}.csv"
    assert "emission [V]" in path.read_text().splitlines()[0]


def test_a_folder_of_a_run_is_measured_by_the_clock_of_the_run(tmp_path: Path) -> None:
    folder = recorded(tmp_path, inputs())
    assert [path.name for path in selected_files([folder])] == ["recording.nc"]
    assert sorted(path.name for path in folder.glob("*.nc")) == ["clock-slow-2.nc", "recording.nc"]
    with raises(UnknownName, match="unknown clock 'slwo'; did you mean slow"):
        read_run(folder).dataset(clock="slwo")


def test_a_killed_run_is_recovered_with_its_clocks(tmp_path: Path) -> None:
    folder = recorded(tmp_path, inputs())
    before = read_run(folder).dataset(clock="slow")
    lines = (folder / "documents.jsonl").read_text().splitlines(keepends=True)
    (folder / "documents.jsonl").write_text("".join(line for line in lines if not line.startswith('["stop"')))
    (folder / "clock-slow-2.nc").unlink()
    assert "clock-slow-2.nc written" in recover_run(folder).done
    assert read_run(folder).dataset(clock="slow")["time"].to_numpy() == approx(before["time"].to_numpy())
    assert recover_run(folder).done == ()


def test_a_pause_ends_the_parts_of_all_clocks_and_later_ones_follow(tmp_path: Path) -> None:
    found = read_run(recorded(tmp_path, inputs(), protocol({"kind": "prompt", "task": "load", "text": "Add."})))
    assert [path.name for path in found.recordings] == ["recording.nc", "recording-3.nc"]
    assert [path.name for path in found.clocks["slow"]] == ["clock-slow-2.nc", "clock-slow-4.nc"]
    assert found.dataset(clock="slow").sizes["time"] == approx(31, abs=8)


@pytest.mark.parametrize(
    ("settings", "reason"),
    [
        ({"value_then": 80.0}, "channel pin_temperature is 80 K; its limit is 60 K"),
        ({"value_then": float("nan")}, "channel pin_temperature gives no number"),
        ({"skips": True}, "slow inputs: 1 samples are missing after sample"),
    ],
)
def test_a_limit_or_a_loss_at_any_clock_ends_the_run_with_outputs_off(settings: dict[str, object], reason: str) -> None:
    slow = inputs(at=0.3, **settings)
    result, rig = run(slow)
    assert result.state is State.SAFE
    assert result.outcome != "completed"
    assert reason in result.reason
    assert rig.is_off
    assert slow.calls[-1] == "close"


@pytest.mark.parametrize(
    ("failure", "reason"),
    [
        (DeviceLost("slow inputs: pulled"), "slow inputs: pulled"),
        (ZeroDivisionError("driver"), "slow inputs: ZeroDivisionError: driver"),
        (SystemExit(3), "slow inputs: SystemExit: 3"),
    ],
)
def test_whatever_a_driver_raises_ends_the_run_with_outputs_off(failure: BaseException, reason: str) -> None:
    def fail() -> None:
        raise failure

    result, rig = run(inputs(at=0.3, happens=fail))
    assert (result.state, result.outcome, result.reason) == (State.SAFE, "failed", reason)
    assert rig.is_off


def test_a_late_block_of_any_clock_ends_the_run_with_outputs_off_although_the_call_hangs(
    release: Event, monkeypatch: MonkeyPatch
) -> None:
    monkeypatch.setattr(supervision, "LATE", 0.3)
    monkeypatch.setattr(own_clocks, "_ENDING", 0.2)
    late = Event()

    def hang() -> None:
        late.set()
        release.wait()

    long = protocol({"kind": "wait", "duration": "20 s"})
    result, rig = run(inputs(at=0.2, happens=hang), long)
    assert late.is_set()
    assert (result.state, result.outcome) == (State.SAFE, "failed")
    assert result.reason.startswith("slow inputs: a block is late by more than ")
    assert rig.is_off
    assert not release.is_set()  # the call still hangs


def test_outputs_are_not_touched_where_a_clock_is_missing() -> None:
    slow, rig = inputs(is_missing=True), PacedRig()
    result, _ = run(slow, rig=rig)
    assert (result.outcome, result.reason) == ("failed", "slow inputs: does not answer")
    assert rig.connected == 0
    assert rig.calls == []
    assert slow.calls == ["connect", "stop", "close"]


def test_a_limit_at_any_clock_holds_while_an_operator_is_asked() -> None:
    slow = inputs(at=0.8, value_then=80.0)
    control, rig, record = RunControl(), PacedRig(), MemoryRecord()

    def work(prompt: Prompt) -> bool:
        for _ in range(6000):
            if control.stop_reason:
                break
            time.sleep(0.01)
        return True

    asking = protocol({"kind": "prompt", "task": "load", "text": "Add."})
    result = run_protocol(asking, devices(rig, slow), record, operator=work, control=control)
    assert result.reason == "channel pin_temperature is 80 K; its limit is 60 K"
    assert rig.is_off


def test_a_check_looks_at_channels_of_other_clocks() -> None:
    check = {"kind": "check", "quantity": "temperature", "lowest": "1 K", "highest": "50 K"}
    slow = Inputs({"temperature": replace(temperature(), name="temperature")}, at=0.0, value_then=30.0)
    read = protocol(check, channels=("friction_force",))
    record, rig = MemoryRecord(), PacedRig()
    rig_without = replace(devices(rig, slow), acquisition=_without(rig, "temperature"))
    result = run_protocol(read, rig_without, record, operator=lambda _: True)
    assert result.outcome == "completed", result.reason
    (facts,) = [facts for kind, facts in record.notes if kind == "check"]
    assert facts["value"] == approx(30.0)


def test_a_limit_of_temperature_holds_every_channel_that_measures_one() -> None:
    read = protocol()
    limits = read.limits.model_copy(update={"temperature_maximum": 40.0})
    slow = inputs(at=0.3, value_then=45.0)
    rig = PacedRig(values={"temperature": 30.0})
    result, _ = run(slow, read.model_copy(update={"limits": limits}), rig)
    assert result.reason == "channel pin_temperature is 45 K; its limit is 40 K"


def test_a_protocol_that_records_no_channel_of_its_own_clock_is_refused() -> None:
    read = protocol(channels=("pin_temperature",))
    (fault,) = impossibilities(read, devices(PacedRig(), inputs()))
    assert fault == "step 3: records no channel of simulated rig; add one"
    with raises(InvalidInput, match="records no channel"):
        run_protocol(read, devices(PacedRig(), inputs()), MemoryRecord(), operator=lambda _: True)


def test_a_fast_clock_shows_a_drive_that_the_clock_of_the_run_does_not(tmp_path: Path) -> None:
    wave = {"voltage": "stack_voltage", "current": "stack_current"}
    fast = Inputs({name: Channel(name=name, quantity=of, sample_rate=500e3) for name, of in wave.items()})
    rig = PacedRig()
    known = replace(devices(rig, inputs()), acquisition=_without(rig, "voltage", "current"))
    read = protocol(channels=("friction_force", "voltage", "current"))
    limited = read.model_copy(update={"limits": read.limits.model_copy(update={"current_maximum": 1.0})})
    assert impossibilities(limited, replace(known, further={"fast": fast})) == ()
    assert unresolved(limited, replace(known, further={"fast": fast})) == ""
    blind = replace(
        known, further={"fast": Inputs({n: replace(c, sample_rate=50e3) for n, c in fast.channels.items()})}
    )
    (fault,) = impossibilities(limited, blind)
    assert "current at 50 kHz does not resolve the drive" in fault
    assert unresolved(read, blind).startswith("voltage and current at 50 kHz do not resolve")


def unresolved(read: Protocol, of: Devices) -> str:
    return planned_run(read, of).limits.unresolved(recorded_channels(read), of.channels)


def _without(rig: SimulatedRig, *names: str) -> SimulatedRig:
    """Rig as an acquisition that lacks some channels."""

    class Without(PacedRig):
        @property
        def channels(self) -> Mapping[str, Channel]:
            return {name: each for name, each in super().channels.items() if name not in names}

    other = Without()
    other.turns, other.setting = rig.turns, rig.setting
    return other


def test_begin_gives_up_where_a_device_does_not_start(release: Event, monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setattr(own_clocks, "_CONNECTING", 0.2)
    monkeypatch.setattr(own_clocks, "_ENDING", 0.2)
    slow = inputs()
    slow.connect = lambda: release.wait()  # type: ignore[method-assign, assignment]
    of = devices(PacedRig(), slow)
    clocks = own_clocks.OwnClocks(of, planned_run(protocol(), of).limits)
    with raises(DeviceError, match="slow inputs: did not start within"):
        clocks.begin(lambda: None)
    with raises(DeviceError, match="slow inputs: did not return"):
        clocks.end()


def test_a_clock_that_is_slower_than_a_recording_is_said_to_have_given_nothing(tmp_path: Path) -> None:
    slow = inputs(rate=0.5)
    slow.channels = {name: replace(each, sample_rate=0.5) for name, each in slow.channels.items()}
    folder = recorded(tmp_path, slow)
    found = read_run(folder)
    assert found.clocks == {}
    assert "clock slow gave no sample of pin_temperature, emission in a part" in found.caveats


def test_a_run_at_work_is_watched_at_all_clocks(tmp_path: Path) -> None:
    recorder = new_run(tmp_path, title="Two clocks", protocol="")
    force = Channel(name="friction_force", quantity="friction_force")
    recorder.note("prepared", state="running", protocol_time=0.0)
    recorder.begin([force], sample_rate=RATE)
    recorder.append(Block(first_sample=0, sample_rate=RATE, values=np.full((4, 1), 2.0)))
    recorder.begin_beside("slow", [temperature()], sample_rate=SLOW, first=7, ago=0.1, uncertainty=0.05)
    recorder.append(Block(first_sample=7, sample_rate=SLOW, values=np.full((2, 1), 300.0)), clock="slow")
    seen = RunObserver(recorder.folder).look()
    assert seen.means == {"friction_force": (2.0, "N"), "pin_temperature": (300.0, "K")}
    with raises(InvalidInput, match="block begins at sample 8, but 9 was expected"):
        recorder.append(Block(first_sample=8, sample_rate=SLOW, values=np.zeros((1, 1))), clock="slow")
    with raises(InvalidInput, match="no part of the recording has begun"):
        recorder.append(Block(first_sample=0, sample_rate=SLOW, values=np.zeros((1, 1))), clock="other")
    with raises(InvalidInput, match="needs one of the run, and no other of its own"):
        recorder.begin_beside("slow", [temperature()], sample_rate=SLOW, first=0, ago=0.0, uncertainty=0.05)
    assert recorder.finish("completed").outcome == "completed"
    assert read_run(recorder.folder).dataset(clock="slow").sizes["time"] == 2
