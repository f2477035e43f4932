"""Section of a device map for motor controllers that take lines of text."""

import re
from typing import Annotated, ClassVar, Literal, Self

from pydantic import AfterValidator, Field, model_validator

from sonolube.facts.protocol.quantity_text import Table
from sonolube.laboratory.devices import Motor
from sonolube.laboratory.drivers.entry import MotorEntry, Resource, Speed, VisaLibrary
from sonolube.laboratory.drivers.line_motor import PLACEHOLDER, Exchange, LineMotor, LineProtocol
from sonolube.laboratory.drivers.resources import visa_resource
from sonolube.laboratory.drivers.visa_connection import TERMINATIONS, VisaConnection

Line = Annotated[str, Field(min_length=1, max_length=80)]


class ExchangeEntry(Table):
    """A command and its answer.

    Parameters
    ----------
    command, answer : str
    """

    command: Line
    answer: Line


def _with_speed(text: str) -> str:
    """Text with one place for the speed."""
    if text.count(PLACEHOLDER) != 1 or re.search(r"[{}]", text.replace(PLACEHOLDER, "")):
        raise ValueError(f"must hold {PLACEHOLDER} once, and no other braces")
    return text


class LineMotorEntry(MotorEntry):
    """Motor controller that takes lines of text.

    Parameters
    ----------
    driver : str
    resource : str
        As VISA calls it, such as ASRL/dev/ttyUSB0::INSTR or ASRL3::INSTR.
    visa_library : str
    baud_rate : int or None
        Of a serial port, 8 data bits without parity.
    termination : str
    speed_unit : float
        Speed of the disc for which 1 stands in commands, such as 1 rpm; in 1/s.
    decimals : int
    speed_command, speed_answer : str
        `{speed}` stands for the number.
    stop_command, stop_answer : str
    query, query_answer : str or None
        Asks for the set speed.
    at_connect : tuple of ExchangeEntry
    description : str
    rotation_speed_maximum : float
        Of the disc, in 1/s.
    groove_diameter : float
        Of the circle under the pin. [m]
    """

    extras: ClassVar[tuple[str, ...]] = ("visa",)

    driver: Literal["line"]
    resource: Resource
    visa_library: VisaLibrary = "@py"
    baud_rate: Annotated[int, Field(ge=50, le=4_000_000)] | None = None
    termination: Literal["CR", "LF", "CRLF"] = "CR"
    speed_unit: Speed
    decimals: Annotated[int, Field(ge=0, le=6)] = 0
    speed_command: Annotated[Line, AfterValidator(_with_speed)]
    speed_answer: Line
    stop_command: Line
    stop_answer: Line
    query: Line | None = None
    query_answer: Annotated[Line, AfterValidator(_with_speed)] | None = None
    at_connect: Annotated[tuple[ExchangeEntry, ...], Field(strict=False, max_length=20)] = ()

    @model_validator(mode="after")
    def _require_pair(self) -> Self:
        if (self.query is None) != (self.query_answer is None):
            raise ValueError("query and query_answer belong together")
        return self

    @property
    def where(self) -> str:
        """Address."""
        return self.resource

    @property
    def reserved_as(self) -> str:
        """Canonical name of the port or instrument."""
        return visa_resource(self.resource)

    def new_device(self) -> Motor:
        """Motor, not connected."""
        line = VisaConnection(
            name=f"motor {self.resource}",
            resource=self.resource,
            library=self.visa_library,
            termination=TERMINATIONS[self.termination],
            baud_rate=self.baud_rate,
        )
        return LineMotor(line, protocol=self._line_protocol, rotation_speed_maximum=self.rotation_speed_maximum)

    @property
    def _line_protocol(self) -> LineProtocol:
        """Lines of text by which the controller is commanded."""
        query = None
        if self.query is not None and self.query_answer is not None:
            query = Exchange(command=self.query, answer=self.query_answer)
        return LineProtocol(
            speed=Exchange(command=self.speed_command, answer=self.speed_answer),
            stop=Exchange(command=self.stop_command, answer=self.stop_answer),
            speed_unit=self.speed_unit,
            at_connect=tuple(Exchange(command=each.command, answer=each.answer) for each in self.at_connect),
            query=query,
            decimals=self.decimals,
        )
