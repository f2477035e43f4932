"""Instruments by SCPI whose commands stand in a device map: identity, setup, errors, replies, and slow channels.

Slow channels, such as those of a logger with thermocouples, are asked for in a steady period.
"""

import re
import time
from collections.abc import Mapping, Sequence
from fnmatch import fnmatchcase
from functools import cached_property
from types import MappingProxyType
from typing import Annotated, Final, Literal, Self

import numpy as np
from pydantic import AfterValidator, Field, model_validator

from sonolube.errors import UnknownName
from sonolube.facts.protocol.quantity_text import SiText, Table
from sonolube.laboratory.block import Block, Channel
from sonolube.laboratory.devices import Acquisition, DeviceError, SamplesLost
from sonolube.laboratory.drivers.entry import AcquisitionEntry, ChannelEntry, Line
from sonolube.laboratory.drivers.visa_connection import VisaConnection, VisaLineEntry
from sonolube.text.units import format_si, to_si

_NUMBER: Final = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+)(?:E[-+]?\d+)?)\s*(?:V|VPP|HZ)?", re.IGNORECASE)
_MAX_ERRORS: Final = 50
_OVERLOAD: Final = 9.9e37  # by SCPI, for no reading or one beyond the range


def _plain(text: str) -> str:
    """Command without a place for a number."""
    if re.search(r"[{}]", text.replace("{highest}", "").replace("{lowest}", "")):
        raise ValueError("must hold no braces but {highest} and {lowest}")
    return text


Setup = Annotated[tuple[Annotated[Line, AfterValidator(_plain)], ...], Field(strict=False, max_length=50)]


class ScpiEntry(VisaLineEntry):
    """Keys of every instrument whose SCPI commands stand in the map."""

    identity: Annotated[Line, Field(min_length=3)]
    setup: Setup = ()


class ErrorEntry(Table):
    """Query of the error queue.

    Parameters
    ----------
    query : str
    none : str
        Beginning of its answer up to a comma where there is no error.
    """

    query: Line = "SYST:ERR?"
    none: Line = "0"

    def errors(self, line: VisaConnection) -> list[str]:
        """All errors of an instrument, which has none afterwards.

        Parameters
        ----------
        line : VisaConnection

        Returns
        -------
        list of str

        Raises
        ------
        DeviceError
            If there is no end of them.
        """
        found: list[str] = []
        while len(found) <= _MAX_ERRORS:
            answer = line.ask(self.query)
            if answer.partition(",")[0].strip().lstrip("+") == self.none:
                return found
            found.append(answer[:80])
        raise DeviceError(f"{line.name}: answers {found[-1]!r} to {self.query!r} without end")


class ReplyEntry(Table):
    """Query whose answer has a number.

    Parameters
    ----------
    query : str
    item : int
        Place in the list between commas, from 1.
    after : str
        Word behind which the number stands, in place of item.
    """

    query: Line
    item: Annotated[int, Field(ge=1, le=1000)] = 1
    after: Annotated[str, Field(max_length=40)] = ""

    def number(self, answer: str, *, device: str) -> float:
        """Number of an answer; NaN where the instrument has none or one beyond its range.

        Parameters
        ----------
        answer : str
        device : str
            Name in errors.

        Returns
        -------
        float

        Raises
        ------
        DeviceError
            If no number stands there.
        """
        items = [each.strip() for each in answer.split(",")]
        place = self.item - 1
        if self.after:
            words = [each.rpartition(" ")[2].upper() for each in items]
            place = words.index(self.after.upper()) + 1 if self.after.upper() in words else len(items)
        found = _NUMBER.fullmatch(items[place]) if place < len(items) else None
        if found is None:
            where = f"behind {self.after}" if self.after else f"at place {self.item}"
            raise DeviceError(f"{device}: answers {answer[:80]!r} to {self.query!r}; expected a number {where}")
        value = float(found[1])
        return value if abs(value) < _OVERLOAD else float("nan")


def require_identity(line: VisaConnection, pattern: str) -> None:
    """Ask an instrument who it is until that answer comes, passing over answers to commands that were broken off."""
    line.ask_until("*IDN?", lambda heard: fnmatchcase(heard.upper(), pattern.upper()), expected=pattern)


def send(line: VisaConnection, command: str, errors: ErrorEntry | None) -> None:
    """Send a command, and raise where the instrument has put an error into its queue."""
    line.write(command)
    complaints = [] if errors is None else errors.errors(line)
    if complaints:
        raise DeviceError(f"{line.name}: refuses {command!r}: {'; '.join(complaints[:3])}")


CHECKED: Final = ("load", "unit", "frequency_mode", "modulation", "combination", "trips")
"""What makes another voltage of the same frequency, amplitude and offset, and is read back where a query tells it."""


class CheckEntry(Table):
    """Query whose answer shows that an output is as it was set up.

    Parameters
    ----------
    of : str
        load, unit, frequency_mode, modulation, combination or trips.
    query : str
    answer : str
        Pattern of the answer, with * for any text; several between |.
    """

    of: Literal["load", "unit", "frequency_mode", "modulation", "combination", "trips"]
    query: Line
    answer: Line

    def require(self, line: VisaConnection) -> str:
        """Ask, and return the answer.

        Raises
        ------
        DeviceError
            If it is another: somebody at the panel, or the instrument itself, has changed the output.
        """
        heard = line.ask(self.query)
        if not any(fnmatchcase(heard.upper(), each.strip().upper()) for each in self.answer.split("|")):
            what, needed = self.of.replace("_", " "), self.answer.replace("|", " or ")
            raise DeviceError(
                f"{line.name}: answers {heard[:80]!r} to {self.query!r}, of its {what}; {needed} was set up"
            )
        return heard


