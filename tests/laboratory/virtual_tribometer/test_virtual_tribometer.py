"""Virtual tribometer: what it records against closed forms, and what the analysis of tests finds in it."""

from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pytest import approx, raises
from scipy.signal import welch
from tests.laboratory.faulty_acquisition import Kind, with_fault
from tests.laboratory.simulated_rig import MemoryRecord

from sonolube.errors import InvalidInput
from sonolube.facts.protocol import protocol_by_name_or_file, protocol_from
from sonolube.laboratory import Devices, DriveSetting, State, connect_devices, run_protocol
from sonolube.laboratory.devices import DeviceError, DeviceLost, SamplesLost
from sonolube.laboratory.dry_run import HeatingAssumptions, dry_run
from sonolube.laboratory.virtual_tribometer import UNDISTURBED, Disturbances, VirtualTribometer, virtual_tribometer
from sonolube.measurement.friction.rotation import hall_pulse_times
from sonolube.measurement.friction.stick_slip import estimate_stick_slip
from sonolube.measurement.friction.wobble import find_rotation_speed
from sonolube.models.thermal import EllipticSource, HeatedContact, ThermalNetwork
from sonolube.models.thermal.contact_history import contact_temperature_history
from sonolube.prediction import predict
from sonolube.rig import read_rig, thermal_solid

RIG = read_rig(Path(__file__).parents[3] / "examples" / "rigs" / "power_map.toml")
DRIVE = DriveSetting(voltage_peak_to_peak=25.9, frequency=22e3, voltage_offset=12.95)
DIAMETER = 0.028


def tribometer(sizes: Disturbances = UNDISTURBED, *, seed: int = 0) -> VirtualTribometer:
    return virtual_tribometer(RIG, seed=seed, disturbances=sizes, groove_diameter=DIAMETER)


def sliding(devices: Devices, *channels: str, speed: float = 0.0655, rate: float = 1000.0) -> None:
    connect_devices(devices)
    devices.acquisition.start(channels, sample_rate=rate)
    devices.motor.turn(speed / (np.pi * DIAMETER))


def test_without_disturbances_the_force_is_that_of_the_draw_with_and_without_vibration() -> None:
    virtual = tribometer()
    devices = virtual.devices
    sliding(devices, "friction_force")
    devices.acquisition.read(1000)
    at_rest = devices.acquisition.read(1000).values[:, 0]
    devices.drive.drive(DRIVE)
    devices.acquisition.read(100)
    vibrating = devices.acquisition.read(1000).values[:, 0]
    truth = virtual.truth()
    assert at_rest == approx(float(truth["friction_coefficient"]) * 5.0, rel=1e-6)
    assert vibrating == approx(float(truth["friction_ratio"][-1]) * at_rest, rel=1e-6)


def test_friction_over_many_specimens_has_mean_and_spread_of_the_prediction() -> None:
    ratios = []
    for seed in range(100):
        virtual = tribometer(seed=seed)
        sliding(virtual.devices, "friction_force")
        virtual.devices.drive.drive(DRIVE)
        ratios.append(float(virtual.truth()["friction_ratio"][-1]))
    drawn = predict(RIG, draws=2000)["friction_ratio"].to_numpy()
    assert np.mean(ratios) == approx(np.mean(drawn), abs=3 * np.std(drawn) / np.sqrt(len(ratios)))
    assert np.std(ratios) == approx(np.std(drawn), rel=0.4)


@pytest.mark.parametrize("sizes", [(1, 999, 7, 993, 1000), (1000, 2000), (500,) * 6])
def test_samples_do_not_depend_on_the_size_of_the_blocks(sizes: tuple[int, ...]) -> None:
    found = []
    for blocks in ((1000, 1000, 1000), sizes):
        devices = tribometer(Disturbances(), seed=3).devices
        sliding(devices, *devices.acquisition.channels, speed=0.005)
        values, taken = [], 0
        for size in blocks:
            values.append(devices.acquisition.read(size).values)
            taken += size
            if taken == 1000:
                devices.drive.drive(DRIVE)
        found.append(np.concatenate(values))
    assert np.array_equal(found[1], found[0])


