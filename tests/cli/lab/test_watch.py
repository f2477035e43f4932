"""`sonolube lab watch`: a run followed from another terminal, to its end or until one has seen enough."""

import os
import pty
import select
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from pytest import MonkeyPatch, approx
from tests.cli.conftest import Program
from tests.lab.records.recorded import begun, block_of, recorded
from tests.lab.records.test_recovery import unfinished

from sonolube.cli.lab import watch
from sonolube.lab.records import read_run

PROGRAM = (
    "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)\nimport sonolube.cli; sonolube.cli.main()"
)
SLOW = """title = "slow"
source = "none"

[limits]
voltage_maximum = "30 V"
duration_maximum = "60 s"

[[steps]]
kind = "acquire"
channels = ["friction_force", "normal_load", "temperature"]
sample_rate = "400 Hz"
duration = "{duration} s"

[[steps]]
kind = "motor_speed"
sliding_speed = "50 mm/s"
"""


@contextmanager
def running(folder: Path, rigs: Path, *, duration: float) -> Iterator[subprocess.Popen[bytes]]:
    """Program that records a virtual run in real time, of which blocks are on the disk."""
    protocol = folder / "slow.toml"
    protocol.write_text(SLOW.format(duration=duration))
    words = ["lab", "run", str(protocol), "--rig", str(rigs / "power_map.toml"), "--real-time"]
    command = [sys.executable, "-c", PROGRAM, *words, "--out", str(folder / "runs")]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as program:
        try:
            while not any(path.stat().st_size > 2000 for path in folder.rglob("raw/*")):
                assert program.poll() is None
                time.sleep(0.02)
            yield program
        finally:
            program.kill()


def folder_of(runs: Path) -> Path:
    (folder,) = (path for path in runs.iterdir() if (path / "run.json").exists())
    return folder


def test_a_run_is_followed_to_its_end_with_lines_where_nothing_can_be_written_over(
    sonolube: Program, rigs: Path, tmp_path: Path, monkeypatch: MonkeyPatch
) -> None:
    monkeypatch.setattr(watch, "LOOK_INTERVAL", 0.05)
    monkeypatch.setattr(watch, "LINE_INTERVAL", 0.3)
    with running(tmp_path, rigs, duration=2.0) as program:
        seen = sonolube("lab", "watch", tmp_path / "runs")
        program.communicate(timeout=60)
    assert (seen.code, seen.err, program.returncode) == (0, "", 0)
    first, *_ = lines = seen.out.splitlines()
    assert "\r" not in seen.out
    assert first.startswith("running; step 2 motor speed; ")
    for part in (
        " s of 2.0 s, ",
        " s left; friction force ",
        "normal load ",
        "temperature 29",
        "; set sliding speed 50 mm/s",
    ):
        assert part in first
    assert sum(line.startswith("running; ") for line in lines) >= 3
    assert "  outcome  completed" in lines
    run = read_run(folder_of(tmp_path / "runs"))
    assert (run.summary.samples, run.caveats) == (800, ())


def test_one_look_is_an_object_in_si(sonolube: Program, tmp_path: Path) -> None:
    recorder = begun(tmp_path)
    recorder.append(block_of(0, 500))
    recorder.note("trip", sample=400, reason="too hot", protocol_time=0.4, state="stopping")
    answer = sonolube("lab", "watch", tmp_path, "--once", "--json").answer
    assert answer["folder"] == str(recorder.folder)
    assert (answer["outcome"], answer["state"], answer["trips"]) == ("running", "stopping", ["too hot"])
    assert answer["protocol_time"] == {"value": approx(0.5), "unit": "s"}
    assert answer["means"]["temperature"] == {"value": approx(293.2495), "unit": "K"}
    recorder.finish("stopped", reason="too hot")
    run = sonolube("lab", "watch", tmp_path, "--once")
    assert run.code == 1
    assert "outcome  stopped: too hot" in run.out


def test_a_completed_run_needs_no_waiting(sonolube: Program, tmp_path: Path) -> None:
    recorded(tmp_path)
    run = sonolube("lab", "watch", tmp_path)
    assert run.code == 0
    assert "  outcome  completed\n" in run.out


def test_a_dead_writer_is_told_with_the_command_that_completes_its_record(sonolube: Program, tmp_path: Path) -> None:
    folder = unfinished(tmp_path)
    run = sonolube("lab", "watch", tmp_path)
    assert run.code == 1
    assert "  outcome  unfinished\n" in run.out
    assert f"sonolube lab recover {folder} completes its record" in run.out
    sonolube("lab", "recover", folder)
    assert "interrupted" in sonolube("lab", "watch", folder).out


def test_a_run_that_is_killed_while_it_is_watched_ends_the_watching(
    sonolube: Program, rigs: Path, tmp_path: Path, monkeypatch: MonkeyPatch
) -> None:
    monkeypatch.setattr(watch, "LOOK_INTERVAL", 0.05)
    with running(tmp_path, rigs, duration=30.0) as program:
        os.kill(program.pid, signal.SIGKILL)
        run = sonolube("lab", "watch", tmp_path / "runs")
    assert run.code == 1
    assert "motor or drive may be on; sonolube lab recover" in run.out


def test_a_signal_ends_the_watching_and_not_the_run_and_a_terminal_gets_one_line_that_is_written_over(
    rigs: Path, tmp_path: Path
) -> None:
    with running(tmp_path, rigs, duration=30.0) as program:
        leader, follower = pty.openpty()
        command = [sys.executable, "-c", PROGRAM, "lab", "watch", str(tmp_path / "runs")]
        with subprocess.Popen(command, stdout=follower, stderr=follower, stdin=follower) as watching:
            os.close(follower)
            text = _read_until(leader, b"s left")
            watching.send_signal(signal.SIGINT)
            text += _rest(leader)
            assert watching.wait(timeout=30) == 0
        assert program.poll() is None
        assert b"\rrunning; step 2" in text
        assert b"\x1b[K" in text
        assert b"outcome      running" in text
        program.send_signal(signal.SIGINT)
        program.communicate(timeout=60)
    assert read_run(folder_of(tmp_path / "runs")).summary.outcome == "stopped"


def _read_until(handle: int, word: bytes) -> bytes:
    """What a terminal shows until a word."""
    text, latest = b"", time.monotonic() + 60
    while word not in text:
        assert time.monotonic() < latest, text
        if select.select([handle], [], [], 1.0)[0]:
            text += os.read(handle, 4096)
    return text


def _rest(handle: int) -> bytes:
    """What a terminal shows until the program has ended."""
    text = b""
    try:
        while piece := os.read(handle, 4096):
            text += piece
    except OSError:  # the program has closed the terminal
        pass
    return text


@pytest.mark.parametrize("place", ["none", "empty"])
def test_a_place_without_runs_is_refused_in_one_line(place: str, sonolube: Program, tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    line = {"none": "none: cannot be read: No such file", "empty": "empty: holds no run; name a run"}[place]
    assert line in sonolube("lab", "watch", tmp_path / place).refusal
