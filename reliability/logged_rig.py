"""Rig whose hardware is a log: a driver package found by entry points, a fault injected into one of its calls.

The log has a line for whatever an output was set to, and is right whatever becomes of the programs.
"""

import json
import os
import subprocess
import sys
import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sonolube.laboratory.records import last_verdict

DRIVERS = '''
import ctypes, json, os, signal, time
from pathlib import Path
from typing import Literal
import numpy as np
from sonolube.laboratory import Block, Channel
from sonolube.laboratory.devices import DeviceError
from sonolube.laboratory.drivers import AcquisitionEntry, ChannelEntry, DriveEntry, MotorEntry

HERE = Path(__file__).parent
FAULT = json.loads((HERE / "fault.json").read_text())
STARTED = time.monotonic()


class Unspeakable(Exception):
    def __str__(self):
        raise RuntimeError("no words")


def write(line):
    handle = os.open(HERE / "log.txt", os.O_WRONLY | os.O_CREAT | os.O_APPEND)
    os.write(handle, f"{os.getpid()} {line}\\n".encode())
    os.close(handle)


def met(where):
    """Count a call, and do what its fault says before it goes on."""
    write(f"call {where}")
    if FAULT.get("where") != where:
        return None
    seen = sum(line.endswith(f"call {where}") for line in (HERE / "log.txt").read_text().splitlines())
    if FAULT.get("call", 1) not in (0, seen):
        return None
    kind, _, value = FAULT["kind"].partition(" ")
    if kind == "hang":
        time.sleep(1e4)
    elif kind == "late":
        time.sleep(float(value))
    elif kind == "held":  # by a library that keeps the interpreter's lock
        ctypes.PyDLL(None).usleep(int(1e6 * float(value)))
    elif kind == "signal":
        os.kill(os.getpid(), getattr(signal, value))
        time.sleep(0.3)
    elif kind == "exit":
        os._exit(int(value))
    elif kind == "acts":  # as its value says, where the call looks for it
        return value
    elif kind == "unspeakable":
        raise Unspeakable
    elif kind == "raise":
        raise {"DeviceError": DeviceError}.get(value) or getattr(__builtins__, value, None) or __builtins__[value]


class Output:
    def __init__(self, name):
        self.name, self.voltage_maximum, self.rotation_speed_maximum = name, 80.0, 5.0

    def connect(self):
        met(f"{self.name}.connect")
        write(f"{self.name} 0")

    def drive(self, setting):
        met(f"{self.name}.drive")
        write(f"{self.name} {setting.voltage_peak_to_peak:g}")

    def turn(self, rotation_speed):
        met(f"{self.name}.turn")
        write(f"{self.name} {rotation_speed:g}")

    def off(self):
        if met(f"{self.name}.off") != "lies":
            write(f"{self.name} 0")

    def close(self):
        met(f"{self.name}.close")
        if FAULT != {"where": f"{self.name}.off", "kind": "acts lies", "call": 0}:
            write(f"{self.name} 0")


class Inputs:
    name = "inputs"

    def __init__(self, channels):
        self.channels = {each.name: each for each in channels}

    def connect(self):
        met("inputs.connect")

    def start(self, channels, *, sample_rate):
        if met("inputs.start") == "slowly":
            sample_rate = sample_rate / 10
        self.names, self.rate, self.next, self.began = list(channels), sample_rate, 0, time.monotonic()
        return sample_rate

    def read(self, samples):
        acts = met("inputs.read")
        time.sleep(max(0.0, (self.next + samples) / self.rate - (time.monotonic() - self.began)))
        first, self.next = self.next, self.next + samples
        values = {"whole numbers": np.int16(-32768), "infinity": np.inf}.get(acts, 0.5)
        columns, rows = len(self.names) * (2 if acts == "doubled" else 1), samples * (2 if acts == "longer" else 1)
        return Block(
            first_sample=first - samples if acts == "stale" else first,
            sample_rate=self.rate / (10 if acts == "slowly" else 1),
            values=np.full((rows, columns), values),
        )

    def stop(self):
        met("inputs.stop")

    def close(self):
        met("inputs.close")


class LoggedInputs(AcquisitionEntry):
    driver: Literal["logged"]
    channels: tuple[ChannelEntry, ...]
    model_config = {"strict": False}
    @property
    def where(self):
        return "log"

    @property
    def reserved_as(self):
        return "logged inputs"


    @property
    def channel_entries(self):
        return self.channels

    def new_device(self, files):
        return Inputs([each.channel(lowest=-10.0, highest=10.0) for each in self.channels])


class LoggedDrive(DriveEntry):
    driver: Literal["logged"]
    @property
    def where(self):
        return "log"

    @property
    def reserved_as(self):
        return "logged drive"


    def new_device(self):
        return Output("drive")


class LoggedMotor(MotorEntry):
    driver: Literal["logged"]
    @property
    def where(self):
        return "log"

    @property
    def reserved_as(self):
        return "logged motor"


    def new_device(self):
        return Output("motor")
'''
ENTRY_POINTS = """[sonolube.drivers]
acquisition.logged = logged_rig_drivers:LoggedInputs
drive.logged = logged_rig_drivers:LoggedDrive
motor.logged = logged_rig_drivers:LoggedMotor
"""
MAP = """title = "Rig of a log"

[acquisition]
driver = "logged"

[[acquisition.channels]]
name = "friction_force"

[drive]
driver = "logged"
voltage_maximum = "80 V"
frequency_maximum = "100 kHz"

[motor]
driver = "logged"
rotation_speed_maximum = "300 rpm"
groove_diameter = "50 mm"
"""
PROTOCOL = """title = "short"
source = "none"

[limits]
voltage_maximum = "30 V"
duration_maximum = "200 s"

[[steps]]
kind = "acquire"
channels = ["friction_force"]
sample_rate = "400 Hz"
duration = "DURATION s"

[[steps]]
kind = "motor_speed"
rotation_speed = "1 Hz"

[[steps]]
kind = "drive"
voltage_peak_to_peak = "20 V"
frequency = "22 kHz"

[[steps]]
kind = "wait"
duration = "DURATION s"
"""


