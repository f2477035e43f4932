"""NI-DAQmx: errors of the driver by their numbers, rate and buffer, and waveforms of an output."""

import sys
from collections.abc import Iterator

import numpy as np
import pytest
from nidaqmx.constants import TerminalConfiguration
from nidaqmx.error_codes import DAQmxErrors
from nidaqmx.errors import DaqError
from pytest import MonkeyPatch, approx, raises
from tests.laboratory.daqmx_device import CLOCK, DaqmxDevice, install

from sonolube.errors import InvalidInput, MissingPackage
from sonolube.laboratory import DeviceError, DeviceLost, DriveSetting, SamplesLost
from sonolube.laboratory.drivers import DaqmxAcquisition, DaqmxDrive, DaqmxMotor, DriveLimits
from sonolube.laboratory.drivers.daqmx_acquisition import DaqmxAcquisitionEntry, tabulated_scale
from sonolube.laboratory.drivers.daqmx_library import daqmx_errors
from sonolube.laboratory.drivers.daqmx_output import DaqmxDriveEntry, DaqmxMotorEntry, whole_periods

LIMITS = DriveLimits(amplifier_gain=20.0, actuator_voltage=80.0, output_voltage=5.0, frequency_maximum=100e3)


@pytest.fixture
def card(monkeypatch: MonkeyPatch) -> Iterator[DaqmxDevice]:
    device = DaqmxDevice()
    install(device, monkeypatch)
    yield device
    assert device.open_tasks == 0, "a task was left to the driver"


def acquisition(wiring: str = "default") -> DaqmxAcquisition:
    gains = {"friction_force": "-2 N/V", "voltage": "-2"}
    inputs = [
        {"name": name, "input": f"ai{number}", "input_range": "5 V", "gain": gain, "wiring": wiring}
        for number, (name, gain) in enumerate(gains.items())
    ]
    entry = {"driver": "daqmx", "device": "Dev1", "sample_rate_maximum": "500 kHz", "channels": inputs}
    return DaqmxAcquisition(DaqmxAcquisitionEntry.model_validate(entry), {})


def drive(sample_rate: float = 900e3) -> DaqmxDrive:
    return DaqmxDrive(terminal="Dev1/ao0", sample_rate=sample_rate, limits=LIMITS)


def test_without_the_package_the_command_that_installs_it_is_named(monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "nidaqmx", None)
    with raises(MissingPackage, match=r"nidaqmx.*pip install nidaqmx"):
        acquisition().connect()


@pytest.mark.parametrize("device", [acquisition(), drive()], ids=lambda each: type(each).__name__)
def test_without_the_driver_the_package_says_so_and_the_remedy_is_named(
    device: DaqmxAcquisition | DaqmxDrive, monkeypatch: MonkeyPatch
) -> None:
    from nidaqmx.errors import DaqNotFoundError

    def absent(*_: object, **__: object) -> None:
        raise DaqNotFoundError("Could not find an installation of NI-DAQmx.")

    monkeypatch.setattr("nidaqmx.utils._select_interpreter", absent)
    with raises(DeviceError, match=r"driver NI-DAQmx is not installed: run `nidaqmx installdriver`"):
        device.connect()
    device.close()


def test_a_device_that_the_driver_does_not_know_is_refused_with_those_it_knows(card: DaqmxDevice) -> None:
    card.names = "Dev2, cDAQ1Mod1"
    with raises(DeviceError, match="no device 'Dev1', but Dev2, cDAQ1Mod1"):
        acquisition().connect()


@pytest.mark.parametrize(
    ("code", "error", "words"),
    [
        (-200279, SamplesLost, "not read in time"),
        (-200222, SamplesLost, "not read in time"),
        (-200361, SamplesLost, "not read in time"),
        (-200284, DeviceLost, "no samples come"),
        (-88709, DeviceLost, "does not answer"),
        (-50405, DeviceLost, "does not answer"),
        (-200324, DeviceLost, "does not answer"),
        (-201003, DeviceLost, "does not answer"),
        (-200077, DeviceError, r"simulated failure \(NI-DAQmx -200077\)$"),
    ],
)
def test_an_error_of_the_driver_is_that_of_a_device_in_one_line_with_its_number(
    code: int, error: type[DeviceError], words: str, card: DaqmxDevice
) -> None:
    here = acquisition()
    here.connect()
    here.start(["friction_force"], sample_rate=1e3)
    card.errors["read_analog_f64"] = code
    with raises(DeviceError, match=words) as failure:
        here.read(10)
    assert type(failure.value) is error
    assert str(code) in str(failure.value)
    assert "\n" not in str(failure.value)
    here.close()


