"""Plan of a run: set points against devices by hand, checked values in words, and the facts of its record."""

from collections.abc import Mapping
from dataclasses import replace
from math import pi
from pathlib import Path
from typing import Any

import pytest
from pytest import approx, raises
from tests.laboratory.simulated_rig import SimulatedRig

from sonolube.errors import InvalidInput, SeveralFaults
from sonolube.facts.protocol import Check, Protocol, SetPoint, flattened, protocol_from
from sonolube.laboratory import Channel, Devices, DriveSetting
from sonolube.laboratory.interlocks import DriveSampling, RunLimits, recorded_channels, run_limits
from sonolube.laboratory.records import read_run
from sonolube.laboratory.run_plan import (
    CheckedValue,
    RunRequest,
    _faults,
    begin_record,
    drive_setting,
    groove_diameter,
    highest_of_steps,
    impossibilities,
    planned_run,
    rotation_speed,
    speed_checks,
)
from sonolube.rig import read_rig

RIG = Path(__file__).parents[2] / "examples" / "rigs" / "power_map.toml"
WAIT = {"kind": "wait", "duration": "1 s"}


def protocol(*steps: Mapping[str, Any], metadata: Mapping[str, Any] | None = None, **limits: str) -> Protocol:
    known = {"voltage_maximum": "200 V", "duration_maximum": "1 min"} | limits
    content = {"title": "a test", "source": "s", "limits": known, "steps": list(steps or [WAIT])}
    return protocol_from(content | ({"metadata": dict(metadata)} if metadata else {}))


def drive(volts: float, offset: float = 0.0) -> dict[str, Any]:
    swing, mean = f"{volts!r} V", f"{offset!r} V"
    return {"kind": "drive", "voltage_peak_to_peak": swing, "voltage_offset": mean, "frequency": "22 kHz"}


def turn(speed: str) -> dict[str, Any]:
    return {"kind": "motor_speed", "rotation_speed": speed}


def acquire(*channels: str) -> dict[str, Any]:
    return {"kind": "acquire", "channels": list(channels), "sample_rate": "100 Hz", "duration": "1 s"}


FORCE = Check(quantity="friction_force", lowest="1 N", highest="3 N")


@pytest.mark.parametrize(
    ("value", "holds"), [(0.999, False), (1.0, True), (2.0, True), (3.0, True), (3.001, False), (None, False)]
)
def test_a_checked_value_holds_within_its_bounds_and_at_them(value: float | None, holds: bool) -> None:
    assert CheckedValue(check=FORCE, value=value).holds is holds


def test_a_checked_value_that_does_not_hold_says_what_it_is_and_what_was_wanted() -> None:
    assert CheckedValue(check=FORCE, value=3.5).reason == "check of friction_force: 3.5 N, wanted 1 N to 3 N"
    unmeasured = "check of friction_force: no channel measures it; wanted 1 N to 3 N"
    assert CheckedValue(check=FORCE, value=None).reason == unmeasured
    as_set = "as it is set: no channel rotation_speed measures it"
    turning = CheckedValue(check=Check(quantity="sliding_speed", lowest="0.1 m/s"), value=0.05, is_set=True)
    assert turning.reason == f"check of sliding_speed: 50 mm/s ({as_set}), wanted 0.1 m/s to any"
    cold = CheckedValue(check=Check(quantity="temperature", highest="300 K"), value=301.0)
    assert cold.reason == "check of temperature: 301 K, wanted any to 300 K"
    assert CheckedValue(check=FORCE, value=2.0).facts == {"quantity": "friction_force", "value": 2.0}
    assert turning.facts == {"quantity": "sliding_speed", "value": 0.05, "basis": as_set}


def test_the_checks_of_a_speed_are_told_once_each() -> None:
    steps: list[dict[str, Any]] = [
        {"kind": "check", "quantity": "temperature", "highest": "40 degC"},
        {"kind": "check", "quantity": "rotation_speed", "highest": "4 1/s"},
        {"kind": "repeat", "count": 2, "steps": [{"kind": "check", "quantity": "sliding_speed", "highest": "1 m/s"}]},
    ]
    assert speed_checks(protocol(*steps)) == ("2", "3.1")


def test_the_disc_turns_as_it_is_told_or_by_the_circumference_of_the_groove() -> None:
    point = SetPoint(time=0.0, step="1", kind="motor_speed", sliding_speed=0.3)
    assert rotation_speed(point, 0.05) == approx(0.3 / (pi * 0.05))
    assert rotation_speed(replace(point, rotation_speed=2.0, sliding_speed=None), 0.05) == 2.0
    assert rotation_speed(replace(point, sliding_speed=None), 0.05) == 0.0
    rig = SimulatedRig().devices()
    assert groove_diameter(protocol(), rig) == 0.05
    assert groove_diameter(protocol(metadata={"groove_diameter": "28 mm"}), rig) == 0.028


