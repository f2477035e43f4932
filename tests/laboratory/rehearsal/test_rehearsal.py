"""Devices of a device map on a virtual rig: channels of the map, readings by hand, faults found or recorded."""

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pytest import MonkeyPatch, approx, raises
from tests.laboratory.simulated_rig import MemoryRecord

from sonolube.errors import InvalidInput
from sonolube.facts.protocol import Protocol, protocol_from
from sonolube.laboratory import RunState, run_protocol
from sonolube.laboratory.devices import DeviceError, Devices, DriveSetting
from sonolube.laboratory.drivers import DeviceMap, read_device_map
from sonolube.laboratory.drivers.daqmx_acquisition import DaqmxAcquisition
from sonolube.laboratory.drivers.visa_connection import VisaConnection
from sonolube.laboratory.records import new_run, read_run
from sonolube.laboratory.rehearsal import FAULTS, Rehearsal, faults_named, rehearsal
from sonolube.laboratory.virtual_tribometer import UNDISTURBED, pace
from sonolube.laboratory.virtual_tribometer.streams import Stream
from sonolube.rig import Rig, read_rig

EXAMPLES = Path(__file__).parents[3] / "examples"
LAB = EXAMPLES / "lab"
STEP = 2 * 5 / 2**16  # V, of 16 bits over +-5 V

PROTOCOL = """title = "drive at rest"
source = "test"
[limits]
voltage_maximum = "60 V"
duration_maximum = "60 s"
temperature_maximum = "100 degC"
[metadata]
thermocouple = "actuator"
[[steps]]
kind = "acquire"
channels = ["friction_force", "temperature", "voltage"]
sample_rate = "20 kHz"
duration = "0.6 s"
[[steps]]
kind = "drive"
voltage_peak_to_peak = "40 V"
frequency = "2 kHz"
[[steps]]
kind = "wait"
duration = "0.6 s"
"""


@pytest.fixture(scope="module")
def rig() -> Rig:
    return read_rig(EXAMPLES / "rigs" / "power_map.toml")


def changed(tmp_path: Path, name: str, *changes: tuple[str, str]) -> DeviceMap:
    """An example of a map with other texts in it, and the calibration beside it."""
    text = (LAB / name).read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    (tmp_path / "normal_load.csv").write_text((LAB / "normal_load.csv").read_text(encoding="utf-8"))
    (tmp_path / name).write_text(text, encoding="utf-8")
    return read_device_map(tmp_path / name)


def silent_map(tmp_path: Path) -> DeviceMap:
    """A map whose generator tells nothing of its load, unit, modulation and trips."""
    before, _, after = (LAB / "siglent_sdg.toml").read_text(encoding="utf-8").partition("checks = [")
    (tmp_path / "silent.toml").write_text(before + after.partition("\n]\n")[2], encoding="utf-8")
    return read_device_map(tmp_path / "silent.toml")


def protocol(*changes: tuple[str, str]) -> Protocol:
    text = PROTOCOL
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    return protocol_from(tomllib.loads(text))


def rehearsed(name: str, rig: Rig, *faults: str, **other: Any) -> Rehearsal:
    given: dict[str, Any] = {"seed": 1, "disturbances": UNDISTURBED} | other
    return rehearsal(read_device_map(LAB / name), rig, protocol(), faults=faults, **given)


def ran(rehearsal: Rehearsal, wanted: Protocol) -> tuple[RunState, MemoryRecord]:
    record = MemoryRecord()
    return run_protocol(wanted, rehearsal.devices, record, operator=lambda prompt: True), record


def values(devices: Devices, *names: str, rate: float = 1000.0, samples: int = 50) -> np.ndarray:
    devices.acquisition.connect()
    devices.acquisition.start(names, sample_rate=rate)
    return devices.acquisition.read(samples).values


@pytest.mark.parametrize("name", ["devices.toml", "several_clocks.toml", "siglent_sdg.toml"])
def test_channels_units_ranges_and_clocks_are_those_of_the_map_and_nothing_is_connected(
    name: str, rig: Rig, monkeypatch: MonkeyPatch
) -> None:
    for real in (DaqmxAcquisition, VisaConnection):
        monkeypatch.setattr(real, "connect" if real is DaqmxAcquisition else "open", lambda self: pytest.fail("real"))
    real_devices = read_device_map(LAB / name).devices()
    devices = rehearsed(name, rig).devices
    assert devices.channels == real_devices.channels
    assert list(devices.further) == list(real_devices.further)
    assert devices.drive.voltage_maximum == approx(80.0)
    assert devices.motor.rotation_speed_maximum == approx(5.0)  # 300 rpm
    assert devices.groove_diameter == approx(0.05)
    assert (devices.simulated, devices.rehearsed, devices.resources) == (True, True, ())
    for each in (devices.acquisition, *devices.further.values(), devices.drive, devices.motor):
        each.connect()


