"""Runner: protocols on a simulated rig, and every way in which a run can end."""

import re
import signal
import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from pytest import raises
from tests.laboratory.simulated_rig import Fault, MemoryRecord, SimulatedRig

from sonolube.errors import InvalidInput, fault_line
from sonolube.facts.protocol import Prompt, Protocol, protocol_from
from sonolube.laboratory import Block, Channel, RunControl, RunState, State, run_protocol
from sonolube.laboratory.block import quantity_of
from sonolube.text.units import format_si

MAP_TEST = {
    "title": "map test",
    "source": "D 4.1.2",
    "limits": {"voltage_maximum": "30 V", "duration_maximum": "40 s"},
    "metadata": {"groove_diameter": "28 mm"},
    "steps": [
        {"kind": "prompt", "task": "cleaning", "text": "Wipe pin and plate."},
        {"kind": "acquire", "channels": ["friction_force", "voltage"], "sample_rate": "400 Hz", "duration": "32.5 s"},
        {"kind": "wait", "duration": "0.5 s"},
        {"kind": "motor_speed", "sliding_speed": "65.5 mm/s"},
        {"kind": "wait", "duration": "12 s"},
        {
            "kind": "voltage_steps",
            "voltages": ["5.1 V", "10.3 V", "15.5 V", "20.7 V", "25.9 V"],
            "step_duration": "4 s",
            "frequency": "22 kHz",
            "unipolar": True,
        },
    ],
}

WATCHED = 800  # samples of the two seconds in which a virtual rig is watched while somebody is asked


def protocol(*steps: Mapping[str, object], **limits: str) -> Protocol:
    content = MAP_TEST | {"limits": MAP_TEST["limits"] | limits}  # type: ignore[operator]
    return protocol_from(content | ({"steps": list(steps)} if steps else {}))


def run(
    test: Protocol,
    rig: SimulatedRig | None = None,
    *,
    record: MemoryRecord | None = None,
    control: RunControl | None = None,
) -> tuple[RunState, SimulatedRig, MemoryRecord]:
    rig, record = rig or SimulatedRig(), record or MemoryRecord()
    result = run_protocol(test, rig.devices(), record, operator=lambda prompt: True, control=control)
    assert rig.is_off or result.state is State.FAILED
    assert not record.is_open
    assert record.outcome == result.outcome
    return result, rig, record


def test_the_map_test_records_every_sample_at_the_set_points_of_the_dissertation() -> None:
    result, rig, record = run(protocol())
    assert (result.state, result.outcome) == (State.SAFE, "completed")
    assert record.samples() == [13_000]
    force = np.concatenate([block.values[:, 0] for block in record.segments[0]])
    levels = [0.0] * 200 + [1.0] * 4800 + [0.4] * 8000
    assert np.array_equal(force, levels)
    turns = 0.0655 / (np.pi * 0.028)
    drives = [f"drive {voltage} V" for voltage in (5.1, 10.3, 15.5, 20.7, 25.9)]
    assert [call for call in rig.calls if call not in ("off", "close")] == [f"turn {turns:.3g}", *drives]


def test_blocks_follow_each_other_and_none_is_longer_than_the_time_between_two_looks() -> None:
    blocks = run(protocol())[2].segments[0]
    assert all(block.next_sample == following.first_sample for block, following in pairwise(blocks))
    assert max(block.samples for block in blocks) <= 0.05 * 400


@pytest.mark.parametrize("call", range(40))
def test_a_device_that_answers_no_more_ends_the_run_with_everything_off(call: int) -> None:
    result, rig, record = run(protocol(), SimulatedRig(fault=Fault(call=call)))
    assert (result.state, result.outcome) == (State.SAFE, "failed")
    assert result.reason == "simulated: answers no more"
    assert rig.calls.count("close") == 3
    assert record.notes[-1][1]["state"] == "safe"


class WordlessError(Exception):
    def __str__(self) -> str:
        raise ValueError("an exception whose text fails")


WORD = "motor and drive: confirmed off, drive measured off; motor by the device's own word, not measured"
ANY = [
    RuntimeError("short circuit"),
    OSError(19, "no such device"),
    WordlessError(),
    MemoryError(),
    KeyboardInterrupt(),
]


@pytest.mark.parametrize("error", [*ANY, SystemExit(3), GeneratorExit()], ids=lambda error: type(error).__name__)
def test_whatever_a_device_raises_ends_the_run_with_everything_off_in_one_line(error: BaseException) -> None:
    rig, record = SimulatedRig(fault=Fault(call=30, error=error, stays_dead=False)), MemoryRecord()
    result = run_protocol(protocol(), rig.devices(), record, operator=lambda prompt: True)
    assert rig.is_off
    assert (result.state, result.outcome, record.outcome) == (State.SAFE, "failed", "failed")
    assert result.reason.startswith(f"simulated rig: read: {type(error).__name__}")
    assert "\n" not in result.reason