LOST_SAMPLES = (
    "SAMPLES_NO_LONGER_AVAILABLE", "ACQ_STOPPED_TO_PREVENT_INPUT_BUFFER_OVERWRITE",
    "ACQ_STOPPED_TO_PREVENT_INTERMEDIATE_BUFFER_OVERFLOW", "INPUT_FIFO_OVERFLOW", "INPUT_FIFO_OVERFLOW_2",
    "INPUT_FIFO_OVERFLOW_3", "ACQ_STOPPED_TO_PREVENT_INPUT_BUFFER_OVERWRITE_ONE_DATA_XFER_MECH",
    "ACQ_STOPPED_DRIVER_CANT_XFER_DATA_FAST_ENOUGH", "PAL_TRANSFER_OVERWRITTEN",
)  # fmt: skip
GONE = (
    "DEV_ABSENT_OR_UNAVAILABLE", "INVALID_DEVICE_ID", "HARDWARE_NOT_RESPONDING", "DEVICE_REMOVED",
    "DEV_CANNOT_BE_ACCESSED", "DEVICE_NOT_USABLE_UNTIL_USB_REPLUG", "NETWORK_STATUS_CONNECTION_LOST",
    "NETWORK_STATUS_DOWN", "NETWORK_TARGET_UNREACHABLE", "NETWORK_TARGET_NOT_FOUND", "NETWORK_STATUS_TIMED_OUT",
    "DEVICE_NAME_NOT_FOUND_ROUTING", "RUNTIME_ABORTING_ROUTING", "RUNTIME_ABORTED_ROUTING",
    "DRIVER_DEVICE_GUID_NOT_FOUND_ROUTING", "DEV_ABSENT_OR_UNAVAILABLE_ROUTING", "PAL_USB_TRANSACTION_ERROR",
    "PAL_TRANSFER_ABORTED", "PAL_TRANSFER_STOPPED", "PAL_COMMUNICATIONS_FAULT", "PAL_TRANSFER_TIMED_OUT",
    "PAL_DEVICE_NOT_FOUND",
)  # fmt: skip


def test_every_error_of_a_lost_device_and_of_lost_samples_is_known_by_its_name_in_the_package() -> None:
    kinds = {**dict.fromkeys(LOST_SAMPLES, SamplesLost), **dict.fromkeys(GONE, DeviceLost)}
    for name, kind in (kinds | {"SAMPLES_NOT_YET_AVAILABLE": DeviceLost, "PAL_RESOURCE_BUSY": DeviceError}).items():
        code = DAQmxErrors[name].value
        with raises(DeviceError, match=rf"\(NI-DAQmx {code}\)") as failure, daqmx_errors("card"):
            raise DaqError("of the driver", code)
        assert type(failure.value) is kind, name
        assert str(failure.value).startswith("card: ")


@pytest.mark.parametrize("call", ["create_ai_voltage_chan", "cfg_samp_clk_timing", "start_task", "create_task"])
def test_whatever_call_fails_at_the_start_no_task_is_left(call: str, card: DaqmxDevice) -> None:
    here = acquisition()
    here.connect()
    card.errors[call] = -200077
    with raises(DeviceError, match="-200077"):
        here.start(["voltage"], sample_rate=1e3)
    card.errors.clear()
    here.start(["voltage"], sample_rate=1e3)
    here.close()


def test_the_buffer_holds_seconds_and_the_rate_is_that_of_the_clock(card: DaqmxDevice) -> None:
    here = acquisition(wiring="differential")
    here.connect()
    rate = here.start(["voltage", "friction_force"], sample_rate=30e3)
    task = card.last
    assert task is not None
    assert rate == CLOCK / round(CLOCK / 30e3) != 30e3
    assert task.buffer >= 2 * rate
    assert task.inputs == ["Dev1/ai1", "Dev1/ai0"]
    assert task.ranges == [(-5.0, 5.0)] * 2
    assert set(task.terminals) == {TerminalConfiguration.DIFF.value}
    assert here.channels["voltage"].lowest == -10.0
    assert here.channels["voltage"].highest == 10.0
    here.close()


