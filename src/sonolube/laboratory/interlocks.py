"""Interlocks: limits of a protocol that every block is held to, and whether channels show the drive that they limit."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from operator import itemgetter
from typing import Final

import numpy as np

from sonolube.errors import InvalidInput, SeveralFaults
from sonolube.facts.protocol import Limits, Protocol, SetPoint, flattened
from sonolube.laboratory.block import CHANNEL_QUANTITIES, Block, Channel
from sonolube.laboratory.devices import Devices, DriveSetting
from sonolube.text.units import format_si

SAMPLES_PER_PERIOD: Final = 5
"""Of the drive, from which on samples show its peaks within a fifth."""

IDLE_RATE: Final = 1000.0
"""Sample rate of protocols that record nothing. [Hz]"""

WAVES: Final = ("voltage", "current")
"""Channels whose samples are values of the wave itself."""


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
        blind = [name for name in WAVES if name in set(channels)]
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


_WATCHED: Final[Mapping[str, Sequence[str]]] = {  # channels by the limit that they are held to
    "duration_maximum": (),  # which the time line is held to
    "voltage_maximum": ("voltage", "voltage_peak_to_peak"),
    "current_maximum": ("current", "current_peak", "current_rms"),
    "temperature_maximum": ("temperature",),
    "friction_force_maximum": ("friction_force",),
}
_SET_POINTS: Final = ("voltage_maximum", "duration_maximum")  # held to by set points where no channel measures them
_OFF_SHARE: Final = 0.05  # of the limit of the voltage, below which the drive counts as off
_OFF_VOLTAGE: Final = 1.0  # V, at least, for the offsets of monitors
_STILL_SHARE: Final = 0.01  # of the speed of the motor, below which the disc counts as at rest
_ROUNDING: Final = 1 + 1e-9
_OF_LIMIT: Final = {
    "current_rms": 0.5**0.5,
    "voltage_peak_to_peak": 2.0,
}  # rms of a sine, and peak to peak, over a peak


@dataclass(frozen=True, slots=True)
class Interlock:
    """Limit of one channel.

    Parameters
    ----------
    channel : Channel
    limit : float
        Of the magnitude of its samples, in SI.
    """

    channel: Channel
    limit: float


def interlocks_for(
    limits: Limits, channels: Mapping[str, Channel], drive: DriveSampling | None
) -> tuple[Interlock, ...]:
    """Interlocks for the limits of a protocol.

    Parameters
    ----------
    limits : Limits
    channels : mapping of str to Channel
        Of the acquisition, by name.
    drive : DriveSampling or None
        Of the protocol; None where nothing is driven.

    Returns
    -------
    tuple of Interlock
        A limit of the current holds for `current` and `current_peak`; over the square root of two for `current_rms`.
        That of the voltage, which is of a peak, holds for `voltage`, and twice it for `voltage_peak_to_peak`. Channels
        of other names with the same quantities are held too.

    Raises
    ------
    InvalidInput
        If limits have no channel to watch them, or lie beyond the range of their channel; if the current is limited,
        fewer than five samples a period are taken of it, and no channel measures its peak, or its rms under a sine.
    """
    found, faults = [], []
    for name in Limits.model_fields:
        watched = _WATCHED[name]
        limit, present = getattr(limits, name), _watching(channels, watched)
        if limit is None or (not present and name in _SET_POINTS):
            continue
        locks = [Interlock(each, limit * _OF_LIMIT.get(_standard_name(each), 1.0)) for each in present]
        fault = _fault(name, watched[0], locks, drive)
        faults += [fault] if fault else []
        found += locks
    for channel in channels.values():
        if channel.limit < np.inf:
            lock = Interlock(channel, channel.limit)
            faults += [_beyond_range(f"limit of channel {channel.name}", lock)] if _is_beyond_range(lock) else []
            found.append(lock)
    if faults:
        raise InvalidInput(faults[0]) if len(faults) == 1 else SeveralFaults(faults)
    return tuple(found)


def _watching(channels: Mapping[str, Channel], watched: Sequence[str]) -> list[Channel]:
    """Channels that a limit holds: those of these names, then others of the same quantities."""
    quantities = {CHANNEL_QUANTITIES[name] for name in watched}
    named = [channels[each] for each in watched if each in channels]
    return [*named, *(each for each in channels.values() if each.quantity in quantities and each not in named)]


_NAMES: Final = {quantity: name for name, quantity in CHANNEL_QUANTITIES.items()}


def _standard_name(channel: Channel) -> str:
    """Name that every rig uses for the quantity of a channel."""
    return _NAMES.get(channel.quantity, channel.name)


def _is_beyond_range(lock: Interlock) -> bool:
    """Whether a limit lies beyond the range of its channel, which would be saturated before."""
    return lock.limit > max(abs(lock.channel.lowest), abs(lock.channel.highest))


def _beyond_range(name: str, lock: Interlock) -> str:
    """Fault of a limit beyond the range of its channel."""
    channel = lock.channel
    held, reach = format_si(lock.limit, channel.unit), format_si(channel.highest, channel.unit)
    return f"{name} of {held} lies beyond the range of channel {channel.name}, {reach}"


def _fault(name: str, watched: str, locks: Sequence[Interlock], drive: DriveSampling | None) -> str:
    """Why a limit cannot be held by its interlocks; empty where it can."""
    if not locks:
        return f"limits.{name} cannot be watched: no device has a channel {watched}; add one, or leave the limit out"
    for lock in locks:
        if _is_beyond_range(lock):
            return _beyond_range(f"limits.{name}", lock)
    measured = {_standard_name(lock.channel): lock.channel for lock in reversed(locks)}
    if name != "current_maximum" or drive is None or drive.of(measured.get("current")).is_resolved:
        return ""
    if "current_peak" in measured or ("current_rms" in measured and drive.is_sine):
        return ""
    reason = drive.of(measured.get("current")).caveat(["current"])
    if "current_rms" in measured:
        reason += "; of other waves than a sine, current_rms tells no peak"
    needed = format_si(SAMPLES_PER_PERIOD * drive.frequency, "Hz")
    others = "a channel current_peak" if not drive.is_sine else "a channel current_peak or current_rms"
    return (
        f"limits.{name} cannot be watched: {reason}; record at {needed} or more, add {others}, or leave the limit out"
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class RunLimits:
    """Limits of a run as channels and set points are held to them, made once, before anything is connected.

    Parameters
    ----------
    stated : Limits
        By the protocol.
    locks : tuple of Interlock
        Of channels while the run samples.
    off : tuple of (str, Interlock)
        Bounds of channels that show whether drive or motor are off, with which of them.
    drive : DriveSampling or None
        None where nothing is driven.
    """

    stated: Limits
    locks: tuple[Interlock, ...]
    off: tuple[tuple[str, Interlock], ...]
    drive: DriveSampling | None

    @property
    def frequency(self) -> float:
        """Highest that the drive has; 0 without one. [Hz]"""
        return 0.0 if self.drive is None else max(self.drive.frequency, self.drive.frequency_maximum)

    def unresolved(self, recorded: Sequence[str], channels: Mapping[str, Channel]) -> str:
        """Quantities of the drive that record and limits do not show, in one line; empty where they show all."""
        names = [*recorded, *(lock.channel.name for lock in self.locks)]
        return "" if self.drive is None else self.drive.caveat_of(names, channels)


def run_limits(limits: Limits, devices: Devices, drive: DriveSampling | None) -> RunLimits:
    """Limits of a run on devices.

    Parameters
    ----------
    limits : Limits
        Of the protocol.
    devices : Devices
    drive : DriveSampling or None
        Of the protocol; None where nothing is driven.

    Returns
    -------
    RunLimits

    Raises
    ------
    InvalidInput
        As `interlocks_for`.
    """
    locks = interlocks_for(limits, devices.channels, drive)
    return RunLimits(stated=limits, locks=locks, off=tuple(off_bounds(devices, limits)), drive=drive)


def off_bounds(devices: Devices, limits: Limits) -> list[tuple[str, Interlock]]:
    """Bounds of channels that show whether motor or drive are off, with what is off within them."""
    channels = devices.channels
    volts = max(_OFF_SHARE * limits.voltage_maximum, _OFF_VOLTAGE)
    at_rest = {
        "voltage": ("drive", volts),
        "voltage_peak_to_peak": ("drive", 2 * volts),
        "rotation_speed": ("motor", _STILL_SHARE * devices.motor.rotation_speed_maximum),
    }
    return [(what, Interlock(channels[name], most)) for name, (what, most) in at_rest.items() if name in channels]


def set_point_trip(setting: DriveSetting, limits: Limits) -> str:
    """Why the peak of a drive setting, offset included, is beyond the limit of the voltage; empty where it is not."""
    most, reached = limits.voltage_maximum, setting.voltage_maximum
    if reached <= most * _ROUNDING:
        return ""
    return f"the drive is to be set to {format_si(reached, 'V')}; limits.voltage_maximum is {format_si(most, 'V')}"


def first_trip(block: Block, names: Sequence[str], locks: Sequence[Interlock]) -> str:
    """Why the first sample that trips does: beyond its limit, saturated, or no number; empty where all are within.

    Parameters
    ----------
    block : Block
    names : sequence of str
        Channels of the block in order.
    locks : sequence of Interlock

    Returns
    -------
    str
    """
    trips = []
    for lock in locks:
        samples = block.values[:, list(names).index(lock.channel.name)]
        within = (np.abs(samples) <= lock.limit) & (samples > lock.channel.lowest) & (samples < lock.channel.highest)
        if not within.all():
            at = int(np.argmin(within))
            trips.append((at, _reason(lock, float(samples[at]))))
    return min(trips, key=itemgetter(0), default=(0, ""))[1]


def _reason(lock: Interlock, value: float) -> str:
    """Why a sample trips an interlock."""
    channel, unit = lock.channel, lock.channel.unit
    if np.isnan(value):
        return f"channel {channel.name} gives no number"
    if abs(value) > lock.limit:
        return f"channel {channel.name} is {format_si(value, unit)}; its limit is {format_si(lock.limit, unit)}"
    return f"channel {channel.name} is saturated at {format_si(value, unit)}"
