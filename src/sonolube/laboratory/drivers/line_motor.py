"""Motor controllers that take lines of text, each with an answer; commands and answers stand in the device map."""

from dataclasses import dataclass
from typing import Final

from sonolube.laboratory.devices import DeviceError
from sonolube.laboratory.drivers.output_limits import require_speed
from sonolube.laboratory.drivers.switched_line import SwitchedLine
from sonolube.laboratory.drivers.visa_connection import VisaConnection
from sonolube.text.units import format_si

PLACEHOLDER: Final = "{speed}"
"""Text for which a command has the speed."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Exchange:
    """A command and the answer that shows that it was taken.

    Parameters
    ----------
    command : str
    answer : str
    """

    command: str
    answer: str


@dataclass(frozen=True, kw_only=True, slots=True)
class LineProtocol:
    """Lines of text by which a controller is commanded.

    Parameters
    ----------
    speed : Exchange
        Sets the speed; `{speed}` stands for it.
    stop : Exchange
    at_connect : tuple of Exchange
        Sent once, such as the choice of the control mode and the enabling.
    query : Exchange or None
        Asks for the set speed, with `{speed}` in the answer.
    speed_unit : float
        Speed of the disc for which 1 stands, gears included; in 1/s.
    decimals : int
        Of the number.
    """

    speed: Exchange
    stop: Exchange
    speed_unit: float
    at_connect: tuple[Exchange, ...] = ()
    query: Exchange | None = None
    decimals: int = 0

    def number(self, rotation_speed: float) -> str:
        """Text of a speed in 1/s."""
        return f"{rotation_speed / self.speed_unit:.{self.decimals}f}"


class LineMotor:
    """Motor with such a controller.

    Parameters
    ----------
    connection : VisaConnection
    protocol : LineProtocol
    rotation_speed_maximum : float
        Of the disc, in 1/s.
    """

    def __init__(self, connection: VisaConnection, *, protocol: LineProtocol, rotation_speed_maximum: float) -> None:
        self.name = connection.name
        self.rotation_speed_maximum = rotation_speed_maximum
        self._line, self._protocol = connection, protocol
        self._switch = SwitchedLine(connection, set_up=self._set_up, switch_off=self._stop)

    def connect(self) -> None:
        """Open the connection, stop the motor, and send what the controller needs first."""
        self._switch.connect()

    def turn(self, rotation_speed: float) -> None:
        """Set the speed of the disc, 0 to stop; where the controller refuses, it is sent the stop command. [1/s]"""
        require_speed(rotation_speed=rotation_speed, highest=self.rotation_speed_maximum, device=self.name)
        number = self._protocol.number(rotation_speed)
        if rotation_speed > 0 and float(number) == 0:
            least = format_si(self._protocol.speed_unit * 10.0**-self._protocol.decimals, "1/s")
            raise DeviceError(f"{self.name}: {format_si(rotation_speed, '1/s')} refused; its smallest step is {least}")
        self._switch.require_connected(before="turning")
        if rotation_speed == 0:
            self.off()
            return
        with self._switch.setting():
            self._exchange(_filled(self._protocol.speed.command, number), _filled(self._protocol.speed.answer, number))
            self._require_set(number)

    def off(self) -> None:
        """Stop, over a new connection where the present one is lost, and wait for the answer."""
        self._switch.off()

    def halt(self) -> None:
        """Stop over a further connection while a call hangs; not every system opens a serial port twice."""
        self._switch.halt()

    def close(self) -> None:
        """Stop and close the connection."""
        self._switch.close()

    def _set_up(self) -> None:
        """Stop the motor, and send what the controller needs first."""
        self._stop(self._line)
        for exchange in self._protocol.at_connect:
            self._exchange(exchange.command, exchange.answer)
        self._stop(self._line)

    def _stop(self, line: VisaConnection) -> None:
        """Stop and have that confirmed."""
        line.ask_for(self._protocol.stop.command, self._protocol.stop.answer)

    def _exchange(self, command: str, expected: str) -> None:
        """Send a command whose answer must be the expected one."""
        answer = self._line.ask(command)
        if answer != expected:
            raise DeviceError(f"{self.name}: answers {answer[:80]!r} to {command!r}; expected {expected!r}")

    def _require_set(self, number: str) -> None:
        """Read the set speed back, where the controller has a query for it, and raise where it differs."""
        query = self._protocol.query
        if query is None:
            return
        answer = self._line.ask(query.command)
        before, _, after = query.answer.partition(PLACEHOLDER)
        told = answer.removeprefix(before).removesuffix(after)
        try:
            difference = abs(float(told) - float(number))
        except ValueError:
            raise DeviceError(
                f"{self.name}: answers {answer[:80]!r} to {query.command!r}; expected {query.answer!r}"
            ) from None
        if not difference <= 0.5 * 10.0**-self._protocol.decimals:
            raise DeviceError(f"{self.name}: was set to {number}, but answers {answer[:80]!r}")


def _filled(template: str, number: str) -> str:
    """Template with the speed in its place."""
    return template.replace(PLACEHOLDER, number)
