"""Instruments of VISA: lines of text over USB, LAN or a serial port, keys of a device map, and outputs they switch.

An output is set up before it is used and off whatever becomes of the connection. Two ways to write one address have one
canonical name, by which a run reserves the instrument.
"""

import os
import re
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from copy import copy
from typing import Annotated, Any, ClassVar, Final, Literal, TypeVar

from pydantic import Field

from sonolube.extras import EXTRAS, missing_package
from sonolube.facts.protocol.quantity_text import SiText, Table
from sonolube.laboratory.devices import DeviceError, DeviceLost
from sonolube.laboratory.drivers.entry import Resource, VisaLibrary

_SERIAL: Final = re.compile(r"ASRL(.*?)(::INSTR)?|(?:\\\\\.\\)?(COM\d+)", re.IGNORECASE)
_PORT: Final = re.compile(r"(?:\\\\\.\\)?(?:COM)?(\d+)", re.IGNORECASE)
_CLASSES: Final = ("instr", "socket", "raw")  # of resources


def visa_resource(resource: str) -> str:
    """Name of an instrument by its address: host and port, number of the serial port, bus and address.

    VISA takes board 0, device inst0 of a LAN instrument, interface 0 of one on USB and class INSTR where an address has
    none, and numbers in decimal or hexadecimal. ASRL3 is COM3 of Windows.

    Source: IVI Foundation, VPP-4.3, The VISA Library, grammar of address strings.
    """
    serial = _SERIAL.fullmatch(resource.strip())
    if serial:
        port = serial[1] or serial[3] or "0"
        number = _PORT.fullmatch(port)
        return f"serial {int(number[1])}" if number else f"serial {os.path.realpath(port)}"
    interface, *parts = resource.strip().lower().split("::")
    kind, board = re.fullmatch(r"(\D*)(\d*)", interface).groups()  # type: ignore[union-attr]
    parts = [part for part in parts if part not in _CLASSES]
    if kind == "tcpip":
        host, *others = parts
        return " ".join([kind, host, *(map(_number, others) if others != ["inst0"] else ())])
    if kind == "usb":
        maker, model, *others = parts
        return " ".join([kind, _number(maker), _number(model), *(others[:-1] if others[1:] == ["0"] else others)])
    return " ".join([f"{kind}{int(board or 0)}", *map(_number, parts)])


def _number(part: str) -> str:
    """Part of an address, a number as a decimal one."""
    if re.fullmatch(r"0x[0-9a-f]+", part):
        return str(int(part, 16))
    return str(int(part)) if part.isdecimal() else part


TIMEOUT: Final = 2.0
"""Time within which an instrument must answer where its map states none. [s]"""

TERMINATIONS: Final = {"CR": "\r", "LF": "\n", "CRLF": "\r\n"}
"""Ends of a line, by name."""

_MAX_STALE: Final = 8  # answers to earlier commands that are passed over

_Result = TypeVar("_Result")


class VisaConnection:
    """Lines of text to and from one instrument.

    Parameters
    ----------
    name : str
        Name in errors.
    resource : str
        As VISA calls it, such as TCPIP::192.168.1.21::5025::SOCKET or ASRL/dev/ttyUSB0::INSTR.
    library : str
        Of VISA: @py, pure Python, or @ivi, that of a maker.
    termination : str
        End of a line, both ways.
    baud_rate : int, optional
        Of a serial port.
    timeout : float, optional
        In which the instrument answers, in s.
    """

    def __init__(
        self,
        *,
        name: str,
        resource: str,
        library: str = "@py",
        termination: str = "\n",
        baud_rate: int | None = None,
        timeout: float | None = None,
    ) -> None:
        self.name = name
        self._resource, self._library = resource, library
        self._termination, self._baud_rate, self._timeout = termination, baud_rate, timeout
        self._line: Any = None
        self._is_barred = False

    @property
    def is_open(self) -> bool:
        """Whether the connection was opened and not closed."""
        return self._line is not None

    def bar(self) -> None:
        """Send nothing more: a call that hangs must not go on where the output was switched off meanwhile."""
        self._is_barred = True

    def another(self) -> "VisaConnection":
        """Further connection to the same instrument, which waits for no call of this one."""
        further = copy(self)
        further._line, further._is_barred = None, False
        return further

    def open(self) -> None:
        """Open the connection, anew where it is open.

        Raises
        ------
        MissingPackage
            If a package of VISA is not installed.
        DeviceError
            If VISA cannot open it.
        """
        self.close()
        if not EXTRAS["visa"].is_installed:
            raise missing_package("visa", context=self.name)
        import pyvisa

        within = round(1e3 * (TIMEOUT if self._timeout is None else self._timeout))
        settings: dict[str, Any] = {} if self._baud_rate is None else {"baud_rate": self._baud_rate}
        try:
            manager = pyvisa.ResourceManager(self._library)
            self._line = manager.open_resource(
                self._resource,
                open_timeout=within,
                timeout=within,
                read_termination=self._termination,
                write_termination=self._termination,
                **settings,
            )
        except Exception as failure:  # libraries of VISA raise whatever they like here, pyvisa-py also bare exceptions
            raise DeviceError(
                f"{self.name}: {self._resource} cannot be opened ({_told(failure)}): look at power, cable and address"
            ) from None

    def write(self, text: str) -> None:
        """Send a line."""
        self._tried(lambda line: line.write(text))

    def read(self) -> str:
        """Next line that comes, without blanks around it.

        Raises
        ------
        DeviceLost
            If none comes in time.
        """
        return str(self._tried(lambda line: line.read())).strip()

    def ask(self, text: str) -> str:
        """Send a line, and return the answer."""
        self.write(text)
        return self.read()

    def ask_for(self, text: str, *answers: str) -> None:
        """Send a line until one of these answers has come, passing over answers to commands that were broken off.

        Raises
        ------
        DeviceError
            If others come.
        """
        self.ask_until(text, lambda heard: heard in answers, expected=answers[0])

    def ask_until(self, text: str, is_answer: Callable[[str], bool], *, expected: str) -> None:
        """Send a line until an answer has come that is one, as `ask_for`; `expected` stands in the error."""
        self.write(text)
        heard = ""
        for _ in range(_MAX_STALE):
            try:
                heard = self.read()
            except DeviceLost:
                if not heard:
                    raise
                break  # it has answered, but not as expected
            if is_answer(heard):
                return
        raise DeviceError(f"{self.name}: answers {heard[:80]!r} to {text!r}; expected {expected!r}")

    def close(self) -> None:
        """Close the connection; harmless where it is closed or lost."""
        line, self._line = self._line, None
        if line is not None:
            with suppress(Exception):  # as above; a lost line cannot be closed better
                line.close()

    def _tried(self, act: Callable[[Any], _Result]) -> _Result:
        """Result of a call of VISA, whose errors become those of devices."""
        if self._is_barred:
            raise DeviceError(f"{self.name}: was switched off while a call hung")
        if self._line is None:
            raise DeviceError(f"{self.name}: connect it first")
        import pyvisa

        try:
            return act(self._line)
        except UnicodeDecodeError:
            raise DeviceError(f"{self.name}: answers what is no text; look at the baud rate") from None
        except (pyvisa.errors.Error, OSError) as failure:
            raise DeviceLost(f"{self.name}: does not answer ({_told(failure)}): look at its cable and power") from None


