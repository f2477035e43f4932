"""`sonolube lab watch`: a run followed from another terminal, to its end or until one has seen enough."""

import os
import pty
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
from tests.cli.terminal import read_until, rest
from tests.laboratory.records.recorded import begun, block_of, recorded
from tests.laboratory.records.test_recovery import unfinished

from sonolube.cli.lab import watch
from sonolube.laboratory.records import read_run

LONG = 3600.0  # s, of a run that a test ends
PROGRAM = (
    "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)\nimport sonolube.cli; sonolube.cli.main()"
)
HELD = """
import sys, time
from pathlib import Path
from sonolube.laboratory.virtual_tribometer import simulation
blocks, seen = 0, Path(sys.argv.pop())
def hold(seconds):
    global blocks
    blocks += 1
    while blocks == 20 and not seen.exists():
        time.sleep(0.01)
simulation.sleep = hold
"""
SLOW = """title = "slow"
source = "none"

[limits]
voltage_maximum = "30 V"
duration_maximum = "2 h"

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
def running(
    folder: Path, rigs: Path, *, duration: float, until: Path | None = None
) -> Iterator[subprocess.Popen[bytes]]:
    """Program that records a virtual run in real time, of which blocks are on the disk.

    Where it has to last until there is a file, it takes no time but waits for that after a second of the run.
    """
    protocol = folder / "slow.toml"
    protocol.write_text(SLOW.format(duration=duration))
    words = ["lab", "run", str(protocol), "--rig", str(rigs / "power_map.toml"), "--real-time"]
    command = [sys.executable, "-c", PROGRAM, *words, "--out", str(folder / "runs")]
    if until is not None:
        command[2] = HELD + PROGRAM
        command.append(str(until))
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
    class Looks(watch.EndOfWatching):
        """End of the watching, for which it waits between looks; after the third the run goes on."""

        waits = 0

        def wait(self, longest: float) -> None:
            self.waits += 1
            if self.waits == 3:
                (tmp_path / "seen").touch()
            super().wait(longest)

    monkeypatch.setattr(watch, "EndOfWatching", Looks)
    monkeypatch.setattr(watch, "LOOK_INTERVAL", 0.05)
    monkeypatch.setattr(watch, "LINE_INTERVAL", 0.0)
    with running(tmp_path, rigs, duration=2.0, until=tmp_path / "seen") as program:
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
    assert f"sonolube lab recover {folder} completes its record" in " ".join(run.out.split())
    sonolube("lab", "recover", folder)
    assert "interrupted" in sonolube("lab", "watch", folder).out


def test_a_run_that_is_killed_while_it_is_watched_ends_the_watching(
    sonolube: Program, rigs: Path, tmp_path: Path, monkeypatch: MonkeyPatch
) -> None:
    monkeypatch.setattr(watch, "LOOK_INTERVAL", 0.05)
    with running(tmp_path, rigs, duration=LONG) as program:
        os.kill(program.pid, signal.SIGKILL)
        run = sonolube("lab", "watch", tmp_path / "runs")
    assert run.code == 1
    assert "motor or drive may be on; sonolube lab recover" in " ".join(run.out.split())


def test_an_end_is_asked_for_at_any_moment_of_a_wait(monkeypatch: MonkeyPatch) -> None:
    end, waits = watch.EndOfWatching(), list[float]()

    def interrupted(wait: float) -> None:
        waits.append(wait)
        if len(waits) == 3:
            end.ask("interrupted")

    monkeypatch.setattr(time, "sleep", interrupted)
    end.wait(3600.0)
    assert len(waits) == 3


def test_a_signal_ends_the_watching_and_not_the_run_and_a_terminal_gets_one_line_that_is_written_over(
    rigs: Path, tmp_path: Path
) -> None:
    with running(tmp_path, rigs, duration=LONG) as program:
        leader, follower = pty.openpty()
        command = [sys.executable, "-c", PROGRAM, "lab", "watch", str(tmp_path / "runs")]
        with subprocess.Popen(command, stdout=follower, stderr=follower, stdin=follower) as watching:
            os.close(follower)
            text = read_until(leader, b"s left")
            watching.send_signal(signal.SIGINT)
            text += rest(leader)
            assert watching.wait(timeout=60) == 0
        assert program.poll() is None
        assert b"\rrunning; step 2" in text
        assert b"\x1b[K" in text
        assert b"outcome      running" in text
        program.send_signal(signal.SIGINT)
        program.communicate(timeout=60)
    assert read_run(folder_of(tmp_path / "runs")).summary.outcome == "stopped"


@pytest.mark.parametrize("place", ["none", "empty"])
def test_a_place_without_runs_is_refused_in_one_line(place: str, sonolube: Program, tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    line = {"none": "none: cannot be read: No such file", "empty": "empty: holds no run; name a run"}[place]
    assert line in sonolube("lab", "watch", tmp_path / place).refusal