def test_the_converter_serves_all_channels_in_turn(card: DaqmxDevice) -> None:
    here = acquisition()
    here.connect()
    here.start(["voltage"], sample_rate=500e3)
    with raises(DeviceError, match=r"samples 2 channels at up to 250 kHz"):
        here.start(["voltage", "friction_force"], sample_rate=251e3)
    with raises(DeviceError, match="each once"):
        here.start(["voltage", "voltage"], sample_rate=1e3)
    here.close()


@pytest.mark.parametrize("frequency", [50.0, 1234.5, 22e3, 44.999e3])
def test_a_repeated_buffer_has_the_frequency_and_amplitude_that_were_set(frequency: float, card: DaqmxDevice) -> None:
    here = drive()
    here.connect()
    here.drive(DriveSetting(voltage_peak_to_peak=28.0, voltage_offset=14.0, frequency=frequency))
    volts, rate = card.outputs["Dev1/ao0"], card.output_rates["Dev1/ao0"]
    spectrum = np.fft.rfft(volts) / len(volts)
    loudest = int(np.abs(spectrum[1:]).argmax()) + 1
    assert loudest * rate / len(volts) == approx(frequency, rel=1e-5)
    assert 4 * abs(spectrum[loudest]) * 20.0 == approx(28.0)
    assert spectrum[0].real * 20.0 == approx(14.0)
    here.close()
    assert card.is_off("Dev1/ao0")


def test_a_period_has_twenty_samples_and_a_buffer_a_whole_period() -> None:
    assert whole_periods(frequency=22e3, sample_rate=880e3, device="") == (25, 1000)
    with raises(DeviceError, match=r"its sample rate allows up to 45 kHz"):
        whole_periods(frequency=46e3, sample_rate=900e3, device="output")
    with raises(DeviceError, match=r"its buffer takes frequencies from 9 Hz"):
        whole_periods(frequency=2.0, sample_rate=900e3, device="output")


def test_an_output_that_could_not_be_switched_off_is_tried_again(card: DaqmxDevice) -> None:
    here = drive()
    here.connect()
    here.drive(DriveSetting(voltage_peak_to_peak=28.0, frequency=22e3))
    card.errors["write_analog_f64"] = -50401
    with raises(DeviceLost):
        here.off()
    card.errors.clear()
    here.off()
    assert card.is_off("Dev1/ao0")
    here.close()


def test_a_waveform_that_cannot_be_given_leaves_the_output_at_rest(card: DaqmxDevice) -> None:
    here = drive()
    here.connect()
    here.drive(DriveSetting(voltage_peak_to_peak=28.0, voltage_offset=20.0, frequency=22e3))
    with raises(DeviceError, match="its buffer takes"):
        here.drive(DriveSetting(voltage_peak_to_peak=28.0, frequency=1.0))
    assert card.is_off("Dev1/ao0")
    here.close()


def test_a_motor_turns_by_a_voltage_of_either_sign(card: DaqmxDevice) -> None:
    motor = DaqmxMotor(terminal="Dev1/ao1", rotation_speed_maximum=5.0, voltage_at_maximum=-8.0)
    motor.connect()
    motor.turn(2.5)
    assert card.outputs["Dev1/ao1"] == approx([-4.0])
    motor.off()
    assert card.is_off("Dev1/ao1")
    motor.close()


def test_halting_sets_0_volt_without_any_guard_and_what_hung_starts_nothing_later(card: DaqmxDevice) -> None:
    drive().halt()  # nothing is connected
    assert "Dev1/ao0" not in card.outputs
    here = drive()
    here.connect()
    here.drive(DriveSetting(voltage_peak_to_peak=28.0, frequency=22e3))
    assert not card.is_off("Dev1/ao0")
    here.halt()
    assert card.is_off("Dev1/ao0")
    assert card.calls["task_control"] == 1  # the waveform was aborted
    with raises(DeviceError, match="was switched off while a call hung"):
        here.drive(DriveSetting(voltage_peak_to_peak=28.0, frequency=22e3))
    assert card.is_off("Dev1/ao0")
    here.close()
    still = drive()
    still.connect()
    card.outputs["Dev1/ao0"] = np.ones(1)
    still.halt()
    assert card.is_off("Dev1/ao0")
    assert card.calls["task_control"] == 1  # nothing ran
    still.close()


