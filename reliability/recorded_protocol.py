"""Protocols run on the virtual tribometer into memory: recordings with their set points, and the friction they hold."""

from collections.abc import Sequence
from math import pi
from typing import TYPE_CHECKING

import numpy as np

from reliability.shortened_protocols import require_completed
from sonolube.facts.protocol import protocol_by_name_or_file
from sonolube.laboratory import Block, Channel, run_protocol
from sonolube.laboratory.virtual_tribometer import virtual_tribometer
from sonolube.rig import Rig

if TYPE_CHECKING:
    import xarray as xr

    from sonolube.measurement import VoltageStep

_SAME_VOLTAGE = 0.3  # V
_SAME_SPEED = 1e-3  # of a speed
_DIAMETER = 0.028  # m


class MemoryRecord:
    """Blocks and set points of the parts of a recording, in memory."""

    def __init__(self) -> None:
        self.parts: list[list[Block]] = []
        self.settings: list[list[tuple[int, float, float]]] = []  # sample, voltage, sliding speed
        self._voltage, self._speed = 0.0, 0.0

    def begin(self, channels: Sequence[Channel], *, sample_rate: float) -> None:
        """Begin a part."""
        self.parts.append([])
        self.settings.append([(0, self._voltage, self._speed)])

    def append(self, block: Block, *, clock: str = "") -> None:
        """Keep a block of the clock of the run."""
        if not clock:
            self.parts[-1].append(block)

    def end(self, *, clock: str = "") -> None:
        """End a part."""

    def begin_beside(
        self,
        clock: str,
        channels: Sequence[Channel],
        *,
        sample_rate: float,
        first: int,
        ago: float,
        uncertainty: float,
        offset: float | None = None,
    ) -> None:
        """Leave out other clocks."""

    def note(self, kind: str, *, sample: int | None = None, **facts: str | float) -> None:
        """Keep the set points."""
        if kind == "drive":
            self._voltage = float(facts["voltage_peak_to_peak"])
        elif kind == "motor":
            self._speed = float(facts["rotation_speed"]) * pi * _DIAMETER
        if self.settings and kind in ("drive", "motor"):
            self.settings[-1].append((sample or 0, self._voltage, self._speed))

    def finish(self, outcome: str, *, reason: str = "") -> None:
        """Nothing is open."""

    def datasets(self, *, with_speed: bool) -> "list[xr.Dataset]":
        """Force and set voltage, and the set speed where it is asked for, over the time of each part."""
        import xarray as xr

        found = []
        for blocks, settings in zip(self.parts, self.settings, strict=True):
            force = np.concatenate([block.values[:, 0] for block in blocks])
            number = np.arange(force.size)
            sample, voltage, speed = np.array(settings).T
            since = np.searchsorted(sample, number, side="right") - 1
            data = {"friction_force": ("time", force), "voltage_peak_to_peak": ("time", voltage[since])}
            if with_speed:
                data["sliding_speed_set"] = ("time", speed[since])
            found.append(xr.Dataset(data, {"time": number / blocks[0].sample_rate}))
        return found


def recorded_protocol(rig: Rig, protocol: str, *, seed: int) -> "tuple[MemoryRecord, xr.Dataset]":
    """Recording of a protocol on the virtual rig, and its truth."""
    virtual = virtual_tribometer(rig, seed=seed, groove_diameter=_DIAMETER)
    record = MemoryRecord()
    result = run_protocol(protocol_by_name_or_file(protocol), virtual.devices, record, operator=lambda prompt: True)
    require_completed(protocol, outcome=result.outcome, reason=result.reason)
    return record, virtual.truth()


class TrueForces:
    """Worn-in friction of the virtual rig at its settings, those of one voltage and speed in the order of time."""

    def __init__(self, truth: "xr.Dataset") -> None:
        names = ("voltage_peak_to_peak", "sliding_speed", "friction_force")
        self._voltage, self._speed, self._force = (truth[name].to_numpy() for name in names)

    def at(self, step: "VoltageStep", *, time: int = 0) -> float:
        """Force at the voltage and speed of a step, for the given time of them. [N]"""
        is_same = (self._speed > 0) & (np.abs(self._voltage - step.voltage_peak_to_peak) < _SAME_VOLTAGE)
        if step.sliding_speed is not None:
            is_same &= np.abs(self._speed - step.sliding_speed) < _SAME_SPEED * self._speed
        return float(self._force[is_same][time])
