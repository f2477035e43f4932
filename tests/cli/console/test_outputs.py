"""Targets that must not be replaced are refused by every command that writes, in one line, before it computes."""

import os
from collections.abc import Callable
from functools import wraps
from glob import escape
from pathlib import Path
from typing import Any

import pytest
from pytest import CaptureFixture, MonkeyPatch, mark, raises

from sonolube.cli import main
from sonolube.cli.commands import COMMANDS, Command
from sonolube.cli.console.outputs import OutputFile, output_marks

ARGUMENTS = {  # of every command that writes: the least that it takes, in.dat being an input
    "simulate": ("in.dat",),
    "response": ("in.dat",),
    "transient": ("in.dat",),
    "thermal": ("in.dat", "--pin", "m50", "--disc", "m50"),
    "regime": ("in.dat", "--film-coefficient", "0.2", "--asperity-pressure", "10MPa"),
    "modes": ("in.dat",),
    "impedance compute": ("stack", "--measured", "in.dat"),
    "sweep": ("in.dat", "--of", "speed"),
    "map": ("in.dat",),
    "uncertainty": ("in.dat",),
    "optimise": ("in.dat", "--target-friction", "0.15"),
    "control": ("in.dat",),
    "efficiency": ("in.dat", "--rig", "rig.toml"),
    "horn design": ("--frequency", "20kHz", "--material", "titanium_6al4v", "--shape", "in.dat"),
    "measure friction": ("in.dat",),
    "measure rotation": ("in.dat", "--groove-diameter", "50mm"),
    "measure calibration": ("in.dat",),
    "measure surface": ("in.dat",),
    "measure groove": ("in.dat",),
    "measure impedance": ("in.dat",),
    "measure vibration": ("in.dat", "--frequency", "22kHz"),
    "compare": ("in.dat",),
    "identify rig": ("in.dat",),
    "literature": ("in.dat",),
    "reproduce": (),
}
WRITERS = {command.name: command for command in COMMANDS if output_marks(command.function)}
TO_A_FILE = [
    (name, argument)
    for name, command in WRITERS.items()
    for argument, kind in output_marks(command.function).items()
    if isinstance(kind, OutputFile)
]
TO_A_FOLDER = [name for name in WRITERS if name not in dict(TO_A_FILE)]


@pytest.fixture
def desk(tmp_path: Path, monkeypatch: MonkeyPatch) -> Path:
    """Work in a folder with one input, where no command may be reached."""

    def unreachable(command: Callable[..., None]) -> Callable[..., None]:
        @wraps(command)
        def reached(**arguments: Any) -> None:
            raise AssertionError("the command computes")

        return reached

    functions = {command: command.function for command in WRITERS.values()}
    monkeypatch.setattr(Command, "function", property(lambda command: unreachable(functions[command])))
    monkeypatch.setattr(Command, "help", "")  # which is read from the source of every command
    monkeypatch.chdir(tmp_path)
    (tmp_path / "in.dat").write_text("an input")
    return tmp_path


def snapshot() -> dict[Path, tuple[int, int, int, int]]:
    """Every file and link of the desk with what changes when it is replaced or written; folders by name alone."""
    found = {path: path.lstat() for path in Path().rglob("*")}
    return {
        path: (0, 0, 0, 0) if path.is_dir() else (each.st_ino, each.st_mode, each.st_size, each.st_mtime_ns)
        for path, each in found.items()
    }


def refusal(capfd: CaptureFixture[str], *arguments: str) -> str:
    """The one line of a refusal after which all files are as before."""
    before = snapshot()
    with raises(SystemExit) as end:
        main(arguments)
    out, err = capfd.readouterr()
    assert (end.value.code, out, err.count("\n")) == (2, "", 1), err
    assert snapshot() == before
    assert Path("/dev/null").is_char_device()
    assert "cannot be written" in err
    return err


