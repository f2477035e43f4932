"""Faults that a virtual tribometer has at a given sample, to test a runner."""

from dataclasses import dataclass, field
from math import inf
from threading import Event
from typing import Final, Literal

import numpy as np

from sonolube.checks import Floats
from sonolube.laboratory.devices import DeviceLost, SamplesLost

_LATE: Final = 3.0  # s


@dataclass(frozen=True, slots=True)
class Fault:
    """A fault of the virtual hardware.

    Parameters
    ----------
    sample : int
        Of the acquisition, from 0, at which it happens.
    kind : {"lost", "overrun", "late", "hang", "saturated", "no number"}
        The devices answer no more; samples are lost; a block comes three seconds late, or never; the force gauge is at
        the end of its range, or its wire is broken.
    """

    sample: int
    kind: Literal["lost", "overrun", "late", "hang", "saturated", "no number"]


@dataclass(slots=True)
class FaultyReading:
    """Reading of the virtual hardware, with its fault.

    Parameters
    ----------
    fault : Fault or None
    delay : float
        By which the clock is ahead of the samples, in s.
    """

    fault: Fault | None
    delay: float = 0.0
    _released: Event = field(default_factory=Event)

    def begin(self, first: int, samples: int) -> None:
        """Fail, wait or be late where the fault is reached by samples from a first one on."""
        fault = self.fault
        if fault is None or fault.sample >= first + samples:
            return
        is_new = first <= fault.sample
        if fault.kind == "hang" and is_new:
            self.delay = inf
            self._released.wait()
        if fault.kind in ("lost", "hang"):
            raise DeviceLost("virtual acquisition: answers no more")
        if fault.kind == "overrun" and is_new:
            raise SamplesLost("virtual acquisition: samples were overwritten before they were read")
        if fault.kind == "late" and is_new:
            self.delay = _LATE

    def spoil(self, force: Floats, first: int, *, highest: float) -> None:
        """Spoil readings of the force gauge from the fault on."""
        broken = {"saturated": highest, "no number": np.nan}
        if self.fault is not None and self.fault.kind in broken:
            force[max(0, self.fault.sample - first) :] = broken[self.fault.kind]

    def release(self) -> None:
        """End a call that hangs."""
        if self.delay == inf:
            self._released.set()
