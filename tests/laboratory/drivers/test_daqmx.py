"""NI-DAQmx: errors of the driver by their numbers, rate and buffer, and waveforms of an output."""

import sys
from collections.abc import Iterator

import numpy as np
import pytest
from nidaqmx.constants import TerminalConfiguration
from pytest import MonkeyPatch, approx, raises
from tests.laboratory.daqmx_device import CLOCK, DaqmxDevice, install

from sonolube.errors import MissingPackage
from sonolube.laboratory import DeviceError, DeviceLost, DriveSetting, SamplesLost
from sonolube.laboratory.drivers import DaqmxAcquisition, DaqmxDrive, DaqmxMotor, DriveLimits
from sonolube.laboratory.drivers.daqmx_acquisition import DaqmxAcquisitionEntry
from sonolube.laboratory.drivers.daqmx_output import whole_periods

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
