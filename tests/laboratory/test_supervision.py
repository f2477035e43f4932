"""A clock of its own switches motor and drive off where a run is late, also while a call does not return."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from threading import Event

import pytest
from pytest import MonkeyPatch, fixture
from tests.laboratory.simulated_rig import MemoryRecord, SimulatedRig
from tests.laboratory.supervised_clock import Clock

from sonolube.facts.protocol import protocol_from
from sonolube.laboratory import Block, Devices, DriveSetting, RunState, State, run_protocol, supervision
from sonolube.laboratory.supervision import Supervisor
from sonolube.laboratory.verdict import Outputs, Verdict

STEPS = [
    {"kind": "acquire", "channels": ["friction_force"], "sample_rate": "400 Hz", "duration": "4.5 s"},
    {"kind": "motor_speed", "rotation_speed": "1 Hz"},
    {"kind": "drive", "voltage_peak_to_peak": "10 V", "frequency": "22 kHz"},
    {"kind": "wait", "duration": "4.5 s"},
    {"kind": "drive", "voltage_peak_to_peak": "0 V"},
    {"kind": "motor_speed", "rotation_speed": "0 Hz"},
]
LIMITS = {"voltage_maximum": "30 V", "duration_maximum": "1 min"}
PROTOCOL = protocol_from({"title": "test", "source": "test", "limits": LIMITS, "steps": STEPS})
MOMENT = 1.0  # s, for outputs that never answer
ENDED = "; the supervisor has told motor and drive to switch off"


@fixture(autouse=True)
def clock(monkeypatch: MonkeyPatch) -> Clock:
    clock = Clock()
    monkeypatch.setattr(supervision, "time", clock)
    monkeypatch.setattr(supervision, "LATE", 2.0)
    return clock


@fixture
def release() -> Iterator[Event]:
    """Let calls that hang return at the end of the test."""
    event = Event()
    yield event
    event.set()


class HangingRig(SimulatedRig):
    """Rig of which the calls of one kind hang from the time on at which the drive is on; its outputs have `halt`."""

    def __init__(self, hangs: str, release: Event, clock: Clock, *, has_halt: bool = True) -> None:
        super().__init__()
        self.clock, self.hangs, self.release = clock, hangs, release
        self.was_on, self.halted = Event(), Event()
        if has_halt:
            self.halt = self._halt  # a method that a driver may have

    def _halt(self) -> None:
        super().off()
        self.halted.set()

    def _hang(self, kind: str) -> None:
        if kind == self.hangs and self.was_on.is_set():
            self.clock.now += 1e5
            assert self.release.wait()

    def read(self, samples: int) -> Block:
        self._hang("read")
        return super().read(samples)

    def drive(self, setting: DriveSetting) -> None:
        super().drive(setting)
        self.was_on.set()
        self._hang("drive")

    def off(self) -> None:
        self._hang("off")
        super().off()

    def stop(self) -> None:
        self._hang("stop")
        super().stop()

    def close(self) -> None:
        self._hang("close")
        super().close()


def hardware(rig: SimulatedRig) -> Devices:
    return replace(rig.devices(), simulated=False, clock=None)


def run(rig: SimulatedRig, record: MemoryRecord | None = None, advance: Callable[..., None] | None = None) -> RunState:
    record = record or MemoryRecord()
    result = run_protocol(PROTOCOL, hardware(rig), record, operator=lambda _: True, advance=advance)
    assert (record.outcome, record.reason) == (result.outcome, result.reason)
    return result


def test_a_run_in_time_is_left_alone(release: Event, clock: Clock) -> None:
    rig = HangingRig("nothing", release, clock)
    record = MemoryRecord()
    assert run(rig, record).outcome == "completed"
    assert record.samples() == [1800]
    assert not rig.halted.is_set()


def test_outputs_are_off_and_the_run_ends_although_a_block_never_comes(release: Event, clock: Clock) -> None:
    rig = HangingRig("read", release, clock)
    result = run(rig)
    assert (result.state, result.outcome) == (State.SAFE, "failed")
    assert result.reason == f"simulated rig: a block is late by more than 2 s{ENDED}"
    assert result.verdict == Verdict(Outputs.CONFIRMED_OFF, "drive and motor by the device's own word, not measured")
    assert rig.halted.is_set()
    assert rig.is_off
    assert not release.is_set()  # the call still hangs


def test_nothing_is_off_while_a_setting_may_still_be_made(
    release: Event, clock: Clock, monkeypatch: MonkeyPatch
) -> None:
    monkeypatch.setattr(supervision, "_RETURNING", 0.2)
    rig = HangingRig("drive", release, clock)
    result = run(rig)
    assert rig.halted.is_set()
    assert (result.state, result.outcome) == (State.FAILED, "failed")
    assert result.reason.startswith(f"simulated rig: drive did not return within 2.05 s{ENDED}; cut the power: ")
    assert result.verdict == Verdict(
        Outputs.CUT_THE_POWER, "simulated rig: drive has not returned, and may switch on when it does"
    )


@pytest.mark.parametrize("has_halt", [True, False])
def test_a_setting_that_is_made_after_the_outputs_were_switched_off_is_undone(
    has_halt: bool, release: Event, clock: Clock
) -> None:
    class Late(HangingRig):
        """Rig that sets the drive long after it was asked to, when it was switched off meanwhile."""

        def drive(self, setting: DriveSetting) -> None:
            self.clock.now += 1e5
            assert switched_off.wait(MOMENT)
            super().drive(setting)

        def off(self) -> None:
            super().off()
            switched_off.set()

        def _halt(self) -> None:
            super()._halt()
            switched_off.set()

    switched_off = Event()
    rig = Late("nothing", release, clock, has_halt=has_halt)
    result = run(rig)
    assert rig.calls.count("drive 10 V") == 1
    assert rig.is_off
    assert (result.state, result.outcome) == (State.SAFE, "failed")


def test_an_output_without_a_way_of_its_own_is_switched_off_by_another_thread(release: Event, clock: Clock) -> None:
    rig = HangingRig("read", release, clock, has_halt=False)
    assert run(rig).state is State.SAFE
    assert rig.is_off


def test_an_output_that_cannot_be_switched_off_in_time_is_told(
    release: Event, clock: Clock, monkeypatch: MonkeyPatch
) -> None:
    monkeypatch.setattr(supervision, "_SWITCHING", MOMENT)
    rig = HangingRig("off", release, clock, has_halt=False)
    result = run(rig)
    assert (result.state, result.outcome) == (State.FAILED, "failed")
    assert "simulated rig: off did not return within 1 s" in result.reason


@pytest.mark.parametrize("hangs", ["stop", "close"])
def test_a_device_that_is_not_released_in_time_is_left_behind(
    hangs: str, release: Event, clock: Clock, monkeypatch: MonkeyPatch
) -> None:
    monkeypatch.setattr(supervision, "_SWITCHING", MOMENT)
    rig = HangingRig(hangs, release, clock)
    assert run(rig).state is State.SAFE
    assert rig.is_off


def test_a_program_that_reads_no_more_is_late_too(release: Event, clock: Clock) -> None:
    rig = HangingRig("nothing", release, clock)

    def stuck(doing: str, *_: int) -> None:  # such as a disk that does not answer
        if "wait" in doing:
            clock.now += 1e5
            assert rig.halted.wait()

    result = run(rig, advance=stuck)
    assert result.state is State.SAFE
    assert result.reason == f"the program read no block for 2.05 s{ENDED}"


def test_delays_of_single_blocks_add_up_by_the_clock_of_the_samples(release: Event, clock: Clock) -> None:
    class Slow(HangingRig):
        def read(self, samples: int) -> Block:
            clock.now += 0.27  # s for every block of 50 ms: 24 s for 4.5 s
            return super().read(samples)

    rig, record = Slow("nothing", release, clock), MemoryRecord()
    result = run(rig, record)
    assert result.reason == f"simulated rig: a block is late by more than 2 s{ENDED}"
    assert rig.is_off
    late_by = 0.27 - 0.05
    assert sum(record.samples()) <= 20 * (2.0 / late_by + 2)  # of 1800


def test_clocks_that_go_a_little_differently_make_nothing_late(release: Event, clock: Clock) -> None:
    class Drifting(HangingRig):
        def read(self, samples: int) -> Block:
            clock.now += samples / self.rate * (1 + 1e-4)
            return super().read(samples)

    rig = Drifting("nothing", release, clock)
    supervisor = Supervisor(hardware(rig))
    with supervisor.at_work():
        acquisition = supervisor.devices.acquisition
        acquisition.connect()
        acquisition.start(["voltage"], sample_rate=1.0)
        for _ in range(60):
            acquisition.read(1000)  # 16.7 h in all, in which the clocks differ by 6 s
    assert not supervisor.reason


class Guard:
    """Enable line that notes what it is told."""

    name = "guard"

    def __init__(self) -> None:
        self.told: list[str] = []

    def __getattr__(self, call: str) -> Callable[[], None]:
        return lambda: self.told.append(call)


def test_a_guard_is_enabled_while_outputs_are_on_and_renewed_with_every_block(release: Event, clock: Clock) -> None:
    guard = Guard()
    rig = HangingRig("nothing", release, clock)
    devices = replace(hardware(rig), guard=guard)
    result = run_protocol(PROTOCOL, devices, MemoryRecord(), operator=lambda _: True)
    assert result.outcome == "completed"
    assert list(dict.fromkeys(guard.told)) == ["connect", "enable", "renew", "disable", "close"]
    assert guard.told.count("enable") == guard.told.count("disable") == 1
    assert guard.told.count("renew") == 90  # 4.5 s in blocks of 50 ms


def test_a_guard_disables_the_outputs_where_a_call_hangs(release: Event, clock: Clock) -> None:
    guard = Guard()
    devices = replace(hardware(HangingRig("read", release, clock)), guard=guard)
    run_protocol(PROTOCOL, devices, MemoryRecord(), operator=lambda _: True)
    assert guard.told[-2:] == ["disable", "close"]