def test_the_drive_of_a_set_point_is_none_without_a_voltage_or_frequency() -> None:
    point = SetPoint(time=0.0, step="1", kind="drive", voltage_peak_to_peak=20.0, voltage_offset=-3.0, frequency=1e3)
    wanted = DriveSetting(voltage_peak_to_peak=20.0, voltage_offset=-3.0, frequency=1e3, waveform="square")
    assert drive_setting(replace(point, waveform="square")) == wanted
    assert drive_setting(replace(point, frequency=None)) is None
    assert drive_setting(replace(point, voltage_peak_to_peak=0.0)) is None


def test_of_each_step_and_kind_the_fault_of_the_highest_value_is_told() -> None:
    faults = [("1", "voltage", 5.0, "a"), ("2", "voltage", 9.0, "b"), ("1", "speed", 1.0, "c")]
    more = [("1", "voltage", 7.0, "d"), ("1", "voltage", 6.0, "e"), ("1", "voltage", 7.0, "f")]
    assert highest_of_steps([*faults, *more]) == ("d", "b", "c")


def test_voltages_and_speeds_beyond_the_devices_are_told_where_a_step_changes_to_them() -> None:
    # the drive gives 100 V, the motor 10 turns a second; both just reached are possible
    rig = SimulatedRig().devices()
    assert impossibilities(protocol(drive(200.0), turn("10 1/s"), WAIT), rig) == ()
    steps = (drive(100.0, -60.0), turn("12 1/s"), WAIT, turn("11 1/s"), drive(210.0), WAIT)
    assert impossibilities(protocol(*steps), rig) == (
        "step 1: the drive reaches 110 V; simulated rig gives at most 100 V",
        "step 2: needs 12 1/s; simulated rig turns at most at 10 1/s",
        "step 4: needs 11 1/s; simulated rig turns at most at 10 1/s",
        "step 5: the drive reaches 105 V; simulated rig gives at most 100 V",
    )
    at_once = protocol({"kind": "motor_speed", "sliding_speed": "2 m/s"}, WAIT)
    assert impossibilities(at_once, rig) == ("step 1: needs 12.7 1/s; simulated rig turns at most at 10 1/s",)


def test_channels_that_are_missing_are_told_by_the_step_that_records_them() -> None:
    rig = SimulatedRig().devices()
    known = "it has friction_force, voltage, current, temperature, gaussmeter"
    assert impossibilities(protocol(acquire("voltage", "normal_load"), WAIT), rig) == (
        f"step 1: simulated rig has no channel normal_load; {known}",
    )
    assert impossibilities(protocol(acquire("displacement", "normal_load"), WAIT), rig) == (
        f"step 1: simulated rig has no channels displacement, normal_load; {known}",
    )

    class Slow(SimulatedRig):
        @property
        def channels(self) -> Mapping[str, Channel]:
            return {"oil": Channel(name="oil", quantity="temperature", sample_rate=5.0)}

    beside = replace(rig, further={"slow": Slow()})
    alone = impossibilities(protocol(acquire("oil"), WAIT), beside)
    assert alone == ("step 1: records no channel of simulated rig; add one",)
    assert impossibilities(protocol(acquire("oil", "voltage"), WAIT), beside) == ()


def test_a_missing_channel_counts_as_no_value_beside_the_fault_of_its_step() -> None:
    wanted = protocol(acquire("normal_load"), WAIT)
    (fault,) = _faults(flattened(wanted)[0], None, SimulatedRig().devices(), 0.05)
    assert fault[:3] == ("1", "channels", 0.0)
    (none_of_its_own,) = _faults(
        flattened(wanted)[0], None, replace(SimulatedRig().devices(), further={"slow": Loaded()}), 0.05
    )
    assert none_of_its_own[:3] == ("1", "channels", 0.0)


class Loaded(SimulatedRig):
    """A further acquisition with a channel of the load."""

    @property
    def channels(self) -> Mapping[str, Channel]:
        return {"normal_load": Channel(name="normal_load", quantity="normal_load", sample_rate=5.0)}


def test_one_impossibility_is_refused_by_itself_and_several_together() -> None:
    rig = SimulatedRig().devices()
    planned_run(protocol(), rig)
    with raises(InvalidInput) as one:
        planned_run(protocol(drive(202.0), WAIT), rig)
    assert str(one.value) == "step 1: the drive reaches 101 V; simulated rig gives at most 100 V"
    assert not isinstance(one.value, SeveralFaults)
    with raises(SeveralFaults) as two:
        planned_run(protocol(drive(202.0), WAIT, friction_force_maximum="30 N"), rig)
    assert two.value.faults == (
        "limits.friction_force_maximum of 30 N lies beyond the range of channel friction_force, 20 N",
        "step 1: the drive reaches 101 V; simulated rig gives at most 100 V",
    )