@pytest.mark.parametrize("failure", [ZeroDivisionError("a fault"), KeyboardInterrupt(), SystemExit(3)], ids=repr)
def test_a_fault_of_the_program_passes_with_the_verdict_and_ends_the_run(failure: BaseException) -> None:
    def fails(stage: str, done: int, total: int) -> None:
        if done > 5_000:
            raise failure

    rig, record = SimulatedRig(), MemoryRecord()
    with raises(type(failure)) as raised:
        run_protocol(protocol(), rig.devices(), record, operator=lambda prompt: True, advance=fails)
    assert raised.value.__notes__ == [WORD]
    assert fault_line(raised.value).startswith(f"{WORD}; a fault of sonolube itself")
    assert rig.is_off
    assert record.outcome == ("stopped" if isinstance(failure, KeyboardInterrupt) else "failed")


def test_a_device_that_cannot_be_switched_off_is_told() -> None:
    class Stuck(SimulatedRig):
        def off(self) -> None:
            raise OSError("no route to device")

    result, _, record = run(protocol(), Stuck())
    assert (result.state, result.outcome) == (State.FAILED, "failed")
    assert "no route to device" in result.reason
    assert record.notes[-1][0] == "not off"


@pytest.mark.parametrize(
    ("limits", "values", "reason"),
    [
        ({"friction_force_maximum": "0.9 N"}, {}, "channel friction_force is 1 N; its limit is 900 mN"),
        ({"temperature_maximum": "300 K"}, {"temperature": 301.0}, "channel temperature is 301 K; its limit is 300 K"),
        ({"friction_force_maximum": "20 N"}, {"friction_force": 20.0}, "channel friction_force is saturated at 20 N"),
    ],
)
def test_a_limit_trips_within_one_block(limits: dict[str, str], values: dict[str, float], reason: str) -> None:
    rig = SimulatedRig(values=values)
    result, _, record = run(protocol(**limits), rig)
    assert (result.outcome, result.reason) == ("stopped", reason)
    begins = 200 if "0.9 N" in limits.values() else 0  # motor on at 0.5 s, at 400 Hz
    assert sum(record.samples()) <= begins + 0.05 * 400


@pytest.mark.parametrize(
    ("channel", "value", "reason"),
    [
        ("current", -0.7, "channel current is -700 mA; its limit is 500 mA"),
        ("current", np.nan, "channel current gives no number"),
        ("current_peak", 0.6, "channel current_peak is 600 mA; its limit is 500 mA"),
        ("current_rms", 0.36, "channel current_rms is 360 mA; its limit is 354 mA"),  # 0.5 A / sqrt(2)
    ],
)
def test_a_current_beyond_its_limit_trips_within_one_block(channel: str, value: float, reason: str) -> None:
    steps: list[Mapping[str, object]] = [
        {"kind": "acquire", "channels": ["friction_force"], "sample_rate": "110 kHz", "duration": "1 s"},
        {"kind": "drive", "voltage_peak_to_peak": "10 V", "frequency": "22 kHz"},
        {"kind": "wait", "duration": "1 s"},
    ]
    result, _, record = run(protocol(*steps, current_maximum="0.5 A"), MeteredRig(values={channel: value}))
    assert (result.outcome, result.reason) == ("stopped", reason)
    assert sum(record.samples()) == 0.05 * 110_000


class MeteredRig(SimulatedRig):
    """Rig with meters of the peak and the rms of the current."""

    @property
    def channels(self) -> Mapping[str, Channel]:
        meters = {name: Channel(name=name, quantity=quantity_of(name)) for name in ("current_peak", "current_rms")}
        return {**super().channels, **meters}


def test_a_setting_beyond_the_limit_of_the_voltage_is_never_sent() -> None:
    test = protocol()
    looser = test.model_copy(update={"limits": test.limits.model_copy(update={"voltage_maximum": 20.0})})
    result, rig, _ = run(looser)
    assert result.outcome == "stopped"
    assert result.reason == "the drive is to be set to 20.7 V; limits.voltage_maximum is 20 V"
    assert "drive 20.7 V" not in rig.calls  # 10.35 V and an offset of as much


