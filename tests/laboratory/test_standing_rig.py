"""While an operator works at a rig, its temperature is watched, and that motor and drive are off."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from threading import Event

import pytest
from tests.laboratory.simulated_rig import MemoryRecord, SimulatedRig

from sonolube.facts.protocol import Prompt, protocol_from
from sonolube.laboratory import Block, Channel, DeviceLost, RunControl, RunState, State, run_protocol

PROTOCOL = protocol_from(
    {
        "title": "test",
        "source": "test",
        "limits": {"voltage_maximum": "30 V", "duration_maximum": "1 min", "temperature_maximum": "320 K"},
        "steps": [
            {"kind": "acquire", "channels": ["friction_force"], "sample_rate": "400 Hz", "duration": "1 s"},
            {"kind": "prompt", "task": "load", "text": "Add a weight."},
            {"kind": "wait", "duration": "1 s"},
        ],
    }
)


class Watched(SimulatedRig):
    """Rig that says when it was read for two seconds of a prompt, and what it reads then."""

    def __init__(self, values: Mapping[str, float]) -> None:
        super().__init__()
        self.read_in_prompt, self.asked, self.in_prompt = 0.0, Event(), dict(values)
        self.is_asking = self.is_lost = False

    @property
    def channels(self) -> Mapping[str, Channel]:
        return {**super().channels, "rotation_speed": Channel(name="rotation_speed", quantity="rotation_speed")}

    def read(self, samples: int) -> Block:
        if self.is_asking and self.is_lost:
            raise DeviceLost("simulated: answers no more")
        self.values = self.in_prompt if self.is_asking else {}
        block = super().read(samples)
        if self.is_asking:
            self.read_in_prompt += samples / self.rate
            if self.read_in_prompt > 12.0:
                self.asked.set()
        return block


def run(rig: Watched, operator: Callable[[Prompt, RunControl], bool]) -> tuple[RunState, MemoryRecord]:
    record, control = MemoryRecord(), RunControl()

    def asked(prompt: Prompt) -> bool:
        rig.is_asking = True
        try:
            return operator(prompt, control)
        finally:
            rig.is_asking = False

    devices = replace(rig.devices(), simulated=False, clock=None)
    result = run_protocol(PROTOCOL, devices, record, operator=asked, control=control)
    assert rig.is_off
    return result, record


def patient(prompt: Prompt, control: RunControl) -> bool:
    """Person at the terminal, who is called back where the run is to end."""
    pause = Event()
    while not control.stop_reason:
        pause.wait(0.01)
    return False


@pytest.mark.parametrize(
    ("values", "reason"),
    [
        ({"temperature": 330.0}, "channel temperature is 330 K; its limit is 320 K"),
        (
            {"voltage": -12.0},
            "the drive was switched off, but channel voltage is -12 V (off is up to 1.5 V): cut the power",
        ),
        (
            {"rotation_speed": 0.2},
            "the motor was switched off, but channel rotation_speed is 0.2 1/s (off is up to 0.1 1/s): cut the power",
        ),
    ],
)
def test_what_goes_wrong_while_a_person_is_asked_calls_it_back_and_ends_the_run(
    values: Mapping[str, float], reason: str
) -> None:
    result, _ = run(Watched(values), patient)
    assert (result.state, result.outcome, result.reason) == (State.SAFE, "stopped", reason)


def test_inputs_that_are_lost_while_a_person_is_asked_end_the_run() -> None:
    rig = Watched({})
    rig.is_lost = True
    result, _ = run(rig, patient)
    assert (result.outcome, result.reason) == ("failed", "simulated: answers no more")


def test_a_rig_at_rest_is_watched_until_the_person_has_confirmed_and_nothing_of_that_is_recorded() -> None:
    rig = Watched({"temperature": 310.0, "voltage": 1.4, "rotation_speed": 0.05})
    result, record = run(rig, lambda prompt, control: rig.asked.wait())
    assert (result.outcome, result.reason) == ("completed", "")
    assert sum(record.samples()) == 400  # of 1 s
