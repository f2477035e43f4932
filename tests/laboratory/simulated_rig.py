"""A simulated rig of three devices that note what they are told and can fail at any call, and a record in memory."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from sonolube.errors import InvalidInput
from sonolube.laboratory import Block, Channel, DeviceLost, Devices, DriveSetting
from sonolube.laboratory.block import quantity_of

RANGES = {"friction_force": 20.0, "voltage": 200.0, "current": 1.0, "temperature": 1000.0, "gaussmeter": 1.0}


@dataclass
class Fault:
    """Failure at one of the calls to any device, counted from 0; a dead device answers none of the later ones."""

    call: int = -1
    error: BaseException = field(default_factory=lambda: DeviceLost("simulated: answers no more"))
    stays_dead: bool = True
    count: int = 0

    def pass_call(self) -> None:
        """Count a call, and fail at the one that was asked for."""
        number, self.count = self.count, self.count + 1
        if number == self.call or (self.stays_dead and -1 < self.call < number):
            raise self.error


@dataclass
class SimulatedRig:
    """Motor, drive and acquisition in one: force 1 N while the motor turns, 0.4 N with the drive on too."""

    fault: Fault = field(default_factory=Fault)
    values: Mapping[str, float] = field(default_factory=dict)
    skip_at: int = -1  # sample at which one is lost
    name: str = "simulated rig"
    voltage_maximum: float = 100.0
    rotation_speed_maximum: float = 10.0
    turns: float = 0.0
    setting: DriveSetting | None = None
    calls: list[str] = field(default_factory=list)
    connected: int = 0
    sample: int = 0
    total: int = 0
    time: float = 0.0
    rate: float = 0.0
    names: tuple[str, ...] = ()

    @property
    def channels(self) -> Mapping[str, Channel]:
        """All channels, symmetric ranges."""
        return {
            name: Channel(name=name, quantity=quantity_of(name), lowest=-reach, highest=reach)
            for name, reach in RANGES.items()
        }

    def devices(self) -> Devices:
        """Return the rig as the runner takes it."""
        return Devices(
            acquisition=self,
            drive=self,
            motor=self,
            description={"rig": "simulated"},
            groove_diameter=0.05,
            simulated=True,
            clock=lambda: self.time,
        )

    @property
    def is_off(self) -> bool:
        """Whether motor and drive are off."""
        return self.turns == 0 and self.setting is None

    def connect(self) -> None:
        self.fault.pass_call()
        self.connected += 1

    def close(self) -> None:
        self.calls.append("close")

    def start(self, channels: Sequence[str], *, sample_rate: float) -> float:
        self.fault.pass_call()
        self.names, self.rate, self.sample = tuple(channels), sample_rate, 0
        return sample_rate

    def read(self, samples: int) -> Block:
        self.fault.pass_call()
        force = 0.0 if self.turns == 0 else (1.0 if self.setting is None else 0.4)
        level = {"friction_force": force, "temperature": 293.0} | dict(self.values)
        row = [level.get(name, 0.0) for name in self.names]
        first = self.sample + (1 if -1 < self.skip_at <= self.total else 0)
        self.sample += samples
        self.total += samples
        self.time += samples / self.rate
        return Block(first_sample=first, sample_rate=self.rate, values=np.tile(row, (samples, 1)))

    def stop(self) -> None:
        self.rate = 0.0

    def drive(self, setting: DriveSetting) -> None:
        self.fault.pass_call()
        self.setting = setting
        self.calls.append(f"drive {setting.voltage_peak_to_peak:g} V")

    def turn(self, rotation_speed: float) -> None:
        self.fault.pass_call()
        self.turns = rotation_speed
        self.calls.append(f"turn {rotation_speed:.3g}")

    def off(self) -> None:
        self.turns, self.setting = 0.0, None
        self.calls.append("off")


@dataclass
class MemoryRecord:
    """Record of a run in memory; full after some blocks."""

    blocks_until_full: int = 10**9
    segments: list[list[Block]] = field(default_factory=list)
    notes: list[tuple[str, dict[str, object]]] = field(default_factory=list)
    outcome: str = ""
    reason: str = ""
    is_open: bool = False
    beside: dict[str, list[Block]] = field(default_factory=dict)
    rates_beside: dict[str, float] = field(default_factory=dict)
    open_beside: set[str] = field(default_factory=set)

    def begin(self, channels: Sequence[Channel], *, sample_rate: float) -> None:
        assert not self.is_open
        self.is_open = True
        self.segments.append([])

    def append(self, block: Block, *, clock: str = "") -> None:
        assert self.is_open
        if clock:
            assert clock in self.open_beside
            self.beside.setdefault(clock, []).append(block)
            return
        if sum(map(len, self.segments)) >= self.blocks_until_full:
            raise InvalidInput("blocks: no space left on device")
        self.segments[-1].append(block)

    def end(self, *, clock: str = "") -> None:
        assert self.is_open
        if clock:
            self.open_beside.remove(clock)
        else:
            self.is_open = False

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
        assert self.is_open
        assert clock not in self.open_beside
        assert uncertainty > 0
        self.open_beside.add(clock)
        self.rates_beside[clock] = sample_rate

    def note(self, kind: str, *, sample: int | None = None, **facts: str | float) -> None:
        self.notes.append((kind, dict(facts)))

    def finish(self, outcome: str, *, reason: str = "") -> None:
        assert not self.outcome
        self.outcome, self.reason = outcome, reason

    def samples(self) -> list[int]:
        """Number of samples of each part of the recording."""
        return [sum(block.samples for block in blocks) for blocks in self.segments]