def test_a_lost_sample_is_no_silent_gap() -> None:
    result, _, _ = run(protocol(), SimulatedRig(skip_at=1000))
    assert result.outcome == "failed"
    assert "1 samples are missing after sample" in result.reason


class WrongRig(SimulatedRig):
    """A rig that samples at another rate than asked for, or changes one block after those of the prompt."""

    def __init__(self, *, rate: float | None = None, change: Callable[[Block], Block] = lambda block: block) -> None:
        super().__init__()
        self._given, self._change, self._blocks = rate, change, 0

    def start(self, channels: Sequence[str], *, sample_rate: float) -> float:
        return super().start(channels, sample_rate=self._given or sample_rate)

    def read(self, samples: int) -> Block:
        block = super().read(samples)
        self._blocks += 1
        return self._change(block) if self._blocks == 45 else block


@pytest.mark.parametrize("rate", [1.0, 40.0, 379.0, 421.0, 4000.0])
def test_a_rate_that_is_more_than_five_per_cent_from_the_one_asked_for_ends_the_run(rate: float) -> None:
    result, rig, record = run(protocol(), WrongRig(rate=rate))
    assert result.outcome == "failed"
    assert result.reason.startswith(f"simulated rig: samples at {format_si(rate, 'Hz')} where 400 Hz was asked for")
    assert record.segments == []
    assert not [call for call in rig.calls if call.startswith(("drive", "turn"))]


@pytest.mark.parametrize("rate", [381.0, 419.0])
def test_a_rate_within_five_per_cent_is_recorded_as_it_is(rate: float) -> None:
    result, _, record = run(protocol(), WrongRig(rate=rate))
    assert result.outcome == "completed"
    assert record.segments[0][0].sample_rate == rate


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (
            lambda block: replace(block, values=np.hstack([block.values, block.values])),
            r"gives values of shape \(20, 4\)",
        ),
        (lambda block: replace(block, values=block.values[:, 0]), r"gives values of shape \(20,\)"),
        (lambda block: replace(block, sample_rate=800.0), "has changed its sample rate from 400 Hz to 800 Hz"),
        (lambda block: replace(block, values=block.values + np.inf), "gives an infinite value"),
        (
            lambda block: replace(block, first_sample=block.first_sample - block.samples),
            "gives sample 60 once more, where 80 follows",
        ),
        (
            lambda block: replace(block, values=np.full(block.values.shape, -(2**15), np.int16)),
            "channel voltage is -32.8 kV; its limit is 30 V",
        ),
    ],
)
def test_a_block_that_is_not_what_was_asked_for_ends_the_run(change: Callable[[Block], Block], reason: str) -> None:
    result, rig, record = run(protocol(friction_force_maximum="20 N"), WrongRig(change=change))
    assert result.outcome in ("failed", "stopped")
    assert re.search(reason, result.reason), result.reason
    assert 0 < sum(record.samples()) <= 5 * 20  # of 40 blocks nothing is recorded
    assert rig.is_off


def test_a_full_disk_ends_the_run_and_keeps_what_was_written() -> None:
    result, _, record = run(protocol(), record=MemoryRecord(blocks_until_full=50))
    assert (result.outcome, result.reason) == ("failed", "blocks: no space left on device")
    assert len(record.segments[0]) == 50


def test_an_operator_who_does_not_confirm_ends_the_run_before_anything_moves() -> None:
    rig, record = SimulatedRig(), MemoryRecord()
    result = run_protocol(protocol(), rig.devices(), record, operator=lambda prompt: False)
    assert (result.outcome, result.reason) == ("stopped", "the operator did not confirm: Wipe pin and plate.")
    assert not any(call.startswith(("turn", "drive")) for call in rig.calls)


@pytest.mark.parametrize(
    ("asked", "reason"), [("interrupted", "interrupted by the operator"), ("terminated", "terminated")]
)
@pytest.mark.parametrize("answer", [True, False])
def test_an_end_that_was_asked_for_in_a_prompt_is_the_reason_whatever_the_answer(
    answer: bool, asked: str, reason: str
) -> None:
    rig, control = SimulatedRig(), RunControl()

    def operator(prompt: Prompt) -> bool:
        control.stop(asked)
        return answer

    result = run_protocol(protocol(), rig.devices(), MemoryRecord(), operator=operator, control=control)
    assert (result.outcome, result.reason) == ("stopped", f"{reason}, while asked: Wipe pin and plate.")
    assert not any(call.startswith(("turn", "drive")) for call in rig.calls)


