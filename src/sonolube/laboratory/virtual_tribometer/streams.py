"""Streams of samples of a virtual rig, each of one acquisition: sources, clock and noise; distortion of the drive."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from sonolube.checks import Floats
from sonolube.laboratory.devices import DriveSetting
from sonolube.laboratory.virtual_tribometer.signals import ColouredNoise

VIBRATION: Final = ("vibration_amplitude", "surface_velocity", "surface_displacement")
"""Signals by the vibration of the contact."""


def _as_is(values: Floats) -> Floats:
    """Values of a sensor without range."""
    return values


@dataclass(frozen=True, kw_only=True, slots=True)
class Source:
    """Signal of the virtual rig that a channel reads, and its sensor.

    Parameters
    ----------
    signal : str
        Such as friction_force; rest for a channel of which the rig knows nothing.
    contact_share : float or None
        Place of a thermocouple: 0 on the actuator, 1 in the contact; None takes that of the disturbances.
    rest, noise : float
        Value and standard deviation of the signal rest, in SI.
    reading : callable
        Values as they are read, of those that are there, in SI.
    """

    signal: str
    contact_share: float | None = None
    rest: float = 0.0
    noise: float = 0.0
    reading: Callable[[Floats], Floats] = _as_is


class Stream:
    """Samples of one acquisition of a virtual rig.

    Parameters
    ----------
    sources : mapping of str to Source
        By the names of the channels.
    generator : callable
        Random numbers of a channel and a part of its noise.
    """

    def __init__(self, sources: Mapping[str, Source], generator: Callable[[str, str], np.random.Generator]) -> None:
        self.sources, self.generator = sources, generator
        self.names: tuple[str, ...] = ()
        self.rate, self.epoch, self.sample = 0.0, 0.0, 0
        self.played: dict[str, float] = {}
        self._noises: dict[tuple[str, str], ColouredNoise] = {}
        self._feedback: Mapping[str, tuple[float, float]] = {}

    @property
    def shows_vibration(self) -> bool:
        """Whether a channel reads the vibration of the contact."""
        return any(source.signal in VIBRATION for source in self.sources.values())

    def start(
        self, names: Sequence[str], *, rate: float, time: float, feedback: Mapping[str, tuple[float, float]]
    ) -> None:
        """Begin with sample 0 at a time, in s; the parts of noise have their feedback, the random numbers go on."""
        self.names, self.rate, self.epoch, self.sample = tuple(names), rate, time, 0
        self._feedback = feedback
        for (name, part), former in self._noises.items():
            self._noises[name, part] = ColouredNoise(former.generator, feedback.get(part, (0.0, 0.0)))

    def next_times(self, samples: int) -> Floats:
        """Times of the next samples, which are taken then. [s]"""
        first = self.sample
        self.sample = first + samples
        return np.asarray(self.epoch + (first + np.arange(samples)) / self.rate)

    def noise(self, name: str, part: str, samples: int) -> Floats:
        """Next noise of unit variance of a channel."""
        key = name, part
        if key not in self._noises:
            self._noises[key] = ColouredNoise(self.generator(*key), self._feedback.get(part, (0.0, 0.0)))
        return self._noises[key].next(samples)


_SECOND_FREQUENCY: Final = 1000.0  # Hz, of generators after they were switched on


@dataclass(frozen=True, kw_only=True, slots=True)
class OutputDistortion:
    """Deviation of the output of a drive source from its setting.

    Parameters
    ----------
    factor : float
        Of the voltage; 0 for no output at all.
    modulation_frequency : float
        Of a modulation of the amplitude between 0 and its whole value, in Hz; 0 without.
    second_share : float
        Amplitude of a sine of 1 kHz that is added, over that of the wave.
    """

    factor: float = 1.0
    modulation_frequency: float = 0.0
    second_share: float = 0.0

    @property
    def mean_envelope(self) -> float:
        """Mean of the amplitude over its whole value."""
        return 0.5 if self.modulation_frequency else 1.0

    def applied(self, setting: DriveSetting | None) -> DriveSetting | None:
        """Setting with the factor; None for no output."""
        return self._scaled(setting, self.factor)

    def vibrating(self, setting: DriveSetting | None) -> DriveSetting | None:
        """Setting of the mean amplitude, at which the contact vibrates; None for no output."""
        return self._scaled(setting, self.factor * self.mean_envelope)

    def envelope(self, time: Floats) -> Floats:
        """Amplitude over its whole value at times."""
        if not self.modulation_frequency:
            return np.ones_like(time)
        return np.asarray(0.5 * (1 + np.sin(2 * np.pi * self.modulation_frequency * time)))

    def second(self, time: Floats) -> Floats:
        """Sine that is added, over half the peak-to-peak value of the wave."""
        return np.asarray(self.second_share * np.sin(2 * np.pi * _SECOND_FREQUENCY * time))

    @staticmethod
    def _scaled(setting: DriveSetting | None, factor: float) -> DriveSetting | None:
        """Setting with its voltages times a factor."""
        if setting is None or factor == 0:
            return None
        if factor == 1:
            return setting
        return replace(
            setting,
            voltage_peak_to_peak=factor * setting.voltage_peak_to_peak,
            voltage_offset=factor * setting.voltage_offset,
        )