def test_the_same_seed_gives_the_same_samples_and_another_seed_others() -> None:
    found = []
    for seed in (1, 1, 2):
        devices = tribometer(Disturbances(), seed=seed).devices
        sliding(devices, "friction_force")
        found.append(devices.acquisition.read(500).values)
    assert np.array_equal(found[0], found[1])
    assert not np.array_equal(found[0], found[2])


def test_the_hall_probe_turns_with_the_disc() -> None:
    devices = tribometer(replace(UNDISTURBED, magnets=4)).devices
    sliding(devices, "gaussmeter", rate=2000.0)
    devices.acquisition.read(2000)
    flux = devices.acquisition.read(20_000).values[:, 0]
    pulses = hall_pulse_times(time=np.arange(flux.size) / 2000.0, magnetic_flux_density=flux)
    turns = 0.0655 / (np.pi * DIAMETER)
    assert 1 / np.diff(pulses) / 4 == approx(turns, rel=1e-3)


def test_the_wobble_is_found_at_the_turns_of_the_disc() -> None:
    devices = tribometer(Disturbances(), seed=4).devices
    sliding(devices, "friction_force", rate=400.0)
    devices.acquisition.read(400)
    force = devices.acquisition.read(12_000).values[:, 0]
    blocks = force.reshape(-1, 8).mean(axis=1)
    found = find_rotation_speed([np.arange(blocks.size) / 50.0], [blocks], harmonics=3)
    assert found == approx(0.0655 / (np.pi * DIAMETER), rel=5e-3)


def test_stick_slip_has_its_period_and_fall_and_vanishes_with_vibration() -> None:
    sizes = replace(UNDISTURBED, static_share=0.15, holder_stiffness=2e3, holder_mass=2e-3, sensor_noise=1e-3)
    virtual = tribometer(sizes)
    devices, speed = virtual.devices, 2e-3
    sliding(devices, "friction_force", speed=speed, rate=2000.0)
    devices.acquisition.read(2000)
    force = devices.acquisition.read(20_000).values[:, 0]
    found = estimate_stick_slip(time=np.arange(force.size) / 2000.0, friction_force=force)
    truth = virtual.truth()
    fall = 2 * float(truth["static_share"] * truth["friction_coefficient"]) * 5.0
    assert found.detected
    assert 1 / found.stick_slip_frequency == approx(fall / 2e3 / speed + np.pi * 1e-3, rel=0.02)
    low, high = found.stick_slip_amplitude_interval
    assert low - 0.02 * fall <= fall <= high + 0.02 * fall
    devices.drive.drive(DRIVE)
    devices.acquisition.read(200)
    assert np.std(devices.acquisition.read(4000).values) < 0.05 * fall


def test_run_in_falls_over_the_distance_that_was_drawn() -> None:
    virtual = tribometer(replace(UNDISTURBED, run_in_share=0.2, run_in_distance=0.3))
    devices = virtual.devices
    sliding(devices, "friction_force", rate=100.0)
    force = devices.acquisition.read(4000).values[:, 0]
    truth = virtual.truth()
    distance = 0.0655 * (np.arange(force.size) / 100.0 - UNDISTURBED.motor_time)
    steady = float(truth["friction_coefficient"]) * 5.0
    expected = steady * (1 + float(truth["run_in_share"]) * np.exp(-distance / float(truth["run_in_distance"])))
    assert force[100:] == approx(expected[100:], rel=1e-3)


def test_the_actuator_warms_as_a_dry_run_says_whether_the_disc_turns_or_not() -> None:
    protocol = protocol_by_name_or_file("map_test")
    heating = dry_run(protocol, rig=RIG).heating
    assert heating is not None
    virtual = tribometer(replace(UNDISTURBED, thermocouple_time=1e-3))
    run_protocol(protocol, virtual.devices, MemoryRecord(), operator=lambda prompt: True)
    assert float(virtual.truth()["actuator_temperature_rise"]) == approx(heating.actuator_rise[-1], rel=1e-2)
    devices = tribometer(replace(UNDISTURBED, thermocouple_time=1e-3)).devices
    connect_devices(devices)
    devices.acquisition.start(["temperature"], sample_rate=10.0)
    devices.drive.drive(replace(DRIVE, voltage_peak_to_peak=28.0))
    at_rest = devices.acquisition.read(20_000).values[-1, 0]
    assert at_rest - 294.15 == approx(10.0, abs=0.1)  # D Table 2.2


