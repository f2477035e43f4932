"""Targets that must not be replaced are refused by every command that writes, in one line, before it computes."""

from collections.abc import Callable, Sequence
from functools import wraps
from itertools import cycle
from pathlib import Path
from typing import Any

import pytest
from pytest import CaptureFixture, MonkeyPatch, mark, raises
from reliability.studies.output_targets import (
    ARGUMENTS,
    INPUT,
    KINDS_INSIDE,
    KINDS_OF_FILE,
    KINDS_OF_FOLDER,
    POSITIONAL,
    hostile,
    names_inside,
    snapshot,
    writers,
)

from sonolube.cli import main
from sonolube.cli.app import COMMANDS, Command
from sonolube.cli.console.options import OutputFile, output_marks

WRITERS = {command.name: command for command in COMMANDS if command.name in writers()}
TO_A_FILE = [
    (name, argument)
    for name, command in WRITERS.items()
    for argument, kind in output_marks(command.function).items()
    if isinstance(kind, OutputFile)
]
TO_A_FOLDER = [name for name in WRITERS if name not in dict(TO_A_FILE)]
READING = [name for name in TO_A_FOLDER if INPUT in ARGUMENTS[name]]
KINDS = [kind for kind in KINDS_INSIDE if kind != "link to a pipe"]


def paired(names: Sequence[str], kinds: Sequence[str]) -> list[tuple[str, str]]:
    """Every kind with the first command, and each other with one in turn; the study output_targets draws all pairs."""
    first, *others = names
    return [*((first, kind) for kind in kinds), *zip(others, cycle(kinds), strict=False)]


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


def test_every_command_that_writes_is_tried_here() -> None:
    assert set(ARGUMENTS) == set(WRITERS)


@mark.usefixtures("desk")
@mark.parametrize(("name", "kind"), paired(list(dict(TO_A_FILE)), KINDS_OF_FILE))
def test_a_file_that_must_not_be_replaced_is_refused(name: str, kind: str, capfd: CaptureFixture[str]) -> None:
    target = hostile(kind, Path("target"))
    option = [] if name in POSITIONAL else [f"--{dict(TO_A_FILE)[name]}"]
    line = refusal(capfd, *name.split(), *ARGUMENTS[name], *option, str(target))
    assert f"{target}: cannot be written: " in line


@mark.usefixtures("desk")
@mark.parametrize(("name", "kind"), paired(TO_A_FOLDER, KINDS_OF_FOLDER))
def test_a_folder_that_is_none_is_refused(name: str, kind: str, capfd: CaptureFixture[str]) -> None:
    target = hostile(kind, Path("target"))
    assert f"{target}: cannot be written: " in refusal(capfd, *name.split(), *ARGUMENTS[name], "--out", str(target))


@mark.usefixtures("desk")
@mark.parametrize(("name", "kind"), paired(READING, KINDS))
def test_a_file_in_the_folder_that_must_not_be_replaced_is_refused(
    name: str, kind: str, capfd: CaptureFixture[str]
) -> None:
    for number, inside in enumerate(names_inside(name)):
        folder = Path(f"out{number}")
        path = folder / inside
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