def test_what_a_run_does_not_show_of_its_drive_is_told_by_recorded_and_watched_channels() -> None:
    rig = SimulatedRig().devices()
    few = "resolve the drive (fewer than five samples a period)"
    forces = protocol(acquire("friction_force"), drive(20.0), WAIT, voltage_maximum="100 V")
    assert unresolved(forces, rig) == f"voltage at 100 Hz does not {few}"  # which its limit watches
    current = protocol(acquire("current"), drive(20.0), WAIT, voltage_maximum="100 V")
    assert unresolved(current, rig) == f"voltage and current at 100 Hz do not {few}"
    assert unresolved(protocol(WAIT, voltage_maximum="100 V"), rig) == ""
    fast = DriveSampling(sample_rate=1e6, frequency=22e3)
    assert run_limits(forces.limits, rig, fast).unresolved(recorded_channels(forces), rig.channels) == ""


def test_the_plan_of_a_run_has_its_limits_and_first_setting_once() -> None:
    rig = SimulatedRig().devices()
    steps = acquire("friction_force"), turn("2 1/s"), drive(20.0), WAIT, drive(30.0), WAIT
    plan = planned_run(protocol(*steps, voltage_maximum="100 V"), rig)
    assert plan.first_setting == DriveSetting(voltage_peak_to_peak=20.0, frequency=22e3)
    assert (plan.limits.frequency, plan.groove_diameter, plan.idle_rate) == (22e3, 0.05, 100.0)
    assert [(lock.channel.name, lock.limit) for lock in plan.limits.locks] == [("voltage", 100.0)]
    assert [(what, lock.channel.name, lock.limit) for what, lock in plan.limits.off] == [("drive", "voltage", 5.0)]
    undriven = planned_run(protocol(acquire("friction_force"), WAIT), rig)
    assert (undriven.first_setting, undriven.limits.frequency) == (None, 0.0)


def unresolved(read: Protocol, devices: Devices) -> str:
    return planned_run(read, devices).limits.unresolved(recorded_channels(read), devices.channels)


def limits_of(request: RunRequest, devices: Devices) -> RunLimits:
    return planned_run(request.protocol, devices).limits


SPECIMEN = {"specimen": "A3", "operator": "D", "humidity": "45 %", "run": 4}
METADATA = {**SPECIMEN, "normal_load": "3 N", "groove_diameter": "28 mm"}


def test_the_record_of_a_plan_has_its_files_and_everything_that_is_known_of_it(tmp_path: Path) -> None:
    rig = replace(read_rig(RIG), pin_material="brass_c36000", disc_material="stainless_steel_304")
    map_file = tmp_path / "bench.toml"
    map_file.write_text("title = 'bench'\n")
    request = RunRequest(
        protocol=protocol(metadata=METADATA, voltage_maximum="100 V"),
        name="map_test",
        rig=rig,
        device_file=map_file,
        seed=7,
        tags=("map", "first"),
        facts={"operator": "E", "calibrated": "2026-03-01"},
    )
    devices = replace(SimulatedRig().devices(), description={"rig": "simulated", "drive hardware": "x"})
    recorder = begin_record(request, devices, limits_of(request, devices), out=tmp_path / "runs", facts={"queue": 3})
    run = read_run(recorder.finish("completed").folder)
    assert run.summary.title == "a test"
    assert set(run.known.files) == {"protocol.toml", "devices.toml"}  # a rig that was changed has no file
    assert dict(run.facts) == {
        "protocol": "map_test",
        "simulated": True,
        "device_rig": "simulated",
        "device_drive_hardware": "x",
        "late_maximum": 2.0,
        "groove_diameter": 0.028,
        "vibration_direction": "normal",
        "specimen": "A3",
        "operator": "E",  # what is told for the run goes before the protocol
        "humidity": "45 %",
        "run": 4,
        "calibrated": "2026-03-01",
        "normal_load": 3.0,
        "tags": "map, first",
        "seed": 7,
        "rig_title": rig.title,
        "nominal_area": approx(0.126e-6),
        "pin_material": "brass_c36000",
        "disc_material": "stainless_steel_304",
        "rig": "bench",
        "queue": 3,
    }


def test_the_record_of_a_plan_without_rig_tags_or_simulation_has_none_of_their_facts(tmp_path: Path) -> None:
    request = RunRequest(protocol=protocol(voltage_maximum="100 V"), name="t", rig=None)
    devices = replace(SimulatedRig().devices(), simulated=False)
    run = read_run(begin_record(request, devices, limits_of(request, devices), out=tmp_path).finish("completed").folder)
    assert dict(run.facts) == {
        "protocol": "t",
        "simulated": False,
        "device_rig": "simulated",
        "late_maximum": 2.0,
        "groove_diameter": 0.05,
    }
    assert set(run.known.files) == {"protocol.toml"}
    of_rig = RunRequest(protocol=protocol(voltage_maximum="100 V"), name="t", rig=read_rig(RIG))
    with_rig = read_run(
        begin_record(of_rig, devices, limits_of(of_rig, devices), out=tmp_path).finish("completed").folder
    )
    assert with_rig.facts["normal_load"] == 5.0
    assert set(with_rig.known.files) == {"protocol.toml", "rig.toml"}