def test_readings_stand_on_the_steps_of_the_converter_behind_gain_and_offset(rig: Rig) -> None:
    devices = rehearsed("devices.toml", rig, disturbances=None).devices
    found = values(devices, "friction_force")[:, 0]  # 4 N/V with -0.012 N at 0 V, +-5 V
    steps = (found + 0.012) / 4 / STEP
    assert steps == approx(np.round(steps), abs=1e-6)
    assert len(np.unique(np.round(steps))) > 10  # noise of 30 mN in steps of 0.6 mN


def test_a_calibration_is_applied_as_it_would_be_and_the_load_is_read_right(rig: Rig) -> None:
    devices = rehearsed("devices.toml", rig).devices
    table = np.loadtxt(LAB / "normal_load.csv", delimiter=",", skiprows=1, dtype=str)
    slope = np.abs(np.diff([float(cell.split()[0]) for cell in table[:, 1]])).max()  # N between two points
    assert values(devices, "normal_load")[:, 0] == approx(5.0, abs=max(slope, 1) * 20 / 2**16)


def test_readings_beyond_the_range_of_an_input_saturate_at_it(tmp_path: Path, rig: Rig) -> None:
    narrow = changed(tmp_path, "devices.toml", ('gain = "20 V/V"', 'gain = "1 V/V"'))
    devices = rehearsal(narrow, rig, protocol(), seed=1, disturbances=UNDISTURBED).devices
    devices.drive.connect()
    devices.drive.drive(DriveSetting(voltage_peak_to_peak=60.0, frequency=50.0))
    found = values(devices, "voltage")[:, 0]
    assert (found.min(), found.max()) == approx((-10.0, 10.0))
    assert (np.abs(found) < 9.9).any()


def test_a_stated_uncertainty_is_one_deviation_of_a_run_and_stands_in_the_truth(tmp_path: Path, rig: Rig) -> None:
    stated = changed(tmp_path, "devices.toml", ('offset = "0 degC"', 'offset = "0 degC"\nuncertainty = "2 K"'))
    found = []
    for seed in (1, 1, 2):
        made = rehearsal(stated, rig, protocol(), seed=seed, disturbances=UNDISTURBED)
        mean = values(made.devices, "temperature").mean()
        assert mean - 294.15 == approx(float(made.truth()["temperature_deviation"]), abs=0.01)
        found.append(mean - 294.15)
    assert found[0] == approx(found[1])
    assert abs(found[0] - found[2]) > 0.01
    with raises(InvalidInput, match="uncertainty 2 degC is a temperature; expected a temperature difference"):
        changed(tmp_path, "devices.toml", ('offset = "0 degC"', 'offset = "0 degC"\nuncertainty = "2 degC"'))
    with raises(InvalidInput, match="uncertainty must be positive, got -2 K"):
        changed(tmp_path, "devices.toml", ('offset = "0 degC"', 'offset = "0 degC"\nuncertainty = "-2 K"'))


def test_what_the_rig_does_not_have_is_named_and_reads_its_value_at_rest(rig: Rig) -> None:
    made = rehearsed("several_clocks.toml", rig)
    assert [each.name for each in made.channels if not each.is_simulated] == ["humidity", "disc_temperature"]
    assert made.caveats == (
        "not simulated, humidity: the virtual rig has no relative humidity: reads 0 with noise",
        "not simulated, disc_temperature: the virtual rig does not warm its disc: reads 294 K with noise, clock slow",
    )
    assert "humidity; disc_temperature" in made.devices.description["not simulated"]
    found = values(made.devices, "humidity", samples=500)[:, 0]
    assert 0 < found.std() < 0.01 * 1.0  # of a range of 100 %
    assert found.mean() == approx(0.0, abs=0.002)