def test_a_thermocouple_in_the_contact_warms_with_the_pin_and_the_flash_behind_its_lag() -> None:
    steel = HeatingAssumptions(pin_material="stainless_steel_304", disc_material="stainless_steel_304")
    sizes = replace(UNDISTURBED, contact_share=1.0, thermocouple_time=2.0)
    virtual = virtual_tribometer(RIG, seed=0, disturbances=sizes, groove_diameter=DIAMETER, heating=steel)
    sliding(virtual.devices, "temperature", rate=100.0)
    read = virtual.devices.acquisition.read(10_000).values[:, 0] - 294.15
    truth = virtual.truth()
    flash, force = float(truth["flash_temperature_rise"][-1]), float(truth["friction_force"][-1])
    solid = thermal_solid("stainless_steel_304")
    radius = np.sqrt(RIG.contact.nominal_area / np.pi)
    contact = HeatedContact(
        pin=solid,
        disc=solid,
        source=EllipticSource(half_length=radius, half_width=radius),
        network=ThermalNetwork(heat_capacity=(1.5,), links=(), losses=(0.05,)),
    )
    time = np.arange(10_001) / 100.0
    history = contact_temperature_history(contact, time=time, friction_force=force, sliding_speed=0.0655)
    expected = np.zeros(10_000)
    for step in range(1, 10_000):  # of the lag, explicitly
        middle = history.bulk_rise[step] + flash
        expected[step] = expected[step - 1] + 0.01 / 2.0 * (middle - expected[step - 1])
    assert flash > 0
    assert read[100:] == approx(expected[100:], rel=0.01)


def test_voltage_and_current_are_those_of_the_waveform_and_the_capacitance() -> None:
    devices = tribometer().devices
    sliding(devices, "voltage", "current", rate=2e6)
    devices.drive.drive(replace(DRIVE, frequency=1e3))
    voltage, current = devices.acquisition.read(20_000).values.T
    assert RIG.capacitance is not None
    assert (voltage.max() + voltage.min()) / 2 == approx(12.95, rel=1e-3)
    assert voltage.max() - voltage.min() == approx(25.9, rel=1e-3)
    assert current.max() == approx(2 * np.pi * 1e3 * RIG.capacitance * 12.95, rel=0.02)


@pytest.mark.parametrize(("kind", "error"), [("lost", DeviceLost), ("overrun", SamplesLost)])
def test_faults_of_the_hardware_come_at_their_sample(kind: Kind, error: type[DeviceError]) -> None:
    devices = with_fault(tribometer().devices, 500, kind)
    sliding(devices, "friction_force")
    devices.acquisition.read(500)
    with raises(error):
        devices.acquisition.read(1)


@pytest.mark.parametrize(("kind", "reason"), [("saturated", "saturated at 60 N"), ("no number", "gives no number")])
def test_a_broken_gauge_trips_the_limit_of_the_force(kind: Kind, reason: str) -> None:
    protocol = protocol_by_name_or_file("map_test")
    limited = protocol.model_copy(
        update={"limits": protocol.limits.model_copy(update={"friction_force_maximum": 60.0})}
    )
    devices = with_fault(tribometer().devices, 2000, kind)
    result = run_protocol(limited, devices, MemoryRecord(), operator=lambda prompt: True)
    assert (result.outcome, reason in result.reason) == ("stopped", True)