def _told(failure: BaseException) -> str:
    """First line of an error."""
    return (str(failure).strip().splitlines() or [type(failure).__name__])[0][:120]


class VisaEntry(Table):
    """Keys of every instrument of VISA."""

    extras: ClassVar[tuple[str, ...]] = ("visa",)

    resource: Resource
    visa_library: VisaLibrary = "@py"
    timeout: Annotated[float, SiText("s", 0.1, 60.0)] | None = None

    @property
    def where(self) -> str:
        """Address."""
        return self.resource

    @property
    def reserved_as(self) -> str:
        """Canonical name of the instrument or port."""
        return visa_resource(self.resource)

    def line(self, kind: str, **serial: Any) -> VisaConnection:
        """Connection, not open, to an instrument of a kind."""
        name = f"{kind} {self.resource}"
        own = {"library": self.visa_library, "timeout": self.timeout}
        return VisaConnection(name=name, resource=self.resource, **own | serial)


class VisaLineEntry(VisaEntry):
    """Keys of every instrument of VISA that may have a serial port."""

    baud_rate: Annotated[int, Field(ge=50, le=4_000_000)] | None = None
    termination: Literal["CR", "LF", "CRLF"] = "LF"

    def line(self, kind: str, **serial: Any) -> VisaConnection:
        """Connection, not open, to an instrument of a kind."""
        own = {"termination": TERMINATIONS[self.termination], "baud_rate": self.baud_rate}
        return super().line(kind, **own | serial)


class SwitchedLine(ABC):
    """Output that lines of text set and switch off.

    Parameters
    ----------
    line : VisaConnection
    """

    def __init__(self, line: VisaConnection) -> None:
        self.name = line.name
        self._line = line
        self._is_connected = False
        self._is_set_up = False  # False also where the instrument may have lost what it was told
        self._is_lost = False
        self._is_halted = False

    @abstractmethod
    def _set_up(self) -> None:
        """Switch the output off, and send what the instrument needs before it is set."""

    @abstractmethod
    def _switch_off(self, line: VisaConnection) -> None:
        """Switch the output off over a connection and have that confirmed."""

    def connect(self) -> None:
        """Open the connection, and set the instrument up with its output off."""
        if self._is_connected:
            return
        self._line.open()
        try:
            self._set_up()
        except BaseException:
            self._line.close()
            raise
        self._is_connected, self._is_set_up, self._is_lost = True, True, False

    def _require_connected(self, *, before: str) -> None:
        """Raise DeviceError where the instrument is not connected, before something such as driving."""
        if not self._is_connected:
            raise DeviceError(f"{self.name}: connect it before {before}")

    @contextmanager
    def _off_where_refused(self) -> Iterator[None]:
        """Set the output inside a `with` block, the instrument set up; where it refuses, the output ends off."""
        try:
            if not self._is_set_up:
                self._line.open()
                self._is_lost = False
                self._set_up()
                self._is_set_up = True
            yield
        except DeviceLost:
            self._is_set_up, self._is_lost = False, True
            raise
        except DeviceError:
            self._is_set_up = False
            with suppress(DeviceError):  # who drives it switches it off again, and hears of that
                self.off()
            raise

    def off(self) -> None:
        """Switch the output off, over a new connection where the present one is lost, and wait for the confirmation."""
        if not self._is_connected:
            return
        if self._is_halted:
            self.halt()
            return
        if not self._is_lost:
            try:
                self._switch_off(self._line)
                return
            except DeviceError:
                self._is_set_up, self._is_lost = False, True
        self._line.open()
        self._switch_off(self._line)
        self._is_lost = False

    def halt(self) -> None:
        """Switch the output off over a further connection, whatever the present one waits for, which ends with that."""
        if not self._is_connected:
            return
        self._is_halted = True
        self._line.bar()
        line = self._line.another()
        line.open()
        try:
            self._switch_off(line)
        finally:
            line.close()

    def close(self) -> None:
        """Switch the output off and close the connection."""
        with suppress(DeviceError):
            self.off()
        self._is_connected = self._is_set_up = False
        self._line.close()
