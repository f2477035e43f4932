"""Verdict on motor and drive: what is measured counts more than what devices say, and one that may be on is said."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import pytest
from tests.laboratory.simulated_rig import MemoryRecord, SimulatedRig

from sonolube.facts.protocol import protocol_from
from sonolube.laboratory import Outputs, RunState, State, Verdict, exit_code, run_protocol, verdict_text
from sonolube.laboratory.block import Channel
from sonolube.laboratory.verdict import verdict_on

PROTOCOL = protocol_from(
    {
        "title": "test",
        "source": "test",
        "limits": {"voltage_maximum": "30 V", "duration_maximum": "1 min"},
        "steps": [
            {"kind": "acquire", "channels": ["friction_force"], "sample_rate": "400 Hz", "duration": "1 s"},
            {"kind": "drive", "voltage_peak_to_peak": "10 V", "frequency": "22 kHz"},
            {"kind": "wait", "duration": "1 s"},
        ],
    }
)
OFF, CONFIRMED, ON = Outputs.MEASURED_OFF, Outputs.CONFIRMED_OFF, Outputs.CUT_THE_POWER


@pytest.mark.parametrize(
    ("failures", "measured", "expected"),
    [
        ([], {"drive": "", "motor": ""}, Verdict(OFF)),
        ([], {}, Verdict(CONFIRMED, "drive and motor by the device's own word, not measured")),
        ([], {"motor": ""}, Verdict(CONFIRMED, "motor measured off; drive by the device's own word, not measured")),
        ([], {"drive": "20 V", "motor": ""}, Verdict(ON, "20 V")),
        (["motor: mute"], {"drive": "", "motor": ""}, Verdict(ON, "motor: mute")),
        (["motor: mute", "motor: mute"], {"drive": "20 V"}, Verdict(ON, "motor: mute; 20 V")),
    ],
)
def test_the_weakest_of_what_is_known_is_the_verdict(
    failures: Sequence[str], measured: Mapping[str, str], expected: Verdict
) -> None:
    assert verdict_on(failures, measured) == expected


def test_texts_and_exit_codes() -> None:
    found = [Verdict(OFF), Verdict(CONFIRMED, "by its word"), Verdict(ON, "drive: mute"), None]
    assert [verdict_text(each) for each in found] == [
        "measured off",
        "confirmed off, by its word",
        "cut the power: drive: mute",
        "as they were before the run, which connected no device",
    ]
    assert [exit_code(each, is_failure=False) for each in found] == [0, 0, 3, 0]
    assert [exit_code(each, is_failure=True) for each in found] == [1, 1, 3, 1]


class MonitoredRig(SimulatedRig):
    """Rig with a monitor of the voltage and a sensor of the speed; both show what the devices really do."""

    lies = False
    slowest = 0.0  # Hz, that the acquisition cannot exceed, where it is not 0

    @property
    def channels(self) -> Mapping[str, Channel]:
        turning = Channel(name="rotation_speed", quantity="rotation_speed", lowest=-20.0, highest=20.0)
        return {**super().channels, "rotation_speed": turning}

    def start(self, channels: Sequence[str], *, sample_rate: float) -> float:
        return super().start(channels, sample_rate=min(sample_rate, self.slowest or sample_rate))

    def read(self, samples: int) -> Any:
        volts = 0.0 if self.setting is None else self.setting.voltage_peak_to_peak / 2
        self.values = {"voltage": volts, "rotation_speed": self.turns}
        return super().read(samples)

    def off(self) -> None:
        kept = self.setting
        super().off()
        if self.lies:
            self.setting = kept


def ended(rig: SimulatedRig) -> tuple[RunState, MemoryRecord]:
    record = MemoryRecord()
    return run_protocol(PROTOCOL, rig.devices(), record, operator=lambda _: True), record


def test_outputs_that_channels_show_at_rest_are_measured_off_and_the_record_says_so() -> None:
    result, record = ended(MonitoredRig())
    assert (result.state, result.outcome, result.verdict) == (State.SAFE, "completed", Verdict(OFF))
    kind, facts = record.notes[-1]
    assert (kind, facts["state"], facts["outputs"]) == ("off", "safe", "measured off")


def test_a_drive_that_lies_is_told_by_its_monitor() -> None:
    rig = MonitoredRig()
    rig.lies = True
    result, record = ended(rig)
    assert (result.state, result.outcome) == (State.FAILED, "failed")
    assert result.verdict is not None
    assert result.verdict.outputs is ON
    assert "the drive was switched off, but channel voltage is 5 V" in result.verdict.text
    assert record.notes[-1][1]["outputs"] == result.verdict.text


def test_a_monitor_that_does_not_resolve_the_drive_measures_nothing() -> None:
    rig = MonitoredRig()
    rig.slowest = 1000.0
    verdict = ended(rig)[0].verdict
    assert verdict == Verdict(CONFIRMED, "motor measured off; drive by the device's own word, not measured")


def test_a_run_that_connects_nothing_has_no_verdict() -> None:
    def prepare(*_: object) -> None:
        raise ValueError("no memory")

    rig = SimulatedRig()
    record = MemoryRecord()
    with pytest.raises(ValueError, match="no memory") as raised:
        run_protocol(PROTOCOL, replace(rig.devices(), prepare=prepare), record, operator=lambda _: True)
    assert rig.connected == 0
    assert raised.value.__notes__ == ["motor and drive: as they were before the run, which connected no device"]