def test_a_thermocouple_without_place_reads_ambient_temperature_and_is_named(rig: Rig) -> None:
    nowhere = protocol(('thermocouple = "actuator"', ""))
    made = rehearsal(read_device_map(LAB / "devices.toml"), rig, nowhere, seed=1)
    assert made.caveats == (
        "not simulated, temperature: neither map nor protocol says where the thermocouple stands: reads 294 K with"
        " noise",
    )


def test_a_vibrometer_reads_the_speed_of_the_contact_that_the_rig_gives_it(tmp_path: Path, rig: Rig) -> None:
    wide = changed(tmp_path, "several_clocks.toml", ('gain = "25 mm/s/V"', 'gain = "1 m/s/V"'))
    made = rehearsal(wide, rig, protocol(), seed=1, disturbances=UNDISTURBED)
    devices = made.devices
    fast = devices.further["fast"]
    devices.acquisition.connect()
    devices.drive.connect()
    fast.connect()
    devices.acquisition.start(["friction_force"], sample_rate=1000.0)
    fast.start(["vibrometer", "voltage"], sample_rate=500e3)
    devices.drive.drive(DriveSetting(voltage_peak_to_peak=25.9, voltage_offset=12.95, frequency=22e3))
    devices.acquisition.read(50)
    seen = fast.read(25_000).values[15_000:, 0]
    truth = made._virtual._friction.amplitude(
        DriveSetting(voltage_peak_to_peak=25.9, voltage_offset=12.95, frequency=22e3), 0.0, normal_load=5.0
    )
    assert seen.std() * np.sqrt(2) == approx(2 * np.pi * 22e3 * truth, rel=0.01)
    with raises(DeviceError, match="has not taken 1 samples yet; they come with those of the run"):
        fast.read(1)


def test_channels_of_slow_instruments_are_recorded_by_their_own_clock_and_repeat(tmp_path: Path, rig: Rig) -> None:
    wanted = protocol(
        ('"friction_force", "temperature", "voltage"', '"friction_force", "pin_temperature"'),
        ('"20 kHz"', '"1 kHz"'),
        ('duration = "0.6 s"', 'duration = "3.2 s"'),
        ('duration = "0.6 s"', 'duration = "3.2 s"'),
    )
    quick = changed(tmp_path, "several_clocks.toml", ('sample_rate = "500 kHz"', 'sample_rate = "15 kHz"'))
    found = []
    for number in range(2):
        made = rehearsal(quick, rig, wanted, seed=3)
        recorder = new_run(tmp_path / f"runs{number}", title="slow", protocol=PROTOCOL)
        state = run_protocol(wanted, made.devices, recorder, operator=lambda prompt: True)
        assert state.outcome == "completed", state.reason
        run = read_run(recorder.folder)
        slow = run.dataset(clock="slow")
        found.append((slow["time"].to_numpy(), slow["pin_temperature"].to_numpy()))
        assert np.diff(found[-1][0]) == approx(1.0)  # period of the map
    assert len(found[0][0]) == 4  # at 0, 1, 2 and 3 s
    assert found[0][1] == approx(found[1][1], abs=1e-12)


VOLTAGE_FAULTS = [
    ("load_50_ohm", "tells another load than was set up", "measures 8"),
    ("unit_vrms", "tells another unit than was set up", "measures 11.3"),
    ("channels_combined", "tells another combination than was set up", "measures 5."),
    ("am_left_on", "tells another modulation than was set up", "measures 2."),
    ("overload_trip", "tells another trips than was set up", "measures "),
]


@pytest.mark.parametrize(("name", "by_itself", "by_channel"), VOLTAGE_FAULTS)
def test_a_fault_of_the_generator_is_told_by_it_or_by_the_voltage_that_is_measured(
    name: str, by_itself: str, by_channel: str, tmp_path: Path, rig: Rig
) -> None:
    state, _ = ran(rehearsed("devices.toml", rig, name), protocol())
    assert by_itself in state.reason
    silent = silent_map(tmp_path)
    state, _ = ran(rehearsal(silent, rig, protocol(), seed=1, faults=[name]), protocol())
    assert state.reason.startswith("self-test before the first step: channel voltage")
    assert by_channel in state.reason  # of 4 V, a tenth of 40 V, that were set
    assert "where 4 V was set" in state.reason


