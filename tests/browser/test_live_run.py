"""Live state of a run: slices of blocks, limits, and readers that are slow."""

from threading import Thread

import numpy as np
from hypothesis import given, strategies as st
from pytest import approx
from tests.browser.laboratory import until

from sonolube.browser.lab.live_run import SLICE_DURATION, LiveRun, slices_of
from sonolube.facts.protocol import Prompt
from sonolube.laboratory import Block, Channel, Interlock, RunControl


def block(values: np.ndarray, *, sample_rate: float, first: int = 0) -> Block:
    return Block(first_sample=first, sample_rate=sample_rate, values=values)


@given(samples=st.integers(1, 400), sample_rate=st.sampled_from([400.0, 1000.0, 7999.0]), seed=st.integers(0, 99))
def test_slices_hold_every_sample_once(samples: int, sample_rate: float, seed: int) -> None:
    values = np.random.default_rng(seed).normal(size=(samples, 2))
    found = slices_of(("a", "b"), block(values, sample_rate=sample_rate), time=2.0)
    for place, name in enumerate(("a", "b")):
        own = values[:, place]
        assert min(each[name][0] for _, each in found) == own.min()
        assert max(each[name][1] for _, each in found) == own.max()
        assert all(
            each[name][0] <= each[name][2] <= each[name][1] or each[name][2] == approx(each[name][0])
            for _, each in found
        )
    times = [time for time, _ in found]
    assert times == sorted(times)
    assert 2.0 < times[0] <= 2.0 + SLICE_DURATION
    assert times[-1] < 2.0 + samples / sample_rate


def test_a_block_of_50_ms_gives_two_slices_whose_means_are_those_of_its_halves() -> None:
    ramp = np.arange(20.0)[:, np.newaxis]
    found = slices_of(("a",), block(ramp, sample_rate=400.0), time=1.0)
    assert [time for time, _ in found] == approx([1.0125, 1.0375])
    assert [each for _, each in found] == [{"a": (0.0, 9.0, 4.5)}, {"a": (10.0, 19.0, 14.5)}]
    assert slices_of(("a",), block(np.zeros((0, 1)), sample_rate=400.0), time=1.0) == []


def live_run() -> LiveRun:
    live = LiveRun({"voltage_maximum": 30.0}, RunControl())
    channels = {
        "friction_force": Channel(name="friction_force", quantity="friction_force"),
        "temperature": Channel(name="temperature", quantity="temperature"),
    }
    locks = [Interlock(channels["friction_force"], 10.0), Interlock(channels["temperature"], 350.0)]
    live.begins(channels, locks)
    return live


def test_limits_are_told_by_the_way_from_rest() -> None:
    live = live_run()
    names = ("friction_force", "temperature")
    live.takes(names, block(np.array([[0.0, 300.0], [-5.0, 300.0]]), sample_rate=400.0), time=0.0)
    until(lambda: bool(live.frame(-1)[0]["channels"]))
    live.takes_aside(names, block(np.array([[1.0, 310.0]]), sample_rate=400.0))  # of a rig that stands
    until(lambda: live.frame(-1)[0]["limits"][1]["value"] == 310.0)
    frame, last = live.frame(-1)
    force, temperature = frame["limits"]
    assert (force["value"], force["share"]) == (1.0, approx(0.1))
    assert temperature["share"] == approx(10 / 50)
    assert last == 0  # the standing rig has no time of the protocol


def test_a_slow_reader_gets_the_latest_slices_and_is_told_what_it_missed() -> None:
    live = live_run()
    for number in range(1300):
        live.takes(("a",), block(np.full((20, 1), number), sample_rate=400.0, first=20 * number), time=0.05 * number)
        if number % 50 == 49:
            until(lambda number=number: caught_up(live, max(2 * number - 9, -1))[2] == 2 * number + 1)  # type: ignore[misc]
    assert caught_up(live, -1) == (2400, 0, 2599)
    assert caught_up(live, 99) == (2400, 100, 2599)
    assert len(live.frame(-1)[0]["channels"]["a"]) <= 300  # of one frame
    last = 2599
    now, _ = live.frame(last)
    assert (now["channels"], now["dropped"]) == ({}, 0)


def caught_up(live: LiveRun, after: int) -> tuple[int, int, int]:
    """Number of slices behind a number in all frames, of those that were dropped, and number of the last."""
    count = dropped = 0
    while True:
        frame, after = live.frame(after)
        dropped += frame["dropped"]
        if not frame["channels"]:
            return count, dropped, after
        count += len(frame["channels"]["a"])


def test_a_prompt_that_is_confirmed_twice_leaves_the_next_one_of_the_same_text_to_be_read() -> None:
    live, answers = LiveRun({}, RunControl()), list[bool]()
    prompt = Prompt(text="Mount the pin.")
    assert live.answer(0, is_done=True) == "nothing is asked now"
    asking = Thread(target=lambda: answers.extend(live.ask(prompt) for _ in range(2)))
    asking.start()
    until(lambda: live.status()["prompt"] is not None)
    assert live.answer(1, is_done=True) == ""
    until(lambda: (live.status()["prompt"] or {}).get("number") == 2)
    assert "another prompt is shown now" in live.answer(1, is_done=True)  # as by a second click
    assert live.status()["prompt"] == {"number": 2, "task": prompt.task, "text": prompt.text}
    assert live.answer(2, is_done=False) == ""
    asking.join()
    assert answers == [True, False]


def test_a_prompt_is_not_waited_for_where_the_run_is_to_end() -> None:
    control = RunControl()
    control.stop("ended")
    assert not LiveRun({}, control).ask(Prompt(text="Mount the pin."))
