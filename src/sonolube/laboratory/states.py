"""States of a run: what may happen in each, requests of others, and how it ends.

The states have no input and no output; the end of a run follows from what was raised.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from enum import Enum
from threading import Event as Signal
from types import MappingProxyType
from typing import Final

from sonolube.errors import InvalidInput, SonolubeError, fault_line, words_of
from sonolube.laboratory.devices import DeviceError, Devices
from sonolube.laboratory.verdict import Verdict


class State(Enum):
    """State of a run."""

    IDLE = "idle"
    """Nothing is connected."""
    PREPARING = "preparing"
    """Devices are being connected, their outputs off."""
    RUNNING = "running"
    """The clock of the protocol runs; motor and drive follow its set points."""
    PAUSED = "paused"
    """The clock stands, motor and drive are off: an operator works at the rig."""
    STOPPING = "stopping"
    """Motor and drive are being switched off, devices released."""
    SAFE = "safe"
    """Motor and drive are off, the record is closed."""
    FAILED = "failed"
    """Motor or drive may be on: a device did not confirm that its output is off."""


class Event(Enum):
    """Event of a run."""

    START = "start"
    PREPARED = "prepared"
    PAUSE = "pause"
    RESUME = "resume"
    COMPLETED = "completed"
    STOP = "stop"
    TRIP = "trip"
    DEVICE_ERROR = "device error"
    CRASH = "crash"
    OFF = "off"
    NOT_OFF = "not off"
    RESET = "reset"


_ENDINGS: Final = (Event.STOP, Event.TRIP, Event.DEVICE_ERROR, Event.CRASH)

TRANSITIONS: Final[Mapping[State, Mapping[Event, State]]] = MappingProxyType(
    {
        State.IDLE: {Event.START: State.PREPARING, **dict.fromkeys(_ENDINGS, State.IDLE)},
        State.PREPARING: {Event.PREPARED: State.RUNNING, **dict.fromkeys(_ENDINGS, State.STOPPING)},
        State.RUNNING: {Event.PAUSE: State.PAUSED, **dict.fromkeys((Event.COMPLETED, *_ENDINGS), State.STOPPING)},
        State.PAUSED: {Event.RESUME: State.RUNNING, **dict.fromkeys(_ENDINGS, State.STOPPING)},
        State.STOPPING: {Event.OFF: State.SAFE, Event.NOT_OFF: State.FAILED, **dict.fromkeys(_ENDINGS, State.STOPPING)},
        State.SAFE: {Event.RESET: State.IDLE, **dict.fromkeys(_ENDINGS, State.SAFE)},
        State.FAILED: {Event.RESET: State.IDLE, **dict.fromkeys(_ENDINGS, State.FAILED)},
    }
)
"""Next state of each state by each event; what is not in it is a mistake of the program and is refused."""

OUTCOMES: Final[Mapping[Event, str]] = MappingProxyType(
    {
        Event.COMPLETED: "completed",
        Event.STOP: "stopped",
        Event.TRIP: "stopped",
        Event.DEVICE_ERROR: "failed",
        Event.CRASH: "failed",
    }
)
"""Outcome of a run by the event that ended it."""


@dataclass(frozen=True, slots=True)
class RunState:
    """State of a run with how it ends.

    Parameters
    ----------
    state : State
    outcome : str
        completed, stopped or failed, by the first event that ended the run; empty before.
    reason : str
        Why it ended before its protocol.
    verdict : Verdict or None
        On motor and drive, after the end; None before it, and where the run connected no device.
    """

    state: State = State.IDLE
    outcome: str = ""
    reason: str = ""
    verdict: Verdict | None = None


def after(present: RunState, event: Event, *, reason: str = "") -> RunState:
    """State of a run after an event.

    Parameters
    ----------
    present : RunState
    event : Event
    reason : str
        Why it happened, in words.

    Returns
    -------
    RunState

    Raises
    ------
    InvalidInput
        If the event cannot happen in the state.
    """
    state = TRANSITIONS[present.state].get(event)
    if state is None:
        known = ", ".join(each.value for each in TRANSITIONS[present.state])
        raise InvalidInput(f"event {event.value!r} cannot happen while {present.state.value}; known: {known}")
    if event is Event.RESET:
        return RunState()
    if event is Event.NOT_OFF:
        return replace(present, state=state, outcome="failed", reason="; ".join(filter(None, (present.reason, reason))))
    if event in OUTCOMES and not present.outcome and state is State.STOPPING:
        return RunState(state, OUTCOMES[event], reason)
    return replace(present, state=state)


@dataclass(slots=True)
class RunControl:
    """Requests to a running protocol.

    Parameters
    ----------
    stop_reason : str
        Why the run is to end; empty while it is not.
    """

    stop_reason: str = ""
    _pause: Signal = field(default_factory=Signal)

    def stop(self, reason: str) -> None:
        """End the run after the present block."""
        self.stop_reason = self.stop_reason or reason

    def pause(self) -> None:
        """Switch motor and drive off after the present block, and let the clock stand."""
        self._pause.set()

    def resume(self) -> None:
        """Resume after a pause."""
        self._pause.clear()

    @property
    def is_paused(self) -> bool:
        """Whether a pause is wanted."""
        return self._pause.is_set()


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
    if isinstance(failure, KeyboardInterrupt):
        return Event.STOP, "interrupted"
    if isinstance(failure, SonolubeError):
        return Event.DEVICE_ERROR if isinstance(failure, DeviceError) else Event.CRASH, words_of(failure)
    return Event.CRASH, fault_line(failure)


def release_devices(devices: Devices, *before: Callable[[], object]) -> list[str]:
    """Failures while all devices are released, each whatever becomes of the others; never raises."""
    return tried(*before, devices.drive.close, devices.motor.close, devices.acquisition.close)


def tried(*calls: Callable[[], object]) -> list[str]:
    """Failures of calls, each made whatever becomes of the others; never raises."""
    failures = []
    for call in calls:
        try:
            call()
        except BaseException as failure:  # whatever a driver raises, the others must be released
            failures.append(words_of(failure))
    return failures
