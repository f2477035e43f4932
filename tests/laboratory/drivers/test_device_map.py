"""Device maps: the example, every fault at once, calibrations, and what is beyond the devices."""

import json
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest
from pytest import MonkeyPatch, approx, raises
from tests.facts.protocol.schema_faults import schema_faults
from tests.laboratory.rig_stand_ins import EXAMPLE

from sonolube.errors import InvalidInput, MissingPackage, SeveralFaults
from sonolube.facts.protocol import protocol_by_name_or_file, protocol_from
from sonolube.laboratory.drivers import device_map_schema, missing_parts, read_device_map, unfulfilled
from sonolube.laboratory.drivers.daqmx_acquisition import tabulated_scale
from sonolube.laboratory.drivers.device_map import _told

TEXT = EXAMPLE.read_text(encoding="utf-8")
LOADS = "normal_load.csv"


def written(folder: Path, *changes: tuple[str, str], calibration: str | None = None) -> Path:
    text = TEXT
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    table = (EXAMPLE.parent / LOADS).read_text(encoding="utf-8") if calibration is None else calibration
    (folder / LOADS).write_text(table, encoding="utf-8")
    path = folder / "devices.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_the_example_names_its_devices_channels_and_limits() -> None:
    read = read_device_map(EXAMPLE)
    devices = read.devices()
    channels = devices.acquisition.channels
    assert set(channels) == {"friction_force", "normal_load", "voltage", "current", "temperature", "gaussmeter"}
    friction = channels["friction_force"]
    assert friction.unit == "N"
    assert [friction.lowest, friction.highest] == approx([-20.012, 19.988])
    assert [channels["normal_load"].lowest, channels["normal_load"].highest] == approx([0.0, 15.696])
    assert channels["temperature"].lowest == approx(-226.85)
    assert devices.drive.voltage_maximum == approx(80.0)
    assert [devices.motor.rotation_speed_maximum, devices.groove_diameter] == approx([5.0, 0.05])
    assert not devices.simulated
    assert "MY50001234" in devices.description["drive hardware"]
    assert set(read.files) == {"devices.toml", LOADS}


def test_a_map_is_read_and_its_devices_are_made_without_their_libraries(monkeypatch: MonkeyPatch) -> None:
    for name in ("nidaqmx", "pyvisa", "pyvisa_py", "serial"):
        monkeypatch.setitem(sys.modules, name, None)
    read = read_device_map(EXAMPLE)
    assert [line.rpartition(": ")[2] for line in missing_parts(read)] == [
        "pip install nidaqmx",
        "pip install pyserial pyvisa pyvisa-py",
    ]
    devices = read.devices()
    for device in (devices.acquisition, devices.drive, devices.motor):
        with raises(MissingPackage, match=r"pip install "):
            device.connect()
        device.close()


def test_no_library_of_an_instrument_is_imported_before_it_is_needed() -> None:
    libraries = "{'nidaqmx', 'pyvisa', 'serial'}"
    code = f"import sys, sonolube.laboratory.drivers as d; d.read_device_map; print({libraries} & {{*sys.modules}})"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "set()"


def test_the_input_of_the_amplifier_can_be_the_tighter_limit(tmp_path: Path) -> None:
    path = written(tmp_path, ('output_maximum = "5 V"', 'output_maximum = "2 V"'))
    assert read_device_map(path).devices().drive.voltage_maximum == approx(40.0)


