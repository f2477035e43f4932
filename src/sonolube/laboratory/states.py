"""States of a run without input or output: what may happen in each, and what must be done then."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import Enum
from types import MappingProxyType
from typing import Final

from sonolube.errors import InvalidInput


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
