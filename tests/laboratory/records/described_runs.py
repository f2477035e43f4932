"""Runs of every kind that is recorded, for the tests of what their netCDF files say of themselves."""

from pathlib import Path

import numpy as np
from tests.laboratory.records.recorded import RATE, block_of
from tests.laboratory.rig_stand_ins import analogue_rig

from sonolube.laboratory import Block, Channel, Sensor
from sonolube.laboratory.records import new_run, run_folders
from sonolube.tasks import lab

ROOT = Path(__file__).parents[3]
FREQUENCY = 22.3e3  # Hz, of the drive
CELL = Sensor(identifier="LCM-1", calibration="gain 2 N/V", calibrated="2026-03-01", uncertainty=0.05)
FACTS = {"protocol": "map_test", "rig": "tribometer", "creator": "Ann", "licence": "CC-BY-4.0", "institution": "Lab 1"}
CHANNELS = (
    Channel(name="friction_force", quantity="friction_force", sensor=CELL),
    Channel(name="voltage", quantity="stack_voltage"),
    Channel(name="humidity", quantity="relative_humidity"),
    Channel(name="emission", quantity="acoustic_emission", free_unit="m/s2"),
)
PROTOCOL = """title = "Short"
source = "none"

[limits]
voltage_maximum = "30 V"
duration_maximum = "2 s"

[metadata]
creator = "Ann"
licence = "CC-BY-4.0"
institution = "Lab 1"

[[steps]]
kind = "motor_speed"
sliding_speed = "50 mm/s"

[[steps]]
kind = "acquire"
channels = ["friction_force", "temperature", "voltage"]
sample_rate = "400 Hz"
duration = "0.4 s"

[[steps]]
kind = "drive"
voltage_peak_to_peak = "10 V"
frequency = "22 kHz"

[[steps]]
kind = "wait"
duration = "0.4 s"
"""


def lubricated(parent: Path) -> Path:
    """Run with set points, a lubricant, settings that were read back, and a wave that is aliased."""
    recorder = new_run(parent, title="Lubricated", protocol="", facts=FACTS)
    recorder.begin(CHANNELS, sample_rate=RATE)
    recorder.note("conditions", sample=0, normal_load=3.0, lubricant="PAO 6 / MoS2")
    recorder.note("motor", sample=0, rotation_speed=1.0, sliding_speed=0.05)
    recorder.note("drive", sample=100, voltage_peak_to_peak=20.0, frequency=FREQUENCY)
    recorder.note("read back", sample=100, step="3", answers="FREQ 22300; LOAD INF")
    values = np.tile([0.4, 3.0, 0.45, 9.0], (500, 1))
    recorder.append(Block(first_sample=0, sample_rate=RATE, values=values))
    return recorder.finish("completed").folder


def two_clocks(parent: Path) -> Path:
    """Run with a second clock of a tenth of the rate."""
    recorder = new_run(parent, title="Two clocks", protocol="", facts=FACTS)
    recorder.begin(CHANNELS[:2], sample_rate=RATE)
    pin = Channel(name="pin_temperature", quantity="temperature")
    recorder.begin_beside("slow", [pin, CHANNELS[2]], sample_rate=RATE / 10, first=3, ago=0.5, uncertainty=1e-3)
    recorder.append(block_of(0, 50))
    recorder.append(block_of(3, 20, RATE / 10), clock="slow")
    return recorder.finish("completed").folder


def virtual(parent: Path) -> Path:
    """Virtual run of a short protocol, with its truth."""
    protocol = parent / "short.toml"
    protocol.write_text(PROTOCOL, encoding="utf-8")
    lab.virtual(ROOT / "examples" / "rigs" / "power_map.toml", protocol=protocol, out=parent / "runs")
    return run_folders(parent / "runs")[0]


def by_device_map(parent: Path) -> Path:
    """Run of a short protocol on the devices of a map, which are stand-ins."""
    protocol = parent / "short.toml"
    protocol.write_text(PROTOCOL, encoding="utf-8")
    with analogue_rig(parent):
        lab.run(protocol, parent / "devices.toml", out=parent / "runs")
    return run_folders(parent / "runs")[0]


RUNS = {"lubricated": lubricated, "two clocks": two_clocks, "virtual": virtual, "device map": by_device_map}
