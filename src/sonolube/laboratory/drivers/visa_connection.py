"""Connection to an instrument by VISA: lines of text over USB, LAN or a serial port."""

from collections.abc import Callable
from contextlib import suppress
from typing import Any, Final, TypeVar

from sonolube.extras import EXTRAS, missing_package
from sonolube.laboratory.devices import DeviceError, DeviceLost

TIMEOUT: Final = 2.0
"""Time within which an instrument must answer. [s]"""

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
    """

    def __init__(
        self, *, name: str, resource: str, library: str = "@py", termination: str = "\n", baud_rate: int | None = None
    ) -> None:
        self.name = name
        self._resource, self._library = resource, library
        self._termination, self._baud_rate = termination, baud_rate
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
        return VisaConnection(
            name=self.name,
            resource=self._resource,
            library=self._library,
            termination=self._termination,
            baud_rate=self._baud_rate,
        )

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

        settings: dict[str, Any] = {} if self._baud_rate is None else {"baud_rate": self._baud_rate}
        try:
            manager = pyvisa.ResourceManager(self._library)
            self._line = manager.open_resource(
                self._resource,
                open_timeout=round(1e3 * TIMEOUT),
                timeout=round(1e3 * TIMEOUT),
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
