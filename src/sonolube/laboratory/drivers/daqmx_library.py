"""NI-DAQmx: its Python package, its errors as those of devices, and a guard of outputs by watchdog or enable line."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import Annotated, Any, ClassVar, Final, Literal, Self

from pydantic import Field, model_validator

from sonolube.errors import InvalidInput
from sonolube.extras import missing_package
from sonolube.facts.protocol.quantity_text import SiText
from sonolube.laboratory.devices import DeviceError, DeviceLost, SamplesLost
from sonolube.laboratory.drivers.entry import GuardEntry
from sonolube.text.units import format_si

DRIVER_REMEDY: Final = (
    "run `nidaqmx installdriver` as administrator (Windows, some Linux), or take it from ni.com/downloads; then restart"
)
"""Installation of the driver that the Python package calls."""

_DROPPED: Final = frozenset(  # the acquisition has stopped since nobody has read in time; as in nidaqmx.error_codes
    {-200279, -200222, -200283, -200361, -200010, -209829, -200613, -200714, -50410}
)
_TOO_LATE: Final = -200284  # samples have not come within the timeout
_GONE: Final = frozenset(  # removed, reset, without power or network
    {
        *(-200324, -200220, -200175, -200045, -201003, -201190, -201390, -201253, -201252, -201251, -201250),
        *(-88717, -88710, -88709, -88705, -89130, -50808, -50405, -50404, -50401, -50400, -50300),
    }
)


def daqmx_library() -> Any:
    """Python package of NI-DAQmx."""
    try:
        import nidaqmx
        import nidaqmx.constants
        import nidaqmx.stream_readers
        import nidaqmx.system
        import nidaqmx.system.watchdog
        import nidaqmx.types
    except ImportError:
        raise missing_package("daqmx") from None
    return nidaqmx


@contextmanager
def daqmx_errors(device: str) -> Iterator[None]:
    """Turn errors of NI-DAQmx inside a `with` block into those of devices."""
    errors = daqmx_library().errors
    try:
        yield
    except (errors.DaqNotFoundError, errors.DaqNotSupportedError):
        raise DeviceError(f"{device}: the driver NI-DAQmx is not installed: {DRIVER_REMEDY}") from None
    except errors.DaqError as failure:
        raise _device_error(device, failure.error_code, str(failure)) from None
    except errors.Error as failure:
        raise DeviceError(f"{device}: {first_line(failure)}") from None


def library_of(device: str, *, name: str) -> Any:
    """Python package of NI-DAQmx; raises where the driver or a device is missing."""
    library = daqmx_library()
    with daqmx_errors(name):
        present = list(library.system.System.local().devices.device_names)
    if device not in present:
        known = ", ".join(present) or "none"
        raise DeviceError(f"{name}: NI-DAQmx knows no device {device!r}, but {known}: plug it in, or correct the map")
    return library


def first_line(failure: BaseException) -> str:
    """First line of an error, which has no more than 200 characters."""
    return (str(failure).strip().splitlines() or [type(failure).__name__])[0][:200]


def _device_error(device: str, code: int, message: str) -> DeviceError:
    """Error of a device for a number of NI-DAQmx."""
    number = f"NI-DAQmx {code}"
    if code in _DROPPED:
        remedy = "record fewer channels, sample more slowly, or close other programs"
        return SamplesLost(f"{device}: samples were not read in time and are lost ({number}): {remedy}")
    if code == _TOO_LATE:
        return DeviceLost(f"{device}: no samples come ({number}): look at its power and at the sample clock")
    if code in _GONE:
        return DeviceLost(f"{device}: does not answer any more ({number}): look at its cable and power")
    line = (message.strip().splitlines() or ["no description"])[0][:200]
    return DeviceError(f"{device}: {line} ({number})")


def daqmx_resource(terminal: str) -> str:
    """Canonical name of a device of NI-DAQmx, by which a run reserves it."""
    return f"NI-DAQmx {terminal.partition('/')[0]}".lower()


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
