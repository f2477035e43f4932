"""Guard of the outputs by NI-DAQmx: a watchdog timer of the device, and a digital line that enables the amplifiers."""

from collections.abc import Sequence
from contextlib import suppress
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import Field, model_validator

from sonolube.errors import InvalidInput
from sonolube.facts.protocol.quantity_text import SiText
from sonolube.laboratory.devices import DeviceError
from sonolube.laboratory.drivers.daqmx_library import daqmx_errors, daqmx_resource, library_of
from sonolube.laboratory.drivers.entry import GuardEntry
from sonolube.text.units import format_si


class DaqmxGuard:
    """Watchdog timer and enable line of NI-DAQmx, either or both.

    Parameters
    ----------
    outputs : sequence of str
        Analogue outputs that the watchdog sets to 0 V where it is not renewed, such as Dev1/ao0.
    timeout : float or None
        Of the watchdog, in s; None without one.
    line : str or None
        Digital line that is high while outputs are enabled, such as Dev1/port0/line0; the watchdog sets it low.

    Notes
    -----
    Not every device has a watchdog timer, and few set analogue outputs by it; NI-DAQmx refuses what a device lacks.
    """

    def __init__(self, *, outputs: Sequence[str], timeout: float | None, line: str | None) -> None:
        device = (line or outputs[0]).partition("/")[0]
        self.name = f"NI-DAQmx {device} guard"
        self._device, self._outputs, self._timeout, self._line = device, tuple(outputs), timeout, line
        self._library: Any = None
        self._watchdog: Any = None

    def connect(self) -> None:
        """Find the device, and set the line low."""
        if self._library is not None:
            return
        self._library = library_of(self._device, name=self.name)
        try:
            self._set_line(is_high=False)
        except BaseException:
            self._library = None
            raise

    def enable(self) -> None:
        """Start the watchdog, then set the line high."""
        if self._library is None:
            raise DeviceError(f"{self.name}: connect it before enabling")
        self._stop_watchdog()
        if self._timeout is not None:
            with daqmx_errors(self.name):
                self._watchdog = self._started_watchdog(self._timeout)
        self._set_line(is_high=True)

    def renew(self) -> None:
        """Restart the time of the watchdog."""
        watchdog = self._watchdog
        if watchdog is None:
            return
        with daqmx_errors(self.name):
            if watchdog.expired:
                raise DeviceError(f"{self.name}: the watchdog has expired, and its outputs are at 0 V")
            watchdog.reset_timer()

    def disable(self) -> None:
        """Set the line low, and stop the watchdog."""
        if self._library is not None:
            try:
                self._set_line(is_high=False)
            finally:
                self._stop_watchdog()

    def close(self) -> None:
        """Disable the outputs and release the device."""
        with suppress(DeviceError):
            self.disable()
        self._library = None

    def _started_watchdog(self, timeout: float) -> Any:
        """Watchdog that waits; it sets outputs to 0 V and the line low where it is not renewed."""
        constants, types = self._library.constants, self._library.types
        watchdog = self._library.system.watchdog.WatchdogTask(self._device, timeout=timeout)
        try:
            if self._outputs:
                volts = constants.WatchdogAOExpirState.VOLTAGE
                states = [types.AOExpirationState(each, 0.0, volts) for each in self._outputs]
                watchdog.cfg_watchdog_ao_expir_states(states)
            if self._line is not None:
                watchdog.cfg_watchdog_do_expir_states([types.DOExpirationState(self._line, constants.Level.LOW)])
            watchdog.start()
        except BaseException:
            watchdog.close()
            raise
        return watchdog

    def _stop_watchdog(self) -> None:
        """Stop the watchdog, and unlock the outputs where it has expired."""
        watchdog, self._watchdog = self._watchdog, None
        if watchdog is not None:
            for act in (watchdog.clear_expiration, watchdog.stop, watchdog.close):
                with suppress(DeviceError), daqmx_errors(self.name):  # each may fail on a device that is lost
                    act()

    def _set_line(self, *, is_high: bool) -> None:
        """Set the enable line, where there is one."""
        if self._line is None:
            return
        with daqmx_errors(self.name), self._library.Task() as task:
            task.do_channels.add_do_chan(self._line)
            task.write(is_high, auto_start=True)


class DaqmxGuardEntry(GuardEntry):
    """Watchdog, enable line, or both.

    Parameters
    ----------
    driver : str
    watchdog_timeout : float or None
        Time without a block, in s, after which the device sets its analogue outputs to 0 V and the line low; None
        without a watchdog.
    enable_line : str or None
        Digital line that is high while outputs are enabled, such as Dev1/port0/line0.
    """

    extras: ClassVar[tuple[str, ...]] = ("daqmx",)

    driver: Literal["daqmx"]
    watchdog_timeout: Annotated[float, SiText("s", 0.2, 60.0)] | None = None
    enable_line: Annotated[str, Field(pattern=r"^[\w-]+/port\d+/line\d+$")] | None = None

    @model_validator(mode="after")
    def _require_one(self) -> Self:
        if self.watchdog_timeout is None and self.enable_line is None:
            raise ValueError("needs watchdog_timeout, enable_line or both")
        return self

    @property
    def where(self) -> str:
        """Line; empty where it is a watchdog on the device of the outputs."""
        return self.enable_line or ""

    @property
    def reserved_as(self) -> str:
        """Canonical name of the device; empty where it is that of the outputs."""
        return "" if self.enable_line is None else daqmx_resource(self.enable_line)

    @property
    def described(self) -> str:
        """Watchdog and enable line in words."""
        timeout = self.watchdog_timeout
        watchdog = "" if timeout is None else f"watchdog of {format_si(timeout, 's')}"
        return "; ".join(filter(None, (watchdog, self.enable_line and f"enable line {self.enable_line}")))

    def outputs(self, guarded: Sequence[str]) -> tuple[str, ...]:
        """Analogue outputs of drive and motor on the device of the line, else on that of the first."""
        line = self.enable_line or (guarded[0] if guarded else "")
        return tuple(each for each in guarded if daqmx_resource(each) == daqmx_resource(line))

    def require_use(self, guarded: Sequence[str]) -> None:
        """Raise where a watchdog alone has no analogue output to guard."""
        if self.enable_line is None and not self.outputs(guarded):
            raise InvalidInput("guard: a watchdog alone guards analogue outputs of drive or motor; give enable_line")

    def new_device(self, guarded: Sequence[str]) -> DaqmxGuard:
        """Guard, not connected."""
        return DaqmxGuard(outputs=self.outputs(guarded), timeout=self.watchdog_timeout, line=self.enable_line)
