"""Time that a protocol is expected to take: counted by hand, said from a second on, and without touching the rig."""

import numpy as np
import pytest
from pytest import MonkeyPatch, approx
from tests.laboratory.virtual_tribometer.test_simulation import DIAMETER, RIG

from sonolube.facts.protocol import Protocol, protocol_from
from sonolube.laboratory.virtual_tribometer import ExpectedTime, VirtualTribometer, pace, virtual_tribometer

PROTOCOL = {
    "title": "ten seconds",
    "source": "test",
    "limits": {"voltage_maximum": "30 V", "duration_maximum": "1 min"},
    "steps": [
        {"kind": "acquire", "channels": ["friction_force", "temperature"], "sample_rate": "1 kHz", "duration": "8 s"},
        {"kind": "motor_speed", "sliding_speed": "50 mm/s"},
        {"kind": "wait", "duration": "10 s"},
    ],
}


class Ticking:
    """Clock that goes on by a step at every look."""

    def __init__(self, step: float) -> None:
        self.now, self.step = 0.0, step

    def __call__(self) -> float:
        self.now += self.step
        return self.now


@pytest.fixture
def protocol() -> Protocol:
    return protocol_from(PROTOCOL)


def made() -> VirtualTribometer:
    return virtual_tribometer(RIG, seed=4, groove_diameter=DIAMETER)


def test_the_time_is_that_of_a_block_times_their_number(protocol: Protocol, monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setattr(pace, "monotonic", Ticking(2e-3))
    found = made().expected_time(protocol)
    # 10 s in blocks of 50 ms are 200 blocks, each 2 ms and 0.5 ms for its handling: 0.5 s; 8 s, 1 kHz, 2 channels
    assert found.wall_time == approx(0.5)
    assert found.duration == approx(10.0)
    assert found.samples == 16_000
    assert found.text == "about 500 ms on this computer for 10 s of the rig and 16,000 samples"
    assert found.text_before_run == ""
    monkeypatch.setattr(pace, "monotonic", Ticking(20e-3))
    assert made().expected_time(protocol).text_before_run.startswith("about 4.1 s on this computer for 10 s")


def test_what_was_spent_on_seeing_is_no_part_of_what_is_left() -> None:
    expected = ExpectedTime(duration=10.0, samples=100, wall_time=5.0, spent=4.5)
    assert expected.left == approx(0.5)
    assert expected.text_before_run == ""
    assert expected.text.startswith("about 5 s")


def test_a_rig_that_was_asked_how_long_it_takes_gives_the_same_samples(protocol: Protocol) -> None:
    found = []
    for asks in (False, True):
        rig = made()
        if asks:
            rig.expected_time(protocol)
        devices = rig.devices
        for device in (devices.acquisition, devices.drive, devices.motor):
            device.connect()
        devices.acquisition.start(["friction_force", "temperature", "gaussmeter"], sample_rate=500.0)
        devices.motor.turn(1.0)
        found.append(devices.acquisition.read(400).values)
    assert np.array_equal(found[0], found[1])
