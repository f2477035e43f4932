"""Drivers that other packages add: by one file and one line of their pyproject, without a change of sonolube."""

import subprocess
import sys
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import pytest
from pytest import MonkeyPatch, approx, raises
from tests.cli.conftest import Program, sonolube as program

from sonolube.errors import InvalidInput
from sonolube.laboratory.drivers import known_drivers, read_device_map
from sonolube.laboratory.drivers.driver_table import DRIVERS
from sonolube.laboratory.records import read_run

sonolube = program

ACME = '''"""A rig of one maker: inputs, source and motor that write a line of what they do."""

import time
from pathlib import Path
from typing import Literal

import numpy as np

from sonolube.laboratory import Block
from sonolube.laboratory.drivers import AcquisitionEntry, ChannelEntry, DriveEntry, MotorEntry

LOG = Path(__file__).with_name("log.txt")


def note(text):
    with LOG.open("a") as file:
        file.write(text + "\\n")


class Inputs:
    def __init__(self, channels):
        self.name, self.channels = "acme inputs", {each.name: each for each in channels}

    def connect(self):
        note("inputs connect")

    def start(self, channels, *, sample_rate):
        self.rate, self.next, self.count = sample_rate, 0, len(channels)
        self.began = time.monotonic()
        return sample_rate

    def read(self, samples):
        first, self.next = self.next, self.next + samples
        time.sleep(max(self.began + self.next / self.rate - time.monotonic(), 0.0))
        return Block(first_sample=first, sample_rate=self.rate, values=np.full((samples, self.count), 0.5))

    def stop(self):
        pass

    def close(self):
        note("inputs close")


class Output:
    voltage_maximum = rotation_speed_maximum = 100.0

    def __init__(self, name):
        self.name = name

    def connect(self):
        note(f"{self.name} connect")

    def drive(self, setting):
        note(f"{self.name} {setting.voltage_peak_to_peak:g} V {setting.frequency:g} Hz")

    def turn(self, rotation_speed):
        note(f"{self.name} turns")

    def off(self):
        note(f"{self.name} off")

    def close(self):
        note(f"{self.name} close")


class AcmeInputs(AcquisitionEntry):
    driver: Literal["acme"]
    port: int
    channels: tuple[ChannelEntry, ...]
    model_config = {"strict": False}

    @property
    def where(self):
        return f"port {self.port}"

    @property
    def reserved_as(self):
        return f"acme inputs {self.port}"

    @property
    def channel_entries(self):
        return self.channels

    def new_device(self, files):
        return Inputs([each.channel(lowest=-10.0, highest=10.0) for each in self.channels])


class AcmeDrive(DriveEntry):
    driver: Literal["acme"]
    port: int

    @property
    def where(self):
        return f"port {self.port}"

    @property
    def reserved_as(self):
        return f"acme drive {self.port}"

    def new_device(self):
        return Output("drive")


class AcmeMotor(MotorEntry):
    driver: Literal["acme"]

    @property
    def where(self):
        return "axis"

    @property
    def reserved_as(self):
        return "acme motor"

    def new_device(self):
        return Output("motor")


class Needy(AcmeDrive):
    extras = ("abacus",)
    driver: Literal["needy"]


class Hollow(AcmeDrive):
    driver: Literal["hollow"]

    def new_device(self):
        raise OSError("no library libacme.so")


class Unfinished(DriveEntry):
    driver: Literal["unfinished"]
'''
ENTRY_POINTS = """[sonolube.drivers]
acquisition.acme = acme_lab:AcmeInputs
drive.acme = acme_lab:AcmeDrive
motor.acme = acme_lab:AcmeMotor
drive.unfinished = acme_lab:Unfinished
drive.needy = acme_lab:Needy
drive.hollow = acme_lab:Hollow
drive.other = acme_lab:Inputs
drive.function = acme_lab:note
drive.absent = acme_lab:Absent
drive.broken = acme_broken:Drive
"""
MAP = """title = "Rig of Acme"

[acquisition]
driver = "acme"
port = 7

[[acquisition.channels]]
name = "friction_force"

[[acquisition.channels]]
name = "emission"
quantity = "acoustic_emission"
unit = "V"

[drive]
driver = "acme"
port = 8
voltage_maximum = "80 V"
frequency_maximum = "100 kHz"

[motor]
driver = "acme"
rotation_speed_maximum = "300 rpm"
groove_diameter = "50 mm"
"""
PROTOCOL = """title = "short"
source = "none"

[limits]
voltage_maximum = "30 V"
duration_maximum = "2 s"

[[steps]]
kind = "acquire"
channels = ["friction_force", "emission"]
sample_rate = "400 Hz"
duration = "0.3 s"

[[steps]]
kind = "motor_speed"
rotation_speed = "1 Hz"

[[steps]]
kind = "drive"
voltage_peak_to_peak = "20 V"
frequency = "22 kHz"

[[steps]]
kind = "wait"
duration = "0.3 s"
"""


