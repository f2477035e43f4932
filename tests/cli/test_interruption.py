"""Signals at any moment: one line, the exit status of the signal, no traceback, and nothing unfinished."""

import signal
import subprocess
import sys
import time
from pathlib import Path

from pytest import mark
from tests.cli.conftest import Program
from tests.cli.terminal import without_progress

from sonolube.storage.files import locked_folder

pytestmark = mark.skipif(sys.platform == "win32", reason="Windows has no such signals")

ROOT = Path(__file__).parents[2]
TRIBOMETER = ROOT / "examples" / "rigs" / "tribometer.toml"
SWEEP = ("sweep", str(TRIBOMETER), "--over", "sliding.sliding_speed=10mm/s:90mm/s:400000", "--chunk", "50")
LINES = {signal.SIGINT: "sonolube: interrupted\n", signal.SIGTERM: "sonolube: terminated\n"}
PROGRAM = (
    "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)\n"  # a background job ignores it
    "import sonolube.cli; print('ready', flush=True); sonolube.cli.main()"
)
KILLED = (  # while it writes its third chunk
    "import os, signal, sys, sonolube.storage.files as files\n"
    "complete = files.UnfinishedFile.complete\n"
    "def killed(file):\n"
    "    if file._path.name.startswith('chunk-000002'): os.kill(os.getpid(), signal.SIGKILL)\n"
    "    complete(file)\n"
    "files.UnfinishedFile.complete = killed\n"
    "import sonolube.cli; sonolube.cli.main()"
)


def started(folder: Path, *words: str) -> "subprocess.Popen[str]":
    """Program whose handlers of signals are about to be set."""
    command = [sys.executable, "-c", PROGRAM, *words]
    run = subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert run.stdout
    assert run.stdout.readline() == "ready\n"
    return run


def unfinished(folder: Path) -> list[Path]:
    return [path for path in folder.rglob("*") if path.name.startswith(".")]


@mark.parametrize("number", LINES)
@mark.parametrize("delay", [0.01, 0.05, 0.1, 0.2, 0.35, 0.5, 0.8, 1.2, 2.0])
def test_a_signal_at_any_moment_ends_the_program_with_one_line(
    tmp_path: Path, delay: float, number: signal.Signals
) -> None:
    with started(tmp_path, *SWEEP, "--out", "out") as run:
        time.sleep(delay)
        run.send_signal(number)
        out, err = run.communicate(timeout=60)
    assert (run.returncode, out, without_progress(err)) == (128 + number, "", LINES[number])
    assert unfinished(tmp_path) == []


@mark.parametrize("number", LINES)
def test_a_signal_during_the_computation_keeps_finished_chunks_only(tmp_path: Path, number: signal.Signals) -> None:
    with started(tmp_path, *SWEEP, "--out", "out") as run:
        while not list((tmp_path / "out").glob("chunk-*.npz")):
            assert run.poll() is None
            time.sleep(0.01)
        run.send_signal(number)
        _, err = run.communicate(timeout=60)
    assert (run.returncode, without_progress(err)) == (128 + number, LINES[number])
    assert unfinished(tmp_path) == []
    assert not (tmp_path / "out" / "sweep.nc").exists()


def test_an_ignored_signal_stays_ignored(tmp_path: Path) -> None:
    code = (
        "import os, signal; signal.signal(signal.SIGINT, signal.SIG_IGN)\n"
        "from sonolube.storage.interruption import end_program_at_signals; end_program_at_signals()\n"
        "os.kill(os.getpid(), signal.SIGINT); print('alive')"
    )
    run = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert run.stdout == "alive\n"


def test_an_interruption_of_the_first_import_is_no_traceback(tmp_path: Path) -> None:
    code = (
        "import builtins\nkept = builtins.__import__\n"
        "def interrupted(name, *rest):\n"
        "    if name == 'sonolube.storage.interruption':\n        raise KeyboardInterrupt\n"
        "    return kept(name, *rest)\n"
        "builtins.__import__ = interrupted\nimport sonolube.cli"
    )
    run = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (run.returncode, run.stderr) == (130, "sonolube: interrupted\n")


def test_what_runs_before_the_handler_is_set_is_small() -> None:
    code = "import sys; before = set(sys.modules); import sonolube.cli; print(len(set(sys.modules) - before))"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert int(run.stdout) < 42


def test_a_second_sweep_into_the_folder_of_one_at_work_is_refused(tmp_path: Path, sonolube: Program) -> None:
    out = tmp_path / "out"
    with locked_folder(out, purpose="sweep"):
        refusal = sonolube(*SWEEP, "--out", out).refusal
    assert refusal == f"sonolube sweep: {out}: another sweep is at work in it; wait for it, or name another folder\n"
    assert list(out.iterdir()) == []


def test_a_sweep_that_was_killed_is_finished_by_the_next(tmp_path: Path, sonolube: Program) -> None:
    words = (*SWEEP[:3], "sliding.sliding_speed=10mm/s:90mm/s:400", "--chunk", "50", "--workers", "1", "--out")
    run = subprocess.run([sys.executable, "-c", KILLED, *words, "out"], cwd=tmp_path, capture_output=True, check=False)
    assert run.returncode == -signal.SIGKILL
    assert len(list((tmp_path / "out").glob("chunk-*.npz"))) == 2
    assert unfinished(tmp_path)
    for folder in ("out", "undisturbed"):
        assert sonolube(*words, tmp_path / folder).code == 0
    assert unfinished(tmp_path) == []
    assert {path.name: path.read_bytes() for path in (tmp_path / "out").iterdir()} == {
        path.name: path.read_bytes() for path in (tmp_path / "undisturbed").iterdir()
    }
