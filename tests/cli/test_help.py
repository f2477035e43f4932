"""Help as it is shown: every word and every unit of what is written, also without docstrings and as a module."""

import inspect
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import pytest
from rich.text import Text
from tests.cli.conftest import Program

from sonolube.cli.app import COMMANDS, GROUPS, Command
from sonolube.cli.console.figure_style import show_help_literally

ROOT = Path(__file__).parents[2]
UNIT = re.compile(r"\[[^\]\s]+\]")


@pytest.fixture(autouse=True)
def wide_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let no line of a help be broken."""
    monkeypatch.setenv("COLUMNS", "4000")


def written(command: Command) -> Iterator[str]:
    """Texts that the help of a command is made of, each in one line: paragraphs, and those of its options."""
    yield from (" ".join(paragraph.split()) for paragraph in command.help.split("\n\n"))
    for parameter in inspect.signature(command.function).parameters.values():
        kinds = [parameter.default, *getattr(parameter.annotation, "__metadata__", ())]
        helps = [kind.help for kind in kinds if isinstance(getattr(kind, "help", None), str)]
        yield from (" ".join(text.split()) for text in helps)


@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command.name)
def test_the_help_of_a_command_shows_what_is_written_with_every_unit(command: Command, sonolube: Program) -> None:
    shown = " ".join(sonolube(*command.name.split(), "--help").out.split())
    texts = list(written(command))
    assert [text for text in texts if text not in shown] == []
    units = [unit for text in texts for unit in UNIT.findall(text)]
    assert [unit for unit in units if unit not in shown] == []


def test_some_help_has_units_that_markup_would_take() -> None:
    found = {unit for command in COMMANDS for text in written(command) for unit in UNIT.findall(text)}
    assert {"[um]", "[mm/s]", "[N]"} <= found


@pytest.mark.parametrize("group", ["", *GROUPS])
def test_a_list_of_commands_shows_the_first_paragraph_of_each(group: str, sonolube: Program) -> None:
    shown = " ".join(sonolube(*group.split(), "--help").out.split())
    for command in COMMANDS:
        if command.name.rpartition(" ")[0] == group:
            assert " ".join(command.help.partition("\n\n")[0].split()) in shown


@pytest.mark.parametrize("text", ["[m/s] and [N]", r"C:\[m]", r"\\[m]", "[/b] [#f00] [@click] []", "a[i] [1/s]", ""])
def test_rich_shows_a_text_as_it_is_written(text: str) -> None:
    part = SimpleNamespace(help=text, params=[])
    show_help_literally(part)
    assert Text.from_markup(part.help).plain == text


def test_completion_shows_units_too() -> None:
    command = next(each for each in COMMANDS if "[mm/s]" in " ".join(written(each)))
    words = f"sonolube {command.name} --"
    environment = {"_SONOLUBE_COMPLETE": "complete_zsh", "_TYPER_COMPLETE_ARGS": words}
    run = python("-m", "sonolube", **environment)
    assert "[mm/s]" in run.stdout


def python(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """Python in a process of its own."""
    return subprocess.run(
        [sys.executable, *arguments], capture_output=True, text=True, check=True, env=os.environ | environment
    )


@pytest.mark.parametrize("arguments", [(), ("measure",), ("sweep",), ("measure", "friction")])
def test_help_is_the_same_where_python_strips_docstrings_and_asserts(arguments: tuple[str, ...]) -> None:
    stripped = python("-m", "sonolube", *arguments, "--help", PYTHONOPTIMIZE="2")
    assert stripped.stdout == python("-m", "sonolube", *arguments, "--help").stdout
    assert len(stripped.stdout.splitlines()) > 10


def test_the_module_is_the_program() -> None:
    assert (
        python("-m", "sonolube", "--version").stdout
        == python("-c", "import sonolube.cli; sonolube.cli.main()", "--version").stdout
    )
    refused = subprocess.run(
        [sys.executable, "-m", "sonolube", "frictoin"], capture_output=True, text=True, check=False
    )
    assert (refused.returncode, refused.stderr[:37]) == (2, "sonolube frictoin: No such command 'f")