@pytest.mark.parametrize("kind", ["late", "hang"])
def test_the_supervisor_ends_a_virtual_run_that_is_late_or_hangs_with_its_outputs_off(
    kind: Kind, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sonolube.laboratory.supervision.LATE", 2.0)  # of the time of the virtual rig
    virtual = tribometer()
    devices = with_fault(virtual.devices, 2000, kind)
    result = run_protocol(protocol_by_name_or_file("map_test"), devices, MemoryRecord(), operator=lambda prompt: True)
    assert (result.outcome, result.state) == ("failed", State.SAFE)
    assert "virtual acquisition: a block is late by more than 2 s; the supervisor has told" in result.reason
    truth = virtual.truth()
    assert (float(truth["sliding_speed"][-1]), float(truth["voltage_peak_to_peak"][-1])) == (0.0, 0.0)


def test_a_virtual_drive_that_stays_on_is_seen_while_the_operator_is_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    virtual = tribometer()
    stuck = virtual.devices.drive
    monkeypatch.setattr(stuck, "off", lambda: None)
    driven = protocol_from(
        {
            "title": "test",
            "source": "test",
            "limits": {"voltage_maximum": "30 V", "duration_maximum": "1 min"},
            "steps": [
                {"kind": "drive", "voltage_peak_to_peak": "20 V", "frequency": "22 kHz"},
                {"kind": "wait", "duration": "1 s"},
                {"kind": "prompt", "task": "load", "text": "Add a weight."},
            ],
        }
    )
    result = run_protocol(driven, virtual.devices, MemoryRecord(), operator=lambda prompt: True)
    assert "the drive was switched off, but channel voltage" in result.reason


def test_devices_refuse_what_they_cannot_give() -> None:
    devices = tribometer().devices
    connect_devices(devices)
    with raises(DeviceError, match="250 V is refused; it gives 0 to 200 V"):
        devices.drive.drive(DriveSetting(voltage_peak_to_peak=500.0, frequency=22e3))
    with raises(DeviceError, match="30 1/s is refused; it turns at 0 to 20 1/s"):
        devices.motor.turn(30.0)
    with raises(DeviceError, match="no channel noise"):
        devices.acquisition.start(["noise"], sample_rate=100.0)
    with raises(DeviceError, match="call start first"):
        devices.acquisition.read(1)


def test_wear_grows_with_the_distance() -> None:
    virtual = tribometer()
    sliding(virtual.devices, "friction_force")
    virtual.devices.acquisition.read(10_000)
    assert float(virtual.truth()["sliding_distance"]) == approx(0.0655 * (10 - UNDISTURBED.motor_time), rel=1e-3)
    ten = float(virtual.truth()["wear_volume"])
    virtual.devices.acquisition.read(10_000)
    assert float(virtual.truth()["wear_volume"]) == approx(ten * 20 / 10, rel=0.01)


def test_every_value_of_the_truth_has_a_unit() -> None:
    virtual = tribometer(Disturbances())
    sliding(virtual.devices, "friction_force")
    truth = virtual.truth()
    assert [name for name in truth.data_vars if not truth[name].attrs.get("units")] == []
    assert {each.name for each in fields(Disturbances)} <= set(truth.data_vars)


def test_sliding_begins_with_the_peak_of_static_friction() -> None:
    virtual = tribometer(replace(UNDISTURBED, static_share=0.35))
    sliding(virtual.devices, "friction_force", rate=20_000.0)
    force = virtual.devices.acquisition.read(20_000).values[:, 0]
    truth = virtual.truth()
    steady = float(truth["friction_coefficient"]) * 5.0
    assert force.max() == approx((1 + float(truth["static_share"])) * steady, rel=0.02)
    assert force[5000:] == approx(steady, rel=1e-6)


def test_the_arm_rings_at_the_resonance_of_the_rigs_structure() -> None:
    virtual = tribometer(replace(UNDISTURBED, ringing=0.02))
    sliding(virtual.devices, "friction_force", rate=1000.0)
    virtual.devices.acquisition.read(1000)
    force = virtual.devices.acquisition.read(200_000).values[:, 0]
    frequency, power = welch(force, fs=1000.0, nperseg=2000)
    arm = np.sqrt(4.56e5 / 0.602)  # examples/rigs/power_map.toml; a stack of 2e9 N/m holds the reaction mass
    assert frequency[np.argmax(power[1:]) + 1] == approx(arm / (2 * np.pi), rel=0.03)
    assert float(virtual.truth()["arm_damping_ratio"]) == approx(90 / (2 * 0.602 * arm), rel=0.03)


@pytest.mark.parametrize(
    "changed", [{"wobble_1": -0.1}, {"noise_time": 0.0}, {"run_in_share": -1.0}, {"contact_share": 2}]
)
def test_disturbances_out_of_their_range_are_refused(changed: dict[str, Any]) -> None:
    with raises(InvalidInput, match=next(iter(changed))):
        replace(Disturbances(), **changed)