def test_a_trip_in_the_middle_of_a_run_is_found_by_the_next_look(tmp_path: Path, rig: Rig) -> None:
    silent = silent_map(tmp_path)
    state, record = ran(rehearsal(silent, rig, protocol(), seed=1, faults=["overload_trip@0.7s"]), protocol())
    assert "channel voltage measures" in state.reason
    assert "where 40 V was set" in state.reason
    assert any(kind == "drive" for kind, *_ in record.notes)


def test_a_drive_that_stays_on_ends_with_the_verdict_to_cut_the_power(rig: Rig) -> None:
    state, _ = ran(rehearsed("devices.toml", rig, "off_ignored"), protocol())
    assert state.verdict is not None
    assert not state.verdict.is_off
    assert "cut the power" in state.verdict.text


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("thermocouple_open", "channel temperature is"),  # an analogue input at the end of its range
        ("slow_sampling", "samples at 18 kHz where 20 kHz was asked for"),
        ("stale_block@0.4s", "once more, where"),
    ],
)
def test_a_fault_of_an_acquisition_ends_the_run(name: str, reason: str, rig: Rig) -> None:
    state, _ = ran(
        rehearsed("devices.toml", rig, name),
        protocol(('voltage_peak_to_peak = "40 V"', 'voltage_peak_to_peak = "4 V"')),
    )
    assert state.outcome != "completed"
    assert reason in state.reason


def test_an_open_thermocouple_of_an_instrument_gives_no_number_and_trips_its_limit(rig: Rig) -> None:
    made = rehearsed("several_clocks.toml", rig, "thermocouple_open")
    wanted = protocol(('"friction_force", "temperature", "voltage"', '"friction_force"'), ('"20 kHz"', '"1 kHz"'))
    state, _ = ran(made, wanted)
    assert "pin_temperature gives no number" in state.reason


def test_friction_turned_round_and_a_disc_that_stands_are_recorded_as_they_would_be(rig: Rig) -> None:
    for name, low, high in (("friction_reversed", -5.0, -0.1), ("motor_stalls", -0.02, 0.02)):
        devices = rehearsed("devices.toml", rig, name).devices
        devices.motor.connect()
        devices.acquisition.connect()
        devices.motor.turn(0.5)
        found = values(devices, "friction_force", samples=500)[400:, 0]
        assert (found > low).all()
        assert (found < high).all()


ASKING = """title = "t"
source = "s"
[limits]
voltage_maximum = "60 V"
duration_maximum = "60 s"
[[steps]]
kind = "prompt"
task = "other"
text = "Look."
[[steps]]
kind = "acquire"
channels = ["friction_force", "voltage"]
sample_rate = "1 kHz"
duration = "5 s"
[[steps]]
kind = "wait"
duration = "5 s"
"""


def test_the_expected_time_counts_all_clocks_also_while_somebody_is_asked(rig: Rig, monkeypatch: MonkeyPatch) -> None:
    # A microsecond for each moment of each clock: 50 a block at 1 kHz, 25,000 at the 500 kHz of the fast clock, and
    # half a millisecond for handling. 100 blocks, and 1200 of the fast clock alone in the minute of the prompt.
    now, next_times = [0.0], Stream.next_times

    def counted(stream: Stream, samples: int) -> np.ndarray:
        now[0] += 1e-6 * samples
        return next_times(stream, samples)

    monkeypatch.setattr(Stream, "next_times", counted)
    monkeypatch.setattr(pace, "monotonic", lambda: now[0])
    found = rehearsed("several_clocks.toml", rig).expected_time(protocol_from(tomllib.loads(ASKING)))
    assert found.wall_time == approx(100 * (0.5e-3 + 50e-6 + 25e-3) + 1200 * 25e-3, rel=0.01)
    assert found.samples == 5_000 + 2_500_000


def test_a_fault_that_begins_leaves_the_disc_at_the_speed_last_set_and_a_motor_that_is_off_at_rest(rig: Rig) -> None:
    devices = rehearsed("devices.toml", rig, "friction_reversed@1s").devices
    devices.motor.connect()
    devices.motor.turn(0.2)
    devices.motor.turn(0.5)
    before = values(devices, "friction_force", samples=900)[400:, 0]
    values(devices, "friction_force", samples=200)  # a fault acts from the next block on
    after = values(devices, "friction_force", samples=500)[:, 0]
    assert (before > 0.1).all()
    assert after.mean() == approx(-before.mean(), rel=0.1)
    still = rehearsed("devices.toml", rig, "friction_reversed@1s").devices
    still.motor.connect()
    still.motor.turn(0.5)
    still.motor.off()
    values(still, "friction_force", samples=1100)
    assert values(still, "friction_force", samples=500)[300:, 0] == approx(0.0, abs=0.05)


