"""A run of eight channels at 100 kS/s: ten minutes locked to the clock, and an hour of samples as fast as it goes.

Run: python benchmarks/long_recording.py clock 600          (duration in s; 7.7 GB of disk for 600 s)
     python benchmarks/long_recording.py fast 2.9e9         (number of values; 49 GB of disk for 2.9e9)

Each is a run of the runner itself with its limits, counters and record, on devices whose acquisition keeps one second
of samples and no more, as the buffer of an instrument does. It prints blocks, gaps, the longest wait of samples in that
buffer, times and peak memory. The record is removed at the end.
"""

import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from peak_memory import peak_memory  # type: ignore[import-not-found]

from sonolube.facts.protocol import read_protocol
from sonolube.laboratory import Block, Channel, Devices, DriveSetting, SamplesLost, run_protocol
from sonolube.laboratory.block import quantity_of
from sonolube.laboratory.records import new_run, read_raw_blocks

RATE, CHANNELS = 100_000, 8
BUFFER = 1.0  # s
PROTOCOL = """
title = "Long recording"
source = "none"
[limits]
voltage_maximum = "400 V"
temperature_maximum = "100 degC"
duration_maximum = "{limit:.0f} s"
[metadata]
groove_diameter = "50 mm"
[[steps]]
kind = "acquire"
channels = [{channels}]
sample_rate = "{rate} Hz"
duration = "{duration:.6f} s"
[[steps]]
kind = "wait"
duration = "{duration:.6f} s"
"""
NAMES = (
    *("friction_force", "normal_load", "voltage", "voltage_peak_to_peak", "current", "temperature", "gaussmeter"),
    "displacement",
)


@dataclass
class Instrument:
    """Motor, drive and acquisition; samples come by the clock or as soon as they are asked for."""

    paced: bool
    name: str = "instrument"
    voltage_maximum: float = 100.0
    rotation_speed_maximum: float = 10.0
    values: np.ndarray = field(default_factory=lambda: np.random.default_rng(0).normal(300.0, 1.0, (1 << 16, CHANNELS)))
    began: float = 0.0
    sample: int = 0
    longest_wait: float = 0.0

    @property
    def channels(self) -> Mapping[str, Channel]:
        """Eight of them."""
        return {name: Channel(name=name, quantity=quantity_of(name), lowest=0.0, highest=1000.0) for name in NAMES}

    def connect(self) -> None:
        """Nothing to reserve."""

    def close(self) -> None:
        """Nothing to release."""

    def off(self) -> None:
        """Nothing runs."""

    def stop(self) -> None:
        """Sample no more."""

    def drive(self, setting: DriveSetting) -> None:
        """Nothing to drive."""

    def turn(self, rotation_speed: float) -> None:
        """Nothing to turn."""

    def start(self, channels: Sequence[str], *, sample_rate: float) -> float:
        """Begin to sample."""
        self.began, self.sample = time.monotonic(), 0
        return sample_rate

    def read(self, samples: int) -> Block:
        """Samples, once they are there; lost where they had to wait for longer than the buffer holds."""
        first, self.sample = self.sample, self.sample + samples
        if self.paced:
            late = time.monotonic() - self.began - self.sample / RATE
            if late < 0:
                time.sleep(-late)
            self.longest_wait = max(self.longest_wait, late)
            if late > BUFFER:
                raise SamplesLost("instrument: samples were overwritten before they were read")
        return Block(first_sample=first, sample_rate=RATE, values=self.values[:samples])


def recorded(duration: float, *, paced: bool) -> None:
    """Record for a time of the sample clock, and print what came of it."""
    text = PROTOCOL.format(
        limit=2 * duration + 10, channels=", ".join(f'"{name}"' for name in NAMES), rate=RATE, duration=duration
    )
    instrument = Instrument(paced)
    devices = Devices(
        acquisition=instrument,
        drive=instrument,
        motor=instrument,
        description={"rig": "none"},
        groove_diameter=0.05,
        simulated=True,
    )
    with TemporaryDirectory(dir=Path.cwd() / "out") as folder:
        (written := Path(folder) / "long.toml").write_text(text, encoding="utf-8")
        recorder = new_run(Path(folder), title="long recording", protocol=text)
        begin, spent = time.perf_counter(), time.process_time()
        ended: list[float] = []
        finish = recorder.end

        def end(*, clock: str = "") -> None:
            finish(clock=clock)
            ended.append(time.perf_counter())

        recorder.end = end  # type: ignore[method-assign]
        result = run_protocol(read_protocol(written), devices, recorder, operator=lambda prompt: True)
        done = time.perf_counter()
        blocks = [
            (block.first_sample, block.samples) for block in read_raw_blocks(recorder.folder / "raw" / "blocks-1.bin")
        ]
        samples = sum(count for _, count in blocks)
        gaps = sum(one[0] + one[1] != other[0] for one, other in pairwise(blocks))
        lines = (
            f"{result.outcome} {result.reason}: {samples * CHANNELS:.4g} values in {len(blocks)} blocks, {gaps} gaps",
            f"recorded in {ended[0] - begin:.1f} s, written as netCDF in {done - ended[0]:.1f} s, "
            f"{time.process_time() - spent:.1f} s of processor time",
            f"longest wait in the buffer {1e3 * instrument.longest_wait:.1f} ms of {1e3 * BUFFER:.0f} ms"
            if paced
            else f"{samples * CHANNELS * 8 / (ended[0] - begin) / 1e6:.0f} MB/s",
            f"peak memory {peak_memory() / 1e6:.0f} MB",
        )
        sys.stdout.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    kind, amount = sys.argv[1], float(sys.argv[2])
    recorded(amount if kind == "clock" else amount / RATE / CHANNELS, paced=kind == "clock")
