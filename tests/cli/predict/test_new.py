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
from math import pi
from pathlib import Path
from typing import Any

import pytest
from pytest import CaptureFixture, MonkeyPatch, approx, raises
from tests.same import same, same_text
from tests.work import calls

from sonolube.cli import main
from sonolube.rig import read_rig
from sonolube.tasks.predict.new import new

PROGRAM = str(Path(sys.executable).parent / "sonolube")
PIN, DISC = "brass_c36000", "stainless_steel_304"
KNOWN = (
    *("--pin", PIN, "--disc", DISC, "--load", "5N", "--speed", "0.2m/s", "--frequency", "20kHz"),
    *("--amplitude", "3um", "--finish", "ground N6"),
)
_LONGEST = 300.0  # s, which ends a hung test only


@pytest.fixture(autouse=True)
def desk(tmp_path: Path, monkeypatch: MonkeyPatch) -> Path:
    """Work in an empty folder."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def conversation(arguments: Sequence[str], answers: Sequence[str], *, end: bytes = b"") -> tuple[int, str]:
    """Exit status and screen of the program on a terminal, each answer typed after a question, then `end`.

    An end is typed again while nothing comes of it: Python notes a signal that comes just before a read after the read.
    """
    process, terminal = pty.fork()
    if process == 0:
        signal.signal(signal.SIGINT, signal.SIG_DFL)  # a background job ignores it
        os.execv(PROGRAM, [PROGRAM, *arguments])
    typed = [f"{each}\n".encode() for each in answers] + [end] * bool(end)
    screen, seen, begin = b"", 0, time.monotonic()
    while time.monotonic() - begin < _LONGEST:
        is_idle = not select.select([terminal], [], [], 1.0)[0]
        if not is_idle:
            try:
                part = os.read(terminal, 4096)
            except OSError:
                break
            if not part:
                break
            screen += part
        if typed and screen[seen:].rstrip(b" ").endswith(b"]:"):
            seen = len(screen)
            os.write(terminal, typed.pop(0))
        elif is_idle and not typed:
            os.write(terminal, end)
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
    run = subprocess.run([PROGRAM, "predict", path, "--json"], capture_output=True, text=True, check=True, timeout=300)
    low, high = json.loads(run.stdout)["friction_ratio"]["interval_80"]
    return low, high


def test_from_what_is_known_to_a_prediction_are_two_commands() -> None:
    run = subprocess.run([PROGRAM, "new", "rig.toml", *KNOWN], capture_output=True, text=True, check=True, timeout=300)
    assert "next: sonolube predict rig.toml" in run.stdout
    low, high = predicted("rig.toml")
    assert high - low <= 0.8
    assert high >= 0.02


def test_from_what_is_known_to_a_prediction_is_the_work_of_seconds() -> None:
    def commands() -> None:
        for words in (["new", "rig.toml", *KNOWN], ["predict", "rig.toml"]):
            with raises(SystemExit):
                main(words)

    work = calls(commands)
    assert work < 30_000_000  # calls, of which even a slow machine does a million a second: less than a minute


def test_questions_on_a_terminal_give_the_same_rig_as_options() -> None:
    answers = [PIN, DISC, "flat 3mm", "5N", "0.2m/s", "20kHz", "3um", "ground N6", "ground N6"]
    code, screen = conversation(["new", "asked.toml"], answers)
    assert code == 0, screen
    with raises(SystemExit):
        main(["new", "given.toml", *KNOWN])
    same_text(Path("asked.toml").read_text(), Path("given.toml").read_text())


def test_of_a_soft_body_the_thickness_is_asked_for() -> None:
    answers = ["felt", "glass", "flat 20mm", "5N", "0.2m/s", "20kHz", "3um", "ground N6", "ground N6", "4mm"]
    code, screen = conversation(["new", "asked.toml"], answers)
    assert code == 0, screen
    assert "Thickness of Unspecified felt or cloth as a layer on a rigid base, such as 3mm [3mm]: " in screen
    assert "next: sonolube friction asked.toml" in screen
    assert read_rig("asked.toml").friction_model.layer_thickness == approx(4e-3)  # type: ignore[attr-defined]


def test_an_empty_answer_takes_the_default_that_the_question_shows() -> None:
    code, screen = conversation(["new", "rig.toml", *KNOWN[4:]], ["", "", ""])
    assert code == 0, screen
    assert "Material of the pin, such as aluminium_2024 or steel [stainless_steel_304]: " in screen
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
        (("--finish", "shiny"), "write a process, an ISO grade, both, Ra or Rz: 'ground', 'lapped', 'turned', 'N6',"),
        (("--finish", "0.4"), "surface finish '0.4' has neither a unit nor Ra, Rz or Rq; write a process"),
        (("--finish", "Ra 4mm"), "surface finish 'Ra 4mm' lies beyond any finish: expected 100 pm to 200 um"),
        (("--finish", "Ra 1,600"), "surface finish 'Ra 1,600' may mean two numbers; write it without a comma"),
        (("--finish", "grund Ra 0.4"), "unknown surface finish 'grund'; did you mean ground?"),
        (("--speed", "100 rpm"), "--speed 100 rpm is a rotational speed: give --track-radius or --track-diameter too"),
        (("--speed", "-100 rpm", "--track-radius", "15mm"), "--speed -100 rpm must be positive"),
        (("--track-radius", "15mm"), "--track-radius belongs to a speed in rpm; --speed 0.2m/s needs none"),
        (
            ("--speed", "9 rpm", "--track-radius", "15mm", "--track-diameter", "30mm"),
            "give either --track-radius or --track-diameter, got both",
        ),
        (("--speed", "9 rpm", "--track-radius", "15"), "--track-radius 15 has no unit; expected a length"),
        (("--shape", "cone 3mm"), "--shape 'cone 3mm' must be 'flat' with its diameter or 'ball' with its radius"),
        (("--shape", "ball diameter"), "'ball 5mm', 'ball radius 5mm', 'ball diameter 10mm'"),
        (("--pin", "stee"), "unknown material 'stee'; did you mean steel?"),
        (
            ("--pin", "powder_coating"),
            "powder_coating has no youngs_modulus: no source is known; name another material",
        ),
        (("--voltage", "40V"), "--actuator and --voltage belong together"),
        (("--actuator", "sa050510", "--voltage", "40V"), "give either --amplitude or --actuator, got both"),
        (("--pin-finish", "N6", "--pin-scan", "pin.opd"), "give either --pin-finish or --pin-scan, got both"),
        (("--scan", "none.opd"), "none.opd"),
        (("--friction", "-0.4"), "--friction -0.4 must be positive"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(change: tuple[str, ...], line: str, capsys: CaptureFixture[str]) -> None:
    assert line in refused(capsys, "rig.toml", *KNOWN, *change)


def test_a_rotational_speed_on_a_terminal_asks_for_the_radius_of_the_track() -> None:
    code, screen = conversation(["new", "rig.toml", *KNOWN[:6], *KNOWN[8:], "--shape", "flat 3mm"], ["60 rpm", "15mm"])
    assert code == 0, screen
    assert "Radius of the track, such as 15mm [20mm]: " in screen
    assert read_rig("rig.toml").sliding_speed == approx(2 * pi * 15e-3, rel=1e-3)


def test_options_and_python_give_the_same_file_byte_for_byte() -> None:
    # what is given here, and how the answer repeats it
    typed: dict[str, Any] = {"pin": "100Cr6", "disc": "Stahl", "shape": "ball d6mm", "load": "5N", "speed": "60 rpm"}
    typed |= {"frequency": "20kHz", "amplitude": "2um", "finish": "Ra 0.4"}
    options = [text for key, value in typed.items() for text in (f"--{key}", value)]
    with raises(SystemExit):
        main(["new", "given.toml", *options, "--track-diameter", "30mm"])
    new(**typed, track_diameter="30mm").rig.to_toml("made.toml")
    text = Path("given.toml").read_text()
    assert Path("made.toml").read_text() == text
    for said in (
        "ball of 6 mm in diameter, tip radius 3 mm",
        "2 pi r n, with 60 rpm and a track of 15 mm in radius",
        "Ra 400 nm, stated as 'Ra 0.4', um assumed",
        "the class, not the material, is known: 190 GPa to 214 GPa",
        "as stated, taken as not measured",
    ):
        assert said in text


def test_a_pair_without_known_friction_is_written_with_the_range_of_its_class(capsys: CaptureFixture[str]) -> None:
    with raises(SystemExit) as end:
        main(["new", "rig.toml", *KNOWN, "--pin", "ptfe", "--disc", "silicon_carbide"])
    assert not end.value.code
    assert "range of the class of pair, polymer on any material" in capsys.readouterr().out
    assert read_rig("rig.toml").uncertainty["friction.friction_coefficient"].text == "uniform, 0.05 to 0.6"


def test_the_help_shows_the_forms_that_are_read(capsys: CaptureFixture[str]) -> None:
    with raises(SystemExit):
        main(["new", "--help"])
    shown = " ".join(capsys.readouterr().out.replace("│", " ").split())
    for form in ("'Ra 0.4'", "'Rz 3.2um'", "'100 rpm'", "'ball diameter", "100Cr6"):
        assert form in shown


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
    same(answers[0], answers[1])
    assert answers[2] != pytest.approx(answers[1], rel=1e-3)


def test_a_folder_is_made_whole_and_never_in_place_of_another(desk: Path, capsys: CaptureFixture[str]) -> None:
    for code in (0, 2):
        with raises(SystemExit) as end:
            main(["new", "bench", "--folder", *KNOWN])
        assert end.value.code == code
    assert "bench: exists; name a new folder" in capsys.readouterr().err
    assert [each.name for each in desk.iterdir()] == ["bench"]
    assert read_rig("bench").name == "bench"
    with raises(SystemExit):
        main(["predict", "bench", "--json"])
    answer = json.loads(capsys.readouterr().out)
    assert {Path(each).parent for each in answer["files"]} == {Path("bench/answers")}
    assert {each.name for each in desk.iterdir()} == {"bench"}


@pytest.mark.parametrize(
    ("pin", "following"), [("ptfe", "friction"), ("polyethylene", "friction"), ("brass", "predict")]
)
def test_the_next_command_of_a_new_rig_works(
    pin: str, following: str, sonolube: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    known = ("--disc", "steel", "--load", "5N", "--speed", "0.2m/s", "--frequency", "20kHz", "--amplitude", "3um")
    out = sonolube("new", "rig.toml", "--pin", pin, *known).out
    assert f"next: sonolube {following} rig.toml" in out
    assert sonolube(following, "rig.toml").code == 0
