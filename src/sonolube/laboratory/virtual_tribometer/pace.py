"""Time that a protocol will take on a virtual rig, by a few blocks and set points that are computed to see."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import pi
from statistics import median
from time import monotonic
from typing import Final

from sonolube.checks import Floats
from sonolube.facts.protocol import PROMPT_DURATIONS, Prompt, Protocol, SetPoint, flattened, step_at
from sonolube.laboratory.block import BLOCK_DURATION
from sonolube.laboratory.devices import DriveSetting
from sonolube.laboratory.virtual_tribometer.simulation import VirtualRig
from sonolube.laboratory.virtual_tribometer.streams import Stream
from sonolube.text.units import format_si

WORTH_SAYING: Final = 1.0
"""Expected time from which on it is said before a run. [s]"""

_HANDLING: Final = 5e-4  # s, of a run for one block: threads, limits, record
_BLOCKS: Final = 5  # that are computed to see
_IDLE: Final = 1000.0  # Hz, of what is not recorded


@dataclass(frozen=True, kw_only=True, slots=True)
class ExpectedTime:
    """Time that a protocol is expected to take on a virtual rig.

    Parameters
    ----------
    duration : float
        Of the protocol, without prompts. [s]
    samples : int
        Of all recordings and channels.
    wall_time : float
        By the clock on the wall, on this computer as it is loaded now, in s; within a factor of two or so.
    spent : float
        Of it, on set points that were computed to see, which the run then has; in s.
    """

    duration: float
    samples: int
    wall_time: float
    spent: float = 0.0

    @property
    def left(self) -> float:
        """Time that is left for the run. [s]"""
        return self.wall_time - self.spent

    @property
    def text(self) -> str:
        """Expected time, duration and samples, in words."""
        return self._spoken(self.wall_time)

    @property
    def text_before_run(self) -> str:
        """The same of the time that is left; empty where that is not worth saying."""
        return self._spoken(self.left) if self.left > WORTH_SAYING else ""

    def _spoken(self, wall_time: float) -> str:
        """A time with duration and samples, in words."""
        takes, lasts = format_si(wall_time, "s", digits=2), format_si(self.duration, "s", digits=3)
        return f"about {takes} on this computer for {lasts} of the rig and {self.samples:,} samples"


def expected_time(
    virtual: VirtualRig,
    protocol: Protocol,
    *,
    channels: tuple[str, ...],
    groove_diameter: float,
    beside: Sequence[tuple[Stream, float]] = (),
) -> ExpectedTime:
    """Time that a protocol is expected to take on a virtual rig, whose samples stay as they are.

    Parameters
    ----------
    virtual : VirtualRig
        Of which a copy reads some blocks; at most two of its set points are computed, which the run then has.
    protocol : Protocol
    channels : tuple of str
        Of the acquisition with the clock of protocols.
    groove_diameter : float
        Of the circle under the pin. [m]
    beside : sequence of (Stream, float)
        Acquisitions with clocks of their own, which sample all the time, also while somebody is asked, each with its
        sample rate in Hz.

    Returns
    -------
    ExpectedTime
    """
    points = flattened(protocol)
    recorded = [point for point in points if point.begins_recording]
    own = {name: rate for stream, rate in beside for name in stream.sources}
    samples = sum(
        round(_lasts(each) * own.get(name, each.sample_rate or 0.0)) for each in recorded for name in each.channels
    )
    duration = points[-1].time
    wall, spent = _prepared(virtual, points, groove_diameter)
    by_block: dict[tuple[tuple[str, ...], float], float] = {}
    for point, following in pairwise(points):
        names = tuple(name for name in point.channels if name in channels) or channels[:1]
        key = names, point.sample_rate or _IDLE
        if key not in by_block:
            by_block[key] = _per_block(virtual, *key, beside=beside)
        wall += (following.time - point.time) / BLOCK_DURATION * by_block[key]
    asked = [step_at(protocol, point.step) for point in points if point.kind == "prompt"]
    if beside and asked:
        prompts = sum(PROMPT_DURATIONS[step.task] for step in asked if isinstance(step, Prompt))
        with_them, alone = (_per_block(virtual, channels[:1], _IDLE, beside=each) for each in (beside, ()))
        wall += prompts / BLOCK_DURATION * max(0.0, with_them - alone)
    return ExpectedTime(duration=duration, samples=samples, wall_time=wall, spent=spent)


def _lasts(point: SetPoint) -> float:
    """Time that is recorded from a set point on. [s]"""
    return (point.recorded_until or point.time) - point.time


def _per_block(
    virtual: VirtualRig, names: tuple[str, ...], rate: float, *, beside: Sequence[tuple[Stream, float]]
) -> float:
    """Time for one block of channels, and for those of other clocks in its time, in s."""
    trial, count, times = virtual.trial(), max(1, round(BLOCK_DURATION * rate)), []
    trial.start(names, rate)
    for stream, own in beside:
        trial.start_beside(Stream(stream.sources, stream.generator), tuple(stream.sources), own, _dropped)
    trial.turn(1.0)
    for _ in range(_BLOCKS):
        began = monotonic()
        trial.read(count)
        times.append(monotonic() - began)
    return median(times) + _HANDLING


def _dropped(_: Floats) -> None:
    """Take samples that are computed to see."""


def _prepared(virtual: VirtualRig, points: tuple[SetPoint, ...], groove_diameter: float) -> tuple[float, float]:
    """Time for the friction at all set points, by the first two of them, and that spent on these. [s]"""
    wanted = list(dict.fromkeys(_vibrated(point, groove_diameter) for point in points if point.frequency is not None))
    took = []
    for setting, turns in wanted[:2]:
        began = monotonic()
        virtual.prepare(setting, turns)
        took.append(monotonic() - began)
    return sum(took) + max(len(wanted) - len(took), 0) * (took[-1] if took else 0.0), sum(took)


def _vibrated(point: SetPoint, groove_diameter: float) -> tuple[DriveSetting | None, float]:
    """Setting of drive and motor at a set point with a drive."""
    turns = point.rotation_speed
    if turns is None:
        turns = (point.sliding_speed or 0.0) / (pi * groove_diameter)
    if point.voltage_peak_to_peak == 0:
        return None, turns
    setting = DriveSetting(
        voltage_peak_to_peak=point.voltage_peak_to_peak,
        voltage_offset=point.voltage_offset,
        frequency=point.frequency or 0.0,
        waveform=point.waveform,
    )
    return setting, turns
