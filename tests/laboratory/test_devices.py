"""Devices are connected, switched off and released each whatever becomes of the others, and a run ends by its cause."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import pytest
from pytest import raises
from tests.laboratory.simulated_rig import SimulatedRig

from sonolube.errors import InvalidInput, fault_line
from sonolube.facts.protocol import Limits
from sonolube.laboratory import Block, Channel, DeviceError, Devices, RunControl, connect_devices
from sonolube.laboratory.block import quantity_of
from sonolube.laboratory.devices import switch_outputs_off
from sonolube.laboratory.interlocks import Interlock, off_bounds
from sonolube.laboratory.standing_rig import still_on
from sonolube.laboratory.states import Event, RunEnded, RunState, State, after, ending, release_devices, tried


@dataclass
class Noted(SimulatedRig):
    """Device that notes its calls in a list of all devices, and fails where that is wanted."""

    heard: list[str] = field(default_factory=list)
    fails: Sequence[str] = ()

    def _note(self, call: str) -> None:
        self.heard.append(f"{self.name} {call}")
        if call in self.fails:
            raise RuntimeError(f"{call} is broken")

    def connect(self) -> None:
        self._note("connect")

    def off(self) -> None:
        self._note("off")

    def close(self) -> None:
        self._note("close")


def devices(heard: list[str], **fails: Sequence[str]) -> Devices:
    inputs, drive, motor = (
        Noted(name=name, heard=heard, fails=fails.get(name, ())) for name in ("inputs", "drive", "motor")
    )
    return replace(SimulatedRig().devices(), acquisition=inputs, drive=drive, motor=motor)


def test_inputs_are_connected_before_any_output() -> None:
    heard: list[str] = []
    connect_devices(devices(heard))
    assert heard == ["inputs connect", "drive connect", "motor connect"]


def test_both_outputs_are_switched_off_although_one_fails_and_the_failure_is_named() -> None:
    heard: list[str] = []
    assert switch_outputs_off(devices(heard, drive=["off"])) == ["drive: RuntimeError: off is broken"]
    assert heard == ["drive off", "motor off"]
    heard.clear()
    assert switch_outputs_off(devices(heard)) == []


def test_all_devices_are_released_outputs_first_although_some_fail() -> None:
    heard: list[str] = []
    calls = [lambda: heard.append("before"), lambda: 1 / 0]
    found = release_devices(devices(heard, drive=["close"], inputs=["close"]), *calls)
    assert found == ["division by zero", "close is broken", "close is broken"]
    assert heard == ["before", "drive close", "motor close", "inputs close"]
    assert tried() == []


@pytest.mark.parametrize(
    ("failure", "event", "reason"),
    [
        (RunEnded(Event.TRIP, "too hot"), Event.TRIP, "too hot"),
        (RunEnded(Event.STOP, "enough"), Event.STOP, "enough"),
        (DeviceError("no answer"), Event.DEVICE_ERROR, "no answer"),
        (InvalidInput("disk full"), Event.CRASH, "disk full"),
        (ValueError("odd"), Event.CRASH, fault_line(ValueError("odd"))),
        (KeyboardInterrupt(), Event.STOP, "interrupted"),
    ],
)
def test_a_run_ends_by_what_was_raised(failure: BaseException, event: Event, reason: str) -> None:
    assert ending(failure) == (event, reason)


def test_an_end_outside_of_stopping_leaves_outcome_and_reason_as_they_are() -> None:
    assert after(RunState(State.IDLE), Event.STOP, reason="why") == RunState(State.IDLE)
    assert after(RunState(State.SAFE, "completed"), Event.STOP, reason="why") == RunState(State.SAFE, "completed")
    assert after(RunState(State.SAFE, "stopped", "why"), Event.RESET) == RunState()
    assert after(RunState(State.STOPPING, "completed"), Event.OFF, reason="x") == RunState(State.SAFE, "completed")
    not_off = after(RunState(State.STOPPING, "completed"), Event.NOT_OFF, reason="motor")
    assert not_off == RunState(State.FAILED, "failed", "motor")
    with raises(InvalidInput, match="event 'pause' cannot happen while idle; known: start, stop, trip, device error"):
        after(RunState(), Event.PAUSE)


def test_the_first_reason_to_stop_is_kept_and_a_pause_lasts_until_it_is_resumed() -> None:
    control = RunControl()
    assert (control.stop_reason, control.is_paused) == ("", False)
    control.pause()
    paused = [control.is_paused]
    control.resume()
    assert [*paused, control.is_paused] == [True, False]
    control.stop("first")
    control.stop("second")
    assert control.stop_reason == "first"


LIMITS = Limits.model_validate({"voltage_maximum": "60 V", "duration_maximum": "1 min"})


class Measured(SimulatedRig):
    """Rig of which everything that tells whether it is off is measured."""

    @property
    def channels(self) -> dict[str, Channel]:
        names = ("voltage", "voltage_peak_to_peak", "rotation_speed", "friction_force")
        return {name: Channel(name=name, quantity=quantity_of(name)) for name in names}


def test_off_is_a_twentieth_of_the_voltage_a_volt_at_least_and_a_hundredth_of_the_speed() -> None:
    rig = Measured(rotation_speed_maximum=8.0).devices()
    bounds = [(what, lock.channel.name, lock.limit) for what, lock in off_bounds(rig, LIMITS)]
    assert bounds == [
        ("drive", "voltage", 3.0),
        ("drive", "voltage_peak_to_peak", 6.0),
        ("motor", "rotation_speed", 0.08),
    ]
    low = LIMITS.model_copy(update={"voltage_maximum": 10.0})
    assert [lock.limit for _, lock in off_bounds(rig, low)] == [1.0, 2.0, 0.08]
    assert [what for what, _ in off_bounds(SimulatedRig().devices(), LIMITS)] == ["drive"]


def test_an_output_counts_as_on_once_it_had_its_time_to_come_to_rest() -> None:
    known = Measured().channels
    off = [("drive", Interlock(known["voltage"], 3.0)), ("motor", Interlock(known["rotation_speed"], 0.08))]
    names = ["rotation_speed", "voltage"]

    def said(turns: float, volts: float, stands: float) -> str:
        block = Block(first_sample=0, sample_rate=10.0, values=np.array([[0.0, 0.0], [turns, volts]]))
        return still_on(block, names, off, stands)

    drive = "the drive was switched off, but channel voltage is -4 V (off is up to 3 V): cut the power"
    motor = "the motor was switched off, but channel rotation_speed is 0.1 1/s (off is up to 0.08 1/s): cut the power"
    assert said(0.1, -4.0, 1.0) == ""  # the amplifier has a second
    assert said(0.1, -4.0, 1.01) == drive
    assert said(0.1, 2.9, 10.0) == ""  # the disc has ten
    assert said(0.1, 2.9, 10.1) == motor
    assert said(0.08, 3.0, 60.0) == ""
