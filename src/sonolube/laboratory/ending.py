"""End of a run: its event and reason by what was raised, and devices released one after the other."""

from collections.abc import Callable

from sonolube.errors import SonolubeError
from sonolube.laboratory.devices import DeviceError, Devices
from sonolube.laboratory.states import Event


class RunEnded(SonolubeError):
    """End of a run before its time: by a limit, a request or the operator.

    Parameters
    ----------
    event : Event
    reason : str
    """

    def __init__(self, event: Event, reason: str) -> None:
        self.event = event
        super().__init__(reason)


def ending(failure: BaseException) -> tuple[Event, str]:
    """Event and reason by which a run ends."""
    if isinstance(failure, RunEnded):
        return failure.event, str(failure)
    if isinstance(failure, DeviceError):
        return Event.DEVICE_ERROR, str(failure)
    if isinstance(failure, SonolubeError):
        return Event.CRASH, str(failure)
    return Event.CRASH, f"{type(failure).__name__}: {failure}"


def release_devices(devices: Devices, *before: Callable[[], object]) -> list[str]:
    """Failures while all devices are released, each whatever becomes of the others; never raises."""
    return tried(*before, devices.drive.close, devices.motor.close, devices.acquisition.close)


def tried(*calls: Callable[[], object]) -> list[str]:
    """Failures of calls, each made whatever becomes of the others; never raises."""
    failures = []
    for call in calls:
        try:
            call()
        except Exception as failure:  # whatever a driver raises, the others must be released
            failures.append(str(failure))
    return failures
