"""Faults of an acquisition at a given sample, to test what ends a run."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import inf
from threading import Event
from typing import Literal

import numpy as np

from sonolube.laboratory import Acquisition, Block, Channel, DeviceLost, Devices, SamplesLost

LATE = 3.0  # s

Kind = Literal["lost", "overrun", "late", "hang", "saturated", "no number"]


@dataclass
class FaultyAcquisition:
    """Acquisition that has a fault from a sample on.

    The devices answer no more; samples are lost; a block comes three seconds late, or never; the force gauge is at the
    end of its range, or its wire is broken.
    """

    device: Acquisition
    sample: int
    kind: Kind
    name: str = "virtual acquisition"
    names: tuple[str, ...] = ()
    read_so_far: int = 0
    delay: float = 0.0  # s, by which the clock is ahead of the samples
    released: Event = field(default_factory=Event)

    @property
    def channels(self) -> Mapping[str, Channel]:
        return self.device.channels

    def connect(self) -> None:
        self.device.connect()

    def start(self, channels: Sequence[str], *, sample_rate: float) -> float:
        self.names, self.read_so_far = tuple(channels), 0
        return self.device.start(channels, sample_rate=sample_rate)

    def read(self, samples: int) -> Block:
        first = self.read_so_far
        if self.sample < first + samples:
            self.fail(is_new=first <= self.sample)
        self.read_so_far += samples
        block = self.device.read(samples)
        broken = {"saturated": self.channels["friction_force"].highest, "no number": np.nan}
        if self.kind in broken and "friction_force" in self.names:
            block.values[max(0, self.sample - first) :, self.names.index("friction_force")] = broken[self.kind]
        return block

    def fail(self, *, is_new: bool) -> None:
        """Fail, wait or be late."""
        if self.kind == "hang" and is_new:
            self.delay = inf
            self.released.wait()
        if self.kind in ("lost", "hang"):
            raise DeviceLost(f"{self.name}: answers no more")
        if self.kind == "overrun" and is_new:
            raise SamplesLost(f"{self.name}: samples were overwritten before they were read")
        if self.kind == "late" and is_new:
            self.delay = LATE

    def stop(self) -> None:
        if self.delay == inf:
            self.released.set()
        self.device.stop()

    def close(self) -> None:
        self.stop()
        self.device.close()


def with_fault(devices: Devices, sample: int, kind: Kind) -> Devices:
    """Virtual devices whose acquisition has a fault from a sample on."""
    faulty, clock = FaultyAcquisition(devices.acquisition, sample, kind), devices.clock
    assert clock is not None
    return replace(devices, acquisition=faulty, clock=lambda: clock() + faulty.delay)