def test_a_motor_that_stalls_and_recovers_turns_again_at_the_speed_last_set(rig: Rig) -> None:
    made = rehearsed("devices.toml", rig, "motor_stalls")
    motor = made.devices.motor
    motor.connect()
    motor.turn(0.5)
    assert values(made.devices, "friction_force", samples=500)[400:, 0] == approx(0.0, abs=0.05)
    made.devices.motor._active._acting.clear()  # type: ignore[attr-defined]
    motor.apply()  # type: ignore[attr-defined]
    assert (values(made.devices, "friction_force", samples=500)[400:, 0] > 0.1).all()


def test_limits_of_map_and_protocol_hold_as_on_hardware(rig: Rig) -> None:
    devices = rehearsed("devices.toml", rig).devices
    devices.drive.connect()
    devices.motor.connect()
    with raises(DeviceError, match=r"virtual .*: 85 V at the actuator refused; it gives at most 80 V"):
        devices.drive.drive(DriveSetting(voltage_peak_to_peak=170.0, frequency=1e3))
    with raises(DeviceError, match=r"200 kHz refused; it gives frequencies up to 100 kHz"):
        devices.drive.drive(DriveSetting(voltage_peak_to_peak=10.0, frequency=200e3))
    with raises(DeviceError, match=r"6 1/s refused; it turns at 0 to 5 1/s"):
        devices.motor.turn(6.0)
    devices.acquisition.connect()
    with raises(DeviceError, match=r"300 kHz refused; it samples 2 channels at up to 250 kHz"):
        devices.acquisition.start(["friction_force", "voltage"], sample_rate=300e3)
    with raises(DeviceError, match=r"unknown channel 'voltag'; did you mean voltage\?"):
        devices.acquisition.start(["voltag"], sample_rate=1e3)
    cold = protocol(('temperature_maximum = "100 degC"', 'temperature_maximum = "10 degC"'))
    state, _ = ran(rehearsed("devices.toml", rig), cold)
    assert "channel temperature is 294" in state.reason
    assert "its limit is 283" in state.reason


def test_unknown_faults_are_refused_with_all_names_and_times_are_read() -> None:
    with raises(InvalidInput, match=r"unknown fault 'load_50'; did you mean load_50_ohm\?; known: load_50_ohm,"):
        faults_named(["load_50"])
    with raises(InvalidInput, match=r"known: " + ", ".join(FAULTS)):
        faults_named(["zzz"])
    with raises(InvalidInput, match="fault stale_block is named twice"):
        faults_named(["stale_block", "stale_block@2s"])
    with raises(InvalidInput, match="must not be negative, got -2s"):
        faults_named(["stale_block@-2s"])
    with raises(InvalidInput, match="fault stale_block 2 has no unit"):
        faults_named(["stale_block@2"])
    (fault,) = faults_named(["overload_trip@250ms"])
    assert fault.from_time == approx(0.25)
    assert fault.described.startswith("overload_trip from 250 ms on: the overload protection")


def test_rms_and_peak_meters_of_the_current_agree_with_the_wave(tmp_path: Path, rig: Rig) -> None:
    made = changed(
        tmp_path,
        "devices.toml",
        ('name = "temperature"', 'name = "current_rms"'),
        ('gain = "100 K/V"', 'gain = "0.1 A/V"'),
        ('offset = "0 degC"\n', ""),
        ('name = "gaussmeter"', 'name = "current_peak"'),
        ('gain = "0.01 T/V"', 'gain = "0.1 A/V"'),
    )
    devices = rehearsal(made, rig, protocol(), seed=1, disturbances=UNDISTURBED).devices
    devices.drive.connect()
    devices.drive.drive(DriveSetting(voltage_peak_to_peak=4.0, frequency=1e3))
    wave, rms, peak = values(devices, "current", "current_rms", "current_peak", rate=100e3, samples=5000).T
    assert wave.std() == approx(rms.mean(), rel=0.02)
    assert np.abs(wave).max() == approx(peak.mean(), rel=0.02)
    assert peak.mean() == approx(np.sqrt(2) * rms.mean(), rel=0.02)  # of a sine