def hostile(kind: str, path: Path) -> Path:
    """Path of a target of this kind: the path given, except for a device."""
    if kind == "device":
        return Path("/dev/null")
    if kind == "link to an input":
        path.symlink_to(Path("in.dat").absolute())
    elif kind == "second name of an input":
        path.hardlink_to("in.dat")
    elif kind == "pipe":
        os.mkfifo(path)
    elif kind == "folder":
        path.mkdir()
    elif kind == "dangling link":
        path.symlink_to("nowhere")
    return {"input": Path("in.dat"), "below a file": Path("in.dat/page.html")}.get(kind, path)


KINDS = (
    *("input", "link to an input", "second name of an input", "pipe", "device", "folder", "dangling link"),
    "below a file",
)


def test_every_command_that_writes_is_tried_here() -> None:
    assert set(ARGUMENTS) == set(WRITERS)


@mark.usefixtures("desk")
@mark.parametrize("kind", KINDS)
@mark.parametrize(("name", "argument"), TO_A_FILE, ids=[name for name, _ in TO_A_FILE])
def test_a_file_that_must_not_be_replaced_is_refused(
    name: str, argument: str, kind: str, capfd: CaptureFixture[str]
) -> None:
    target = hostile(kind, Path("target"))
    line = refusal(capfd, *name.split(), *ARGUMENTS[name], f"--{argument}", str(target))
    assert f"{target}: cannot be written: " in line


@mark.usefixtures("desk")
@mark.parametrize("kind", ["input", "pipe", "device", "dangling link", "below a file"])
@mark.parametrize("name", TO_A_FOLDER)
def test_a_folder_that_is_none_is_refused(name: str, kind: str, capfd: CaptureFixture[str]) -> None:
    target = hostile(kind, Path("target"))
    assert f"{target}: cannot be written: " in refusal(capfd, *name.split(), *ARGUMENTS[name], "--out", str(target))


@mark.usefixtures("desk")
@mark.parametrize("kind", ["link to an input", "second name of an input", "pipe", "folder", "dangling link"])
@mark.parametrize("name", TO_A_FOLDER)
def test_a_file_in_the_folder_that_must_not_be_replaced_is_refused(
    name: str, kind: str, capfd: CaptureFixture[str]
) -> None:
    if name == "reproduce" and "input" in kind:
        pytest.skip("it reads no file")
    if name == "impedance compute":
        stems = {"part": "stack"}
    else:
        stems = dict.fromkeys(("rig", "part", "shape", "runs"), "in") | {"of": "speed", "kind": "velocity-power"}
    folder_mark = output_marks(WRITERS[name].function)["out"]
    assert not isinstance(folder_mark, OutputFile)
    for number, pattern in enumerate(folder_mark.names.split()):
        folder = Path(f"out{number}")
        path = folder / pattern.format_map({key: escape(stem) for key, stem in stems.items()}).replace("*", "x")
        path.parent.mkdir(parents=True)
        hostile(kind, path)
        line = refusal(capfd, *name.split(), *ARGUMENTS[name], "--out", str(folder))
        assert f"{path}: cannot be written: " in line


def test_a_page_in_the_folder_of_its_recordings_is_refused(desk: Path, capfd: CaptureFixture[str]) -> None:
    (desk / "tests").mkdir()
    (desk / "tests" / "test.csv").write_text("a recording")
    refusal(capfd, "measure", "friction", "tests", "--report", "tests/test.csv")


def test_a_file_that_the_rig_names_is_an_input(
    tmp_path: Path, monkeypatch: MonkeyPatch, capfd: CaptureFixture[str]
) -> None:
    rig = (Path(__file__).parents[3] / "examples/rigs/tribometer.toml").read_text(encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    structure = '[structure]\nkind = "modes"\nfile = "modes.csv"\n'
    Path("rig.toml").write_text(f"{rig[: rig.index('[structure]')]}{structure}", encoding="utf-8")
    Path("modes.csv").write_text("modes")
    Path("out").mkdir()
    Path("out/rig-response.nc").hardlink_to("modes.csv")
    assert "it is modes.csv, an input of this command" in refusal(capfd, "response", "rig.toml")
