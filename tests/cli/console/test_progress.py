"""Progress on standard error: nothing of short work, plain lines of long work, a bar on a terminal."""

import os
import pty
import subprocess
import sys
import time

import pytest

from sonolube.cli.console import progress as module
from sonolube.cli.console.progress import progress, time_left


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


def test_long_work_prints_plain_lines_with_stage_count_and_time_left(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "SHORT", 0.05)
    with progress("sweeping") as advance:
        advance("second chunk", 1, 2)
        time.sleep(0.5)
    printed = capsys.readouterr()
    assert printed.err == "sweeping: second chunk (1 of 2, 0 s, about 0 s left)\n"
    assert printed.out == ""


def test_long_work_of_unknown_length_says_how_long_it_has_taken(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "SHORT", 0.05)
    with progress("mapping"):
        time.sleep(0.5)
    assert capsys.readouterr().err == "mapping (0 s)\n"


def test_a_terminal_shows_a_bar_with_count_and_never_a_question_mark() -> None:
    work = (
        "import time; from sonolube.cli.console.progress import progress\n"
        "with progress('tuning') as advance:\n"
        "    time.sleep(0.3); advance('length', 1, 2); time.sleep(0.3)\n"
    )
    own, terminal = pty.openpty()
    environment = os.environ | {"TERM": "xterm", "COLUMNS": "120"}
    subprocess.run([sys.executable, "-c", work], stderr=terminal, env=environment, check=True)
    os.close(terminal)
    shown = os.read(own, 100_000).decode()
    os.close(own)
    assert "tuning: length" in shown
    assert "1/2" in shown
    assert "left" in shown
    assert "?" not in shown.replace("\x1b[?", "")
