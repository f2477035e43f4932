"""Motor controllers that take lines of text, each with an answer; commands and answers stand in the device map."""

import re
from typing import Annotated, Final, Literal, Self

from pydantic import AfterValidator, Field, model_validator

from sonolube.facts.protocol.quantity_text import Table
from sonolube.laboratory.devices import DeviceError, Motor
from sonolube.laboratory.drivers.entry import MotorEntry, Speed, require_speed
from sonolube.laboratory.drivers.visa_connection import SwitchedLine, VisaConnection, VisaLineEntry
from sonolube.text.units import format_si

PLACEHOLDER: Final = "{speed}"
"""Text for which a command has the speed."""

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


class LineMotorEntry(VisaLineEntry, MotorEntry):
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

    driver: Literal["line"]
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

    def new_device(self) -> Motor:
        """Motor, not connected."""
        return LineMotor(self)


class LineMotor(SwitchedLine):
    """Motor with such a controller.

    Parameters
    ----------
    entry : LineMotorEntry
    """

    def __init__(self, entry: LineMotorEntry) -> None:
        super().__init__(entry.line("motor"))
        self.rotation_speed_maximum = entry.rotation_speed_maximum
        self._entry = entry

    def turn(self, rotation_speed: float) -> None:
        """Set the speed of the disc, 0 to stop; where the controller refuses, it is sent the stop command. [1/s]"""
        require_speed(rotation_speed=rotation_speed, highest=self.rotation_speed_maximum, device=self.name)
        entry = self._entry
        number = f"{rotation_speed / entry.speed_unit:.{entry.decimals}f}"
        if rotation_speed > 0 and float(number) == 0:
            least = format_si(entry.speed_unit * 10.0**-entry.decimals, "1/s")
            raise DeviceError(f"{self.name}: {format_si(rotation_speed, '1/s')} refused; its smallest step is {least}")
        self._require_connected(before="turning")
        if rotation_speed == 0:
            self.off()
            return
        with self._off_where_refused():
            self._exchange(_filled(entry.speed_command, number), _filled(entry.speed_answer, number))
            self._require_set(number)

    def _set_up(self) -> None:
        """Stop the motor, and send what the controller needs first."""
        self._switch_off(self._line)
        for exchange in self._entry.at_connect:
            self._exchange(exchange.command, exchange.answer)
        self._switch_off(self._line)

    def _switch_off(self, line: VisaConnection) -> None:
        """Stop and have that confirmed."""
        line.ask_for(self._entry.stop_command, self._entry.stop_answer)

    def _exchange(self, command: str, expected: str) -> None:
        """Send a command whose answer must be the expected one."""
        answer = self._line.ask(command)
        if answer != expected:
            raise DeviceError(f"{self.name}: answers {answer[:80]!r} to {command!r}; expected {expected!r}")

    def _require_set(self, number: str) -> None:
        """Read the set speed back, where the controller has a query for it, and raise where it differs."""
        query, expected = self._entry.query, self._entry.query_answer
        if query is None or expected is None:
            return
        answer = self._line.ask(query)
        before, _, after = expected.partition(PLACEHOLDER)
        told = answer.removeprefix(before).removesuffix(after)
        try:
            difference = abs(float(told) - float(number))
        except ValueError:
            raise DeviceError(f"{self.name}: answers {answer[:80]!r} to {query!r}; expected {expected!r}") from None
        if not difference <= 0.5 * 10.0**-self._entry.decimals:
            raise DeviceError(f"{self.name}: was set to {number}, but answers {answer[:80]!r}")


def _filled(template: str, number: str) -> str:
    """Template with the speed in its place."""
    return template.replace(PLACEHOLDER, number)
