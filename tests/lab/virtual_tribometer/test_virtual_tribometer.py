"""Virtual tribometer: what it records against closed forms, and what the analysis of tests finds in it."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pytest import approx, raises
from tests.lab.simulated_rig import MemoryRecord

from sonolube.lab import Devices, DriveSetting, run_protocol
from sonolube.lab.devices import DeviceError, DeviceLost, SamplesLost
from sonolube.lab.virtual_tribometer import UNDISTURBED, Disturbances, Fault, VirtualTribometer, virtual_tribometer
from sonolube.measurement.friction.rotation import hall_pulse_times
from sonolube.measurement.friction.stick_slip import estimate_stick_slip
from sonolube.measurement.friction.wobble_search import find_rotation_speed
from sonolube.prediction import predict
from sonolube.protocol import protocol_by_name_or_file
from sonolube.rig import friction_point, read_rig

RIG = read_rig(Path(__file__).parents[3] / "examples" / "rigs" / "power_map.toml")
DRIVE = DriveSetting(voltage_peak_to_peak=25.9, frequency=22e3, voltage_offset=12.95)
DIAMETER = 0.028


def tribometer(sizes: Disturbances = UNDISTURBED, *, seed: int = 0, fault: Fault | None = None) -> VirtualTribometer:
    return virtual_tribometer(RIG, seed=seed, disturbances=sizes, groove_diameter=DIAMETER, fault=fault)


def sliding(devices: Devices, *channels: str, speed: float = 0.0655, rate: float = 1000.0) -> None:
    for device in (devices.drive, devices.motor, devices.acquisition):
        device.connect()
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
    assert at_rest == approx(truth.attrs["friction_coefficient"] * 5.0, rel=1e-6)
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


@pytest.mark.parametrize("sizes", [(3000,), (1000, 2000), (1, 999, 7, 993, 1000)])
def test_samples_do_not_depend_on_the_size_of_the_blocks(sizes: tuple[int, ...]) -> None:
    channels = ("friction_force", "normal_load", "voltage", "current", "temperature", "gaussmeter")
    found = []
    for blocks in ((3000,), sizes):
        devices = tribometer(Disturbances(stick_slip_share=0.1), seed=3).devices
        sliding(devices, *channels)
        found.append(np.concatenate([devices.acquisition.read(size).values for size in blocks]))
    assert found[1] == approx(found[0], rel=1e-9, abs=1e-9)


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


def test_stick_slip_has_the_period_of_its_fall_over_stiffness_and_speed_and_vanishes_with_vibration() -> None:
    sizes = replace(UNDISTURBED, stick_slip_share=0.3, holder_stiffness=2e3, sensor_noise=1e-3)
    virtual = tribometer(sizes)
    devices, speed = virtual.devices, 2e-3
    sliding(devices, "friction_force", speed=speed, rate=2000.0)
    devices.acquisition.read(2000)
    force = devices.acquisition.read(20_000).values[:, 0]
    found = estimate_stick_slip(time=np.arange(force.size) / 2000.0, friction_force=force)
    truth = virtual.truth().attrs
    fall = truth["stick_slip_share"] * truth["friction_coefficient"] * 5.0
    assert found.detected
    assert 1 / found.stick_slip_frequency == approx(fall / 2e3 / speed, rel=0.02)
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
    truth = virtual.truth().attrs
    distance = 0.0655 * (np.arange(force.size) / 100.0 - UNDISTURBED.motor_time)
    steady = truth["friction_coefficient"] * 5.0
    expected = steady * (1 + truth["run_in_share"] * np.exp(-distance / truth["run_in_distance"]))
    assert force[100:] == approx(expected[100:], rel=1e-3)


def test_the_actuator_warms_to_its_heat_times_resistance() -> None:
    sizes = replace(UNDISTURBED, thermal_time=1.0)
    devices = tribometer(sizes).devices
    sliding(devices, "temperature", rate=100.0)
    devices.drive.drive(DRIVE)
    temperature = devices.acquisition.read(1000).values[:, 0]
    rise = temperature[-1] - 295.0
    power = friction_point(RIG).actuator_power
    assert power is not None
    assert rise == approx(power * sizes.heat_share * sizes.thermal_resistance, rel=1e-3)
    assert temperature[100] - 295.0 == approx(rise * (1 - np.exp(-1.0)) / (1 - np.exp(-10.0)), rel=1e-2)


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
def test_faults_of_the_hardware_come_at_their_sample(kind: str, error: type[DeviceError]) -> None:
    devices = tribometer(fault=Fault(500, kind)).devices  # type: ignore[arg-type]
    sliding(devices, "friction_force")
    devices.acquisition.read(500)
    with raises(error):
        devices.acquisition.read(1)


@pytest.mark.parametrize(("kind", "reason"), [("saturated", "saturated at 25 N"), ("no number", "gives no number")])
def test_a_broken_gauge_trips_the_limit_of_the_force(kind: str, reason: str) -> None:
    protocol = protocol_by_name_or_file("map_test")
    limited = protocol.model_copy(
        update={"limits": protocol.limits.model_copy(update={"friction_force_maximum": 25.0})}
    )
    virtual = tribometer(fault=Fault(2000, kind))  # type: ignore[arg-type]
    result = run_protocol(limited, virtual.devices, MemoryRecord(), operator=lambda prompt: True)
    assert (result.outcome, reason in result.reason) == ("stopped", True)


def test_devices_refuse_what_they_cannot_give() -> None:
    devices = tribometer().devices
    for device in (devices.drive, devices.motor, devices.acquisition):
        device.connect()
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
    truth = virtual.truth().attrs
    assert truth["sliding_distance"] == approx(0.0655 * (10 - UNDISTURBED.motor_time), rel=1e-3)
    ten = truth["wear_volume"]
    virtual.devices.acquisition.read(10_000)
    assert virtual.truth().attrs["wear_volume"] == approx(ten * 20 / 10, rel=0.01)