def test_an_output_is_set_to_0_volt_when_it_is_connected_driven_by_none_and_closed(card: DaqmxDevice) -> None:
    here = drive()
    here.off()
    assert "Dev1/ao0" not in card.outputs
    with raises(DeviceError, match="connect it before driving"):
        here.drive(DriveSetting(voltage_peak_to_peak=28.0, frequency=22e3))
    card.outputs["Dev1/ao0"] = np.ones(1)
    here.connect()
    assert card.is_off("Dev1/ao0")
    assert card.last is not None
    assert card.last.ranges == [(-5.0, 5.0)]
    written = card.calls["write_analog_f64"]
    here.connect()
    assert card.calls["write_analog_f64"] == written  # once
    here.drive(DriveSetting(voltage_peak_to_peak=28.0, frequency=22e3))
    assert not card.is_off("Dev1/ao0")
    here.drive(DriveSetting(voltage_peak_to_peak=0.0, frequency=22e3))
    assert card.is_off("Dev1/ao0")
    here.drive(DriveSetting(voltage_peak_to_peak=28.0, frequency=22e3))
    here.close()
    assert card.is_off("Dev1/ao0")


def test_an_output_that_cannot_be_set_is_not_connected(card: DaqmxDevice) -> None:
    here = drive()
    card.errors["write_analog_f64"] = -200077
    with raises(DeviceError, match="-200077"):
        here.connect()
    card.errors.clear()
    with raises(DeviceError, match="connect it before driving"):
        here.drive(DriveSetting(voltage_peak_to_peak=28.0, frequency=22e3))


def test_a_motor_turns_at_most_at_its_highest_speed_and_stands_at_0_volt(card: DaqmxDevice) -> None:
    motor = DaqmxMotor(terminal="Dev1/ao1", rotation_speed_maximum=5.0, voltage_at_maximum=8.0)
    with raises(DeviceError, match="connect it before turning"):
        motor.turn(1.0)
    motor.connect()
    motor.turn(5.0 * (1 + 5e-10))
    assert card.outputs["Dev1/ao1"].max() <= 8.0
    motor.turn(1.25)
    assert card.outputs["Dev1/ao1"] == approx([2.0])
    for speed in (5.1, -0.1):
        with raises(DeviceError, match="turns at 0 to 5 1/s"):
            motor.turn(speed)
    assert card.outputs["Dev1/ao1"] == approx([2.0])
    motor.turn(0.0)
    assert card.is_off("Dev1/ao1")
    motor.close()


def test_samples_are_scaled_channel_by_channel_also_where_one_call_cannot_take_them_all(card: DaqmxDevice) -> None:
    slopes = {"Dev1/ai0": 1e-4, "Dev1/ai1": -2e-4}
    card.voltage = lambda terminal, numbers: np.asarray(slopes[terminal] * numbers, dtype=np.float64)
    here = acquisition()
    with raises(DeviceError, match="connect it before sampling"):
        here.start(["voltage"], sample_rate=1e3)
    here.connect()
    with raises(DeviceError, match="start it before reading"):
        here.read(1)
    rate = here.start(["voltage", "friction_force"], sample_rate=1e3)
    assert card.last is not None
    assert card.last.buffer == 4000  # four seconds
    block = here.read(4500)  # two calls of 2000 and one of 500
    assert card.calls["read_analog_f64"] == 3
    numbers = np.arange(4500)
    assert block.values[:, 0] == approx(-2 * -2e-4 * numbers)
    assert block.values[:, 1] == approx(-2 * 1e-4 * numbers)
    assert (block.first_sample, block.sample_rate) == (0, rate)
    assert here.read(3).first_sample == 4500
    with raises(DeviceError, match="0 samples cannot be read; at least 1"):
        here.read(0)
    here.start(["voltage"], sample_rate=100.0)
    assert card.last.buffer == 1000  # at least
    assert card.open_tasks == 1
    here.stop()
    with raises(DeviceError, match="start it before reading"):
        here.read(1)
    here.close()
    with raises(DeviceError, match="connect it before sampling"):
        here.start(["voltage"], sample_rate=1e3)


@pytest.mark.parametrize(
    ("channels", "rate", "reason"),
    [
        ([], 1e3, "needs at least one channel, each once, got none"),
        (["current"], 1e3, "unknown channel 'current'"),
        (["voltage"], 0.0, "0 Hz refused; it samples 1 channels at up to 500 kHz"),
        (["voltage"], 501e3, "501 kHz refused; it samples 1 channels at up to 500 kHz"),
    ],
)
def test_what_the_converter_cannot_sample_is_refused(
    channels: list[str], rate: float, reason: str, card: DaqmxDevice
) -> None:
    here = acquisition()
    here.connect()
    with raises(DeviceError, match=reason):
        here.start(channels, sample_rate=rate)
    here.close()


