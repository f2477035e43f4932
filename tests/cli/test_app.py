"""The program as its users meet it: help, exit codes, completion, and the addition of a command."""

import inspect
import json
import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from sonolube.cli import app, main
from sonolube.cli.app import COMMANDS, Command

ROOT = Path(__file__).parents[2]
Program = Callable[..., Any]
TRIBOMETER = "examples/rigs/tribometer.toml"


def installed(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run the program in a process of its own."""
    return subprocess.run(
        [Path(sys.executable).parent / "sonolube", *arguments],
        capture_output=True,
        text=True,
        check=False,
        cwd=ROOT,
        env=os.environ | environment,
    )


def assert_refused(run: subprocess.CompletedProcess[str], line: str) -> None:
    assert (run.returncode, run.stdout) == (2, "")
    assert len(run.stderr.splitlines()) == 1
    assert line in run.stderr


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (
            ["contact", "RIG", "--load", "40mm"],
            "sonolube contact: --load 40mm is a length; expected a force, such as 40N",
        ),
        (["contact", "RIG", "--load", "40"], "sonolube contact: --load 40 has no unit; expected a force, such as 40N"),
        (["contact", "RIG", "--load", "-3N"], "normal_load must be positive, got -3.0 N"),
        (["contact", "RIG", "--load", "1e9N"], "leaves no separation"),
        (["friction", "RIG", "--set", "drive.frequenzy=1kHz"], "drive.frequenzy: unknown key; did you mean frequency?"),
        (["friction", "RIG", "--set", "drive"], "change 'drive' must look like drive.frequency=22kHz"),
        (["friction", "RIG", "--model", "kinematics"], "did you mean kinematic?"),
        (["friction", "RIG", "--closure", "kinematic"], "sonolube friction: --closure is now --model"),
        (["wear", "none.toml"], "sonolube wear: none.toml: no such file"),
        (["materials", "unobtainium"], "sonolube materials: unknown material 'unobtainium'"),
        (["published", "9.9"], "sonolube published: unknown table '9.9'"),
        (["reproduce", "--chapter", "7"], "sonolube reproduce:"),
        (["thermal", "RIG", "--pin", "m50", "--disc", "uncoated_steel"], "uncoated_steel has no thermal_conductivity"),
        (
            ["regime", "RIG", "--film-coefficient", "0.1", "--asperity-pressure", "10mm"],
            "--asperity-pressure 10mm is a length",
        ),
        (
            ["regime", "RIG", "--film-coefficient", "0.1", "--asperity-pressure", "10MPa", "--pin", "m50"],
            "--pin and --disc belong together",
        ),
        (["contact"], "sonolube contact: Missing argument 'RIG.toml'"),
        (["fricton", "RIG"], "sonolube fricton: No such command 'fricton'. Did you mean 'friction', 'fit'?"),
        (
            ["study", "RIG", "--of", "voltage"],
            "sonolube study: now part of sweep: sonolube sweep RIG.toml --of voltage|speed|",
        ),
    ],
)
def test_bad_input_gets_one_clear_line_and_exit_code_2(
    arguments: list[str], line: str, sonolube: Program, rigs: Path
) -> None:
    assert line in sonolube(*[rigs / "tribometer.toml" if word == "RIG" else word for word in arguments]).refusal


def test_the_installed_program_refuses_in_one_line_too() -> None:
    assert_refused(installed("contact", TRIBOMETER, "--load", "40mm"), "sonolube contact: --load 40mm is a length")


def test_the_help_lists_every_command_under_the_heading_of_its_task() -> None:
    run = installed("--help", COLUMNS="200")
    assert run.returncode == 0
    for command in COMMANDS:
        panel = run.stdout.split(f"─ {command.panel} ─", 1)[1].split("╰", 1)[0]
        assert re.search(rf"^│ {command.name.split()[0]} ", panel, flags=re.MULTILINE), command


SERVERS = ("app",)  # answer in a browser


@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command.name)
def test_every_command_has_json_and_an_example_in_its_help(command: Command) -> None:
    function = command.function
    assert f"Example: sonolube {command.name}" in (function.__doc__ or "")
    assert command.help == inspect.getdoc(function)
    assert ">>>" not in command.help  # examples of Python
    assert ("json" in function.__annotations__) == (command.name not in SERVERS)


@pytest.mark.parametrize("arguments", [["--help"], ["measure", "--help"], ["frictoin"], ["study"]])
def test_commands_that_are_not_called_are_not_imported(arguments: list[str]) -> None:
    heavy = ("numpy", "xarray", "sonolube.rig", "sonolube.report")
    code = (
        "import sys\nfrom sonolube.cli import main\n"
        f"try: main({arguments!r})\nexcept SystemExit: pass\n"
        f"print([name for name in {heavy!r} if name in sys.modules], file=sys.stderr)"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stderr.splitlines()[-1] == "[]"


@pytest.mark.parametrize(("chosen", "threads"), [({}, "1"), ({"OPENBLAS_NUM_THREADS": "3"}, "3")])
def test_linear_algebra_has_one_thread_unless_the_user_chooses(chosen: dict[str, str], threads: str) -> None:
    code = (
        "import os, sys\nsys.argv = ['sonolube', '--version']\nfrom sonolube.cli import main\n"
        "try: main()\nexcept SystemExit: print(os.environ['OPENBLAS_NUM_THREADS'])"
    )
    kept = {name: value for name, value in os.environ.items() if "NUM_THREADS" not in name}
    run = subprocess.run([sys.executable, "-c", code], env=kept | chosen, capture_output=True, text=True, check=True)
    assert run.stdout.split()[-1] == threads


def test_options_of_a_command_are_completed() -> None:
    words = {"COMP_WORDS": "sonolube friction --mo", "COMP_CWORD": "2", "_SONOLUBE_COMPLETE": "complete_bash"}
    assert installed(**words).stdout.split() == ["--model"]


def test_help_of_a_command_shows_its_example() -> None:
    run = installed("sweep", "--help")
    assert run.returncode == 0
    assert "Example: sonolube sweep" in " ".join(run.stdout.split())


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_completion_can_be_had_for_every_shell(shell: str) -> None:
    run = installed(_SONOLUBE_COMPLETE=f"source_{shell}")
    assert run.returncode == 0
    assert "_SONOLUBE_COMPLETE" in run.stdout


@pytest.mark.parametrize(
    "failure", [IndexError("list index out of range"), ZeroDivisionError("by zero"), RuntimeError()]
)
def test_what_no_refusal_foresees_ends_with_one_line_on_a_fault_of_sonolube_and_its_file(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], failure: Exception
) -> None:
    def failing() -> None:
        raise failure

    monkeypatch.setattr(app, "_function", lambda *_: failing)
    with pytest.raises(SystemExit) as end:
        main(["materials"])
    out, err = capsys.readouterr()
    assert (end.value.code, out) == (70, "")
    (line,) = err.splitlines()
    kind = type(failure).__name__
    assert line.startswith(f"sonolube materials: a fault of sonolube itself, not of your input: {kind}")
    assert " in sonolube/cli/app.py, line " in line
    assert "please report it" in line
    file = Path(line.partition(", and attach ")[2].partition(",")[0])
    assert json.loads(file.read_text(encoding="utf-8"))["arguments"] == {"arguments": ["materials"]}
    file.unlink()
