"""Live state of a run by hand-made blocks: its times, events, limits, and the voltage that is set."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from pytest import MonkeyPatch, approx

from sonolube.browser.lab import live_run
from sonolube.browser.lab.live_run import LiveRun, slices_of
from sonolube.laboratory import Block, Channel, Interlock, RunControl


class Idle:
    """Thread that never runs, so that a test reduces the blocks itself."""

    def __init__(self, **_: object) -> None: ...
    def start(self) -> None: ...


@pytest.fixture(autouse=True)
def no_thread(monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setattr(live_run, "Thread", Idle)
    monkeypatch.setattr(live_run, "_POLL", 1e-3)


def block(*rows: tuple[float, ...], sample_rate: float = 100.0) -> Block:
    return Block(first_sample=0, sample_rate=sample_rate, values=np.array(rows))


def reduced(live: LiveRun) -> LiveRun:
    """The run after the blocks that waited were reduced."""
    while live._waiting:
        live._take_slices(*live._waiting.popleft())
    return live


def point(**more: Any) -> Any:
    return SimpleNamespace(**({"step": "2.1", "kind": "drive", "time": 3.0, "voltage_maximum": 25.0} | more))


@pytest.mark.parametrize(
    ("samples", "sample_rate", "count"),
    [(4, 100.0, 1), (5, 100.0, 2), (8, 100.0, 2), (9, 100.0, 3), (3, 10.0, 3), (100, 1.0, 64), (1, 1e4, 1)],
)
def test_slices_last_at_most_40_ms_and_are_no_more_than_samples_and_64(
    samples: int, sample_rate: float, count: int
) -> None:
    values = np.zeros((samples, 1))
    assert len(slices_of(("a",), Block(first_sample=0, sample_rate=sample_rate, values=values), time=0.0)) == count


def test_a_slice_has_its_middle_and_the_extremes_and_mean_of_each_channel() -> None:
    # five samples of 10 ms from 2 s on: two, then three
    found = slices_of(("a", "b"), block((1, 9), (3, 7), (4, 6), (5, 5), (9, 1)), time=2.0)
    (first, one), (second, other) = found
    assert (first, second) == approx((2.01, 2.035))
    assert (one, other) == ({"a": (1, 3, 2), "b": (7, 9, 8)}, {"a": (4, 9, 6), "b": (1, 6, 4)})


def test_a_run_that_has_not_begun_is_preparing_and_says_what_it_is_of() -> None:
    assert LiveRun({"title": "Own"}, RunControl()).status() == {
        "title": "Own", "state": "preparing", "outcome": "", "reason": "", "outputs": "",
        "folder": "", "step": "", "kind": "",
        "doing": "", "time": 0.0, "prompt": None, "trips": [], "is_paused": False, "is_stopping": False,
        "is_ended": False, "is_lost": False,
    }  # fmt: skip


def test_events_steps_and_blocks_change_state_reason_and_time() -> None:
    live = LiveRun({}, RunControl())
    live.records(Path("runs", "0715"))
    live.notes("state", {"state": "paused", "reason": "by hand"})
    live.reaches(point())
    found = live.status()
    assert (found["state"], found["reason"], found["doing"], found["is_paused"]) == (
        "paused",
        "by hand",
        "by hand",
        True,
    )
    assert (found["step"], found["kind"], found["time"], found["folder"]) == ("2.1", "drive", 3.0, "0715")
    live.notes("state", {"state": "running", "reason": "by hand"})
    assert (live.status()["reason"], live.status()["doing"]) == ("", "by hand")
    live.progress("running: step 2", 1, 2)
    assert live.status()["doing"] == "step 2"
    live.notes("other", {"reason": "nothing"})
    assert live.status()["trips"] == []
    live.takes(("a",), block(*[(0.0,)] * 5), time=4.0)
    assert live.status()["time"] == approx(4.05)
    live.notes("state", {"state": "stopping"})
    assert live.status()["is_stopping"] is True


def test_pause_and_stop_that_were_asked_for_are_seen_before_the_run_obeys() -> None:
    control = RunControl()
    live = LiveRun({}, control)
    control.pause()
    assert (live.status()["is_paused"], live.status()["is_stopping"]) == (True, False)
    control.stop("by hand")
    assert live.status()["is_stopping"] is True


def test_the_last_twenty_limits_that_were_exceeded_are_kept() -> None:
    live = LiveRun({}, RunControl())
    for number in range(22):
        live.notes("trip", {"reason": f"limit {number}"})
    assert live.status()["trips"] == [f"limit {number}" for number in range(2, 22)]


def test_a_block_of_another_clock_ends_now_while_the_run_goes_on_and_has_no_slices_before() -> None:
    live = LiveRun({}, RunControl())
    live.takes_aside(("b",), block((1.0,)))
    assert reduced(live).frame(-1)[0]["channels"] == {}
    live.notes("state", {"state": "running"})
    live.reaches(point(time=8.0))
    live.takes_aside(("b",), block((1.0,), (2.0,)))  # 20 ms until 8 s
    ((middle, low, high, mean),) = reduced(live).frame(-1)[0]["channels"]["b"]
    assert (middle, low, high, mean) == approx((7.99, 1.0, 2.0, 1.5))


def test_a_frame_has_the_units_of_its_channels_and_the_slices_behind_a_number() -> None:
    live = LiveRun({}, RunControl())
    channel = Channel(name="friction_force", quantity="friction_force")
    live.begins({"friction_force": channel}, [])
    live.takes(("friction_force", "other"), block((1.0, 2.0)), time=0.0)
    live.takes(("friction_force", "other"), block((3.0, 4.0)), time=0.01)
    frame, last = reduced(live).frame(-1)
    assert (last, frame["dropped"]) == (1, 0)
    assert frame["units"] == {"friction_force": "N", "other": ""}
    assert [each[3] for each in frame["channels"]["friction_force"]] == [1.0, 3.0]
    later, last = live.frame(0)
    assert ([each[3] for each in later["channels"]["other"]], last) == ([4.0], 1)
    assert live.frame(1)[1] == 1
    assert LiveRun({}, RunControl()).frame(-1)[1] == -1


def limits(live: LiveRun) -> dict[str, dict[str, Any]]:
    return {each["label"]: each for each in live.frame(-1)[0]["limits"]}


def test_limits_are_near_by_the_way_from_rest_and_a_temperature_rests_at_its_first_reading() -> None:
    live = LiveRun({}, RunControl())
    force, heat = (Channel(name=name, quantity=name) for name in ("friction_force", "temperature"))
    live.begins({}, [Interlock(force, 10.0), Interlock(heat, 350.0)])
    assert limits(live)["friction force"] == {
        "label": "friction force", "unit": "N", "value": None, "limit": 10.0, "share": None, "text": "10 N",
    }  # fmt: skip
    live.takes(("friction_force", "temperature"), block((1.0, 300.0), (-4.0, 310.0)), time=0.0)
    found = limits(reduced(live))
    assert (found["friction force"]["value"], found["friction force"]["share"]) == approx((4.0, 0.4))
    assert (found["temperature"]["value"], found["temperature"]["share"]) == approx((310.0, 0.2))
    live.takes(("temperature",), block((330.0,)), time=0.1)
    assert limits(reduced(live))["temperature"]["share"] == approx(0.6)  # still from 300 K
    live.begins({}, [Interlock(heat, 300.0)])
    assert limits(live)["temperature"]["share"] is None  # a limit at rest has no way to it


def test_the_voltage_that_is_set_takes_the_place_of_a_lower_one_that_was_measured() -> None:
    live = LiveRun({"voltage_maximum": 30.0}, RunControl())
    live.notes("state", {"state": "running"})
    assert "voltage" not in limits(live)  # before a set point
    live.reaches(point())
    assert limits(live)["voltage"] == {
        "label": "voltage", "unit": "V", "value": 25.0, "limit": 30.0, "text": "30 V", "share": approx(25 / 30),
    }  # fmt: skip
    volts = Channel(name="voltage", quantity="voltage")
    live.begins({}, [Interlock(volts, 40.0)])
    assert (limits(live)["voltage"]["value"], limits(live)["voltage"]["share"]) == approx((25.0, 0.625))
    live.takes(("voltage",), block((10.0,), (-32.0,)), time=0.0)
    assert (limits(reduced(live))["voltage"]["value"], limits(live)["voltage"]["share"]) == approx((32.0, 0.8))
    live.notes("state", {"state": "paused"})
    live.begins({}, [])
    assert "voltage" not in limits(live)
    without = LiveRun({}, RunControl())
    without.notes("state", {"state": "running"})
    without.reaches(point())
    assert limits(without) == {}


def test_the_end_has_its_outcome_and_no_prompt() -> None:
    live = LiveRun({}, RunControl())
    live.takes(("a",), block((0.0,)), time=0.0)  # that nobody reduces, and which is not waited for without end
    live.end("safe", "stopped", "by hand")
    found = live.status()
    assert (found["state"], found["outcome"], found["reason"], found["is_ended"]) == (
        "safe",
        "stopped",
        "by hand",
        True,
    )
    assert found["prompt"] is None