def test_an_acquisition_stands_in_words_for_the_record_and_knows_its_rates() -> None:
    inputs = [
        {"name": "friction_force", "input": "ai3", "gain": "-2 N/V", "offset": "1 N", "input_range": "5 V"},
        {"name": "normal_load", "input": "ai0", "calibration": "load.csv"},
    ]
    content = {"driver": "daqmx", "device": "Dev7", "sample_rate_maximum": "500 kHz", "channels": inputs}
    entry = DaqmxAcquisitionEntry.model_validate(content)
    assert entry.described == "NI-DAQmx Dev7: friction_force ai3 -2 N/V +-5 V; normal_load ai0 load.csv +-10 V"
    assert (entry.where, entry.reserved_as, entry.total_rate_maximum, entry.own_rate) == (
        *("Dev7", "ni-daqmx dev7", 500e3, None),
    )
    assert dict(entry.files_beside) == {"channels[2].calibration": "load.csv"}
    table = "voltage,normal_load\n-1 V,8 N\n3 V,0 N\n"
    entry.check_file("channels[2].calibration", table)
    with raises(InvalidInput, match="line 1: expected voltage,normal_load"):
        entry.check_file("channels[2].calibration", "voltage,temperature\n")
    channels = entry.new_device({"load.csv": table}).channels
    assert (channels["friction_force"].lowest, channels["friction_force"].highest) == (-9.0, 11.0)
    assert (channels["normal_load"].lowest, channels["normal_load"].highest) == (0.0, 8.0)
    own = DaqmxAcquisitionEntry.model_validate(content | {"sample_rate": "250 kHz"})
    assert (own.own_rate, own.channels[0].ranged(own.channels[0].scale({}), sample_rate=5.0).sample_rate) == (
        250e3,
        5.0,
    )
    with raises(ValueError, match="sample_rate is at most 250 kHz with 2 channels"):
        DaqmxAcquisitionEntry.model_validate(content | {"sample_rate": "251 kHz"})


def test_a_table_of_a_sensor_may_fall_and_has_two_points_at_least() -> None:
    falling = tabulated_scale("voltage,normal_load\n-1 V,8 N\n3 V,0 N\n", quantity="normal_load")
    assert falling(np.array([-2.0, 0.0, 3.0])) == approx([8.0, 6.0, 0.0])
    free = tabulated_scale("voltage,emission\n0 V,0 m/s2\n2 V,30 m/s2", quantity="emission", unit="m/s2")
    assert free(np.array([1.0])) == approx([15.0])
    with raises(InvalidInput, match="1 points; expected 2 to 9999"):
        tabulated_scale("voltage,normal_load\n-1 V,8 N\n", quantity="normal_load")
    with raises(InvalidInput, match="line 3: expected a voltage and a reading, got 3 cells"):
        tabulated_scale("voltage,normal_load\n-1 V,8 N\n0 V,1 N,2 N\n", quantity="normal_load")


def test_an_output_as_drive_gives_frequencies_of_twenty_samples_and_a_motor_needs_a_voltage() -> None:
    content = {"driver": "daqmx", "output": "Dev1/ao0", "sample_rate": "900 kHz", "voltage_maximum": "80 V"}
    entry = DaqmxDriveEntry.model_validate(content | {"frequency_maximum": "100 kHz", "amplifier_gain": 20.0})
    assert (entry.highest_frequency, entry.limits.frequency_maximum) == (45e3, 45e3)
    assert DaqmxDriveEntry.model_validate(content | {"frequency_maximum": "10 kHz"}).highest_frequency == 10e3
    assert (entry.where, entry.reserved_as, entry.guarded_output) == ("Dev1/ao0", "ni-daqmx dev1", "Dev1/ao0")
    assert entry.new_device().voltage_maximum == 80.0
    turning = {"driver": "daqmx", "output": "Dev1/ao1", "rotation_speed_maximum": "5 1/s", "groove_diameter": "50 mm"}
    motor = DaqmxMotorEntry.model_validate(turning | {"voltage_at_maximum": "-0.1 V"})
    assert (motor.voltage_at_maximum, motor.new_device().rotation_speed_maximum) == (-0.1, 5.0)
    with raises(ValueError, match=r"voltage_at_maximum must be at least 0\.1 V, of either sign"):
        DaqmxMotorEntry.model_validate(turning | {"voltage_at_maximum": "-0.09 V"})