DIFFERENCES: Final = {"frequency": (1e-4, 0.0, "Hz"), "amplitude": (2e-3, 1e-3, "V"), "offset": (2e-3, 1e-3, "V")}
"""Share, and absolute in a unit, by which a value that is read back may differ from the one that was set."""


def require_set(name: str, *, found: float, wanted: float, device: str) -> None:
    """Raise DeviceError where a generator has another frequency, amplitude or offset than the one that was set."""
    share, absolute, unit = DIFFERENCES[name]
    if not abs(found - wanted) <= share * abs(wanted) + absolute:
        has, was = format_si(found, unit), format_si(wanted, unit)
        raise DeviceError(f"{device}: has the {name} {has} where {was} was set")


def require_state(line: VisaConnection, query: str, states: Sequence[str]) -> None:
    """Raise DeviceError where an output answers at once, up to a comma, with another state than one of those."""
    heard = line.ask(query)
    if heard.partition(",")[0] not in states:
        raise DeviceError(f"{line.name}: answers {heard[:80]!r} to {query!r}; expected {states[0]!r}")


_LATE_PERIODS: Final = 1.0  # by which a query may begin late


class QueriedChannelEntry(ReplyEntry, ChannelEntry):
    """Channel read by a query.

    Parameters
    ----------
    name : str
    quantity, unit, limit, identifier, calibrated, uncertainty : str or None
        As those of every channel.
    query : str
        Channels with the same query share one answer.
    item : int
        Place in the list between commas, from 1.
    after : str
        Word behind which the number stands, in place of item.
    answer_unit : str or None
        Unit of the number, such as degC; that of SI by default.
    """

    answer_unit: Annotated[str, Field(max_length=40)] | None = None

    @model_validator(mode="after")
    def _require_convertible(self) -> Self:
        self.conversion  # noqa: B018
        return self

    @cached_property
    def conversion(self) -> tuple[float, float]:
        """Gain and offset of the number in the answer to SI."""
        if self.answer_unit is None:
            return 1.0, 0.0
        zero, one = (to_si(f"{n} {self.answer_unit}", unit=self.si_unit, name="answer_unit") for n in (0, 1))
        return one - zero, zero

    def value(self, answer: str, *, device: str) -> float:
        """Value of the channel in SI by an answer to its query."""
        gain, offset = self.conversion
        return gain * self.number(answer, device=device) + offset


class ScpiQueryEntry(ScpiEntry, AcquisitionEntry):
    """Instrument that is asked for its readings in a steady period.

    Parameters
    ----------
    driver : str
    resource : str
        As VISA calls it.
    visa_library : str
    baud_rate : int or None
        Of a serial port.
    termination : str
    identity : str
        Pattern of the answer to *IDN?, with * for any text.
    setup : tuple of str
        Sent once after connecting.
    error : ErrorEntry or None
    period : float
        Time between two queries, longer than all of their answers take. [s]
    channels : tuple of QueriedChannelEntry
    description : str
    """

    driver: Literal["scpi_query"]
    error: ErrorEntry | None = None
    period: Annotated[float, SiText("s", 0.02, 3600.0)]
    channels: Annotated[tuple[QueriedChannelEntry, ...], Field(strict=False, min_length=1, max_length=64)]

    @model_validator(mode="after")
    def _require_period(self) -> Self:
        if self.sample_rate is not None:
            raise ValueError("sample_rate: period tells it")
        return self

    @property
    def own_rate(self) -> float:
        """Queries a second. [Hz]"""
        return 1 / self.period

    @property
    def channel_entries(self) -> Sequence[ChannelEntry]:
        """Channels."""
        return self.channels

    def new_device(self, files: Mapping[str, str]) -> Acquisition:
        """Instrument, not connected."""
        return ScpiQueries(self)


class ScpiQueries:
    """Channels of one instrument, asked for in a steady period by the clock of the computer.

    Parameters
    ----------
    entry : ScpiQueryEntry
    """

    def __init__(self, entry: ScpiQueryEntry) -> None:
        self._line, self._entry, self._period = entry.line("instrument"), entry, entry.period
        self.name = self._line.name
        self.channels: Mapping[str, Channel] = MappingProxyType(
            {each.name: each.channel(sample_rate=entry.own_rate) for each in entry.channels}
        )
        self._known = {each.name: each for each in entry.channels}
        self._chosen: tuple[QueriedChannelEntry, ...] = ()
        self._began, self._next = 0.0, 0

    def connect(self) -> None:
        """Open the connection and set the instrument up."""
        if self._line.is_open:
            return
        self._line.open()
        try:
            require_identity(self._line, self._entry.identity)
            if self._entry.error is not None:
                self._entry.error.errors(self._line)  # of the last user
            for command in self._entry.setup:
                send(self._line, command, self._entry.error)
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
        answers = {query: self._line.ask(query) for query in dict.fromkeys(each.query for each in self._chosen)}
        return [each.value(answers[each.query], device=self.name) for each in self._chosen]