def test_motor_and_drive_are_off_while_the_operator_works_and_the_recording_goes_on_in_a_second_part() -> None:
    steps: list[Mapping[str, object]] = [
        {"kind": "acquire", "channels": ["friction_force"], "sample_rate": "1 kHz", "duration": "2 s"},
        {"kind": "motor_speed", "rotation_speed": "1 Hz"},
        {"kind": "wait", "duration": "0.5 s"},
        {"kind": "prompt", "task": "mounting", "text": "Turn the specimen."},
        {"kind": "wait", "duration": "1.5 s"},
    ]
    rig, record, states = SimulatedRig(), MemoryRecord(), []

    def look(prompt: Prompt) -> bool:
        states.append(rig.is_off)
        return True

    result = run_protocol(protocol(*steps), rig.devices(), record, operator=look)
    assert result.outcome == "completed"
    assert states == [True]
    assert record.samples() == [500, 1500]
    assert record.segments[1][0].values[0, 0] == 1.0  # the motor turns again


def test_a_pause_holds_the_clock_and_a_stop_ends_after_the_present_block() -> None:
    control = RunControl()

    class Watched(SimulatedRig):
        def read(self, samples: int) -> Block:
            if self.total == 1000:
                control.pause()
            if self.total >= 4000:
                control.stop("enough")
            return super().read(samples)

    class Resuming(MemoryRecord):
        def note(self, kind: str, *, sample: int | None = None, **facts: str | float) -> None:
            super().note(kind, sample=sample, **facts)
            if facts.get("reason") == "on request":
                threading.Timer(0.2, control.resume).start()

    result, _, record = run(protocol(), Watched(), record=Resuming(), control=control)
    assert (result.outcome, result.reason) == ("stopped", "enough")
    assert sum(record.samples()) == 4020 - 2 * WATCHED
    assert [kind for kind, _ in record.notes].count("pause") == 2  # the prompt, and the request


@pytest.mark.parametrize(("otherwise", "outcome"), [("stop", "stopped"), ("note", "completed"), ("wait", "completed")])
def test_a_check_stops_notes_or_waits(otherwise: str, outcome: str) -> None:
    steps: list[Mapping[str, object]] = [
        {"kind": "acquire", "channels": ["friction_force"], "sample_rate": "1 kHz", "duration": "1 s"},
        {"kind": "check", "quantity": "temperature", "highest": "295 K", "otherwise": otherwise},
        {"kind": "wait", "duration": "1 s"},
    ]

    class Cooling(SimulatedRig):
        def read(self, samples: int) -> Block:
            self.values = {"temperature": 300.0 - self.total / 100}
            return super().read(samples)

    result, _, record = run(protocol(*steps, temperature_maximum="400 K"), Cooling())
    assert result.outcome == outcome
    if outcome == "completed":
        assert sum(record.samples()) >= 1000
    else:
        assert "check of temperature: 300 K, wanted any to 295 K" in result.reason


SPEED_CHECK = [
    {"kind": "motor_speed", "rotation_speed": "1 Hz"},
    {"kind": "check", "quantity": "sliding_speed", "lowest": "80 mm/s", "highest": "90 mm/s"},  # 88 mm/s at 28 mm
]


class Tachometer(SimulatedRig):
    """Rig that measures the speed of its disc, which comes up to a share of what was set within some blocks."""

    share, blocks = 1.0, 0

    @property
    def channels(self) -> Mapping[str, Channel]:
        return {**super().channels, "rotation_speed": Channel(name="rotation_speed", quantity="rotation_speed")}

    def read(self, samples: int) -> Block:
        self.blocks += self.turns > 0
        self.values = {"rotation_speed": self.turns * self.share * min(self.blocks / 20, 1.0)}
        return super().read(samples)


def test_a_check_of_a_speed_looks_at_the_measured_one_once_it_has_settled() -> None:
    result, _, record = run(protocol(*SPEED_CHECK), Tachometer())
    assert result.outcome == "completed"
    (checked,) = [facts for kind, facts in record.notes if kind == "check"]
    assert 0.08 <= checked["value"] <= 0.09  # type: ignore[operator]
    assert "basis" not in checked


def test_a_disc_that_does_not_turn_as_it_is_set_fails_the_check() -> None:
    rig = Tachometer()
    rig.share = 0.5
    result, _, _ = run(protocol(*SPEED_CHECK), rig)
    assert result.outcome == "stopped"
    assert result.reason == "check of sliding_speed: 44 mm/s, wanted 80 mm/s to 90 mm/s"
    assert rig.blocks == pytest.approx(5.0 / 0.05, abs=2)  # it had five seconds


