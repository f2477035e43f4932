"""Plan of a hold: voltages and samples by hand, its limits, its channels and its protocol."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from pytest import raises
from tests.same import approx

from sonolube.design.control import (
    Amplifier,
    ControlDesign,
    ControlSettings,
    FrictionCharacteristic,
    FrictionController,
    Process,
    tuned_controller,
)
from sonolube.errors import InvalidInput
from sonolube.facts.protocol import Limits, flattened
from sonolube.laboratory import Channel
from sonolube.laboratory.block import quantity_of
from sonolube.laboratory.closed_loop import FrictionHold, SpeedStep
from sonolube.laboratory.closed_loop.plan import hold_protocol, planned_hold, recorded_channels
from sonolube.models.actuator.drive import Drive

LINE = FrictionCharacteristic(level=np.array([0.0, 30.0]), friction_force=np.array([1.0, 0.1]))
START = (SpeedStep(time=0.0, sliding_speed=0.02),)


def controller(interval: float = 0.05) -> FrictionController:
    process = Process(time_constant=5e-3, dead_time=0.0, sample_interval=interval)
    return tuned_controller(LINE, process, level_maximum=30.0)


def hold(**changes: Any) -> FrictionHold:
    limits = Limits.model_validate({"voltage_maximum": "33 V", "duration_maximum": "100 s"})
    wanted = FrictionHold(
        controller=controller(), friction_force=0.55, frequency=22e3, speeds=START, duration=5.0, limits=limits
    )
    return replace(wanted, **changes)


@pytest.mark.parametrize(("ratio", "volts"), [(0.5, 30.0), (-0.25, 22.5), (0.0, 15.0)])
def test_the_greatest_voltage_is_half_the_swing_and_the_magnitude_of_the_offset(ratio: float, volts: float) -> None:
    assert hold(offset_ratio=ratio).voltage_maximum == approx(volts)  # of 30 V peak to peak


def test_an_interval_has_a_whole_number_of_samples_within_a_thousandth() -> None:
    assert hold().samples_per_interval(1000.0) == 50
    assert hold().samples_per_interval(1000.9) == 50
    assert hold().samples_per_interval(999.1) == 50
    for rate in (1002.0, 998.0, 9.9, 30.0):
        with raises(InvalidInput, match=rf"sample_rate {rate:g} Hz makes .* samples in an interval of 0\.05 s"):
            hold().samples_per_interval(rate)
    assert hold().samples_per_interval(20.0) == 1


def test_the_drive_is_a_sine_at_the_rate_of_the_acquisition() -> None:
    sampling = hold(sample_rate=4000.0).drive_sampling
    assert (sampling.sample_rate, sampling.frequency, sampling.is_sine) == (4000.0, 22e3, True)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"averaging": 1.01}, "averaging must be above 0 and at most 1, got 1.01"),
        ({"duration": 0.0}, "duration must be positive"),
        ({"run_in": -1.0}, "run_in must not be negative"),
        ({"friction_force": -1.0}, "friction_force must not be negative"),
        ({"offset_ratio": float("nan")}, "offset_ratio"),
        ({"speeds": (*START, SpeedStep(time=0.0, sliding_speed=0.1))}, r"order of time, got times \[0.0, 0.0\]"),
        ({"speeds": (*START, *(SpeedStep(time=t, sliding_speed=0.1) for t in (2.0, 1.0)))}, "order of time"),
    ],
)
def test_a_hold_without_meaning_is_refused_by_name(changes: dict[str, Any], message: str) -> None:
    with raises(InvalidInput, match=message):
        hold(**changes)
    assert hold(averaging=1.0, run_in=0.0, friction_force=0.0).run_in == 0.0


def test_a_negative_time_or_speed_of_a_step_is_refused() -> None:
    for values in ({"time": -1.0, "sliding_speed": 0.0}, {"time": 0.0, "sliding_speed": -1.0}):
        with raises(InvalidInput, match="must not be negative"):
            SpeedStep(**values)


def channels(*names: str) -> dict[str, Channel]:
    return {name: Channel(name=name, quantity=quantity_of(name)) for name in names}


def test_the_channels_of_the_analysis_and_those_of_limits_are_recorded_once_each() -> None:
    known = channels("current", "gaussmeter", "voltage", "friction_force", "temperature")
    assert recorded_channels(hold(), known) == ("friction_force", "voltage", "temperature", "gaussmeter")
    limits = hold().limits.model_copy(update={"temperature_maximum": 350.0})
    known |= {"pin": Channel(name="pin", quantity="temperature")}
    found = recorded_channels(hold(limits=limits), known)
    assert found == ("friction_force", "voltage", "temperature", "gaussmeter", "pin")


def test_the_protocol_of_a_hold_records_throughout_and_sets_each_speed_after_the_run_in() -> None:
    steps = (*START, SpeedStep(time=2.0, sliding_speed=0.05), SpeedStep(time=5.0 - 1e-9, sliding_speed=0.01))
    protocol = hold_protocol(hold(speeds=steps, run_in=1.5), channels("friction_force", "current"))
    assert protocol.title == "Friction held at 550 mN"
    assert protocol.limits.voltage_maximum == 33.0
    points = flattened(protocol)
    told = [(point.kind, round(point.time, 6), point.sliding_speed) for point in points]
    assert told == [
        ("acquire", 0.0, 0.0),
        ("motor_speed", 0.0, 0.02),
        ("wait", 0.0, 0.02),
        ("motor_speed", 3.5, 0.05),
        ("wait", 3.5, 0.05),
        ("motor_speed", 6.5, 0.01),  # too late for a wait
        ("end", 6.5, 0.0),
    ]
    assert (points[0].channels, points[0].sample_rate, points[0].recorded_until) == (("friction_force",), 2000.0, 6.5)


def planned(*, interval: float = 0.05, **drive: Any) -> FrictionHold:
    settings = ControlSettings(amplifier=Amplifier(voltage_maximum=28.0), sample_interval=interval, duration=8.0)
    found = SimpleNamespace(controller=controller(interval), friction_force=0.4)
    return planned_hold(
        Drive(**({"frequency": 21e3, "voltage_peak_to_peak": 28.0, "voltage_offset": -7.0} | drive)),
        cast(ControlDesign, found),
        speeds=START,
        settings=settings,
        run_in=1.5,
        temperature=340.0,
        force=3.0,
    )


def test_the_limits_of_a_planned_hold_have_a_tenth_of_headroom_over_the_voltage_and_none_over_the_time() -> None:
    found = planned()
    # offset a quarter of the swing: 1.1 (0.25 + 0.5) 30 V = 24.75 V; 1.5 s + 8 s
    assert found.limits.voltage_maximum == approx(24.75)
    assert (found.limits.duration_maximum, found.duration, found.run_in) == (approx(9.5), 8.0, 1.5)
    assert (found.limits.temperature_maximum, found.limits.friction_force_maximum) == (340.0, 3.0)
    assert found.limits.current_maximum is None
    assert (found.offset_ratio, found.frequency, found.friction_force) == (approx(-0.25), 21e3, 0.4)
    assert found.speeds == START


@pytest.mark.parametrize(("interval", "rate"), [(0.05, 2000.0), (0.0009, 2 / 0.0009), (0.0006, 2 / 0.0006)])
def test_a_planned_hold_samples_whole_intervals_at_two_kilohertz_or_more(interval: float, rate: float) -> None:
    assert planned(interval=interval).sample_rate == approx(rate)


def test_a_drive_without_a_voltage_has_no_offset() -> None:
    still = planned(voltage_peak_to_peak=None, voltage_offset=0.0)
    assert (still.offset_ratio, still.limits.voltage_maximum) == (0.0, approx(16.5))  # 1.1 * 0.5 * 30 V
