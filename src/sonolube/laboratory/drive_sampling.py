"""Sampling of the drive: whether channels of voltage and current are sampled often enough to show its peaks."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

from sonolube.facts.protocol import Protocol, SetPoint, flattened
from sonolube.laboratory.block import Channel
from sonolube.text.units import format_si

SAMPLES_PER_PERIOD: Final = 5
"""Of the drive, from which on samples show its peaks within a fifth."""

IDLE_RATE: Final = 1000.0
"""Sample rate of protocols that record nothing. [Hz]"""

_WAVES: Final = ("voltage", "current")  # channels whose samples are values of the wave itself


@dataclass(frozen=True, kw_only=True, slots=True)
class DriveSampling:
    """Sample rate and frequency of the drive where it is sampled the least.

    Parameters
    ----------
    sample_rate : float
        [Hz]
    frequency : float
        Of the drive. [Hz]
    is_sine : bool
        Whether the drive is a sine throughout.
    frequency_maximum : float
        Of the drive where it is higher, in Hz.
    """

    sample_rate: float
    frequency: float
    is_sine: bool = True
    frequency_maximum: float = 0.0

    @property
    def is_resolved(self) -> bool:
        """Whether a period of the drive has at least five samples."""
        return self.sample_rate >= SAMPLES_PER_PERIOD * self.frequency * (1 - 1e-9)

    def of(self, channel: Channel | None) -> "DriveSampling":
        """Sampling by a channel, which may have a sample rate of its own; this one for None."""
        if channel is None or channel.sample_rate is None:
            return self
        highest = max(self.frequency, self.frequency_maximum)
        return replace(self, sample_rate=channel.sample_rate, frequency=highest)

    def caveat_of(self, names: Iterable[str], channels: Mapping[str, Channel]) -> str:
        """Caveat of channels that do not show the drive, each at its own rate."""
        by_rate: dict[DriveSampling, list[str]] = {}
        for name in names:
            by_rate.setdefault(self.of(channels.get(name)), []).append(name)
        return "; ".join(filter(None, (sampling.caveat(them) for sampling, them in by_rate.items())))

    def caveat(self, channels: Iterable[str]) -> str:
        """Caveat of channels of voltage and current that do not show the drive, in one line; empty where they do."""
        blind = [name for name in _WAVES if name in set(channels)]
        if self.is_resolved or not blind:
            return ""
        them = f"{' and '.join(blind)} at {format_si(self.sample_rate, 'Hz')} {'do' if len(blind) > 1 else 'does'}"
        return f"{them} not resolve the drive (fewer than five samples a period)"


def drive_sampling(protocol: Protocol) -> DriveSampling | None:
    """Sampling of the drive of a protocol, where it is sampled the least; None without a drive."""
    points = flattened(protocol)
    driven = [(rate, point.frequency) for rate, point in _sampled(points) if point.frequency is not None]
    if not driven:
        return None
    rate, frequency = min(driven, key=lambda each: each[0] / each[1])
    is_sine = all(point.waveform == "sine" for point in points if point.frequency is not None)
    highest = max(each for _, each in driven)
    return DriveSampling(sample_rate=rate, frequency=frequency, is_sine=is_sine, frequency_maximum=highest)


def recorded_channels(protocol: Protocol) -> tuple[str, ...]:
    """Channels that a protocol records while the drive is on, each once.

    Parameters
    ----------
    protocol : Protocol

    Returns
    -------
    tuple of str
    """
    driven = (point for point in flattened(protocol) if point.frequency is not None)
    return tuple(dict.fromkeys(name for point in driven for name in point.channels))


def idle_rate(points: Sequence[SetPoint]) -> float:
    """Sample rate after the last recording: that of the last one, else `IDLE_RATE`. [Hz]"""
    rates = [point.sample_rate for point in points if point.sample_rate is not None]
    return rates[-1] if rates else IDLE_RATE


def _sampled(points: Sequence[SetPoint]) -> Iterator[tuple[float, SetPoint]]:
    """Sample rate at each set point: that of the recording, else after a prompt that of the next, else the former."""
    rate: float | None = None
    for number, point in enumerate(points):
        if point.sample_rate is not None:
            rate = point.sample_rate
        elif point.kind == "prompt" or rate is None:
            later = (each.sample_rate for each in points[number:] if each.sample_rate is not None)
            rate = next(later, idle_rate(points))
        yield rate, point