def install(folder: Path, *, name: str = "acme-lab", points: str = ENTRY_POINTS) -> None:
    """Install a package as an installer leaves it: modules beside a folder of metadata."""
    metadata = folder / f"{name.replace('-', '_')}-1.0.dist-info"
    metadata.mkdir(parents=True)
    (metadata / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
    (metadata / "entry_points.txt").write_text(points)


@pytest.fixture
def packages(tmp_path: Path, monkeypatch: MonkeyPatch) -> Iterator[Path]:
    """Folder of installed packages with that of Acme, another of whose modules cannot be imported."""
    folder = tmp_path / "packages"
    install(folder)
    (folder / "acme_lab.py").write_text(ACME)
    (folder / "acme_broken.py").write_text("raise OSError('no library libacme.so')\n")
    monkeypatch.syspath_prepend(str(folder))
    yield folder
    sys.modules.pop("acme_lab", None)


def written(folder: Path, text: str) -> Path:
    path = folder / "devices.toml"
    path.write_text(text)
    return path


def test_a_protocol_runs_on_devices_of_another_package(sonolube: Program, packages: Path, tmp_path: Path) -> None:
    (tmp_path / "short.toml").write_text(PROTOCOL)
    device_map = written(tmp_path, MAP)
    checked = sonolube("lab", "check", device_map, "--protocol", tmp_path / "short.toml", "--json").answer
    assert (checked["missing"], checked["impossible"]) == ([], [])
    ran = sonolube(
        "lab", "run", tmp_path / "short.toml", "--device", device_map, "--out", tmp_path / "runs", "--json"
    ).answer
    assert (ran["outcome"], ran["state"]) == ("completed", "safe")
    recording = read_run(Path(ran["folder"])).dataset()
    assert recording["friction_force"].to_numpy() == approx(0.5)
    assert recording["emission"].attrs["units"] == "V"
    lines = (packages / "log.txt").read_text().splitlines()
    assert lines.index("inputs connect") < lines.index("drive connect")
    assert "drive 20 V 22000 Hz" in lines
    assert lines[lines.index("drive 20 V 22000 Hz") + 1 :][:2] == ["drive off", "motor off"]
    assert {"drive close", "motor close", "inputs close"} <= set(lines)


def test_an_unknown_driver_is_refused_with_the_names_of_all(packages: Path, tmp_path: Path) -> None:
    path = written(tmp_path, MAP.replace('[drive]\ndriver = "acme"', '[drive]\ndriver = "acne"'))
    with raises(InvalidInput, match=r"drive: driver must be scpi, daqmx, scpi_commands, .*acme.* got 'acne'"):
        read_device_map(path)


def test_all_faults_of_a_section_of_another_package_are_told_with_their_keys(packages: Path, tmp_path: Path) -> None:
    path = written(tmp_path, MAP.replace("port = 8", 'prot = 8\nvoltage = "1 V"'))
    with raises(InvalidInput) as refusal:
        read_device_map(path)
    for part in ("drive.port: missing", "drive.prot: unknown key", "drive.voltage: unknown key"):
        assert part in str(refusal.value)


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        (
            "broken",
            r"driver drive\.broken of the package acme-lab cannot be loaded \(OSError: no library libacme\.so\)",
        ),
        ("absent", r"driver drive\.absent of the package acme-lab cannot be loaded \(AttributeError: "),
        ("needy", r"driver drive\.needy of the package acme-lab needs 'abacus', which is no optional part"),
        ("unfinished", r"driver drive\.unfinished of the package acme-lab is no complete DriveEntry; mend"),
        ("other", r"driver drive\.other of the package acme-lab is no complete DriveEntry; mend"),
        ("function", r"driver drive\.function of the package acme-lab is no complete DriveEntry; mend"),
    ],
)
def test_a_broken_driver_is_one_line_that_names_its_package(
    name: str, reason: str, packages: Path, tmp_path: Path
) -> None:
    path = written(tmp_path, MAP.replace('[drive]\ndriver = "acme"', f'[drive]\ndriver = "{name}"'))
    with raises(InvalidInput, match=reason) as refusal:
        read_device_map(path)
    assert "\n" not in str(refusal.value)


