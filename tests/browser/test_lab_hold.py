"""Hold of the laboratory: one tab at a time, kept by requests, free after a silence; by a clock of the test."""

from pathlib import Path

import pytest
from pytest import raises

from sonolube.browser.lab.hold import SILENCE, Hold
from sonolube.errors import InvalidInput

ONE, TWO = "tab-number-one", "tab-number-two"


class Clock:
    """Clock that goes on when a test says so."""

    def __init__(self) -> None:
        self.now = 1e9

    def __call__(self) -> float:
        return self.now


def test_a_hold_is_kept_by_requests_and_free_after_a_silence_for_all_workbenches(tmp_path: Path) -> None:
    clock = Clock()
    hold, of_another_workbench = Hold(tmp_path, clock), Hold(tmp_path, clock)
    hold.take(ONE)
    for _ in range(3):
        clock.now += SILENCE - 1
        assert hold.state(ONE) == {"is_me": True, "is_free": False}
    assert of_another_workbench.state(TWO) == {"is_me": False, "is_free": False}
    with raises(InvalidInput, match="another tab has the laboratory"):
        of_another_workbench.take(TWO)
    clock.now += SILENCE - 1
    hold.state(TWO)  # keeps nothing
    clock.now += 2
    assert of_another_workbench.state(TWO) == {"is_me": False, "is_free": True}
    of_another_workbench.take(TWO)
    with raises(InvalidInput, match="this tab watches only"):
        hold.require(ONE)
    hold.release(ONE)  # of another
    of_another_workbench.require(TWO)
    hold.release(TWO)
    hold.take(ONE)


def test_a_clock_that_was_set_back_keeps_nobody_out(tmp_path: Path) -> None:
    clock = Clock()
    hold = Hold(tmp_path, clock)
    hold.take(ONE)
    clock.now -= 3600
    hold.take(TWO)


@pytest.mark.parametrize("text", ["", "null", "[]", "{", '{"holder": 3, "seen": "x"}', '{"holder": "tab-number-one"}'])
def test_a_damaged_record_of_the_hold_is_no_hold(text: str, tmp_path: Path) -> None:
    (tmp_path / "hold.json").write_text(text)
    hold = Hold(tmp_path, Clock())
    assert hold.state(ONE) == {"is_me": False, "is_free": True}
    hold.take(TWO)
    hold.require(TWO)


@pytest.mark.parametrize("name", ["", "short", "with spaces in it", "x" * 65, "../../../etc/passwd"])
def test_a_name_that_no_tab_draws_is_refused(name: str, tmp_path: Path) -> None:
    with raises(InvalidInput, match="8 to 64 letters"):
        Hold(tmp_path, Clock()).take(name)
