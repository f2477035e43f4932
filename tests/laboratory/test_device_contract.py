"""What every rig does, whatever its devices are: the runner relies on it."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, suppress
from pathlib import Path

import numpy as np
import pytest
from pytest import approx, raises
from tests.laboratory.rig_stand_ins import HARDWARE, StandIn
from tests.laboratory.simulated_rig import MemoryRecord, SimulatedRig

from sonolube.facts.protocol import Protocol, protocol_from
from sonolube.laboratory import DeviceError, DeviceLost, Devices, DriveSetting, State, run_protocol
from sonolube.laboratory.virtual_tribometer import virtual_tribometer
from sonolube.rig import read_rig

TRIBOMETER = Path(__file__).parents[2] / "examples" / "rigs" / "tribometer.toml"

SETTING = DriveSetting(voltage_peak_to_peak=28.0, voltage_offset=10.0, frequency=22e3)
CHANNELS = ("temperature", "friction_force")

# Further rigs that the contract holds for, one a line: a name, and what makes the devices.
SIMULATED: Mapping[str, Callable[[], Devices]] = {
    "noting": lambda: SimulatedRig().devices(),
    "virtual": lambda: virtual_tribometer(read_rig(TRIBOMETER), seed=1).devices,
}
HOLDING_LIMITS = HARDWARE.keys() | (SIMULATED.keys() - {"noting"})

Rig = AbstractContextManager[StandIn]


@pytest.fixture
def stand_in(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[StandIn]:
    with HARDWARE[request.param](tmp_path) as rig:
        yield rig


@pytest.fixture
def devices(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Devices]:
    if request.param in SIMULATED:
        yield SIMULATED[request.param]()
    else:
        with HARDWARE[request.param](tmp_path) as rig:
            yield rig.devices


every_rig = pytest.mark.parametrize("devices", [*HARDWARE, *SIMULATED], indirect=True)
every_limited_rig = pytest.mark.parametrize("devices", sorted(HOLDING_LIMITS), indirect=True)
every_stand_in = pytest.mark.parametrize("stand_in", HARDWARE, indirect=True)


def connect(devices: Devices) -> None:
    for device in (devices.drive, devices.motor, devices.acquisition):
        device.connect()


@every_rig
def test_connecting_stopping_and_closing_twice_do_no_harm(devices: Devices) -> None:
    for _ in range(2):
        connect(devices)
    devices.drive.off()
    devices.motor.off()
    for _ in range(2):
        devices.acquisition.stop()
        for device in (devices.drive, devices.motor, devices.acquisition):
            device.close()
    connect(devices)
    devices.drive.drive(SETTING)


@every_limited_rig
def test_nothing_runs_and_nothing_is_read_before_it_was_connected_and_started(devices: Devices) -> None:
    devices.drive.off()
    devices.motor.off()
    for act in (
        lambda: devices.drive.drive(SETTING),
        lambda: devices.motor.turn(1.0),
        lambda: devices.acquisition.start(CHANNELS, sample_rate=1e3),
        lambda: devices.acquisition.read(1),
    ):
        with raises(DeviceError, match=r"connect|start"):
            act()
    connect(devices)
    with raises(DeviceError, match="start"):
        devices.acquisition.read(1)


@every_rig
def test_blocks_follow_one_another_by_the_counter_from_zero_at_the_rate_that_was_returned(devices: Devices) -> None:
    connect(devices)
    for _ in range(2):
        rate = devices.acquisition.start(CHANNELS, sample_rate=3333.0)
        assert rate == approx(3333.0, rel=1e-3)
        expected = 0
        for samples in (1, 7, 50, 20_000):
            block = devices.acquisition.read(samples)
            assert (block.first_sample, block.sample_rate, block.values.shape) == (expected, rate, (samples, 2))
            expected = block.next_sample
        devices.acquisition.stop()


@every_limited_rig
def test_settings_beyond_the_limits_are_refused_and_change_nothing(devices: Devices) -> None:
    connect(devices)
    most, fastest = devices.drive.voltage_maximum, devices.motor.rotation_speed_maximum
    for voltage, offset in ((2.1 * most, 0.0), (most, 0.6 * most), (most, -0.6 * most), (-1.0, 0.0), (np.nan, 0.0)):
        with raises(DeviceError, match="refused"):
            devices.drive.drive(DriveSetting(voltage_peak_to_peak=voltage, voltage_offset=offset, frequency=22e3))
    for frequency in (0.0, -1.0, 1e12, np.nan):
        with raises(DeviceError, match="refused"):
            devices.drive.drive(DriveSetting(voltage_peak_to_peak=1.0, frequency=frequency))
    for speed in (1.01 * fastest, -0.1, np.nan):
        with raises(DeviceError, match="refused"):
            devices.motor.turn(speed)
    with raises(DeviceError, match="no_channel"):
        devices.acquisition.start(["no_channel"], sample_rate=1e3)
    with raises(DeviceError, match="refused"):
        devices.acquisition.start(CHANNELS, sample_rate=1e9)


@every_stand_in
def test_whatever_ran_before_is_off_after_connecting(stand_in: StandIn) -> None:
    stand_in.was_on()
    connect(stand_in.devices)
    assert (stand_in.voltage(), stand_in.rotation_speed()) == (0.0, 0.0)


@every_stand_in
def test_actuator_and_disc_get_what_was_set_until_they_are_off_or_closed(stand_in: StandIn) -> None:
    drive, motor = stand_in.devices.drive, stand_in.devices.motor
    connect(stand_in.devices)
    for end in ("off", "close"):
        drive.connect()
        motor.connect()
        for waveform in ("sine", "square", "triangle", "sawtooth", "sine"):
            drive.drive(DriveSetting(voltage_peak_to_peak=28.0, voltage_offset=10.0, frequency=1e4, waveform=waveform))
            assert stand_in.voltage() == approx(24.0, abs=0.01)
        drive.drive(DriveSetting(voltage_peak_to_peak=160.0, frequency=22e3))
        assert stand_in.voltage() == approx(80.0, rel=0.01)
        motor.turn(2.5)
        assert stand_in.rotation_speed() == approx(2.5)
        getattr(drive, end)()
        getattr(motor, end)()
        assert (stand_in.voltage(), stand_in.rotation_speed()) == (0.0, 0.0)


@every_stand_in
def test_no_voltage_and_no_speed_are_off(stand_in: StandIn) -> None:
    connect(stand_in.devices)
    stand_in.devices.drive.drive(SETTING)
    stand_in.devices.motor.turn(1.0)
    stand_in.devices.drive.drive(DriveSetting(voltage_peak_to_peak=0.0, frequency=22e3))
    stand_in.devices.motor.turn(0.0)
    assert (stand_in.voltage(), stand_in.rotation_speed()) == (0.0, 0.0)


@every_stand_in
def test_samples_are_in_si_by_gain_offset_and_calibration_in_the_order_asked_for(stand_in: StandIn) -> None:
    acquisition = stand_in.devices.acquisition
    connect(stand_in.devices)
    acquisition.start(("temperature", "friction_force", "normal_load"), sample_rate=1e3)
    acquisition.read(10)
    temperature, friction, load = acquisition.read(5).values.T
    numbers = np.arange(10, 15)
    assert temperature == approx(273.15 + 100 * (4 + 1e-3 * numbers))  # K, 100 K/V above 0 degC
    assert friction == approx(4 * 1e-3 * numbers - 0.012)  # N, 4 N/V at ai0
    assert load == approx(1.962 / 1.015 * (1.013 + 1e-3 * numbers), rel=0.02)  # N, between the points of the table


@every_stand_in
def test_lost_devices_say_so_and_tell_that_they_could_not_be_switched_off_but_close(stand_in: StandIn) -> None:
    devices = stand_in.devices
    connect(devices)
    devices.acquisition.start(CHANNELS, sample_rate=1e3)
    devices.drive.drive(SETTING)
    devices.motor.turn(1.0)
    stand_in.unplug()
    for act in (
        lambda: devices.acquisition.read(5),
        lambda: devices.drive.drive(DriveSetting(voltage_peak_to_peak=20.0, frequency=22e3)),
        lambda: devices.motor.turn(2.0),
    ):
        with raises(DeviceLost, match="does not answer"):
            act()
    for device in (devices.drive, devices.motor):
        for _ in range(2):  # the second call must not take the device for one that was never connected
            with raises(DeviceError):
                device.off()
    devices.acquisition.stop()
    for each in (devices.drive, devices.motor, devices.acquisition):
        each.close()


def protocol(**limits: str) -> Protocol:
    return protocol_from(
        {
            "title": "Short test",
            "source": "test",
            "limits": {"voltage_maximum": "60 V", "duration_maximum": "1 min"} | limits,
            "steps": [
                {"kind": "motor_speed", "rotation_speed": "60 rpm"},
                {
                    "kind": "acquire",
                    "channels": ["friction_force", "temperature"],
                    "sample_rate": "1 kHz",
                    "duration": "1 s",
                },
                {
                    "kind": "voltage_steps",
                    "voltages": ["10 V", "20 V"],
                    "step_duration": "0.3 s",
                    "frequency": "22 kHz",
                    "unipolar": True,
                },
                {"kind": "wait", "duration": "0.4 s"},
            ],
        }
    )


@every_stand_in
def test_a_protocol_runs_to_its_end_and_leaves_everything_off(stand_in: StandIn) -> None:
    record = MemoryRecord()
    result = run_protocol(protocol(), stand_in.devices, record, operator=lambda _: True)
    assert (result.state, result.outcome, result.reason) == (State.SAFE, "completed", "")
    assert record.samples() == [1000]
    assert (stand_in.voltage(), stand_in.rotation_speed()) == (0.0, 0.0)


@every_stand_in
def test_a_run_that_loses_samples_ends_with_everything_off_and_keeps_those_before(stand_in: StandIn) -> None:
    def overrun(doing: str, *_: int) -> None:
        if "wait" in doing:
            stand_in.overrun()

    record = MemoryRecord()
    result = run_protocol(protocol(), stand_in.devices, record, operator=lambda _: True, advance=overrun)
    assert (result.state, result.outcome) == (State.SAFE, "failed")
    assert "samples were not read in time and are lost (NI-DAQmx -200279)" in result.reason
    assert 600 < sum(record.samples()) < 1000
    assert (stand_in.voltage(), stand_in.rotation_speed()) == (0.0, 0.0)


@every_stand_in
def test_a_run_whose_devices_are_lost_says_that_they_may_be_on(stand_in: StandIn) -> None:
    def unplug(doing: str, *_: int) -> None:
        if "wait" in doing:
            stand_in.unplug()

    record = MemoryRecord()
    result = run_protocol(protocol(), stand_in.devices, record, operator=lambda _: True, advance=unplug)
    assert (result.state, result.outcome) == (State.FAILED, "failed")
    assert record.notes[-1][0] == "not off"
    with suppress(DeviceError):
        stand_in.devices.drive.off()
