"""Sections of a device map with the SCPI commands of an instrument: a source of the drive, slow channels."""

import re
from collections.abc import Mapping, Sequence
from typing import Annotated, ClassVar, Literal, Self

from pydantic import AfterValidator, Field, model_validator

from sonolube.facts.protocol.quantity_text import SiText, Table
from sonolube.laboratory.devices import Acquisition, DriveSource
from sonolube.laboratory.drivers.entry import AcquisitionEntry, ChannelEntry, DriveEntry, Line, Resource, VisaLibrary
from sonolube.laboratory.drivers.resources import visa_resource
from sonolube.laboratory.drivers.scpi_query import QueriedChannel, ScpiQueries
from sonolube.laboratory.drivers.scpi_replies import ErrorQueue, Reply
from sonolube.laboratory.drivers.scpi_source import ScpiSource, SourceCommands
from sonolube.laboratory.drivers.visa_connection import TERMINATIONS, VisaConnection
from sonolube.text.units import to_si


def _with_value(text: str) -> str:
    """Command with one place for a number."""
    if text.count("{value}") != 1 or re.search(r"[{}]", text.replace("{value}", "")):
        raise ValueError("must hold {value} once, and no other braces")
    return text


def _plain(text: str) -> str:
    """Command without a place for a number."""
    if re.search(r"[{}]", text.replace("{highest}", "").replace("{lowest}", "")):
        raise ValueError("must hold no braces but {highest} and {lowest}")
    return text


Setting = Annotated[Line, AfterValidator(_with_value)]
Setup = Annotated[tuple[Annotated[Line, AfterValidator(_plain)], ...], Field(strict=False, max_length=50)]
Item = Annotated[int, Field(ge=1, le=1000)]


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

    @property
    def queue(self) -> ErrorQueue:
        """As drivers take it."""
        return ErrorQueue(query=self.query, none=self.none)


class StateEntry(Table):
    """Query of the state of an output.

    Parameters
    ----------
    query, on, off : str
        The query, and its answers up to a comma.
    """

    query: Line
    on: Line
    off: Line

    @model_validator(mode="after")
    def _require_different(self) -> Self:
        if self.on == self.off:
            raise ValueError("on and off must differ")
        return self


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
    item: Item = 1
    after: Annotated[str, Field(max_length=40)] = ""

    @property
    def reply(self) -> Reply:
        """As drivers take it."""
        return Reply(query=self.query, item=self.item, after=self.after)


class ReadbackEntry(Table):
    """Queries of what was set.

    Parameters
    ----------
    frequency : ReplyEntry or None
        [Hz]
    amplitude, offset : ReplyEntry or None
        In V.
    """

    frequency: ReplyEntry | None = None
    amplitude: ReplyEntry | None = None
    offset: ReplyEntry | None = None

    @property
    def replies(self) -> dict[str, Reply]:
        """Queries that are stated, by the quantity that they read back."""
        named = {"frequency": self.frequency, "amplitude": self.amplitude, "offset": self.offset}
        return {name: entry.reply for name, entry in named.items() if entry is not None}


class WaveformEntry(Table):
    """Commands by waveform.

    Parameters
    ----------
    sine, square, triangle, sawtooth : str or None
    """

    sine: Line
    square: Line | None = None
    triangle: Line | None = None
    sawtooth: Line | None = None


class _LineEntry(Table):
    """Keys of every instrument on a line of VISA."""

    extras: ClassVar[tuple[str, ...]] = ("visa",)

    resource: Resource
    visa_library: VisaLibrary = "@py"
    baud_rate: Annotated[int, Field(ge=50, le=4_000_000)] | None = None
    termination: Literal["CR", "LF", "CRLF"] = "LF"
    identity: Annotated[Line, Field(min_length=3)]
    setup: Setup = ()

    @property
    def where(self) -> str:
        """Address."""
        return self.resource

    @property
    def reserved_as(self) -> str:
        """Canonical name of the instrument."""
        return visa_resource(self.resource)

    def line(self, kind: str) -> VisaConnection:
        """Connection, not open, to an instrument of a kind."""
        return VisaConnection(
            name=f"{kind} {self.resource}",
            resource=self.resource,
            library=self.visa_library,
            termination=TERMINATIONS[self.termination],
            baud_rate=self.baud_rate,
        )