def test_a_check_of_a_speed_that_nothing_measures_says_so() -> None:
    _, _, record = run(protocol(*SPEED_CHECK))
    (checked,) = [facts for kind, facts in record.notes if kind == "check"]
    assert checked["basis"] == "as it is set: no channel rotation_speed measures it"
    too_fast = {"kind": "check", "quantity": "rotation_speed", "highest": "0.5 Hz"}
    result, _, _ = run(protocol(SPEED_CHECK[0], too_fast))
    assert result.reason.startswith(
        "check of rotation_speed: 1 1/s (as it is set: no channel rotation_speed measures it)"
    )


def test_what_devices_cannot_do_is_refused_before_they_are_connected() -> None:
    weak = SimulatedRig(voltage_maximum=20.0)
    with raises(InvalidInput, match=r"step 6: the drive reaches 25.9 V; simulated rig gives at most 20 V"):
        run_protocol(protocol(), weak.devices(), MemoryRecord(), operator=lambda prompt: True)
    slow = SimulatedRig(rotation_speed_maximum=0.1)
    with raises(InvalidInput, match=r"step 4: needs .* simulated rig turns at most at 0.1 1/s"):
        run_protocol(protocol(), slow.devices(), MemoryRecord(), operator=lambda prompt: True)
    unknown = {"kind": "acquire", "channels": ["noise"], "sample_rate": "1 Hz", "duration": "1 s"}
    with raises(InvalidInput, match="has no channel noise; it has friction_force"):
        run_protocol(protocol(unknown), SimulatedRig().devices(), MemoryRecord(), operator=lambda prompt: True)
    assert (weak.connected, slow.connected) == (0, 0)


def test_a_limit_that_nothing_watches_is_refused() -> None:
    rig = SimulatedRig()
    found = rig.devices()
    blind = replace(found, acquisition=_Blind())
    with raises(InvalidInput, match="temperature_maximum cannot be watched: no device has a channel temperature"):
        run_protocol(protocol(temperature_maximum="400 K"), blind, MemoryRecord(), operator=lambda prompt: True)


class _Blind(SimulatedRig):
    @property
    def channels(self):  # type: ignore[no-untyped-def]
        return {name: each for name, each in super().channels.items() if name != "temperature"}


def test_progress_tells_step_time_and_friction() -> None:
    told = []
    run_protocol(
        protocol(),
        SimulatedRig().devices(),
        MemoryRecord(),
        operator=lambda prompt: True,
        advance=lambda now, done, whole: told.append((now, done, whole)),
    )
    assert told[-1] == ("step 6, voltage steps, 400 mN", 32_500, 32_500)
    assert [done for _, done, _ in told] == sorted(done for _, done, _ in told)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_the_run_after_the_present_block_and_handlers_are_as_before(
    number: signal.Signals, request: pytest.FixtureRequest
) -> None:
    former = signal.signal(number, signal.default_int_handler)  # a background job ignores it
    request.addfinalizer(lambda: signal.signal(number, former))

    class Signalled(SimulatedRig):
        def read(self, samples: int) -> Block:
            if self.total == 1000:
                signal.raise_signal(number)
            return super().read(samples)

    result, _, record = run(protocol(), Signalled())
    assert result.outcome == "stopped"
    assert result.reason in ("interrupted", "terminated")
    assert sum(record.samples()) == 1020 - WATCHED
    assert signal.getsignal(number) is signal.default_int_handler


OTHERS = ("SIGQUIT", "SIGTSTP", "SIGUSR1", "SIGUSR2", "SIGALRM", "SIGXCPU", "SIGVTALRM", "SIGTTIN", "SIGTTOU")


@pytest.mark.skipif(not hasattr(signal, "SIGQUIT"), reason="Windows has no such signals")
@pytest.mark.parametrize("name", OTHERS)
def test_a_signal_that_would_end_or_stop_the_process_ends_the_run_in_order(name: str) -> None:
    number = getattr(signal, name)

    class Signalled(SimulatedRig):
        def read(self, samples: int) -> Block:
            if self.total in (1000, 1020):
                signal.raise_signal(number)  # also once more, while the outputs are being switched off
            return super().read(samples)

    told = {"SIGQUIT": "ended by Ctrl-\\", "SIGTSTP": "suspended by Ctrl-Z"}.get(name, f"ended by {name}")
    before = signal.signal(number, signal.SIG_DFL)  # which a shell ignores for programs in the background
    try:
        result, rig, _ = run(protocol(), Signalled())
        assert (result.state, result.outcome, result.reason) == (State.SAFE, "stopped", told)
        assert rig.is_off
        assert signal.getsignal(number) is signal.SIG_DFL
    finally:
        signal.signal(number, before)
