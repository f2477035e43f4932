"""Planned run by hand: loads of the drive, samples, heat over unequal steps, contents of steps, and assumptions."""

from dataclasses import replace
from math import exp, pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.facts.protocol import Protocol, SetPoint, protocol_from
from sonolube.laboratory.devices import DriveSetting
from sonolube.laboratory.dry_run import HeatingAssumptions, drive_load, dry_run
from sonolube.laboratory.dry_run.record import DriveLoad, DryRun, PlannedPoint, heating_over, rubbed_contact
from sonolube.rig import Rig, operating_points, power_to_supply, read_rig, thermal_solid

RIGS = Path(__file__).parents[3] / "examples" / "rigs"
ASSUMED = HeatingAssumptions(
    pin_heat_capacity=2.0,
    pin_conductance=0.5,
    actuator_heat_capacity=12.0,
    actuator_conductance=0.4,
    loss_factor=0.1,
    ambient_temperature=300.15,
    pin_material="stainless_steel_304",
    disc_material="brass_c36000",
)


@pytest.fixture(scope="module")
def power_map() -> Rig:
    return read_rig(RIGS / "power_map.toml")


def protocol(*steps: dict[str, Any], **metadata: str) -> Protocol:
    limits = {"voltage_maximum": "100 V", "duration_maximum": "10 h"}
    content = {"title": "t", "source": "s", "limits": limits, "steps": list(steps)}
    return protocol_from(content | ({"metadata": metadata} if metadata else {}))


def wait(text: str, **more: str) -> dict[str, Any]:
    return {"kind": "wait", "duration": text, **more}


SLIDE = {"kind": "motor_speed", "sliding_speed": "50 mm/s"}
DRIVE = {"kind": "drive", "voltage_peak_to_peak": "20 V", "voltage_offset": "10 V", "frequency": "22 kHz"}


def test_a_drive_that_is_off_loads_nothing_and_a_sine_by_its_capacitance() -> None:
    off = drive_load(None, capacitance=1e-6)
    assert (off.peak_current, off.slew_rate, off.power.power_to_supply, off.capacitive_power) == (0.0, 0.0, 0.0, 0.0)
    setting = DriveSetting(voltage_peak_to_peak=20.0, voltage_offset=-6.0, frequency=1e3)
    found = drive_load(setting, capacitance=1e-6)
    assert found.peak_current == approx(pi * 1e3 * 1e-6 * 20.0)
    # D 1.9 with the peak voltage of 16 V: twice it times the mean current of a half period, f C U
    without = drive_load(replace(setting, voltage_offset=6.0), capacitance=1e-6)
    centred = drive_load(replace(setting, voltage_offset=0.0), capacitance=1e-6)
    assert found.power.power_to_supply == approx(without.power.power_to_supply)
    assert found.power.power_to_supply / centred.power.power_to_supply == approx(16.0 / 10.0)
    assert found.power.text == "at least 320 mW"  # 1 uF 16 V 20 V 1 kHz; the heat of the motion is not known
    moving = drive_load(setting, capacitance=1e-6, dissipated_power=2.5, peak_current=0.4)
    assert (moving.power.text, moving.power.peak_current) == ("2.5 W", 0.4)
    assert moving.peak_current == approx(found.peak_current)  # of the capacitance
    for capacitance in (0.0, -1e-6):
        with raises(InvalidInput, match="capacitance must be positive"):
            drive_load(None, capacitance=capacitance)


def planned(time: float, lasts: float, power: float | None, **more: Any) -> PlannedPoint:
    supplied = power_to_supply(charging_power=power, dissipated_power=0.0)
    assert supplied is not None
    load = None if power is None else DriveLoad(peak_current=1.0, slew_rate=1.0, power=supplied, capacitive_power=power)
    return PlannedPoint(setting=SetPoint(time=time, step="1", kind="wait"), duration=lasts, load=load, **more)


