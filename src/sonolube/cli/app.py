"""Program `sonolube`: its commands from their table, exit codes, and the lines of a refusal."""

import io
import os
import re
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module

import typer
from typer.main import get_command

from sonolube import __version__
from sonolube.cli.console.figure_style import show_help_literally, with_figure_style
from sonolube.cli.console.options import with_checked_files
from sonolube.errors import SeveralFaults, SonolubeError, UnexpectedFault
from sonolube.execution.threads import threads_running
from sonolube.tasks.table import LAB, LOOKUP, PREDICT, TASKS, Task, docstring
from sonolube.text.plain_text import printable


@dataclass(frozen=True, slots=True)
class Command:
    """One command of the program.

    Parameters
    ----------
    panel : str
        Heading of the help under which it is listed.
    name : str
        As typed; two words for a command of a group.
    where : str
        Module and function in it, as "sonolube.cli.lab.watch:watch"; of a task below `sonolube.tasks`.
    """

    panel: str
    name: str
    where: str
    task: Task | None = None

    @property
    def function(self) -> Callable[..., None]:
        """Function of the command, imported with its module."""
        if self.task is not None and self.name not in _OWN_FUNCTIONS:
            from sonolube.cli.generated import command_of

            return command_of(self.task)
        module, _, name = _OWN_FUNCTIONS.get(self.name, self.where).partition(":")
        function: Callable[..., None] = getattr(import_module(module), name)
        return function

    @property
    def help(self) -> str:
        """Docstring of the function, read from the source without importing the module."""
        return docstring("sonolube.tasks" if self.task else "", self.where)


_OWN_FUNCTIONS = {
    "new": "sonolube.cli.new:new",
    "identify rig": "sonolube.cli.identify_rig:identify_rig",
    "evidence learn": "sonolube.cli.evidence_learn:evidence_learn",
    "mapping": "sonolube.cli.mapping:mapping",
    "runs": "sonolube.cli.runs:runs",
}
"""Tasks of which a terminal has a function of its own."""

_TERMINAL_ONLY = (
    Command(PREDICT, "app", "sonolube.browser.command:app"),
    Command(LAB, "lab watch", "sonolube.cli.lab.watch:watch"),
    Command(LOOKUP, "doctor", "sonolube.cli.lookup.doctor:doctor"),
)

_PANELS = list(dict.fromkeys(each.panel for each in TASKS))
COMMANDS = tuple(
    sorted(
        (*(Command(each.panel, each.name, each.where, each) for each in TASKS), *_TERMINAL_ONLY),
        key=lambda each: _PANELS.index(each.panel),
    )
)
"""Every command: those of tasks, and those that only a terminal has."""

GROUPS = {
    "impedance": "Impedance of piezoelectric parts, by finite elements.",
    "horn": "Design horns and other resonators.",
    "export": "Export a rig to other programs.",
    "measure": "Measure what instruments recorded: friction, surfaces, spectra, vibration.",
    "lab": "Laboratory: run protocols on a rig, and keep their records.",
    "evidence": "Published tests that predictions learn from: list, check, draw, and learn from your own.",
    "identify": "Identify the parameters of a rig from facts, and what sets the decay length of a contact.",
}
"""Help of each group of commands."""

MOVED_COMMANDS = {
    "study": "now part of sweep: sonolube sweep RIG.toml --of voltage|speed|frequency|power|waveform|load",
    "gui": "the workbench in the browser is opened by: sonolube app",
    "help": "all commands are listed by: sonolube --help; one is explained by: sonolube predict --help",
    "demo": "take an example: sonolube example tribometer, then: sonolube predict examples/rigs/tribometer.toml",
    "examples": "the example files are listed by: sonolube example; one is written by: sonolube example tribometer",
}
"""Words that are no command, among them those of earlier versions, each with what to type instead."""

RENAMED_OPTIONS = {
    ("friction", "--closure"): "--model",
    ("horn", "--shape"): "the argument PART, such as sonolube horn design stepped_horn",
}
"""Options of earlier versions by the first word of their command, each with its new name."""


_BAD_INPUT, _FAULT, _INTERRUPTED = 2, 70, 130  # exit codes
_LONGEST = 1200  # characters of a refusal, which may quote the input
_LONGEST_FAULT = 300  # characters of one fault among several
_LONGEST_COMMAND = 60  # characters of a name of a command
_HELP = (
    "Ultrasonic lubrication: friction and wear of two surfaces of which one vibrates.\n\n"
    "Example: sonolube friction examples/rigs/tribometer.toml\n\n"
    "To get the file of that rig: sonolube example tribometer"
)
_MISSING_FILE = re.compile(r"(examples/[\w./-]+): (?:cannot be read: )?no such file", re.IGNORECASE)


def program(arguments: Sequence[str]) -> typer.Typer:
    """Program with all commands of the table, of which only the one that is called is imported."""
    words = [*arguments, *_words_to_complete()]
    called = [command for command in COMMANDS if _is_called(command, words)] or COMMANDS
    app = typer.Typer(
        name="sonolube",
        no_args_is_help=True,
        pretty_exceptions_enable=False,
        context_settings={"help_option_names": ["-h", "--help"]},
        help=_HELP,
    )
    app.callback(invoke_without_command=True)(_version)
    groups: dict[str, typer.Typer] = {}
    for command in called:
        *group, name = command.name.split()
        if not group:
            app.command(name, rich_help_panel=command.panel)(_function(command, words))
            continue
        if group[0] not in groups:
            groups[group[0]] = typer.Typer(no_args_is_help=True, help=GROUPS[group[0]])
            app.add_typer(groups[group[0]], name=group[0], rich_help_panel=command.panel)
        groups[group[0]].command(name)(_function(command, words))
    return app


