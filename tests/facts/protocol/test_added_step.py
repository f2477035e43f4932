"""A new kind of step takes one class and its name in the table, and is limited, recorded and shown everywhere."""

import json
from pathlib import Path
from typing import Any

import pytest
from pytest import approx
from tests.test_additions import RIG, answer, extend, run

DEVICES = Path(__file__).parents[3] / "examples" / "lab"

VOLTAGE_RAMP = '''
"""Step `voltage_ramp`."""

from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Any, ClassVar, Literal, final

from pydantic import Field

from sonolube.facts.protocol.quantity_text import Hertz, Seconds, Volts
from sonolube.facts.protocol.step import Change, DriveSetPoint, StepTable


@final
class VoltageRamp(StepTable):
    """Raise the voltage of the actuator from 0 V in equal steps."""

    example: ClassVar[Mapping[str, Any]] = MappingProxyType(
        {"last_voltage": "10 V", "points": 5, "duration": "10 s", "frequency": "20 kHz"}
    )

    kind: Literal["voltage_ramp"] = "voltage_ramp"
    last_voltage: Volts
    points: int = Field(ge=1, le=10_000)
    duration: Seconds
    frequency: Hertz

    def changes(self) -> Iterator[Change]:
        """Voltages in turn."""
        for number in range(1, self.points + 1):
            voltage = self.last_voltage * number / self.points
            drive = DriveSetPoint(voltage_peak_to_peak=voltage, frequency=self.frequency)
            yield Change(duration=self.duration / self.points, drive=drive)
'''
RAMP = """
[[steps]]
kind = "voltage_ramp"
last_voltage = "20 V"
points = 5
duration = "10 s"
frequency = "22 kHz"
"""
RAMPED = f"""title = "Ramp"
source = "a test"

[limits]
voltage_maximum = "12 V"
duration_maximum = "60 s"

[[steps]]
kind = "acquire"
channels = ["friction_force"]
sample_rate = "400 Hz"
duration = "12 s"

[[steps]]
kind = "wait"
duration = "1 s"
{RAMP}
[[steps]]
kind = "wait"
duration = "1 s"
"""


def with_ramp(copied_package: Path) -> Path:
    """Folder of a copied package with the step added, and of a protocol that has one."""
    extend(
        copied_package / "facts" / "protocol" / "voltage_ramp.py",
        VOLTAGE_RAMP,
        table=copied_package / "facts" / "protocol" / "record.py",
        after="from sonolube.facts.protocol.step import Change, StepTable\n",
        line="from sonolube.facts.protocol.voltage_ramp import VoltageRamp",
    )
    record = copied_package / "facts" / "protocol" / "record.py"
    text, table = record.read_text(), "Step = Annotated[\n    Wait |"
    assert table in text
    record.write_text(text.replace(table, f"{table} VoltageRamp |"))
    (copied_package.parent / "ramp.toml").write_text(RAMPED, encoding="utf-8")
    return copied_package.parent


@pytest.fixture
def folder(copied_package: Path) -> Path:
    return with_ramp(copied_package)


def told(folder: Path, script: str) -> Any:
    """Object that a script prints with the package."""
    start = (
        "import json\nfrom pathlib import Path\nfrom sonolube.facts.protocol import *\n"
        "TEXT = Path('ramp.toml').read_text()\nread = read_protocol('ramp.toml')\n"
    )
    return json.loads(run(folder, "-c", start + script))


def test_set_points_of_an_added_step_are_those_of_its_class(folder: Path) -> None:
    script = "print(json.dumps([[each.time, each.step, each.voltage_peak_to_peak, each.frequency, each.sets]"
    points = told(folder, f"{script} for each in flattened(read)]))")
    assert [points[0][:2], points[1][:2], points[-2][:2]] == [[0.0, "1"], [0.0, "2"], [approx(11.0), "4"]]
    assert points[2:-2] == [
        [approx(1.0 + 2.0 * number), "3", approx(4.0 * (number + 1)), 22e3, ["drive"]] for number in range(5)
    ]
    assert points[-2][-1] == []
    assert points[-1][0] == approx(12.0)


def test_an_added_step_is_held_to_the_limit_of_the_voltage(folder: Path) -> None:
    (folder / "ramp.toml").write_text(RAMPED.replace('"12 V"', '"9.9 V"'), encoding="utf-8")
    with pytest.raises(AssertionError, match=r"step 3: the drive reaches 10 V; limits\.voltage_maximum is 9\.9 V"):
        told(folder, "")