def test_heat_is_summed_over_steps_of_their_own_lengths() -> None:
    points = (
        planned(0.0, 8.0, 30.0, friction_force=2.0, sliding_speed=0.5),
        planned(8.0, 0.0, 99.0, friction_force=9.0, sliding_speed=9.0),
        planned(8.0, 2.0, None, friction_force=None, sliding_speed=None),
        planned(10.0, 5.0, 10.0, friction_force=1.0, sliding_speed=0.2),
    )
    found = heating_over(points, bodies=None, assumed=ASSUMED)
    assert found is not None
    assert found.frictional_heat == approx(2.0 * 0.5 * 8.0 + 1.0 * 0.2 * 5.0)
    assert found.actuator_heat == approx(0.1 * (30.0 * 8.0 + 10.0 * 5.0))
    assert (found.contact_rise, found.pin_rise, found.ambient_temperature) == (None, None, 300.15)
    # 400 parts of 15 s: 8 s are 214, at most 200; 2 s are 54; 5 s are 134
    assert found.time.size == 1 + 200 + 54 + 134
    assert found.time[[0, 200, 254, 388]] == approx([0.0, 8.0, 10.0, 15.0])
    warm = 0.1 * 30.0 / 0.4 * (1 - exp(-8 / 30))  # 12 J/K over 0.4 W/K: 30 s
    assert found.actuator_rise[200] == approx(warm)
    assert found.actuator_rise[254] == approx(warm * exp(-2 / 30))
    assert heating_over(points[1:2], bodies=None, assumed=ASSUMED) is None


def test_pin_and_contact_warm_by_the_heat_of_friction_of_each_step() -> None:
    pin, disc = thermal_solid("stainless_steel_304"), thermal_solid("brass_c36000")
    bodies = rubbed_contact(pin, disc, nominal_area=pi * 0.5e-3**2, assumed=ASSUMED)
    assert (bodies.source.half_length, bodies.source.half_width) == approx((0.5e-3, 0.5e-3))
    points = (planned(0.0, 40.0, 0.0, friction_force=2.0, sliding_speed=0.5), planned(40.0, 4.0, 0.0))
    found = heating_over(points, bodies=bodies, assumed=ASSUMED)
    assert found is not None
    assert found.pin_rise is not None
    assert found.contact_rise is not None
    at_stop = int(np.argmin(np.abs(found.time - 40.0)))
    assert found.pin_rise[-1] / found.pin_rise[at_stop] == approx(exp(-4 / 4))  # 2 J/K over 0.5 W/K
    assert found.contact_rise[at_stop] > found.pin_rise[at_stop] > 0
    assert found.contact_rise[-1] == approx(found.pin_rise[-1])


def recorded(lasts: float, rate: float | None, *channels: str) -> PlannedPoint:
    setting = SetPoint(
        time=5.0,
        step="1",
        kind="acquire",
        sets=("record",),
        channels=channels,
        sample_rate=rate,
        recorded_until=5.0 + lasts,
    )
    return PlannedPoint(setting=setting, duration=1.0, load=None)


def test_samples_are_those_of_each_recording_and_channel_and_bytes_eight_each() -> None:
    points = recorded(0.1, 333.0, "a", "b"), recorded(2.0, 10.0, "a"), planned(9.0, 1.0, 3.0)
    found = DryRun(protocol=protocol(wait("1 s")), rig_title="", points=points, duration=1.0, prompt_time=0.0)
    assert [point.recorded for point in points] == approx([0.1, 2.0, 0.0])
    assert (found.samples, found.bytes) == (2 * 33 + 20, 8 * 86)
    assert len(found.recordings) == 2
    assert found.amplifier_energy is None
    known = replace(found, points=(planned(0.0, 2.0, 3.0), planned(2.0, 5.0, 7.0)))
    assert known.amplifier_energy == approx(41.0)


