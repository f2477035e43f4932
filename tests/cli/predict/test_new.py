"""Command `new`: by options, by questions under a pseudo-terminal, and refused; then `predict` on what it wrote."""

import json
import os
import pty
import select
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path

import pytest
from pytest import CaptureFixture, MonkeyPatch, raises

from sonolube.cli import main
from sonolube.rig import read_rig

PROGRAM = str(Path(sys.executable).parent / "sonolube")
PIN, DISC = "brass_c36000", "stainless_steel_304"
KNOWN = (
    *("--pin", PIN, "--disc", DISC, "--load", "5N", "--speed", "0.2m/s", "--frequency", "20kHz"),
    *("--amplitude", "3um", "--finish", "ground N6"),
)
_LONGEST = 60.0  # s
_REACTION = 0.2  # s; what is typed before a line editor has set the terminal may be lost


@pytest.fixture(autouse=True)
def desk(tmp_path: Path, monkeypatch: MonkeyPatch) -> Path:
    """Work in an empty folder."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def conversation(arguments: Sequence[str], answers: Sequence[str], *, end: bytes = b"") -> tuple[int, str]:
    """Exit status and screen of the program on a terminal, each answer typed after a question, then `end`."""
    process, terminal = pty.fork()
    if process == 0:
        os.execv(PROGRAM, [PROGRAM, *arguments])
    screen, typed, seen, begin = (
        b"",
        [f"{each}\n".encode() for each in answers] + [end] * bool(end),
        0,
        time.monotonic(),
    )
    while time.monotonic() - begin < _LONGEST:
        if select.select([terminal], [], [], 0.1)[0]:
            try:
                part = os.read(terminal, 4096)
            except OSError:
                break
            if not part:
                break
            screen += part
        if typed and screen[seen:].rstrip(b" ").endswith(b"]:"):
            seen = len(screen)
            time.sleep(_REACTION)
            os.write(terminal, typed.pop(0))
    else:
        os.kill(process, signal.SIGKILL)
    _, status = os.waitpid(process, 0)
    os.close(terminal)
    return os.waitstatus_to_exitcode(status), screen.decode()


def refused(capsys: CaptureFixture[str], *arguments: str) -> str:
    before = sorted(Path().rglob("*"))
    with raises(SystemExit) as end:
        main(["new", *arguments])
    out, err = capsys.readouterr()
    assert (end.value.code, out, err.count("\n")) == (2, "", 1), err
    assert sorted(Path().rglob("*")) == before
    return err


def predicted(path: str) -> tuple[float, float]:
    """80 % interval of the friction ratio that `predict` gives for a rig."""
    run = subprocess.run([PROGRAM, "predict", path, "--json"], capture_output=True, text=True, check=True, timeout=60)
    low, high = json.loads(run.stdout)["friction_ratio"]["interval_80"]
    return low, high


def test_from_what_is_known_to_a_prediction_takes_less_than_a_minute() -> None:
    begin = time.monotonic()
    run = subprocess.run([PROGRAM, "new", "rig.toml", *KNOWN], capture_output=True, text=True, check=True, timeout=60)
    assert "next: sonolube predict rig.toml" in run.stdout
    low, high = predicted("rig.toml")
    assert time.monotonic() - begin < 60
    assert high - low <= 0.8
    assert high >= 0.02


def test_questions_on_a_terminal_give_the_same_rig_as_options() -> None:
    answers = [PIN, DISC, "flat 3mm", "5N", "0.2m/s", "20kHz", "3um", "ground N6", "ground N6"]
    code, screen = conversation(["new", "asked.toml"], answers)
    assert code == 0, screen
    with raises(SystemExit):
        main(["new", "given.toml", *KNOWN])
    assert Path("asked.toml").read_text() == Path("given.toml").read_text()


def test_an_empty_answer_takes_the_default_that_the_question_shows() -> None:
    code, screen = conversation(["new", "rig.toml", *KNOWN[4:]], ["", "", ""])
    assert code == 0, screen
    assert "Material of the pin, such as aluminium_2024 [stainless_steel_304]: " in screen
    rig = read_rig("rig.toml")
    assert rig.pin_material == rig.disc_material == "stainless_steel_304"


def test_an_answer_that_cannot_be_read_is_asked_for_again() -> None:
    code, screen = conversation(["new", "rig.toml", *KNOWN[2:]], ["aluminium_2042", PIN, ""])
    assert code == 0, screen
    assert "unknown material 'aluminium_2042'; did you mean aluminium_2024?" in screen
    assert screen.count("Material of the pin") == 2


@pytest.mark.parametrize(
    ("end", "code", "line"),
    [(b"\x03", 130, "sonolube: interrupted"), (b"\x04", 2, "the input ended at --disc; nothing is written")],
)
def test_an_interrupted_conversation_writes_nothing(end: bytes, code: int, line: str) -> None:
    status, screen = conversation(["new", "rig.toml"], [PIN], end=end)
    assert status == code, screen
    assert line in screen
    assert "Traceback" not in screen
    assert not list(Path().iterdir())


def test_off_a_terminal_the_missing_options_are_named(capsys: CaptureFixture[str]) -> None:
    assert "missing --speed, --amplitude; give them" in refused(
        capsys, "rig.toml", *("--pin", PIN, "--disc", DISC, "--load", "5N", "--frequency", "20kHz")
    )


@pytest.mark.parametrize(
    ("change", "line"),
    [
        (("--load", "-5N"), "--load -5N must be positive"),
        (("--amplitude", "3m"), "vibration_amplitude 3 m is beyond any ultrasonic vibration"),
        (("--pin", "aluminium_2042"), "unknown material 'aluminium_2042'; did you mean aluminium_2024?"),
        (("--speed", "5N"), "--speed 5N is a force; expected a speed"),
        (("--finish", "N66"), "unknown surface finish 'n66'"),
        (("--shape", "cone 3mm"), "--shape 'cone 3mm' must be 'flat' with its diameter or 'ball' with its radius"),
        (("--voltage", "40V"), "--actuator and --voltage belong together"),
        (("--pin", "ptfe", "--disc", "silicon_carbide"), "no dry friction is known of ptfe on silicon_carbide;"),
        (("--actuator", "sa050510", "--voltage", "40V"), "give either --amplitude or --actuator, got both"),
        (("--pin-finish", "N6", "--pin-scan", "pin.opd"), "give either --pin-finish or --pin-scan, got both"),
        (("--scan", "none.opd"), "none.opd"),
        (("--friction", "-0.4"), "--friction -0.4 must be positive"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(change: tuple[str, ...], line: str, capsys: CaptureFixture[str]) -> None:
    assert line in refused(capsys, "rig.toml", *KNOWN, *change)


def test_a_file_that_exists_is_replaced_only_by_force(capsys: CaptureFixture[str]) -> None:
    Path("rig.toml").write_text("mine")
    assert "rig.toml: exists; name another file, or give --force" in refused(capsys, "rig.toml", *KNOWN)
    assert Path("rig.toml").read_text() == "mine"
    with raises(SystemExit) as end:
        main(["new", "rig.toml", "--force", *KNOWN])
    assert not end.value.code
    assert read_rig("rig.toml").normal_load == 5.0


def test_thermal_takes_the_materials_of_the_rig(capsys: CaptureFixture[str]) -> None:
    for arguments in (["new", "rig.toml", *KNOWN], ["thermal", "rig.toml", "--json"]):
        with raises(SystemExit) as end:
            main(arguments)
        assert not end.value.code
    capsys.readouterr()
    answers = []
    for given in ((), ("--pin", PIN, "--disc", DISC), ("--pin", "m50", "--disc", DISC)):
        with raises(SystemExit):
            main(["thermal", "rig.toml", "--json", *given])
        answers.append(json.loads(capsys.readouterr().out)["temperature_rise"])
    assert answers[0] == answers[1] != answers[2]
