"""A simulated rig whose friction follows the drive by a static characteristic, a first-order lag and a delay."""

from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from math import exp

import numpy as np
from tests.laboratory.simulated_rig import Fault

from sonolube.checks import Floats
from sonolube.laboratory import Block, Channel, Devices, DriveSetting

Friction = Callable[[Floats, float], Floats]
"""Friction in N by the envelope of the vibration, in V of a steady drive, and the speed of the disc, in 1/s."""


@dataclass
class LaggedRig:
    """Acquisition of a rig; its drive and motor act from the next sample on."""

    friction: Friction
    time_constant: float
    delay: float = 0.0  # s, of the drive
    deviation: float = 0.0  # N, of each sample
    disturbance: Callable[[float], float] = lambda time: 0.0  # N, added from outside
    fault: Fault = field(default_factory=Fault)
    skip_at: int = -1  # sample at which one is lost
    name: str = "lagged rig"
    swing: float = 0.0
    turns: float = 0.0
    envelope: float = 0.0
    rate: float = 0.0
    sample: int = 0
    peaks: list[float] = field(default_factory=list)
    is_stuck: bool = False

    def __post_init__(self) -> None:
        self.random = np.random.default_rng(5)
        self.pending: deque[float] = deque()

    @property
    def channels(self) -> Mapping[str, Channel]:
        """Friction, drive and temperature."""
        return {
            "friction_force": Channel(name="friction_force", quantity="friction_force", lowest=-20, highest=20),
            "voltage_peak_to_peak": Channel(name="voltage_peak_to_peak", quantity="voltage_peak_to_peak"),
            "temperature": Channel(name="temperature", quantity="temperature"),
        }

    def devices(self) -> Devices:
        """Return the rig as the loop takes it."""
        about = {"rig": "lagged"}
        return Devices(
            acquisition=self,
            drive=LaggedDrive(self),
            motor=LaggedMotor(self),
            description=about,
            groove_diameter=0.0582,
            simulated=True,
        )

    @property
    def is_off(self) -> bool:
        """Whether motor and drive are off."""
        return self.turns == 0 and self.swing == 0

    def connect(self) -> None:
        self.fault.pass_call()

    def close(self) -> None:
        pass

    def start(self, channels: Sequence[str], *, sample_rate: float) -> float:
        self.fault.pass_call()
        self.names, self.rate, self.sample = tuple(channels), sample_rate, 0
        self.pending = deque([0.0] * round(self.delay * sample_rate))
        return sample_rate

    def read(self, samples: int) -> Block:
        self.fault.pass_call()
        kept = exp(-1 / (self.rate * self.time_constant))
        envelope = np.empty(samples)
        for index in range(samples):
            self.pending.append(self.swing)
            self.envelope = kept * self.envelope + (1 - kept) * self.pending.popleft()
            envelope[index] = self.envelope
        time = (self.sample + np.arange(samples)) / self.rate
        force = self.friction(envelope, self.turns) + np.array([self.disturbance(each) for each in time])
        force = (force if self.turns else 0 * force) + self.deviation * self.random.standard_normal(samples)
        columns = {
            "friction_force": force,
            "voltage_peak_to_peak": np.full(samples, self.swing),
            "temperature": np.full(samples, 294.0),
        }
        first = self.sample + (1 if -1 < self.skip_at <= self.sample else 0)
        self.sample += samples
        values = np.column_stack([columns[name] for name in self.names])
        return Block(first_sample=first, sample_rate=self.rate, values=values)

    def stop(self) -> None:
        self.rate = 0.0


@dataclass
class LaggedDrive:
    """Drive of the rig."""

    rig: LaggedRig
    name: str = "lagged drive"
    voltage_maximum: float = 200.0

    def connect(self) -> None:
        self.rig.fault.pass_call()

    def drive(self, setting: DriveSetting) -> None:
        self.rig.fault.pass_call()
        self.rig.swing = setting.voltage_peak_to_peak
        self.rig.peaks.append(setting.voltage_offset + setting.voltage_peak_to_peak / 2)

    def off(self) -> None:
        self.rig.swing = 0.0

    def close(self) -> None:
        pass


@dataclass
class LaggedMotor:
    """Motor of the rig; may be stuck at its speed."""

    rig: LaggedRig
    name: str = "lagged motor"
    rotation_speed_maximum: float = 10.0

    def connect(self) -> None:
        self.rig.fault.pass_call()

    def turn(self, rotation_speed: float) -> None:
        self.rig.fault.pass_call()
        self.rig.turns = rotation_speed

    def off(self) -> None:
        if self.rig.is_stuck:
            raise RuntimeError("relay welded")
        self.rig.turns = 0.0

    def close(self) -> None:
        pass
