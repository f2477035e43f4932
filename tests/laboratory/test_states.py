"""States of a run: every event in every state, and that every path ends with motor and drive off."""

from pathlib import Path

import pytest
from hypothesis import given, strategies as st

from sonolube.errors import InvalidInput
from sonolube.laboratory import OUTCOMES, TRANSITIONS, Action, Event, RunState, State, Transition, after

ENDINGS = (Event.STOP, Event.TRIP, Event.DEVICE_ERROR, Event.CRASH)
OUTPUTS_ON = (State.RUNNING,)
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
        assert after(present, event)[0].state is EXPECTED[state][event]
    elif event in ENDINGS:
        found, action = after(present, event)
        assert (found.state, action) == (state, Action.NOTHING)
    else:
        with pytest.raises(InvalidInput, match=f"cannot happen while {state.value}"):
            after(present, event)


@pytest.mark.parametrize("state", [State.PREPARING, State.RUNNING, State.PAUSED])
@pytest.mark.parametrize("event", ENDINGS)
def test_whatever_ends_a_run_switches_motor_and_drive_off(state: State, event: Event) -> None:
    found, action = after(RunState(state), event, reason="why")
    assert action is Action.SWITCH_OFF
    assert (found.outcome, found.reason) == (OUTCOMES[event], "why")


@given(st.lists(st.sampled_from(Event), max_size=40))
def test_outputs_are_only_on_while_running_and_every_other_state_was_entered_by_switching_them_off(
    events: list[Event],
) -> None:
    present, on = RunState(), False
    for event in events:
        if event not in TRANSITIONS[present.state]:
            continue
        present, action = after(present, event)
        on = action is Action.FOLLOW or (on and action not in (Action.HOLD, Action.SWITCH_OFF))
        assert on <= (present.state in OUTPUTS_ON)


def test_the_first_cause_of_the_end_is_kept() -> None:
    present, _ = after(RunState(State.RUNNING), Event.TRIP, reason="3 N")
    present, _ = after(present, Event.DEVICE_ERROR, reason="no answer")
    assert (present.outcome, present.reason) == ("stopped", "3 N")
    failed, action = after(present, Event.NOT_OFF, reason="motor: no answer")
    assert action is Action.CALL_OPERATOR
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


def _cell(transition: Transition | None, state: State) -> str:
    """Next state in the table."""
    if transition is None:
        return "-"
    return "stays" if transition.state is state else transition.state.value
