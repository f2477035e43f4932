"""Output of an instrument behind lines of text, set up before it is used and off whatever becomes of the connection."""

from abc import ABC, abstractmethod
from collections.abc import Iterator
from contextlib import contextmanager, suppress

from sonolube.laboratory.devices import DeviceError, DeviceLost
from sonolube.laboratory.drivers.visa_connection import VisaConnection


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
