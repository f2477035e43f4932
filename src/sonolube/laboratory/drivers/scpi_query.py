"""Slow channels of instruments by SCPI: queries in a steady period, such as those of a logger with thermocouples."""

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

import numpy as np

from sonolube.errors import UnknownName
from sonolube.laboratory.block import Block, Channel
from sonolube.laboratory.devices import DeviceError, SamplesLost
from sonolube.laboratory.drivers.scpi_replies import ErrorQueue, Reply, require_identity, send
from sonolube.laboratory.drivers.visa_connection import VisaConnection
from sonolube.text.units import format_si

_LATE_PERIODS: Final = 1.0  # by which a query may begin late


@dataclass(frozen=True, kw_only=True, slots=True)
class QueriedChannel:
    """Channel read by a query.

    Parameters
    ----------
    channel : Channel
    reply : Reply
    gain, offset : float
        Of the number in the answer to the quantity, in SI.
    """

    channel: Channel
    reply: Reply
    gain: float = 1.0
    offset: float = 0.0


class ScpiQueries:
    """Channels of one instrument, asked for in a steady period by the clock of the computer.

    Parameters
    ----------
    connection : VisaConnection
    identity : str
        Pattern of the answer to ``*IDN?``.
    setup : sequence of str
        Sent once after connecting.
    errors : ErrorQueue or None
    period : float
        [s]
    channels : sequence of QueriedChannel
        Those with one query share its answer.
    """

    def __init__(
        self,
        connection: VisaConnection,
        *,
        identity: str,
        setup: Sequence[str],
        errors: ErrorQueue | None,
        period: float,
        channels: Sequence[QueriedChannel],
    ) -> None:
        self.name = connection.name
        self._line, self._identity, self._setup, self._errors = connection, identity, tuple(setup), errors
        self._period = period
        self._known = {each.channel.name: each for each in channels}
        self._chosen: tuple[QueriedChannel, ...] = ()
        self._began, self._next = 0.0, 0

    @property
    def channels(self) -> Mapping[str, Channel]:
        """Channels that can be recorded, by name."""
        return MappingProxyType({name: each.channel for name, each in self._known.items()})

    def connect(self) -> None:
        """Open the connection and set the instrument up."""
        if self._line.is_open:
            return
        self._line.open()
        try:
            require_identity(self._line, self._identity)
            if self._errors is not None:
                self._errors.errors(self._line)  # of the last user
            for command in self._setup:
                send(self._line, command, self._errors)
        except BaseException:
            self._line.close()
            raise

    def start(self, channels: Sequence[str], *, sample_rate: float) -> float:
        """Begin the first period, and return the rate of the queries. [Hz]"""
        for name in channels:
            if name not in self._known:
                raise DeviceError(f"{self.name}: {UnknownName.among(self._known, kind='channel', name=name)}")
        if not self._line.is_open:
            raise DeviceError(f"{self.name}: connect it before sampling")
        self._chosen = tuple(self._known[name] for name in channels)
        self._began, self._next = time.monotonic(), 0
        return 1 / self._period

    def read(self, samples: int) -> Block:
        """Wait for the next periods, and return what the instrument answers in each."""
        if not self._chosen:
            raise DeviceError(f"{self.name}: start it before reading")
        first = self._next
        values = np.array([self._sample() for _ in range(samples)])
        return Block(first_sample=first, sample_rate=1 / self._period, values=values)

    def stop(self) -> None:
        """Ask no more."""
        self._chosen = ()

    def close(self) -> None:
        """Close the connection."""
        self.stop()
        self._line.close()

    def _sample(self) -> list[float]:
        """Values of the next period, in SI."""
        due = self._began + self._next * self._period
        if (wait := due - time.monotonic()) > 0:
            time.sleep(wait)
        elif -wait > _LATE_PERIODS * self._period:
            raise SamplesLost(
                f"{self.name}: its answers take longer than the period of {format_si(self._period, 's')}; lengthen it"
            )
        self._next += 1
        answers = {query: self._line.ask(query) for query in dict.fromkeys(each.reply.query for each in self._chosen)}
        return [
            each.gain * each.reply.number(answers[each.reply.query], device=self.name) + each.offset
            for each in self._chosen
        ]
