"""Set points that take devices time are worked out before anything is connected, and change no sample."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pytest import MonkeyPatch
from tests.laboratory.simulated_rig import MemoryRecord, SimulatedRig
from tests.same import same

from sonolube.facts.protocol import Prompt, protocol_from
from sonolube.laboratory import Devices, DriveSetting, RunControl, run_protocol
from sonolube.laboratory.virtual_tribometer import virtual_tribometer
from sonolube.laboratory.virtual_tribometer.truth import FrictionDraw
from sonolube.rig import read_rig

RIG = Path(__file__).parents[2] / "examples" / "rigs" / "power_map.toml"
TEST = protocol_from(
    {
        "title": "steps",
        "source": "none",
        "limits": {"voltage_maximum": "30 V", "duration_maximum": "10 s"},
        "steps": [
            {"kind": "acquire", "channels": ["friction_force"], "sample_rate": "400 Hz", "duration": "1.2 s"},
            {"kind": "motor_speed", "rotation_speed": "0.2 Hz"},
            {"kind": "wait", "duration": "0.2 s"},
            {
                "kind": "voltage_steps",
                "voltages": ["10 V", "10.05 V", "10.1 V", "20 V", "10 V"],
                "step_duration": "0.2 s",
                "frequency": "22 kHz",
            },
        ],
    }
)


def test_every_set_point_is_prepared_once_before_a_device_is_connected() -> None:
    rig, prepared = SimulatedRig(), list[tuple[float, float]]()

    def prepare(setting: DriveSetting | None, rotation_speed: float) -> None:
        assert rig.connected == 0
        prepared.append((0.0 if setting is None else setting.voltage_peak_to_peak, rotation_speed))

    run_protocol(TEST, replace(rig.devices(), prepare=prepare), MemoryRecord(), operator=lambda prompt: True)
    assert prepared == [(0.0, 0.0), (0.0, 0.2), (10.0, 0.2), (10.05, 0.2), (10.1, 0.2), (20.0, 0.2)]
    assert rig.connected == 3


def test_a_request_to_stop_ends_the_preparation_with_nothing_connected() -> None:
    rig, control = SimulatedRig(), RunControl()
    devices = replace(rig.devices(), prepare=lambda setting, turns: control.stop("enough"))
    result = run_protocol(TEST, devices, MemoryRecord(), operator=lambda prompt: True, control=control)
    assert (result.outcome, result.reason, rig.connected) == ("stopped", "enough", 0)
    assert not any(call.startswith(("turn", "drive")) for call in rig.calls)


def samples_of(devices: Devices) -> np.ndarray:
    """Samples that are recorded on devices."""
    record = MemoryRecord()
    assert run_protocol(TEST, devices, record, operator=lambda prompt: True).outcome == "completed"
    return np.concatenate([block.values for block in record.segments[0]])


@pytest.mark.parametrize("seed", [0, 7])
def test_preparation_changes_no_sample_of_the_virtual_tribometer(seed: int) -> None:
    prepared, at_need = (virtual_tribometer(read_rig(RIG), seed=seed).devices for _ in range(2))
    assert prepared.prepare is not None
    same(samples_of(prepared), samples_of(replace(at_need, prepare=None)))


def test_no_model_is_computed_while_the_virtual_motor_turns(monkeypatch: MonkeyPatch) -> None:
    devices = virtual_tribometer(read_rig(RIG), seed=0).devices
    computed, started = list[bool](), list[str]()
    compute, start = FrictionDraw._computed, devices.acquisition.start

    def counted(draw: FrictionDraw, setting: DriveSetting, sliding_speed: float, normal_load: float) -> object:
        computed.append(bool(started))
        return compute(draw, setting, sliding_speed, normal_load)

    def noted(channels: Sequence[str], *, sample_rate: float) -> float:
        started.append("now")
        return start(channels, sample_rate=sample_rate)

    monkeypatch.setattr(FrictionDraw, "_computed", counted)
    monkeypatch.setattr(devices.acquisition, "start", noted)
    samples_of(devices)
    assert started
    assert computed
    assert not any(computed)


def test_models_at_the_load_of_a_prompt_are_computed_before_the_virtual_motor_turns(monkeypatch: MonkeyPatch) -> None:
    devices = virtual_tribometer(read_rig(RIG), seed=0).devices
    assert devices.prepare is not None
    assert devices.attend is not None
    setting = DriveSetting(voltage_peak_to_peak=25.9, frequency=22e3, voltage_offset=12.95)
    devices.prepare(setting, 0.7)
    devices.attend(Prompt.model_validate({"task": "load", "text": "Hang 9 N.", "normal_load": "9 N"}))
    monkeypatch.setattr(FrictionDraw, "_computed", lambda *_: pytest.fail("computed while the motor turns"))
    for device in (devices.motor, devices.drive):
        device.connect()
    devices.motor.turn(0.7)
    devices.drive.drive(setting)