def test_all_faults_are_told_at_once_with_their_keys(tmp_path: Path) -> None:
    path = written(
        tmp_path,
        ('gain = "4 N/V"', 'gain = "4 N"'),
        ('name = "current"', 'name = "curent"'),
        ('input = "ai2"', 'input = "Dev1/ai0:3"'),
        ("amplifier_gain = 20.0", 'amplifier_gain = "20"'),
        ('frequency_maximum = "100 kHz"', "frequency_maximum = 100e3"),
        ('speed_command = "V{speed}"', 'speed_command = "V{0.__class__}"'),
        ('query = "GV"\n', ""),
        ("baud_rate", "baudrate"),
    )
    with raises(SeveralFaults) as refusal:
        read_device_map(path)
    told = "\n".join(refusal.value.lines)
    for part in (
        "acquisition.channels[1]: gain 4 N",
        "acquisition.channels[4].name: unknown channel 'curent'; did you mean current?",
        "acquisition.channels[3].input:",
        "drive.amplifier_gain:",
        "drive.frequency_maximum: 100000.0 has no unit",
        "motor.speed_command: must hold {speed} once",
        "motor.baudrate: unknown key",
    ):
        assert part in told
    assert refusal.value.where == str(path)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (('driver = "scpi"', 'driver = "gpib"'), "drive: driver must be scpi, daqmx or scpi_commands, got .gpib"),
        (('driver = "line"\n', ""), "motor: driver is missing"),
        (('input = "ai1"', 'input = "ai0"'), "input ai0 stands twice"),
        (('gain = "20 V/V"', 'gain = "20 V/V"\ncalibration = "x.csv"'), "needs either gain or calibration"),
        (('gain = "0.1 A/V"', 'gain = "0 A/V"'), "gain must not be 0"),
        (('output_maximum = "5 V"', 'output_maximum = "12 V"'), "at most 10 V"),
        (('query = "GV"\n', ""), "query and query_answer belong together"),
        (('"TCPIP::192.168.1.21::5025::SOCKET"', '"192.168.1.21"'), "drive.resource"),
        ((f'"{LOADS}"', '"../secret.csv"'), "must be the name of a file beside the map"),
        ((f'"{LOADS}"', '"absent.csv"'), r"acquisition.channels\[2\].calibration: absent.csv: no such file"),
    ],
)
def test_an_impossible_map_is_refused_with_the_reason(change: tuple[str, str], reason: str, tmp_path: Path) -> None:
    with raises(InvalidInput, match=reason):
        read_device_map(written(tmp_path, change))


@pytest.mark.parametrize(
    ("table", "reason"),
    [
        ("voltage,friction_force\n0 V,0 N\n1 V,1 N", "line 1: expected voltage,normal_load"),
        ("voltage,normal_load\n0 V,0 N", "1 points"),
        ("voltage,normal_load\n0 V,0 N\n0 V,1 N", "the voltages must increase"),
        ("voltage,normal_load\n0 V,0 N\n1 V,2 N\n2 V,1 N", "the readings must rise or fall"),
        ("voltage,normal_load\n0 V,0 N\n1,1 N", "line 3: 1 has no unit"),
        ("voltage,normal_load\n0 V,0 N\n1 V", "line 3: expected a voltage and a reading"),
    ],
)
def test_a_calibration_that_is_no_function_of_voltage_is_refused(table: str, reason: str, tmp_path: Path) -> None:
    with raises(InvalidInput, match=f"{LOADS}: {reason}"):
        read_device_map(written(tmp_path, calibration=table))


def test_a_calibration_is_linear_between_its_points_and_saturates_beyond_them() -> None:
    scale = tabulated_scale("voltage,temperature\n0 V,20 degC\n1 V,120 degC\n2 V,320 degC\n", quantity="temperature")
    assert scale(np.array([-1.0, 0.0, 0.5, 1.5, 9.0])) == approx([293.15, 293.15, 343.15, 493.15, 593.15])


def test_the_example_follows_the_schema_and_a_faulty_map_does_not() -> None:
    schema = json.loads(json.dumps(device_map_schema()))
    content = tomllib.loads(TEXT)
    assert list(schema_faults(schema, content, schema)) == []
    del content["motor"]["speed_command"]
    content["acquisition"]["channels"][0]["input"] = 3
    assert len(list(schema_faults(schema, content, schema))) >= 2


@pytest.mark.parametrize("name", sorted(path.name for path in EXAMPLE.parent.glob("*.toml")))
def test_every_shipped_map_is_read_and_follows_the_schema(name: str) -> None:
    path = EXAMPLE.parent / name
    assert read_device_map(path).devices().channels
    schema = json.loads(json.dumps(device_map_schema()))
    content = tomllib.loads(path.read_text(encoding="utf-8"))
    assert list(schema_faults(schema, content, schema)) == []


def with_channel(folder: Path, lines: str) -> Path:
    """Example with a further channel."""
    return written(folder, ("[drive]", f"[[acquisition.channels]]\n{lines}\n\n[drive]"))