def test_each_step_says_what_it_asks_checks_or_waits_for() -> None:
    steps: list[dict[str, Any]] = [
        {"kind": "prompt", "task": "load", "text": "Hang it."},
        {"kind": "check", "quantity": "friction_force", "lowest": "1 N", "otherwise": "note"},
        {"kind": "check", "quantity": "temperature", "highest": "40 degC"},
        wait("2 s", reason="to settle"),
        {"kind": "motor_speed", "rotation_speed": "2 1/s"},
        wait("3 s"),
    ]
    found = dry_run(protocol(*steps, groove_diameter="28 mm"), rig=None)
    told = [(point.setting.kind, point.content, point.duration, point.sliding_speed) for point in found.points]
    turning = approx(pi * 0.028 * 2.0)
    assert told == [
        ("prompt", "load: Hang it.", 0.0, 0.0),
        ("check", "friction_force from 1 N to any, else note", 0.0, 0.0),
        ("check", "temperature from any to 40 degC, else stop", 0.0, 0.0),
        ("wait", "to settle", 2.0, 0.0),
        ("motor_speed", "", 0.0, turning),
        ("wait", "", 3.0, turning),
        ("end", "motor and drive off", 0.0, 0.0),
    ]
    assert (found.duration, found.prompt_time, found.rig_title, found.heating) == (5.0, 60.0, "", None)
    assert dict(found.assumptions) == {
        "supervisor": "on devices, motor and drive are switched off where a block is late by more than 2 s",
        "prompts": "load 1 min",
    }
    unknown = dry_run(protocol(*steps[4:]), rig=None)
    assert [point.sliding_speed for point in unknown.points] == [None, None, 0.0]
    stopped = dry_run(protocol({"kind": "motor_speed", "rotation_speed": "0 1/s"}, wait("1 s")), rig=None)
    assert [point.sliding_speed for point in stopped.points] == [0.0, 0.0, 0.0]


def test_friction_and_amplitude_are_those_of_the_rig_at_the_load_of_the_protocol(power_map: Rig) -> None:
    steps = SLIDE, wait("1 s"), DRIVE, wait("1 s"), {"kind": "motor_speed", "sliding_speed": "0 m/s"}, wait("1 s")
    found = dry_run(protocol(*steps, normal_load="4 N"), rig=power_map, heating=ASSUMED)
    at = operating_points(
        power_map,
        normal_load=4.0,
        voltage_peak_to_peak=np.array([20.0]),
        voltage_offset=np.array([10.0]),
        frequency=np.array([22e3]),
        sliding_speed=np.array([0.05]),
    )
    force, amplitude = float(at.friction_force[0]), float(at.vibration_amplitude[0])
    intrinsic = 0.178 * 4.0
    assert [point.friction_force for point in found.points] == approx(
        [intrinsic, intrinsic, force, force, 0.0, 0.0, 0.0]
    )
    assert [point.vibration_amplitude for point in found.points] == approx(
        [0.0, 0.0, amplitude, amplitude, amplitude, amplitude, 0.0]
    )
    assert [point.load.peak_current for point in found.points if point.load] == approx(
        [0.0, 0.0, *[pi * 22e3 * 360e-9 * 20.0] * 4, 0.0]
    )
    supplied = float(at.power_to_supply[0])
    assert supplied == approx(float(at.dissipated_power[0]), rel=1e-12)
    assert [point.load.power.power_to_supply for point in found.points if point.load] == approx(
        [0.0, 0.0, *[supplied] * 4, 0.0]
    )
    assert any("with that of the computed motion they reach" in line for line in found.caveats)
    assert found.heating is not None
    assert found.heating.frictional_heat == approx((intrinsic + force) * 0.05)
    assert f"amplitude {at.amplitude_origin}; friction by {power_map.friction_model.name}" in found.caveats
    assert not any("states no load" in line for line in found.caveats)


def test_a_rig_stands_in_for_a_load_that_the_protocol_does_not_state(power_map: Rig) -> None:
    found = dry_run(protocol(SLIDE, wait("1 s")), rig=power_map, heating=ASSUMED)
    assert found.points[0].friction_force == approx(0.178 * 5.0)
    assert found.caveats[0] == "the protocol states no load; taken is the rig's, 5 N"
    assert found.rig_title == power_map.title
    assert not any("friction by" in line for line in found.caveats)  # nothing vibrates