class ScpiSourceEntry(_LineEntry, DriveEntry):
    """Function generator whose commands for one output stand here; `{value}` stands for a number in Hz or V.

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
        Sent once while the output is off: high impedance, peak-to-peak unit, no modulation, limits by {highest} and
        {lowest}.
    waveforms : WaveformEntry
    frequency : str
        Command with a number in Hz. [Hz]
    amplitude, offset : str
        Commands with a number in V; amplitude is peak to peak.
    amplitude_minimum : float
        Peak to peak, that the output gives, in V.
    on, off : str
    state : StateEntry
    error : ErrorEntry or None
    readback : ReadbackEntry
        Of frequency, amplitude and offset; all of them where there is no error queue.
    description, amplifier : str
        Model and serial number.
    amplifier_gain : float
        []
    voltage_maximum : float
        Magnitude at the actuator, offset included. [V]
    frequency_maximum : float
        In Hz.
    output_maximum : float
        Magnitude that the amplifier takes, in V.
    """

    extras: ClassVar[tuple[str, ...]] = ("visa",)

    driver: Literal["scpi_commands"]
    waveforms: WaveformEntry
    frequency: Setting
    amplitude: Setting
    offset: Setting
    amplitude_minimum: Annotated[float, SiText("V", 1e-6, 10.0)]
    on: Line
    off: Line
    state: StateEntry
    error: ErrorEntry | None = None
    readback: ReadbackEntry = ReadbackEntry()

    @model_validator(mode="after")
    def _require_safe(self) -> Self:
        if self.on == self.off:
            raise ValueError("on and off must differ")
        if any(self.on in command for command in self.setup):
            raise ValueError(f"setup must not hold {self.on!r}, which switches the output on")
        if self.error is None and len(self.readback.replies) < 3:
            raise ValueError("without an error queue, readback needs frequency, amplitude and offset")
        return self

    def new_device(self) -> DriveSource:
        """Generator, not connected."""
        told = self.waveforms.model_dump()
        commands = SourceCommands(
            identity=self.identity,
            off=self.off,
            on=self.on,
            state=self.state.query,
            is_off=self.state.off,
            is_on=self.state.on,
            setup=self.setup,
            waveforms={name: command for name, command in told.items() if command is not None},
            frequency=self.frequency,
            amplitude=self.amplitude,
            offset=self.offset,
            amplitude_minimum=self.amplitude_minimum,
            errors=None if self.error is None else self.error.queue,
            readback=self.readback.replies,
        )
        return ScpiSource(self.line("function generator"), commands=commands, limits=self.limits)


class QueriedChannelEntry(ChannelEntry):
    """Channel read by a query.

    Parameters
    ----------
    name : str
    quantity, unit, limit : str or None
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

    query: Line
    item: Item = 1
    after: Annotated[str, Field(max_length=40)] = ""
    answer_unit: Annotated[str, Field(max_length=40)] | None = None

    @model_validator(mode="after")
    def _require_convertible(self) -> Self:
        self.conversion  # noqa: B018
        return self

    @property
    def conversion(self) -> tuple[float, float]:
        """Gain and offset of the number in the answer to SI."""
        if self.answer_unit is None:
            return 1.0, 0.0
        zero, one = (to_si(f"{n} {self.answer_unit}", unit=self.si_unit, name="answer_unit") for n in (0, 1))
        return one - zero, zero


class ScpiQueryEntry(_LineEntry, AcquisitionEntry):
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

    extras: ClassVar[tuple[str, ...]] = ("visa",)

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
        queried = []
        for each in self.channels:
            gain, offset = each.conversion
            channel = each.channel(sample_rate=self.own_rate)
            reply = Reply(query=each.query, item=each.item, after=each.after)
            queried.append(QueriedChannel(channel=channel, reply=reply, gain=gain, offset=offset))
        return ScpiQueries(
            self.line("instrument"),
            identity=self.identity,
            setup=self.setup,
            errors=None if self.error is None else self.error.queue,
            period=self.period,
            channels=queried,
        )