@pytest.mark.parametrize(
    ("lines", "unit", "quantity"),
    [
        ('name = "pin_temperature"\nquantity = "temperature"\ngain = "100 K/V"', "K", "temperature"),
        ('name = "emission"\nquantity = "acoustic_emission"\nunit = "V"\ngain = "2 V/V"', "V", "acoustic_emission"),
        (
            'name = "vibrometer"\nquantity = "surface_velocity"\nunit = "m/s"\ngain = "25 mm/s/V"',
            "m/s",
            "surface_velocity",
        ),
        ('name = "humidity"\nquantity = "humidity"\nunit = ""\ngain = "10 %/V"', "", "humidity"),
    ],
)
def test_a_channel_of_any_name_has_its_quantity_and_unit(lines: str, unit: str, quantity: str, tmp_path: Path) -> None:
    channels = read_device_map(with_channel(tmp_path, f'input = "ai9"\n{lines}')).devices().channels
    channel = channels[list(channels)[-1]]
    assert (channel.unit, channel.quantity, channel.limit) == (unit, quantity, np.inf)


@pytest.mark.parametrize(
    ("lines", "reason"),
    [
        ('name = "noise"\ngain = "1 V/V"', "unknown channel 'noise'.*any other name needs its quantity"),
        ('name = "a"\nquantity = "noise"\ngain = "1 V/V"', "noise is not in the vocabulary and needs its unit"),
        ('name = "a"\nquantity = "noise"\nunit = "mm/s"\ngain = "1 mm/s/V"', "'mm/s' is no unit of SI"),
        ('name = "a"\nquantity = "noise"\nunit = "furlong/x"\ngain = "1 V/V"', "is no unit"),
        ('name = "a"\nquantity = "temperature"\nunit = "K"\ngain = "1 K/V"', "unit belongs to free quantities"),
        ('name = "a"\nquantity = "temperature"\ngain = "1 N/V"', "gain 1 N/V"),
        ('name = "a"\nquantity = "temperature"\ngain = "1 K/V"\nlimit = "5 N"', "limit 5 N"),
        ('name = "displacement"\nquantity = "temperature"\ngain = "1 K/V"', "choose another name"),
        ('name = "frequency_set"\nquantity = "temperature"\ngain = "1 K/V"', "choose another name"),
        ('name = "voltage"\ngain = "1 V/V"', "name voltage stands twice among the channels"),
    ],
)
def test_a_channel_whose_meaning_is_unclear_is_refused(lines: str, reason: str, tmp_path: Path) -> None:
    with raises(InvalidInput, match=reason):
        read_device_map(with_channel(tmp_path, f'input = "ai9"\n{lines}'))


SECOND = """[acquisitions.slow]
driver = "daqmx"
device = "Dev2"
sample_rate_maximum = "100 Hz"
sample_rate = "10 Hz"

[[acquisitions.slow.channels]]
name = "pin_temperature"
quantity = "temperature"
input = "ai0"
gain = "100 K/V"

[drive]"""


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (('sample_rate = "10 Hz"\n', ""), "acquisitions.slow: needs sample_rate, which no protocol tells"),
        (('sample_rate = "10 Hz"', 'sample_rate = "1 kHz"'), "sample_rate is at most 100 Hz with 1 channels"),
        (('"Dev2"', '"dev1"'), "acquisitions.slow: dev1 is that of acquisition too; one device has one clock"),
        (('"pin_temperature"', '"temperature"'), "name temperature is one of acquisition too"),
        (("acquisitions.slow", "acquisitions.Slow-1"), "acquisitions"),
        (
            ('gain = "100 K/V"', 'calibration = "absent.csv"'),
            r"acquisitions.slow.channels\[1\].calibration: absent.csv",
        ),
    ],
)
def test_clocks_that_cannot_be_are_refused(change: tuple[str, str], reason: str, tmp_path: Path) -> None:
    assert read_device_map(written(tmp_path, ("[drive]", SECOND))).devices().further["slow"].channels
    with raises(InvalidInput, match=reason):
        read_device_map(written(tmp_path, ("[drive]", SECOND.replace(*change))))


