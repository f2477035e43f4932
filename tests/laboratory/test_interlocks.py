"""Interlocks hold every sample of a block to the limit and to both ends of its channel's range."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from pytest import raises

from sonolube.errors import InvalidInput, SeveralFaults
from sonolube.facts.protocol import Limits, flattened, protocol_from
from sonolube.laboratory.block import Block, Channel, quantity_of
from sonolube.laboratory.devices import DriveSetting
from sonolube.laboratory.interlocks import (
    DriveSampling,
    Interlock,
    drive_sampling,
    first_trip,
    idle_rate,
    interlocks_for,
    recorded_channels,
    set_point_trip,
)
from sonolube.text.units import format_si

FORCE = Channel(name="friction_force", quantity="friction_force", lowest=-20.0, highest=50.0)
LOCK = Interlock(FORCE, 30.0)


def trip_of(*samples: float) -> str:
    values = np.array(samples, dtype=np.float64)[:, np.newaxis]
    return first_trip(Block(first_sample=100, sample_rate=1e3, values=values), ["friction_force"], [LOCK])


@pytest.mark.parametrize("value", [0.0, 30.0, -19.999])
def test_samples_within_limit_and_range_trip_nothing(value: float) -> None:
    assert not trip_of(1.0, value, 1.0)


@pytest.mark.parametrize(
    ("value", "reason"),
    [
        (-20.0, "channel friction_force is saturated at -20 N"),  # the lower end, within the limit of 30 N
        (-25.0, "channel friction_force is saturated at -25 N"),
        (30.001, "channel friction_force is 30 N; its limit is 30 N"),
        (-31.0, "channel friction_force is -31 N; its limit is 30 N"),
        (np.nan, "channel friction_force gives no number"),
    ],
)
def test_the_first_sample_beyond_them_trips(value: float, reason: str) -> None:
    assert trip_of(1.0, 2.0, value, -40.0) == reason


def channel(name: str, reach: float = np.inf, **more: Any) -> Channel:
    return Channel(name=name, quantity=quantity_of(name), lowest=-reach, highest=reach, **more)


def test_the_channel_whose_sample_comes_first_is_the_cause_whatever_the_order_of_the_locks() -> None:
    # temperature passes 350 K at the third sample, the force 30 N at the second: the force is the cause
    values = np.array([[1.0, 300.0], [40.0, 340.0], [45.0, 360.0]])
    block = Block(first_sample=0, sample_rate=1e3, values=values)
    heat = Interlock(channel("temperature"), 350.0)
    for locks in ([LOCK, heat], [heat, LOCK]):
        reason = first_trip(block, ["friction_force", "temperature"], locks)
        assert reason == "channel friction_force is 40 N; its limit is 30 N"
    assert first_trip(block, ["friction_force", "temperature"], [heat]).startswith("channel temperature is 360 K")


def limits_of(**maxima: float) -> Limits:
    return Limits.model_construct(voltage_maximum=30.0, duration_maximum=60.0).model_copy(update=maxima)


def channels_of(*found: Channel) -> dict[str, Channel]:
    return {each.name: each for each in found}


FAST = DriveSampling(sample_rate=200e3, frequency=22e3)  # nine samples a period
SLOW = DriveSampling(sample_rate=400.0, frequency=22e3)


def test_each_limit_holds_its_channels_and_that_of_the_current_an_rms_by_the_root_of_two() -> None:
    probe = Channel(name="pin_temperature", quantity="temperature", lowest=200.0, highest=900.0)
    speed = channel("rotation_speed")
    known = channels_of(
        *map(channel, ("voltage", "current", "current_peak", "current_rms", "temperature", "friction_force")),
        probe,
        speed,
    )
    maxima = {"current_maximum": 0.5, "temperature_maximum": 350.0, "friction_force_maximum": 9.0}
    held = {lock.channel.name: lock.limit for lock in interlocks_for(limits_of(**maxima), known, FAST)}
    assert held == {
        "voltage": 30.0,
        "current": 0.5,
        "current_peak": 0.5,
        "current_rms": pytest.approx(0.353553, rel=1e-5),  # 0.5 / 1.41421
        "temperature": 350.0,
        "pin_temperature": 350.0,
        "friction_force": 9.0,
    }


def test_channels_of_other_names_are_held_by_what_they_measure() -> None:
    known = channels_of(
        Channel(name="amplifier_swing", quantity="voltage_peak_to_peak", lowest=-500.0, highest=500.0),
        Channel(name="clamp", quantity="stack_current_rms", lowest=-5.0, highest=5.0),
        Channel(name="second_cell", quantity="friction_force", lowest=-50.0, highest=50.0),
        Channel(name="load", quantity="normal_load"),
    )
    limits = limits_of(current_maximum=0.5, friction_force_maximum=9.0)
    held = {lock.channel.name: lock.limit for lock in interlocks_for(limits, known, SLOW)}
    assert held == {
        "amplifier_swing": 60.0,
        "clamp": pytest.approx(0.353553, rel=1e-5),  # 0.5 / 1.41421
        "second_cell": 9.0,
    }
    with raises(InvalidInput, match=r"current_rms tells no peak"):
        interlocks_for(limits, known, replace(SLOW, is_sine=False))


def test_a_limit_of_a_channel_itself_holds_beside_those_of_the_protocol() -> None:
    known = channels_of(channel("voltage", 200.0), channel("friction_force", 60.0, limit=40.0))
    locks = interlocks_for(limits_of(friction_force_maximum=12.0), known, None)
    assert [(lock.channel.name, lock.limit) for lock in locks] == [
        ("voltage", 30.0),
        ("friction_force", 12.0),
        ("friction_force", 40.0),
    ]


def test_a_voltage_that_nothing_measures_is_held_by_set_points_alone_and_a_force_is_refused() -> None:
    assert interlocks_for(limits_of(), {}, None) == ()
    with pytest.raises(InvalidInput) as refusal:
        interlocks_for(limits_of(friction_force_maximum=9.0), channels_of(channel("voltage")), None)
    assert str(refusal.value) == (
        "limits.friction_force_maximum cannot be watched: no device has a channel friction_force; add one, or leave the"
        " limit out"
    )


def test_several_limits_that_cannot_be_held_are_refused_together() -> None:
    known = channels_of(channel("voltage", 20.0), channel("friction_force", 50.0, limit=60.0))
    with pytest.raises(SeveralFaults) as refusal:
        interlocks_for(limits_of(temperature_maximum=350.0), known, None)
    assert refusal.value.faults == (
        "limits.voltage_maximum of 30 V lies beyond the range of channel voltage, 20 V",
        "limits.temperature_maximum cannot be watched: no device has a channel temperature; add one, or leave the limit"
        " out",
        "limit of channel friction_force of 60 N lies beyond the range of channel friction_force, 50 N",
    )


@pytest.mark.parametrize(
    ("lowest", "highest", "limit", "is_held"),
    [
        (-20.0, 50.0, 50.0, True),
        (-20.0, 50.0, 50.1, False),
        (-50.0, 20.0, 50.0, True),  # the larger magnitude of both ends is the reach
        (-50.0, 20.0, 50.1, False),
        (-20.0, 50.0, 30.0, True),
    ],
)
def test_a_limit_lies_within_the_end_of_the_range_that_is_farther_from_zero(
    lowest: float, highest: float, limit: float, is_held: bool
) -> None:
    force = Channel(name="friction_force", quantity="friction_force", lowest=lowest, highest=highest)
    arguments = limits_of(friction_force_maximum=limit), channels_of(force), None
    if is_held:
        assert [lock.limit for lock in interlocks_for(*arguments)] == [limit]
    else:
        with pytest.raises(InvalidInput, match="lies beyond the range of channel friction_force"):
            interlocks_for(*arguments)


def current_of(drive: DriveSampling | None, *names: str, own_rate: float | None = None) -> str:
    """Refusal of a limit of the current of 0.5 A; empty where it can be watched."""
    found = [channel(name, sample_rate=own_rate if name == "current" else None) for name in names]
    try:
        interlocks_for(limits_of(current_maximum=0.5), channels_of(*found), drive)
    except InvalidInput as refusal:
        return str(refusal)
    return ""


def test_a_current_is_watched_by_five_samples_a_period_by_its_peak_or_by_the_rms_of_a_sine() -> None:
    square = DriveSampling(sample_rate=400.0, frequency=22e3, is_sine=False)
    assert current_of(None, "current") == ""
    assert current_of(FAST, "current") == ""
    assert current_of(SLOW, "current", own_rate=110e3) == ""
    assert current_of(SLOW, "current", "current_peak") == ""
    assert current_of(SLOW, "current_rms") == ""
    assert current_of(square, "current_peak") == ""
    cannot = "limits.current_maximum cannot be watched: current at 400 Hz does not resolve the drive (fewer than five"
    at_least = "record at 110 kHz or more"
    assert current_of(SLOW, "current") == (
        f"{cannot} samples a period); {at_least}, add a channel current_peak or current_rms, or leave the limit out"
    )
    assert current_of(square, "current", "current_rms") == (
        f"{cannot} samples a period); of other waves than a sine, current_rms tells no peak; {at_least}, add a channel"
        " current_peak, or leave the limit out"
    )


def test_a_channel_of_its_own_rate_is_held_to_the_highest_frequency_of_the_drive() -> None:
    swept = DriveSampling(sample_rate=400.0, frequency=10e3, frequency_maximum=24e3)
    assert swept.of(None) is swept
    assert swept.of(channel("current")) is swept
    own = swept.of(channel("current", sample_rate=110e3))
    assert (own.sample_rate, own.frequency) == (110e3, 24e3)
    assert not own.is_resolved  # 4.6 samples a period
    assert swept.of(channel("current", sample_rate=120e3)).is_resolved  # exactly five
    lower = DriveSampling(sample_rate=400.0, frequency=30e3, frequency_maximum=24e3)
    assert lower.of(channel("current", sample_rate=1e6)).frequency == 30e3


def test_the_caveat_names_voltage_and_current_together_at_one_rate_and_apart_at_two() -> None:
    few = "resolve the drive (fewer than five samples a period)"
    assert SLOW.caveat(["friction_force"]) == ""
    assert FAST.caveat(["voltage", "current"]) == ""
    assert SLOW.caveat(["current", "friction_force"]) == f"current at 400 Hz does not {few}"
    assert SLOW.caveat(["current", "voltage"]) == f"voltage and current at 400 Hz do not {few}"
    apart = channels_of(channel("voltage"), channel("current", sample_rate=50e3))
    names = ["voltage", "current", "friction_force"]
    assert SLOW.caveat_of(names, apart) == f"voltage at 400 Hz does not {few}; current at 50 kHz does not {few}"
    fast = channels_of(channel("current", sample_rate=110e3))
    assert SLOW.caveat_of(["current", "voltage"], fast) == f"voltage at 400 Hz does not {few}"


@pytest.mark.parametrize(("volts", "offset", "trips"), [(40.0, 10.0, False), (40.0, -10.001, True), (60.1, 0.0, True)])
def test_a_set_point_trips_where_half_its_swing_and_its_offset_exceed_the_limit(
    volts: float, offset: float, trips: bool
) -> None:
    # of 30 V: 20 V + 10 V is just within
    setting = DriveSetting(voltage_peak_to_peak=volts, voltage_offset=offset, frequency=22e3)
    reached = abs(offset) + volts / 2
    expected = f"the drive is to be set to {format_si(reached, 'V')}; limits.voltage_maximum is 30 V" if trips else ""
    assert set_point_trip(setting, limits_of()) == expected


def test_the_rate_after_the_last_recording_is_that_of_the_last_one_and_a_kilohertz_without_any() -> None:
    steps: list[dict[str, Any]] = [
        {"kind": "acquire", "channels": [name], "sample_rate": rate, "duration": "1 s"}
        for name, rate in (("voltage", "50 Hz"), ("friction_force", "70 Hz"))
    ]
    wait = {"kind": "wait", "duration": "2 s"}
    drive = {"kind": "drive", "voltage_peak_to_peak": "10 V", "frequency": "22 kHz"}
    known = {"title": "t", "source": "s", "limits": {"voltage_maximum": "30 V", "duration_maximum": "1 min"}}
    recorded = protocol_from({**known, "steps": [steps[0], wait, drive, steps[1], wait]})
    assert idle_rate(flattened(recorded)) == 70.0
    assert idle_rate(flattened(protocol_from({**known, "steps": [drive, wait]}))) == 1000.0
    assert recorded_channels(recorded) == ("friction_force",)  # the voltage is recorded with the drive off
    undriven = protocol_from({**known, "steps": [steps[0], wait]})
    assert drive_sampling(undriven) is None


def test_the_sampling_of_a_protocol_is_that_with_the_fewest_samples_a_period() -> None:
    known = {"title": "t", "source": "s", "limits": {"voltage_maximum": "30 V", "duration_maximum": "1 min"}}

    def part(frequency: str, waveform: str, rate: str) -> list[dict[str, Any]]:
        acquire = {"kind": "acquire", "channels": ["voltage"], "sample_rate": rate, "duration": "1 s"}
        volts = {"voltage_peak_to_peak": "10 V", "frequency": frequency, "waveform": waveform}
        off = {"kind": "drive", "voltage_peak_to_peak": "0 V"}
        return [acquire, {"kind": "drive", **volts}, {"kind": "wait", "duration": "1 s"}, off]

    # 50 kHz / 10 kHz = 5, 80 kHz / 20 kHz = 4, 300 kHz / 30 kHz = 10 samples a period
    parts = ("10 kHz", "sine", "50 kHz"), ("20 kHz", "square", "80 kHz"), ("30 kHz", "sine", "300 kHz")
    steps = [step for each in parts for step in part(*each)]
    found = drive_sampling(protocol_from({**known, "steps": steps}))
    assert found == DriveSampling(sample_rate=80e3, frequency=20e3, is_sine=False, frequency_maximum=30e3)
    sines = drive_sampling(protocol_from({**known, "steps": part("20 kHz", "sine", "100 kHz")}))
    assert sines == DriveSampling(sample_rate=100e3, frequency=20e3, is_sine=True, frequency_maximum=20e3)
    assert DriveSampling(sample_rate=1.0, frequency=1.0) == DriveSampling(
        sample_rate=1.0, frequency=1.0, is_sine=True, frequency_maximum=0.0
    )


def test_a_limit_of_the_voltage_holds_twice_for_a_peak_to_peak_monitor() -> None:
    monitor = Channel(name="voltage_peak_to_peak", quantity="voltage_peak_to_peak", lowest=-1.0, highest=200.0)
    (lock,) = interlocks_for(limits_of(), {monitor.name: monitor}, None)
    assert lock.limit == pytest.approx(60.0)
    eighty = Block(first_sample=0, sample_rate=1.0, values=np.array([[59.0], [80.0]]))
    assert first_trip(eighty, [monitor.name], [lock]) == "channel voltage_peak_to_peak is 80 V; its limit is 60 V"


@pytest.mark.parametrize("kind", [np.int8, np.int16, np.int32, np.int64])
def test_the_lowest_integer_of_a_kind_trips(kind: type[np.signedinteger[Any]]) -> None:
    lowest = np.array([[np.iinfo(kind).min]], dtype=kind)  # whose magnitude is itself in integers
    block = Block(first_sample=0, sample_rate=1.0, values=lowest)
    hot = Channel(name="temperature", quantity="temperature", lowest=-np.inf, highest=np.inf)
    assert "its limit is 100 K" in first_trip(block, ["temperature"], [Interlock(hot, 100.0)])