def run(arguments: Sequence[str] | None = None) -> None:
    """Run the program and exit: 0 after success, 1 after files refused, 2 after bad input.

    After a fault of the program, of which one line names a file that reproduces it, 70; after an interruption, 130.

    Parameters
    ----------
    arguments : sequence of str, optional
        Command with its arguments; those of the process where absent.

    Raises
    ------
    SystemExit
        Always.
    """
    arguments = list(sys.argv[1:] if arguments is None else arguments)
    _print_everything()
    command = next((word for word in arguments[:1] if not word.startswith("-")), "")
    try:
        if command in MOVED_COMMANDS:
            raise SonolubeError(MOVED_COMMANDS[command])
        called = get_command(program(arguments))
        show_help_literally(called)
        code = called(args=arguments, prog_name="sonolube", standalone_mode=False)
    except UnexpectedFault as fault:
        _refuse(command, str(fault))
        code = _FAULT
    except SeveralFaults as refusal:
        code = _refuse(command, refusal.heading, refusal.lines)
    except (SonolubeError, OSError) as refusal:
        code = _refuse(command, _with_example(str(refusal)))
    except typer.TyperException as refusal:
        code = _refuse(command, _usage_error(command, refusal))
    except MemoryError as refusal:
        code = _refuse(command, f"does not fit into memory; ask for fewer points: {refusal}")
    except (KeyboardInterrupt, typer.Abort):
        code = _INTERRUPTED
    except Exception as failure:  # whatever a command raises that no refusal foresees
        from sonolube.tasks.faults import unexpected

        _refuse(command, str(unexpected(failure, command, {"arguments": arguments})))
        code = _FAULT
    if code == _INTERRUPTED and threads_running():
        sys.stdout.flush()
        os._exit(_INTERRUPTED)
    sys.exit(code if isinstance(code, int) else 0)


def _print_everything() -> None:
    """Print characters that a terminal cannot show, such as bytes of a file name, as escapes."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def _function(command: Command, words: Sequence[str]) -> Callable[..., None]:
    """Function of a command that is called; for others one with the same help, whose module is not imported."""
    if _is_called(command, words):
        function = with_figure_style(with_checked_files(command.function))
        function.__doc__ = function.__doc__ or command.help  # Python -OO strips docstrings
        return function

    def not_called() -> None:
        pass

    not_called.__doc__ = command.help
    return not_called


def _is_called(command: Command, words: Sequence[str]) -> bool:
    """Whether the words begin with the name of a command."""
    name = command.name.split()
    return list(words[: len(name)]) == name


def _words_to_complete() -> list[str]:
    """Words typed so far where a shell asks to complete an option or its value; files the shell completes itself."""
    if "_SONOLUBE_COMPLETE" not in os.environ:
        return []
    words = (os.environ.get("_TYPER_COMPLETE_ARGS") or os.environ.get("COMP_WORDS", "")).split()[1:]
    return words if any(word.startswith("-") for word in words[-2:]) else []


def _version(
    version: bool = typer.Option(False, "--version", help="Print the version and stop.", is_eager=True),
) -> None:
    """Print the version where it is asked for."""
    if version:
        typer.echo(f"sonolube {__version__}")
        raise typer.Exit


def _usage_error(command: str, refusal: typer.TyperException) -> str:
    """Message of arguments that do not fit a command, with the new name of a renamed option."""
    renamed = RENAMED_OPTIONS.get((command, getattr(refusal, "option_name", "")))
    if renamed:
        return f"{refusal.option_name} is now {renamed}"  # type: ignore[attr-defined]
    return str(getattr(refusal, "format_message", refusal.__str__)())


def _with_example(reason: str) -> str:
    """Reason of a refusal, and how to get the file that is missing where it is an example."""
    missing = _MISSING_FILE.search(reason.replace("\\", "/"))
    if missing is None:
        return reason
    from sonolube.example_files import example_files

    names = [name for name, each in example_files().items() if each.path == missing[1]]
    return f"{reason}; to get it: sonolube example {names[0]}" if names else reason


def _refuse(command: str, reason: str, faults: Sequence[str] = ()) -> int:
    """Print a refusal as one line on standard error, and its faults one below the other; return the exit code."""
    if text := _one_line(reason, _LONGEST):
        named = _one_line(command, _LONGEST_COMMAND)
        lines = [f"{f'sonolube {named}'.strip()}: {text}", *(f"  {_one_line(each, _LONGEST_FAULT)}" for each in faults)]
        typer.echo("\n".join(lines), err=True)
    return _BAD_INPUT


def _one_line(text: str, longest: int) -> str:
    """Text as it is shown in one line."""
    return _shortened(printable(" ".join(text.replace("Value error, ", "").split())), longest)


def _shortened(text: str, longest: int) -> str:
    """Text without its middle where it is longer than that."""
    return text if len(text) <= longest else f"{text[: longest // 2]} ... {text[-longest // 2 :]}"
