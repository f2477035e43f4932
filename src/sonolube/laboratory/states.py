"""States of a run: what may happen in each and what must be done then, requests of others, and how it ends.

The states have no input and no output; the end of a run follows from what was raised.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from enum import Enum
from threading import Event as Signal
from types import MappingProxyType
from typing import Final

from sonolube.errors import InvalidInput, SonolubeError
from sonolube.laboratory.devices import DeviceError, Devices


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


class Action(Enum):
    """Action that follows an event."""

    NOTHING = "nothing"
    CONNECT = "connect the devices, outputs off"
    FOLLOW = "set motor and drive as the protocol says"
    HOLD = "switch motor and drive off, keep the devices"
    SWITCH_OFF = "switch motor and drive off, release the devices"
    CLOSE = "close the record"
    CALL_OPERATOR = "close the record; tell the operator to cut the power"


@dataclass(frozen=True, slots=True)
class Transition:
    """Next state and what must be done.

    Parameters
    ----------
    state : State
    action : Action
    """

    state: State
    action: Action


_STAY: Final = {state: Transition(state, Action.NOTHING) for state in State}
_END: Final = Transition(State.STOPPING, Action.SWITCH_OFF)
_ENDINGS: Final = (Event.STOP, Event.TRIP, Event.DEVICE_ERROR, Event.CRASH)

TRANSITIONS: Final[Mapping[State, Mapping[Event, Transition]]] = MappingProxyType(
    {
        State.IDLE: {
            Event.START: Transition(State.PREPARING, Action.CONNECT),
            **dict.fromkeys(_ENDINGS, _STAY[State.IDLE]),
        },
        State.PREPARING: {Event.PREPARED: Transition(State.RUNNING, Action.FOLLOW), **dict.fromkeys(_ENDINGS, _END)},
        State.RUNNING: {
            Event.PAUSE: Transition(State.PAUSED, Action.HOLD),
            Event.COMPLETED: _END,
            **dict.fromkeys(_ENDINGS, _END),
        },
        State.PAUSED: {Event.RESUME: Transition(State.RUNNING, Action.FOLLOW), **dict.fromkeys(_ENDINGS, _END)},
        State.STOPPING: {
            Event.OFF: Transition(State.SAFE, Action.CLOSE),
            Event.NOT_OFF: Transition(State.FAILED, Action.CALL_OPERATOR),
            **dict.fromkeys(_ENDINGS, _STAY[State.STOPPING]),
        },
        State.SAFE: {Event.RESET: Transition(State.IDLE, Action.NOTHING), **dict.fromkeys(_ENDINGS, _STAY[State.SAFE])},
        State.FAILED: {
            Event.RESET: Transition(State.IDLE, Action.NOTHING),
            **dict.fromkeys(_ENDINGS, _STAY[State.FAILED]),
        },
    }
)
"""Transition of each state by each event; what is not in it is a mistake of the program and is refused."""

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
        Of the first event that ended the run; empty before.
    reason : str
        Why it ended.
    """

    state: State = State.IDLE
    outcome: str = ""
    reason: str = ""


def after(present: RunState, event: Event, *, reason: str = "") -> tuple[RunState, Action]:
    """State of a run after an event, and what must be done.

    Parameters
    ----------
    present : RunState
    event : Event
    reason : str
        Why it happened, in words.

    Returns
    -------
    RunState
    Action

    Raises
    ------
    InvalidInput
        If the event cannot happen in the state.
    """
    transition = TRANSITIONS[present.state].get(event)
    if transition is None:
        known = ", ".join(each.value for each in TRANSITIONS[present.state])
        raise InvalidInput(f"event {event.value!r} cannot happen while {present.state.value}; known: {known}")
    found = replace(present, state=transition.state)
    if event is Event.RESET:
        found = RunState()
    elif event is Event.NOT_OFF:
        found = replace(found, outcome="failed", reason="; ".join(filter(None, (present.reason, reason))))
    elif event in OUTCOMES and not present.outcome and transition.state is State.STOPPING:
        found = replace(found, outcome=OUTCOMES[event], reason=reason)
    return found, transition.action


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
