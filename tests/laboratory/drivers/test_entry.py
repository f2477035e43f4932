"""Sections of a device map and limits of outputs: voltages, gains and names by hand."""

from dataclasses import replace
from datetime import date
from math import inf

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.laboratory.block import Block, Channel, Sensor
from sonolube.laboratory.devices import DeviceError, DriveSetting, SamplesLost, require_gapless
from sonolube.laboratory.drivers.daqmx_library import daqmx_resource
from sonolube.laboratory.drivers.daqmx_output import whole_periods
from sonolube.laboratory.drivers.driver_table import _listed
from sonolube.laboratory.drivers.entry import ChannelEntry, DriveLimits, require_speed, si_gain
from sonolube.laboratory.drivers.visa_connection import visa_resource

LIMITS = DriveLimits(amplifier_gain=20.0, actuator_voltage=150.0, output_voltage=6.0, frequency_maximum=50e3)
SETTING = DriveSetting(voltage_peak_to_peak=100.0, voltage_offset=-40.0, frequency=22e3)


def test_the_greatest_voltage_is_that_of_the_actuator_or_of_output_and_amplifier() -> None:
    assert LIMITS.voltage_maximum == 120.0  # 6 V times 20
    assert replace(LIMITS, output_voltage=8.0).voltage_maximum == 150.0


def test_the_output_gives_the_voltage_at_the_actuator_over_the_gain() -> None:
    assert LIMITS.output_of(SETTING, device="d") == approx((5.0, -2.0))


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"voltage_offset": -70.1}, "d: 120 V at the actuator refused; it gives at most 120 V"),
        ({"voltage_offset": 80.0}, "d: 130 V at the actuator refused; it gives at most 120 V"),
        ({"voltage_peak_to_peak": -1.0}, "at the actuator refused"),
        ({"frequency": 50.1e3}, "d: 50.1 kHz refused; it gives frequencies up to 50 kHz"),
        ({"frequency": 0.0}, "d: 0 Hz refused; it gives frequencies up to 50 kHz"),
        ({"waveform": "noise"}, "d: no waveform 'noise'; it gives sine, square, triangle, sawtooth"),
    ],
)
def test_settings_beyond_a_limit_are_refused_and_those_at_it_are_not(
    changes: dict[str, float | str], reason: str
) -> None:
    with raises(DeviceError) as refusal:
        LIMITS.output_of(replace(SETTING, **changes), device="d")  # type: ignore[arg-type]
    assert reason in str(refusal.value)
    at_it = replace(SETTING, voltage_offset=70.0, frequency=50e3)
    assert LIMITS.output_of(at_it, device="d") == approx((5.0, 3.5))


def test_a_motor_turns_from_rest_to_its_highest_speed() -> None:
    for speed in (0.0, 2.5, 10.0):
        require_speed(rotation_speed=speed, highest=10.0, device="m")
    for speed in (-0.1, 10.1):
        with raises(DeviceError, match=rf"m: {speed:g} 1/s refused; it turns at 0 to 10 1/s"):
            require_speed(rotation_speed=speed, highest=10.0, device="m")


@pytest.mark.parametrize(
    ("gain", "offset", "unit", "expected"),
    [
        ("20 N/V", "-3 N", "N", (20.0, -3.0)),
        ("5 mV/V", "2 mV", "V", (5e-3, 2e-3)),
        ("100 (m/s2)/V", None, "m/s2", (100.0, 0.0)),
        ("3 1/V", "0.5", "", (3.0, 0.5)),
    ],
)
def test_gain_and_offset_are_read_in_si(
    gain: str, offset: str | None, unit: str, expected: tuple[float, float]
) -> None:
    assert si_gain(gain, offset, unit=unit) == approx(expected)
    with raises(InvalidInput, match="gain must not be 0"):
        si_gain("0 N/V", None, unit="N")


def test_a_channel_has_the_quantity_of_its_name_or_its_own_and_its_limit_in_si() -> None:
    plain = ChannelEntry(name="friction_force", limit="40 N")
    assert plain.channel(lowest=-20.0, highest=50.0, sample_rate=5.0) == Channel(
        name="friction_force", quantity="friction_force", lowest=-20.0, highest=50.0, limit=40.0, sample_rate=5.0
    )
    free = ChannelEntry(name="ae", quantity="acoustic_emission", unit="V")
    assert (free.kind, free.si_unit, free.limit_value) == ("acoustic_emission", "V", inf)
    assert free.channel() == Channel(name="ae", quantity="acoustic_emission", free_unit="V")
    pin = ChannelEntry(name="pin", quantity="temperature", limit="100 degC")
    assert pin.channel().limit == approx(373.15)


def test_a_standard_channel_has_the_name_that_every_rig_uses_and_heat_and_limits_are_watched_at_rest() -> None:
    force = Channel(name="friction_force", quantity="friction_force")
    assert (force.is_standard, force.unit, force.is_watched_at_rest) == (True, "N", False)
    assert replace(force, limit=5.0).is_watched_at_rest
    pin = Channel(name="pin", quantity="temperature")
    assert (pin.is_standard, pin.unit, pin.is_watched_at_rest) == (False, "K", True)
    assert not Channel(name="voltage", quantity="temperature").is_standard
    assert Channel(name="ae", quantity="emission", free_unit="V").unit == "V"


