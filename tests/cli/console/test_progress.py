"""Progress on standard error: nothing of short work, plain lines of long work, a bar on a terminal."""

import os
import pty
import subprocess
import sys
from threading import Event
from types import SimpleNamespace

import pytest
from tests.cli.terminal import read_until, rest

from sonolube.cli.console import options as module
from sonolube.cli.console.options import progress, time_left


def test_time_left_follows_from_the_pace_so_far() -> None:
    assert time_left(10.0, 1, 4) == "about 30 s left"
    assert time_left(60.0, 1, 11) == "about 10 min left"


@pytest.mark.parametrize(("done", "total"), [(0, 0), (0, 7), (3, None)])
def test_no_time_left_is_invented_before_a_part_is_done_or_the_total_known(done: int, total: int | None) -> None:
    assert time_left(10.0, done, total) == ""


def test_short_work_prints_nothing_where_there_is_no_terminal(capsys: pytest.CaptureFixture[str]) -> None:
    with progress("sweeping") as advance:
        advance("chunk", 1, 2)
    assert capsys.readouterr().err == ""


class Waiting(Event):
    """Stand-in of the event that ends work: a first wait is over when the work is reported, a second when it ends."""

    def __init__(self) -> None:
        super().__init__()
        self.waits: list[float | None] = []
        self.reported, self.printed = Event(), Event()

    def wait(self, timeout: float | None = None) -> bool:
        self.waits.append(timeout)
        if len(self.waits) == 1:
            assert self.reported.wait(60)
            return False
        self.printed.set()
        return super().wait(60)


@pytest.fixture
def waiting(monkeypatch: pytest.MonkeyPatch) -> Waiting:
    """Event of work of which half a minute goes by before a line is printed."""
    event, times = Waiting(), iter([1000.0, 1030.0])
    monkeypatch.setattr(module, "Event", lambda: event)
    monkeypatch.setattr(module, "time", SimpleNamespace(monotonic=lambda: next(times)))
    monkeypatch.setattr(module, "SHORT", 2.0)
    return event


def test_long_work_prints_plain_lines_with_stage_count_and_time_left(
    capsys: pytest.CaptureFixture[str], waiting: Waiting
) -> None:
    with progress("sweeping") as advance:
        advance("second chunk", 1, 2)
        waiting.reported.set()
        assert waiting.printed.wait(60)
    printed = capsys.readouterr()
    assert printed.err == "sweeping: second chunk (1 of 2, 30 s, about 30 s left)\n"
    assert printed.out == ""
    assert waiting.waits == [2.0, 10.0]  # s, before the first line and before a further one


def test_long_work_of_unknown_length_says_how_long_it_has_taken(
    capsys: pytest.CaptureFixture[str], waiting: Waiting
) -> None:
    with progress("mapping"):
        waiting.reported.set()
        assert waiting.printed.wait(60)
    assert capsys.readouterr().err == "mapping (30 s)\n"


def test_a_terminal_shows_a_bar_with_count_and_never_a_question_mark() -> None:
    work = (
        "from sonolube.cli.console.options import progress\n"
        "with progress('tuning') as advance:\n"
        "    advance('length', 1, 2); input()\n"
    )
    own, terminal = pty.openpty()
    environment = os.environ | {"TERM": "xterm", "COLUMNS": "120"}
    with subprocess.Popen(
        [sys.executable, "-c", work], stdin=subprocess.PIPE, stderr=terminal, env=environment
    ) as program:
        os.close(terminal)
        shown = read_until(own, b"tuning: length", b"1/2", b"left")
        program.communicate(b"\n")
        shown += rest(own)
    os.close(own)
    assert program.returncode == 0
    assert "?" not in shown.decode().replace("\x1b[?", "")
