"""Table of all commands, one line each: the panel of the help, the name, and the module with the function."""

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module

from sonolube.tasks.docstrings import docstring
from sonolube.tasks.table import LAB, LOOKUP, PREDICT, TASKS, Task


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
    "mapping": "sonolube.cli.mapping:mapping",
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
    "measure": "Measure what instruments recorded: friction, surfaces, spectra, vibration.",
    "lab": "Laboratory: run protocols on a rig, and keep their records.",
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
