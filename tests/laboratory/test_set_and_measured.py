"""Set voltages against measured ones: waves by hand, and rigs whose amplifier gives another voltage than it is told."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import pytest
from pytest import approx
from tests.laboratory.simulated_rig import MemoryRecord, SimulatedRig

from sonolube.facts.protocol import Protocol, protocol_from
from sonolube.laboratory import Block, Channel, DeviceError, DriveSetting, RunState, run_protocol
from sonolube.laboratory.set_and_measured import difference, is_near, monitor_of, self_test_setting

FREQUENCY = 22e3
SET = DriveSetting(voltage_peak_to_peak=20.0, frequency=FREQUENCY)
RATE = 250e3  # Hz


def wave(swing: float, *, waveform: str = "sine", offset: float = 0.0, rate: float = RATE) -> Block:
    """Half a second of a channel, and another channel before it that is no voltage."""
    phase = FREQUENCY * np.arange(round(0.5 * rate)) / rate % 1.0
    shapes = {
        "sine": np.sin(2 * np.pi * phase),
        "square": np.where(phase < 0.5, 1.0, -1.0),
        "triangle": np.abs(4 * phase - 2) - 1,
        "sawtooth": 2 * phase - 1,
    }
    values = np.stack([np.full(phase.shape, 400.0), offset + swing / 2 * shapes[waveform]], axis=1)
    return Block(first_sample=0, sample_rate=rate, values=values)


NAMES = ("temperature", "voltage")


@pytest.mark.parametrize("waveform", ["sine", "square", "triangle", "sawtooth"])
@pytest.mark.parametrize(
    ("swing", "differs"), [(20.0, False), (22.8, False), (17.2, False), (23.4, True), (16.6, True)]
)
def test_a_wave_may_differ_by_fifteen_per_cent(waveform: str, swing: float, differs: bool) -> None:
    told = difference(wave(swing, waveform=waveform), NAMES, replace(SET, waveform=waveform))
    assert bool(told) is differs
    assert difference(wave(20.0, waveform=waveform, offset=30.0), NAMES, replace(SET, waveform=waveform)) == ""


@pytest.mark.parametrize(("swing", "measured"), [(40.0, "40 V"), (56.6, "56.6 V"), (0.0, "0 V")])
def test_a_load_a_unit_and_a_trip_are_told(swing: float, measured: str) -> None:
    assert difference(wave(swing), NAMES, SET) == (
        f"channel voltage measures {measured} peak to peak where 20 V was set; look at load, unit and amplifier"
    )


def test_small_voltages_may_differ_by_a_volt() -> None:
    small = replace(SET, voltage_peak_to_peak=2.0)
    assert difference(wave(2.9), NAMES, small) == ""
    assert difference(wave(3.2), NAMES, small) != ""


def test_a_channel_of_the_swing_is_taken_as_it_is_and_one_that_is_sampled_seldom_tells_nothing() -> None:
    swing = Block(first_sample=0, sample_rate=10.0, values=np.array([[25.0], [27.0]]))
    assert "measures 26 V" in difference(swing, ["voltage_peak_to_peak"], SET)
    assert difference(wave(40.0, rate=104e3), NAMES, SET) == ""
    assert "measures 40 V" in difference(wave(40.0, rate=109.9e3), NAMES, SET)  # 110 kHz as a divided clock gives it
    assert difference(wave(40.0), ["temperature", "current"], SET) == ""
    assert monitor_of(["voltage"], sample_rate=110e3, frequency=FREQUENCY) == "voltage"
    assert monitor_of(["voltage", "voltage_peak_to_peak"], sample_rate=1.0, frequency=FREQUENCY) == (
        "voltage_peak_to_peak"
    )


def test_the_self_test_is_a_tenth_of_the_first_voltage_without_offset_where_that_can_be_seen() -> None:
    first = replace(SET, voltage_peak_to_peak=28.0, voltage_offset=14.0, waveform="square")
    tested = self_test_setting(first)
    assert tested is not None
    assert tested.voltage_peak_to_peak == approx(2.8)
    assert tested.voltage_offset == 0.0
    assert (tested.frequency, tested.waveform) == (FREQUENCY, "square")
    assert self_test_setting(replace(SET, voltage_peak_to_peak=19.0)) is None
    assert self_test_setting(None) is None


@dataclass
class Amplified(SimulatedRig):
    """A rig with a monitor of the voltage at the actuator, which gets a multiple of what is set."""

    gain: float = 1.0
    gain_from: int = 0  # setting from which on, counted from 1, that is so
    swings: list[float] = field(default_factory=list)

    def drive(self, setting: DriveSetting) -> None:
        super().drive(setting)
        self.swings.append(setting.voltage_peak_to_peak)

    def read(self, samples: int) -> Block:
        block = super().read(samples)
        first, values = block.first_sample, block.values.copy()
        if self.setting is not None and "voltage" in self.names:
            gain = self.gain if len(self.swings) >= self.gain_from else 1.0
            phase = 2 * np.pi * FREQUENCY * (first + np.arange(samples)) / self.rate
            values[:, self.names.index("voltage")] = gain * self.setting.voltage_peak_to_peak / 2 * np.sin(phase)
        return replace(block, values=values)


def protocol(steps: Sequence[Mapping[str, object]], *, sample_rate: str = "200 kHz") -> Protocol:
    return protocol_from(
        {
            "title": "driven",
            "source": "none",
            "limits": {"voltage_maximum": "80 V", "duration_maximum": "10 s"},
            "steps": [
                {"kind": "acquire", "channels": ["voltage"], "sample_rate": sample_rate, "duration": "1 s"},
                *steps,
            ],
        }
    )


DRIVEN = [
    {"kind": "drive", "voltage_peak_to_peak": "20 V", "frequency": "22 kHz"},
    {"kind": "wait", "duration": "0.5 s"},
    {"kind": "drive", "voltage_peak_to_peak": "30 V", "frequency": "22 kHz"},
    {"kind": "wait", "duration": "0.5 s"},
]


def run(rig: Amplified, *, self_test: bool = True) -> tuple[RunState, MemoryRecord]:
    record = MemoryRecord()
    devices = replace(rig.devices(), simulated=False)
    return run_protocol(protocol(DRIVEN), devices, record, operator=lambda _: True, self_test=self_test), record


def test_a_run_begins_with_a_tenth_of_its_voltage_and_the_record_says_so() -> None:
    rig = Amplified()
    result, record = run(rig)
    assert (result.outcome, rig.swings) == ("completed", [2.0, 20.0, 30.0])
    (facts,) = [facts for kind, facts in record.notes if kind == "self-test"]
    assert (facts["voltage_peak_to_peak"], facts["channel"], facts["reason"]) == (approx(2.0), "voltage", "")
    assert record.samples() == [200_000]


def test_a_rig_that_doubles_the_voltage_gets_a_tenth_of_it_and_no_more() -> None:
    rig = Amplified(gain=2.0)
    result, record = run(rig)
    assert (result.outcome, rig.swings) == ("stopped", [2.0])
    assert result.reason.startswith("self-test before the first step: channel voltage measures 4 V")
    assert record.segments == []
    assert rig.is_off


def test_a_voltage_that_becomes_another_during_a_run_ends_it() -> None:
    rig = Amplified(gain=0.0, gain_from=3)
    result, _ = run(rig)
    assert (result.outcome, rig.swings) == ("stopped", [2.0, 20.0, 30.0])
    assert "measures 0 V peak to peak where 30 V was set" in result.reason


@dataclass
class Divided(Amplified):
    """A rig whose converter divides a clock of 20 MHz, up to a highest rate."""

    highest: float = 1e6

    def start(self, channels: Sequence[str], *, sample_rate: float) -> float:
        if sample_rate > self.highest:
            raise DeviceError(f"simulated: {sample_rate:g} Hz refused")
        self.rate = super().start(channels, sample_rate=20e6 / math.ceil(20e6 / sample_rate))
        return self.rate


def test_a_voltage_is_compared_at_the_somewhat_lower_rate_that_hardware_gives() -> None:
    # For 5 samples a period of 22 kHz the clock of 20 MHz is divided by 182: 109.89 kHz.
    rig = Divided(gain=2.0)
    result, _ = run(rig)
    assert (result.outcome, rig.swings) == ("stopped", [2.0])


def test_a_self_test_at_a_rate_that_the_acquisition_has_not_is_left_out_with_the_reason() -> None:
    rig = Divided(highest=2e3)
    record, devices = MemoryRecord(), replace(rig.devices(), simulated=False)
    slow = protocol(DRIVEN, sample_rate="1 kHz")
    result = run_protocol(slow, devices, record, operator=lambda _: True)
    assert (result.outcome, rig.swings) == ("completed", [20.0, 30.0])
    (facts,) = [facts for kind, facts in record.notes if kind == "self-test"]
    assert facts["reason"] == "left out: simulated: 110000 Hz refused"


def test_the_limit_of_the_voltage_holds_in_the_self_test() -> None:
    rig = Amplified(gain=100.0)  # a peak of 100 V where 80 V are allowed
    result, _ = run(rig)
    assert (result.outcome, rig.swings) == ("stopped", [2.0])
    assert "its limit is 80 V" in result.reason
    assert rig.is_off


def test_both_comparisons_can_be_left_out() -> None:
    rig = Amplified(gain=2.0)
    result, record = run(rig, self_test=False)
    assert (result.outcome, rig.swings) == ("completed", [20.0, 30.0])
    assert "self-test" not in [kind for kind, _ in record.notes]


class Telling(Amplified):
    """A source that is asked what it gives, and gives nothing from a setting on."""

    def read_back(self) -> str:
        from sonolube.laboratory import DeviceError

        if self.gain == 0 and len(self.swings) >= self.gain_from:
            raise DeviceError("simulated: its output has tripped")
        return f"{self.swings[-1]:g} V; output on"


def test_what_the_source_reads_back_is_noted_at_each_step_and_ends_a_run_that_it_does_not_bear_out() -> None:
    rig = Telling()
    result, record = run(rig, self_test=False)
    assert result.outcome == "completed"
    told = [facts["answers"] for kind, facts in record.notes if kind == "read back"]
    assert told[0] == "20 V; output on"
    assert told[-1] == "30 V; output on"
    assert set(told) == {"20 V; output on", "30 V; output on"}
    tripped = Telling(gain=0.0, gain_from=2)
    result, record = run(tripped, self_test=False)
    assert (result.outcome, result.reason) == ("failed", "simulated: its output has tripped")
    assert tripped.is_off


def test_channels_without_a_name_of_the_voltage_are_not_compared() -> None:
    channel = Channel(name="pin_temperature", quantity="temperature")
    assert monitor_of([channel.name], sample_rate=1e6, frequency=FREQUENCY) == ""


@pytest.mark.parametrize(
    ("former", "setting", "near"),
    [
        (replace(SET, voltage_peak_to_peak=19.0), SET, True),  # five per cent of 20 V
        (replace(SET, voltage_peak_to_peak=18.9), SET, False),
        (replace(SET, voltage_peak_to_peak=21.0), SET, True),
        (replace(SET, frequency=21e3), SET, False),
        (None, SET, False),
        (SET, None, False),
        (None, None, True),
    ],
)
def test_settings_are_near_that_differ_by_a_twentieth_of_the_voltage_alone(
    former: DriveSetting | None, setting: DriveSetting | None, near: bool
) -> None:
    assert is_near(former, setting) is near
