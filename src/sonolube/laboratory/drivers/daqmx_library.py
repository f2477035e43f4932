"""NI-DAQmx: its Python package, and its errors as those of devices."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Final

from sonolube.extras import missing_package
from sonolube.laboratory.devices import DeviceError, DeviceLost, SamplesLost

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