_PATIENT = """import runpy
import sonolube.laboratory.supervision as supervision
supervision.LATE = 3600.0
runpy.run_module("sonolube", run_name="__main__", alter_sys=True)
"""


@dataclass(frozen=True, kw_only=True)
class Ended:
    """What a run has left: exit code, both streams, the last setting of each output, and the record's last words."""

    code: int
    output: str
    error: str
    drive: float
    motor: float
    record: str

    @property
    def is_off(self) -> bool:
        """Whether both outputs are off."""
        return self.drive == self.motor == 0


class LoggedRig:
    """A run of `lab run` on the logged rig.

    Parameters
    ----------
    folder : Path
    fault : mapping of str to object
        where (such as drive.off), call (from 1; 0 for all), kind: hang, late S, held S, signal NAME, exit CODE, raise
        NAME, unspeakable, or acts: lies, slowly, doubled, longer, stale, whole numbers, infinity.
    duration : float
        Of the run. [s]
    is_patient : bool
        Whether its supervisor lets blocks and calls be late, so that no run ends because the machine is slow.
    """

    def __init__(self, folder: Path, *, duration: float = 0.4, is_patient: bool = False, **fault: Any) -> None:
        self.folder = folder
        self._begin = ["-c", _PATIENT] if is_patient else ["-m", "sonolube"]
        folder.mkdir(exist_ok=True)
        metadata = folder / "logged_rig-1.0.dist-info"
        metadata.mkdir()
        (metadata / "METADATA").write_text("Metadata-Version: 2.1\nName: logged-rig\nVersion: 1.0\n")
        (metadata / "entry_points.txt").write_text(ENTRY_POINTS)
        (folder / "logged_rig_drivers.py").write_text(DRIVERS)
        (folder / "fault.json").write_text(json.dumps(fault))
        (folder / "devices.toml").write_text(MAP)
        (folder / "short.toml").write_text(PROTOCOL.replace("DURATION", f"{duration:g}"))

    def start(self) -> "subprocess.Popen[str]":
        """Start the program of the run."""
        path, own = os.pathsep.join([str(self.folder), *filter(None, sys.path)]), str(self.folder / "state")
        words = [*self._begin, "lab", "run", "short.toml", "--device", "devices.toml", "--out", "runs", "--json"]
        return subprocess.Popen(
            [sys.executable, *words],
            cwd=self.folder,
            env=os.environ | {"PYTHONPATH": path} | dict.fromkeys(("XDG_STATE_HOME", "SONOLUBE_DEVICE_LOCKS"), own),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    def ended(self, process: "subprocess.Popen[str]") -> Ended:
        """What is left when every process of the run has ended."""
        output, error = process.communicate(timeout=120)
        return Ended(
            code=process.returncode,
            output=output,
            error=error,
            drive=self.last("drive"),
            motor=self.last("motor"),
            record=self._record(),
        )

    def run(self) -> Ended:
        """Run to the end."""
        return self.ended(self.start())

    @property
    def log(self) -> list[list[str]]:
        """Lines of the hardware: process, output, value."""
        with suppress(FileNotFoundError):
            return [line.split() for line in (self.folder / "log.txt").read_text().splitlines()]
        return []

    def last(self, output: str) -> float:
        """Value that an output was set to last."""
        return next((float(words[2]) for words in reversed(self.log) if words[1] == output), 0.0)

    def wait_until_on(self, output: str = "drive") -> None:
        """Wait until an output is on."""
        latest = time.monotonic() + 60
        while self.last(output) == 0:
            assert time.monotonic() < latest, f"{output} was never on"
            time.sleep(0.02)

    def _record(self) -> str:
        """Verdict in the record; empty without one."""
        folders = list((self.folder / "runs").glob("*/"))
        return last_verdict(folders[0]) if folders else ""
