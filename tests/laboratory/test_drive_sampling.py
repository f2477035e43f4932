"""A drive of fewer than five samples a period is said not to be seen, and a limit of its current is refused."""

from collections.abc import Mapping

import pytest
from pytest import raises
from tests.laboratory.simulated_rig import MemoryRecord, SimulatedRig

from sonolube.errors import InvalidInput
from sonolube.facts.protocol import Protocol, protocol_by_name_or_file, protocol_from, protocol_names
from sonolube.laboratory import Channel, run_protocol
from sonolube.laboratory.block import quantity_of
from sonolube.laboratory.interlocks import drive_sampling, recorded_channels

AT_400_HZ = "voltage and current at 400 Hz do not resolve the drive (fewer than five samples a period)"
SHIPPED = {  # sample rates and drives as printed in the dissertation's tables
    "appendix_a": AT_400_HZ,
    "both_directions": AT_400_HZ,
    "decay_length_run": AT_400_HZ,  # the voltage at 60 kHz is not resolved either
    "lubrication_comparison": AT_400_HZ,
    "map_test": AT_400_HZ,
    "resonance_sweep": AT_400_HZ.replace("400 Hz", "100 kHz"),  # up to 24 kHz
    "study_1": AT_400_HZ,
    "study_2": AT_400_HZ,
    "temperature_test": AT_400_HZ,
    "waveguide_calibration": "",
}


def protocol(*steps: Mapping[str, object], **limits: str) -> Protocol:
    known = {"voltage_maximum": "30 V", "duration_maximum": "1 min"}
    return protocol_from({"title": "test", "source": "test", "limits": known | limits, "steps": list(steps)})


def acquire(rate: str, lasts: str) -> dict[str, object]:
    return {"kind": "acquire", "channels": ["voltage"], "sample_rate": rate, "duration": lasts}


def drive(frequency: str, **more: object) -> dict[str, object]:
    return {"kind": "drive", "voltage_peak_to_peak": "10 V", "frequency": frequency, **more}


WAIT = {"kind": "wait", "duration": "1 s"}
PROMPT = {"kind": "prompt", "text": "Look."}
OFF = {"kind": "drive", "voltage_peak_to_peak": "0 V"}


def test_every_shipped_protocol_is_known_here() -> None:
    assert set(protocol_names()) == set(SHIPPED)


@pytest.mark.parametrize("name", SHIPPED)
def test_what_the_shipped_protocols_do_not_show_is_said_in_one_line(name: str) -> None:
    read = protocol_by_name_or_file(name)
    sampling = drive_sampling(read)
    assert (sampling.caveat(recorded_channels(read)) if sampling else "") == SHIPPED[name]


@pytest.mark.parametrize(("rate", "is_resolved"), [("110 kHz", True), ("109 kHz", False)])
def test_five_samples_a_period_resolve_the_drive(rate: str, is_resolved: bool) -> None:
    sampling = drive_sampling(protocol(acquire(rate, "1 s"), drive("22 kHz"), WAIT))
    assert sampling is not None
    assert sampling.is_resolved == is_resolved


@pytest.mark.parametrize(
    ("steps", "rate"),
    [
        ((acquire("400 Hz", "1 s"), WAIT, acquire("200 kHz", "1 s"), drive("22 kHz"), WAIT), 200e3),  # off at 400 Hz
        ((acquire("200 kHz", "1 s"), drive("22 kHz"), WAIT, acquire("400 Hz", "1 s"), WAIT), 400.0),  # on at both
        ((acquire("200 kHz", "1 s"), WAIT, drive("22 kHz"), WAIT), 200e3),  # goes on as it was recorded
        ((acquire("200 kHz", "1 s"), WAIT, PROMPT, drive("22 kHz"), WAIT, OFF, acquire("400 Hz", "1 s")), 400.0),
        ((drive("22 kHz"), WAIT), 1000.0),  # nothing is recorded
    ],
)
def test_the_rate_that_counts_is_the_lowest_while_the_drive_is_on(
    steps: tuple[Mapping[str, object], ...], rate: float
) -> None:
    sampling = drive_sampling(protocol(*steps))
    assert sampling is not None
    assert sampling.sample_rate == rate


class Metered(SimulatedRig):
    """Rig with a meter of the current."""

    meter: str

    @property
    def channels(self) -> Mapping[str, Channel]:
        return {**super().channels, self.meter: Channel(name=self.meter, quantity=quantity_of(self.meter))}


@pytest.mark.parametrize(
    ("meter", "waveform", "refusal"),
    [
        ("displacement", "sine", "record at 110 kHz or more, add a channel current_peak or current_rms, or leave"),
        ("current_rms", "square", "of other waves than a sine, current_rms tells no peak; record at 110 kHz or more"),
        ("current_rms", "sine", ""),
        ("current_peak", "square", ""),
    ],
)
def test_a_limit_of_a_current_that_is_not_resolved_needs_a_meter(meter: str, waveform: str, refusal: str) -> None:
    test = protocol(acquire("400 Hz", "1 s"), drive("22 kHz", waveform=waveform), WAIT, current_maximum="0.5 A")
    rig, record = Metered(), MemoryRecord()
    rig.meter = meter
    if refusal:
        reason = r"limits.current_maximum cannot be watched: current at 400 Hz does not resolve the drive"
        with raises(InvalidInput, match=reason) as found:
            run_protocol(test, rig.devices(), record, operator=lambda _: True)
        assert refusal in str(found.value)
        assert rig.connected == 0
    else:
        assert run_protocol(test, rig.devices(), record, operator=lambda _: True).outcome == "completed"
