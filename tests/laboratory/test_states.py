"""States of a run: every event in every state, and that every path ends with motor and drive off."""

from pathlib import Path

import pytest
from hypothesis import given, strategies as st

from sonolube.errors import InvalidInput
from sonolube.laboratory import OUTCOMES, TRANSITIONS, Event, RunState, State, after

ENDINGS = (Event.STOP, Event.TRIP, Event.DEVICE_ERROR, Event.CRASH)
EXPECTED = {  # of every state: events that lead elsewhere; the rest stays or is refused
    State.IDLE: {Event.START: State.PREPARING},
    State.PREPARING: {Event.PREPARED: State.RUNNING, **dict.fromkeys(ENDINGS, State.STOPPING)},
    State.RUNNING: {
        Event.PAUSE: State.PAUSED,
        Event.COMPLETED: State.STOPPING,
        **dict.fromkeys(ENDINGS, State.STOPPING),
    },
    State.PAUSED: {Event.RESUME: State.RUNNING, **dict.fromkeys(ENDINGS, State.STOPPING)},
    State.STOPPING: {Event.OFF: State.SAFE, Event.NOT_OFF: State.FAILED},
    State.SAFE: {Event.RESET: State.IDLE},
    State.FAILED: {Event.RESET: State.IDLE},
}


@pytest.mark.parametrize("event", Event)
@pytest.mark.parametrize("state", State)
def test_every_event_in_every_state_leads_on_stays_or_is_refused(state: State, event: Event) -> None:
    present = RunState(state)
    if event in EXPECTED[state]:
        assert after(present, event).state is EXPECTED[state][event]
    elif event in ENDINGS:
        assert after(present, event).state is state
    else:
        with pytest.raises(InvalidInput, match=f"cannot happen while {state.value}"):
            after(present, event)


@pytest.mark.parametrize("state", [State.PREPARING, State.RUNNING, State.PAUSED])
@pytest.mark.parametrize("event", ENDINGS)
def test_while_a_run_ends_motor_and_drive_are_being_switched_off(state: State, event: Event) -> None:
    assert after(RunState(state), event, reason="why") == RunState(State.STOPPING, OUTCOMES[event], "why")


@given(st.lists(st.sampled_from(Event), max_size=40))
def test_a_run_that_was_begun_only_ends_once_devices_have_said_whether_they_are_off(events: list[Event]) -> None:
    present, is_begun = RunState(), False
    for event in events:
        if event not in TRANSITIONS[present.state]:
            continue
        present = after(present, event)
        is_begun = event is Event.START or (is_begun and event not in (Event.OFF, Event.NOT_OFF))
        assert is_begun <= (present.state not in (State.IDLE, State.SAFE, State.FAILED))


def test_the_first_cause_of_the_end_is_kept() -> None:
    present = after(RunState(State.RUNNING), Event.TRIP, reason="3 N")
    present = after(present, Event.DEVICE_ERROR, reason="no answer")
    assert (present.outcome, present.reason) == ("stopped", "3 N")
    failed = after(present, Event.NOT_OFF, reason="motor: no answer")
    assert failed.state is State.FAILED
    assert (failed.outcome, failed.reason) == ("failed", "3 N; motor: no answer")


def test_the_documented_table_is_that_of_the_code() -> None:
    page = (Path(__file__).parents[2] / "src/sonolube/laboratory/README.md").read_text(encoding="utf-8")
    assert transition_table() in page


def transition_table() -> str:
    """Table of the transitions as Markdown: states down, events across, a dash where an event cannot happen."""
    head = ["state", *(event.value for event in Event)]
    rows = [[state.value, *(_cell(TRANSITIONS[state].get(event), state) for event in Event)] for state in State]
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def _cell(following: State | None, state: State) -> str:
    """Next state in the table."""
    if following is None:
        return "-"
    return "stays" if following is state else following.value
