"""Interlocks: limits of a protocol that every block of samples is held to."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from sonolube.errors import InvalidInput, SeveralFaults
from sonolube.facts.protocol import Limits
from sonolube.laboratory.block import Block, Channel
from sonolube.units import format_si

_WATCHED: Final = {  # channel by the limit that it is held to
    "voltage_maximum": "voltage",
    "current_maximum": "current",
    "temperature_maximum": "temperature",
    "friction_force_maximum": "friction_force",
}
_SET_POINTS: Final = ("voltage_maximum",)  # held to by set points alone where no channel measures them


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


@dataclass(frozen=True, slots=True)
class Trip:
    """Sample beyond a limit.

    Parameters
    ----------
    channel : str
    sample : int
        Number of the sample since the acquisition started.
    reason : str
        What was beyond which limit.
    """

    channel: str
    sample: int
    reason: str


def interlocks_for(limits: Limits, channels: Mapping[str, Channel]) -> tuple[Interlock, ...]:
    """Interlocks for the limits of a protocol.

    Parameters
    ----------
    limits : Limits
    channels : mapping of str to Channel
        Of the acquisition, by name.

    Returns
    -------
    tuple of Interlock

    Raises
    ------
    InvalidInput
        If limits have no channel to watch them, or lie beyond the range of their channel.
    """
    found, faults = [], []
    for name, watched in _WATCHED.items():
        limit, channel = getattr(limits, name), channels.get(watched)
        if limit is None or (channel is None and name in _SET_POINTS):
            continue
        if channel is None:
            faults.append(
                f"limits.{name} cannot be watched: no device has a channel {watched}; add one, or leave the limit out"
            )
        elif limit > max(abs(channel.lowest), abs(channel.highest)):
            held, reach = format_si(limit, channel.unit), format_si(channel.highest, channel.unit)
            faults.append(f"limits.{name} of {held} lies beyond the range of channel {watched}, {reach}")
        else:
            found.append(Interlock(channel, limit))
    if faults:
        raise InvalidInput(faults[0]) if len(faults) == 1 else SeveralFaults(faults)
    return tuple(found)


def first_trip(block: Block, names: Sequence[str], locks: Sequence[Interlock]) -> Trip | None:
    """First sample of a block that is beyond a limit, is saturated, or is no number; None where all are within.

    Parameters
    ----------
    block : Block
    names : sequence of str
        Channels of the block in order.
    locks : sequence of Interlock

    Returns
    -------
    Trip or None
    """
    trips = []
    for lock in locks:
        samples = block.values[:, list(names).index(lock.channel.name)]
        within = (np.abs(samples) <= lock.limit) & (samples > lock.channel.lowest) & (samples < lock.channel.highest)
        if not within.all():
            at = int(np.argmin(within))
            trips.append(Trip(lock.channel.name, block.first_sample + at, _reason(lock, float(samples[at]))))
    return min(trips, key=lambda trip: trip.sample, default=None)


def _reason(lock: Interlock, value: float) -> str:
    """Why a sample trips an interlock."""
    channel, unit = lock.channel, lock.channel.unit
    if np.isnan(value):
        return f"channel {channel.name} gives no number"
    if abs(value) > lock.limit:
        return f"channel {channel.name} is {format_si(value, unit)}; its limit is {format_si(lock.limit, unit)}"
    return f"channel {channel.name} is saturated at {format_si(value, unit)}"