def test_an_acquisition_with_a_rate_of_its_own_has_not_the_clock_of_protocols(tmp_path: Path) -> None:
    path = written(tmp_path, ('device = "Dev1"', 'device = "Dev1"\nsample_rate = "10 Hz"'))
    with raises(InvalidInput, match="one of its own belongs below acquisitions"):
        read_device_map(path)


def test_what_a_protocol_asks_beyond_the_devices_is_told_by_its_step(tmp_path: Path) -> None:
    slow = written(
        tmp_path,
        ('frequency_maximum = "100 kHz"', 'frequency_maximum = "20 kHz"'),
        ('sample_rate_maximum = "500 kHz"', 'sample_rate_maximum = "10 Hz"'),
        ('voltage_maximum = "80 V"', 'voltage_maximum = "5 V"'),
    )
    protocol = protocol_by_name_or_file("map_test")
    told = "\n".join(unfulfilled(read_device_map(slow), protocol))
    for part in ("the drive gives at most 20 kHz", "the device takes 10 Hz in all", "gives at most 5 V"):
        assert part in told
    assert unfulfilled(read_device_map(EXAMPLE), protocol) == ()


def test_all_that_is_beyond_the_devices_is_told_at_once_each_with_its_step_and_worst_value(tmp_path: Path) -> None:
    weak = written(
        tmp_path,
        ('voltage_maximum = "80 V"', 'voltage_maximum = "8 V"'),
        ('rotation_speed_maximum = "300 rpm"', 'rotation_speed_maximum = "6 rpm"'),
    )
    drive = {"kind": "drive", "frequency": "22 kHz"}
    steps = [
        {"kind": "acquire", "channels": ["noise", "voltage", "smell"], "sample_rate": "1 kHz", "duration": "3 s"},
        {"kind": "motor_speed", "rotation_speed": "2 Hz"},
        {"kind": "wait", "duration": "1 s"},
        drive | {"voltage_peak_to_peak": "20 V"},
        {"kind": "voltage_steps", "voltages": ["18 V", "28 V", "10 V"], "step_duration": "1 s", "frequency": "22 kHz"},
        {"kind": "motor_speed", "rotation_speed": "0.05 Hz"},
        drive | {"voltage_peak_to_peak": "10 V"},
        {"kind": "motor_speed", "rotation_speed": "3 Hz"},
    ]
    limits = {"voltage_maximum": "30 V", "duration_maximum": "10 s", "friction_force_maximum": "100 N"}
    protocol = protocol_from({"title": "much", "source": "none", "limits": limits, "steps": steps})
    name = "function generator TCPIP::192.168.1.21::5025::SOCKET"
    motor = "motor ASRL/dev/ttyUSB0::INSTR"
    assert [line.partition("; it has")[0] for line in unfulfilled(read_device_map(weak), protocol)] == [
        "limits.friction_force_maximum of 100 N lies beyond the range of channel friction_force, 20 N",
        "step 1: NI-DAQmx Dev1 has no channels noise, smell",
        f"step 2: needs 2 1/s; {motor} turns at most at 0.1 1/s",
        f"step 4: the drive reaches 10 V; {name} gives at most 8 V",
        f"step 5: the drive reaches 14 V; {name} gives at most 8 V",
        f"step 8: needs 3 1/s; {motor} turns at most at 0.1 1/s",
    ]


def test_the_schema_of_a_role_with_several_drivers_is_one_of_their_sections() -> None:
    sections = device_map_schema()["properties"]
    assert len(sections["drive"]["oneOf"]) == 3
    assert len(sections["acquisition"]["oneOf"]) == 2
    assert "oneOf" not in json.dumps(sections["guard"])  # of one driver


@pytest.mark.parametrize(("faults", "rest"), [(2, 0), (20, 0), (21, 1), (45, 25)])
def test_twenty_faults_of_a_map_are_told_and_the_number_of_the_others(faults: int, rest: int) -> None:
    told = _told([f"fault {number}" for number in range(faults)], [f"key {number}" for number in range(faults)])
    assert len(told.faults) == len(told.keys) == faults - rest
    assert told.rest == rest
    assert told.faults[-1] == f"fault {faults - rest - 1}"