def test_a_block_that_begins_elsewhere_than_expected_has_lost_samples() -> None:
    block = Block(first_sample=40, sample_rate=20.0, values=np.zeros((3, 2)))
    assert (block.samples, block.next_sample, block.start) == (3, 43, 2.0)
    require_gapless(block, 40, device="d")
    with raises(SamplesLost, match="d: 7 samples are missing after sample 33"):
        require_gapless(block, 33, device="d")


@pytest.mark.parametrize(
    ("waveform", "values"),
    [
        ("sine", (0.0, 1.0, 0.0, -1.0, 0.70710678)),
        ("square", (1.0, 1.0, -1.0, -1.0, 1.0)),
        ("triangle", (0.0, 1.0, 0.0, -1.0, 0.5)),
        ("sawtooth", (0.0, 0.5, -1.0, -0.5, 0.25)),
    ],
)
def test_waveforms_lie_between_minus_one_and_one_with_the_phase_of_a_sine(
    waveform: str, values: tuple[float, ...]
) -> None:
    setting = replace(SETTING, waveform=waveform)
    phase = np.array([0.0, 0.25, 0.5, 0.75, 0.125])
    assert setting.wave(phase) == approx(values, abs=1e-8)
    assert setting.wave(phase + 3.0) == approx(values, abs=1e-8)


@pytest.mark.parametrize(
    ("frequency", "rate", "expected"),
    [
        (1e3, 50e3, (20, 1000)),  # 50 samples a period
        (2.5e3, 50e3, (50, 1000)),  # just twenty
        (15.0, 50e3, (3, 10_000)),  # 3333.3 samples a period: three of them
        (22e3, 1e6, (22, 1000)),
        (13.0, 50e3, (13, 50_000)),
    ],
)
def test_a_buffer_holds_whole_periods_and_a_thousand_samples_at_least(
    frequency: float, rate: float, expected: tuple[int, int]
) -> None:
    assert whole_periods(frequency=frequency, sample_rate=rate, device="d") == expected


def test_frequencies_that_a_buffer_cannot_repeat_are_refused_with_those_it_can() -> None:
    with raises(DeviceError, match=r"d: 2\.51 kHz refused; its sample rate allows up to 2\.5 kHz"):
        whole_periods(frequency=2510.0, sample_rate=50e3, device="d")
    with raises(DeviceError, match=r"d: 300 mHz refused; its buffer takes frequencies from 500 mHz"):
        whole_periods(frequency=0.3, sample_rate=50e3, device="d")


@pytest.mark.parametrize(
    ("resource", "name"),
    [
        ("ASRL3::INSTR", "serial 3"),
        ("ASRLCOM3::INSTR", "serial 3"),
        ("COM3", "serial 3"),
        (r"\\.\COM12", "serial 12"),
        ("ASRL/dev/does-not-exist::INSTR", "serial /dev/does-not-exist"),
        ("TCPIP::Host::5025::SOCKET", "tcpip host 5025"),
        ("TCPIP0::host::inst0::INSTR", "tcpip host"),
        ("TCPIP::host::INSTR", "tcpip host"),
        ("TCPIP::host::inst1::INSTR", "tcpip host inst1"),
        ("USB0::0x0957::0x2C07::MY1::0::INSTR", "usb 2391 11271 my1"),
        ("USB::2391::11271::MY1::INSTR", "usb 2391 11271 my1"),
        ("USB::2391::11271::MY1::2::INSTR", "usb 2391 11271 my1 2"),
        ("GPIB::7::INSTR", "gpib0 7"),
        ("GPIB1::0x0a::INSTR", "gpib1 10"),
    ],
)
def test_each_way_to_write_an_address_has_one_name(resource: str, name: str) -> None:
    assert visa_resource(resource) == name


def test_a_device_of_ni_daqmx_is_named_without_its_terminal() -> None:
    assert (daqmx_resource("Dev1/ao0"), daqmx_resource("Dev1")) == ("NI-DAQmx Dev1".lower(), "ni-daqmx dev1")


def test_names_are_listed_with_or_before_the_last() -> None:
    assert (_listed(["a"]), _listed(["a", "b"]), _listed(["a", "b", "c"])) == ("a", "a or b", "a, b or c")


@pytest.mark.parametrize(
    ("stated", "reason"),
    [
        ({"calibrated": "March 2026"}, "calibrated must be a date such as 2026-03-01, got 'March 2026'"),
        ({"uncertainty": "0.5 degC"}, "uncertainty 0.5 degC is a temperature; expected a temperature difference"),
        ({"uncertainty": "0 K"}, "uncertainty must be positive, got 0 K"),
        ({"uncertainty": "1 N"}, "uncertainty 1 N is a force"),
    ],
)
def test_a_sensor_has_a_date_and_an_uncertainty_in_the_unit_of_its_channel(stated: dict[str, str], reason: str) -> None:
    with raises(ValueError, match=reason):
        ChannelEntry.model_validate({"name": "temperature", **stated})
    told: dict[str, object] = {
        "identifier": "TC-1",
        "calibrated": date(2026, 3, 1),
        "uncertainty": "500 mK",
    }  # a date as TOML has it
    sensor = ChannelEntry.model_validate({"name": "temperature", **told}).channel(calibration="gain 1 K/V").sensor
    assert sensor == Sensor(identifier="TC-1", calibration="gain 1 K/V", calibrated="2026-03-01", uncertainty=0.5)