def test_a_driver_that_cannot_make_its_device_is_one_line(packages: Path, tmp_path: Path) -> None:
    read = read_device_map(written(tmp_path, MAP.replace('[drive]\ndriver = "acme"', '[drive]\ndriver = "hollow"')))
    with raises(InvalidInput, match=r"driver hollow \(acme_lab\.Hollow\) cannot make its device \(OSError: no library"):
        read.devices()


@pytest.mark.parametrize("broken", ["drive", "turn", "connect"])
def test_a_driver_of_another_package_that_raises_ends_the_run_with_outputs_off(
    broken: str, sonolube: Program, packages: Path, tmp_path: Path
) -> None:
    before, _, after = ACME.partition("class Output:")
    head, _, body = after.partition(f"    def {broken}(self")
    signature, _, rest = body.partition("\n")
    fault = "        raise ZeroDivisionError('driver')\n"
    (packages / "acme_lab.py").write_text(f"{before}class Output:{head}    def {broken}(self{signature}\n{fault}{rest}")
    (tmp_path / "short.toml").write_text(PROTOCOL)
    words = ("lab", "run", tmp_path / "short.toml", "--device", written(tmp_path, MAP), "--out", tmp_path / "runs")
    with suppress(ZeroDivisionError):  # the fault of a driver is shown as it is
        sonolube(*words, "--json")
    lines = (packages / "log.txt").read_text().splitlines()
    assert {"drive off", "motor off", "drive close", "motor close", "inputs close"} <= set(lines)
    (folder,) = (tmp_path / "runs").iterdir()
    assert read_run(folder).summary.outcome == "failed"


def test_a_driver_that_two_packages_add_is_refused_and_one_of_sonolube_is_not_replaced(
    packages: Path, tmp_path: Path
) -> None:
    points = "[sonolube.drivers]\ndrive.acme = other:Drive\ndrive.scpi = other:Drive\n"
    install(packages, name="other-lab", points=points)
    with raises(InvalidInput, match="package acme-lab and other-lab: several packages add it"):
        read_device_map(written(tmp_path, MAP))
    assert DRIVERS["drive"]["scpi"].__module__.startswith("sonolube.")
    assert list(DRIVERS["drive"]).count("scpi") == 1


def test_the_drivers_of_a_role_are_those_of_sonolube_then_those_of_packages(packages: Path) -> None:
    drives, guards = DRIVERS["drive"], DRIVERS["guard"]
    assert drives.own == ("scpi", "daqmx", "scpi_commands")
    assert list(drives)[:3] == list(drives.own)
    assert len(drives) == len(list(drives)) == 3 + len(drives.added)
    assert "acme" in drives
    assert "acme" not in guards
    assert (guards.own, list(guards), len(guards)) == (("daqmx",), ["daqmx"], 1)
    known = known_drivers()
    assert known["drive"][:4] == ("scpi", "daqmx", "scpi_commands", "absent (acme-lab)")
    assert known["guard"] == ("daqmx",)


def test_packages_are_looked_up_when_a_map_names_a_driver_that_sonolube_does_not_have(packages: Path) -> None:
    assert known_drivers()["drive"] == (
        *("scpi", "daqmx", "scpi_commands"),
        *("absent (acme-lab)", "acme (acme-lab)", "broken (acme-lab)", "function (acme-lab)", "hollow (acme-lab)"),
        *("needy (acme-lab)", "other (acme-lab)", "unfinished (acme-lab)"),
    )
    assert "acme_lab" not in sys.modules
    example = Path(__file__).parents[2] / "examples" / "lab" / "devices.toml"
    code = (
        "import importlib.metadata as m\n"
        "found = m.entry_points\n"
        "def refuse(**named):\n"
        "    assert named.get('group') != 'sonolube.drivers'\n"
        "    return found(**named)\n"
        "m.entry_points = refuse\n"
        f"import sys; sys.path.insert(0, {str(packages)!r})\n"
        "from sonolube.laboratory.drivers import read_device_map\n"
        f"read_device_map({str(example)!r}); print('acme_lab' in sys.modules)"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "False"