def test_the_assumptions_of_heat_are_told_with_their_values(power_map: Rig) -> None:
    ask = [{"kind": "prompt", "task": task, "text": "Do."} for task in ("load", "cleaning", "load")]
    found = dry_run(protocol(*ask, SLIDE, wait("1 s")), rig=power_map, heating=ASSUMED)
    assert dict(found.assumptions) == {
        "supervisor": "on devices, motor and drive are switched off where a block is late by more than 2 s",
        "prompts": "load 1 min, cleaning 5 min",
        "pin": "one temperature, 2 J/K, loses 0.5 W/K",
        "actuator": "one temperature, 12 J/K, loses 0.4 W/K (time constant 30 s); 0.1 of its reactive power becomes"
        " heat, the 10 K of D Table 2.2 under cooling air",
        "start": "all at 27 degC; prompts take no time",
    }
    assert found.prompt_time == 60.0 + 300.0 + 60.0


def test_materials_of_the_protocol_stand_in_for_those_that_nobody_else_knows(power_map: Rig) -> None:
    nobody = replace(ASSUMED, pin_material=None, disc_material=None)
    told = {"pin_material": " Stainless Steel 304 ", "disc_material": "Brass C36000"}
    by_protocol = dry_run(protocol(SLIDE, wait("1 s"), **told), rig=power_map, heating=nobody).heating
    by_assumption = dry_run(protocol(SLIDE, wait("1 s")), rig=power_map, heating=ASSUMED).heating
    assert by_protocol is not None
    assert by_assumption is not None
    assert by_protocol.contact_rise is not None
    assert by_protocol.contact_rise == approx(by_assumption.contact_rise)
    half = dry_run(protocol(SLIDE, wait("1 s"), pin_material="steel 304"), rig=power_map, heating=nobody)
    assert half.heating is not None
    assert half.heating.contact_rise is None
    assert any(line.startswith("temperature of the contact is left out: ") for line in half.caveats)
    none = dry_run(protocol(SLIDE, wait("1 s")), rig=power_map, heating=nobody)
    missing = "temperature of the contact is left out: the material of the pin is not known; give metadata.pin_material"
    assert missing in none.caveats


@pytest.mark.parametrize(
    "changed",
    [{name: 0.0} for name in ("pin_heat_capacity", "pin_conductance", "actuator_conductance", "ambient_temperature")],
)
def test_a_heat_capacity_conductance_or_temperature_of_zero_is_refused(changed: dict[str, Any]) -> None:
    with raises(InvalidInput, match=f"{next(iter(changed))} must be positive"):
        replace(ASSUMED, **changed)
    with raises(InvalidInput, match="loss_factor must not be negative"):
        replace(ASSUMED, loss_factor=-0.1)
    assert replace(ASSUMED, loss_factor=0.0).loss_factor == 0.0


def test_the_loads_that_prompts_state_are_those_of_what_follows(power_map: Rig) -> None:
    def load(text: str) -> dict[str, Any]:
        return {"kind": "prompt", "task": "load", "text": "Hang it.", "normal_load": text}

    steps = [load("3 N"), SLIDE, wait("1 s"), load("6 N"), wait("1 s"), DRIVE, wait("1 s"), load("0 N"), wait("1 s")]
    found = dry_run(protocol(*steps), rig=power_map)
    forces = {point.setting.step: point.friction_force for point in found.points}
    coefficient = power_map.friction_coefficient
    assert [forces["3"], forces["5"], forces["9"]] == approx([3 * coefficient, 6 * coefficient, 0.0])
    alone = operating_points(
        power_map, normal_load=6.0, voltage_peak_to_peak=20.0, voltage_offset=10.0, frequency=22e3, sliding_speed=0.05
    )
    assert forces["7"] == approx(float(alone.friction_force))
    assert not [each for each in found.caveats if "states no load" in each]
    assert [each for each in dry_run(protocol(SLIDE, wait("1 s")), rig=power_map).caveats if "states no load" in each]
