"""Guard of the outputs by NI-DAQmx: a watchdog timer of the device, and a digital line that enables the amplifiers."""

from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Any

from sonolube.laboratory.devices import DeviceError
from sonolube.laboratory.drivers.daqmx_library import daqmx_errors, daqmx_library, require_device


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
        library = daqmx_library()
        require_device(library, self._device, name=self.name)
        self._library = library
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
                self._tried(act)

    def _tried(self, act: Callable[[], object]) -> None:
        """Call what may fail on a device that is lost."""
        with suppress(DeviceError), daqmx_errors(self.name):
            act()

    def _set_line(self, *, is_high: bool) -> None:
        """Set the enable line, where there is one."""
        if self._line is None:
            return
        with daqmx_errors(self.name), self._library.Task() as task:
            task.do_channels.add_do_chan(self._line)
            task.write(is_high, auto_start=True)