def test_an_added_step_is_held_to_the_highest_frequency_of_a_device_map(folder: Path) -> None:
    for name in ("devices.toml", "normal_load.csv"):
        text = (DEVICES / name).read_text(encoding="utf-8")
        (folder / name).write_text(text.replace('"100 kHz"', '"20 kHz"'), encoding="utf-8")
    script = (
        "from sonolube.laboratory.drivers import read_device_map, unfulfilled\n"
        "print(json.dumps(unfulfilled(read_device_map('devices.toml'), read)))\n"
    )
    assert told(folder, script) == ["step 3: drives at 22 kHz; the drive gives at most 20 kHz"]


def test_settings_of_an_added_step_are_recorded_and_observed(folder: Path) -> None:
    answer(folder, "lab", "run", "ramp.toml", "--rig", RIG, "--out", "runs")
    script = (
        "from sonolube.laboratory.records import new_run, observation, read_run, run_folders\n"
        "data = read_run(run_folders(Path('runs'))[0]).dataset()\n"
        "times = 0.5, 2, 4, 6, 8, 10, 11.5\n"
        "told = [float(data.voltage_peak_to_peak_set.sel(time=each, method='nearest')) for each in times]\n"
        "later = protocol_from({'title': 'a', 'source': 'b', 'limits': {'voltage_maximum': '30 V',\n"
        "    'duration_maximum': '60 s'}, 'steps': [{'kind': 'wait', 'duration': '0.3 s'}, {'kind': 'voltage_ramp',\n"
        "    'last_voltage': '20 V', 'points': 5, 'duration': '10 s', 'frequency': '22 kHz'}]})\n"
        "recorder = new_run(Path('watched'), title='watched', protocol=protocol_text(later))\n"
        "recorder.note('prepared', sample=None, protocol_time=0.0, reason='', state='running')\n"
        "observer = observation.RunObserver(recorder.folder)\n"
        "begun = observation.time.time()\n"
        "observation.time.time = lambda: begun + 5.0\n"
        "print(json.dumps([told, observer.look().protocol_time]))\n"
    )
    recorded, at = told(folder, script)
    assert recorded == approx([0.0, 4.0, 8.0, 12.0, 16.0, 20.0, 20.0])
    assert at == approx(0.3)  # the clock on the wall tells no time beyond a set point that is not yet noted


def test_a_dry_run_tells_the_voltages_of_an_added_step(folder: Path) -> None:
    shown = run(folder, "-c", "from sonolube.cli import main; main(['lab', 'run', 'ramp.toml', '--dry-run'])")
    lines = [line.split() for line in shown.splitlines() if "voltage ramp" in line]
    assert [line[0] for line in lines] == ["0:01", "0:03", "0:05", "0:07", "0:09"]
    assert [" ".join(line[4:9]) for line in lines] == [f"{volts} V pp 22 kHz" for volts in (4, 8, 12, 16, 20)]


def test_an_added_step_is_in_the_schema_and_refusals_name_it(folder: Path) -> None:
    entries = answer(folder, "schema", "protocol")["$defs"]["VoltageRamp"]["properties"]
    assert entries["kind"]["const"] == "voltage_ramp"
    assert entries["last_voltage"]["x-si-unit"] == "V"
    (folder / "ramp.toml").write_text(RAMPED.replace("voltage_ramp", "voltage_rump"), encoding="utf-8")
    with pytest.raises(AssertionError, match=r"step 3: kind must be one of .*voltage_ramp"):
        told(folder, "")


def test_an_added_step_is_inserted_edited_and_written(folder: Path) -> None:
    script = (
        "import tomllib\n"
        "text = edited_protocol_text(TEXT, {'insert': {'before': '5', 'kind': 'voltage_ramp'}})\n"
        "text = edited_protocol_text(text, {'steps.5.points': '2', 'steps.5.last_voltage': '6 V'})\n"
        "after = protocol_from(tomllib.loads(text))\n"
        "again = protocol_from(tomllib.loads(protocol_text(after)))\n"
        "fields = {each.key: [each.kind, each.unit] for each in protocol_steps(tomllib.loads(text))[4].fields}\n"
        "told = [each.voltage_peak_to_peak for each in flattened(after) if each.step == '5']\n"
        "print(json.dumps([told, again == after, fields]))\n"
    )
    voltages, is_same, fields = told(folder, script)
    assert voltages == approx([3.0, 6.0])
    assert is_same
    assert fields["steps.5.last_voltage"] == ["quantity", "V"]
    assert fields["steps.5.points"] == ["number", ""]
