"""Option `--style` of all commands that draw figures, and literal help texts."""

import os
import re
from collections.abc import Callable
from functools import wraps
from inspect import Parameter, signature
from pathlib import Path
from typing import Any, get_type_hints

from sonolube.cli.console.options import FigureStyleName, OutputFolder, Style, output_marks

_REPORT = "report"  # argument of a page with figures


def with_figure_style(command: Callable[..., None]) -> Callable[..., None]:
    """Command with the option `--style`, where it writes figures into a folder or a page."""
    marks = output_marks(command)
    if _REPORT not in marks and not any(isinstance(mark, OutputFolder) for mark in marks.values()):
        return command

    @wraps(command)
    def run(*, style: FigureStyleName, **arguments: Any) -> None:
        from sonolube.figure import figure_style

        with figure_style(style):
            command(**arguments)

    hints = get_type_hints(command, include_extras=True)
    given = [each.replace(annotation=hints[name]) for name, each in signature(command).parameters.items()]
    option = Parameter("style", Parameter.KEYWORD_ONLY, default="journal", annotation=Style)
    run.__signature__ = signature(command).replace(parameters=[*given, option])  # type: ignore[attr-defined]
    run.__annotations__ = {**hints, "style": Style}
    return run


def prepare_matplotlib() -> None:
    """Skip work of matplotlib at the first figure that no command needs.

    Where the user's folders cannot be written, matplotlib would search for all fonts in each run, and say so; it keeps
    their list among temporary files instead. It leaves out of docstrings the lists of properties, whose collection is a
    fifth of its import.
    """
    if "MPLCONFIGDIR" not in os.environ and not all(map(_is_writable, _matplotlib_folders())):
        from sonolube.execution.compilation import private_folder

        if folder := private_folder():
            os.environ["MPLCONFIGDIR"] = folder
    import matplotlib.artist

    matplotlib.artist.kwdoc = lambda artist: ""


def _matplotlib_folders() -> list[Path]:
    """Folders in which matplotlib keeps settings and its list of fonts."""
    named = (os.environ.get("XDG_CONFIG_HOME") or "~/.config", os.environ.get("XDG_CACHE_HOME") or "~/.cache")
    return [Path(name).expanduser() / "matplotlib" for name in named]


def _is_writable(folder: Path) -> bool:
    """Whether a folder, or the parent in which it would be made, can be written to."""
    present = next((each for each in (folder, *folder.parents) if each.exists()), Path())
    return present.is_dir() and os.access(present, os.W_OK)


_TAG = re.compile(r"(\\*)\[(?=[a-z#/@])")  # what rich takes for markup, such as [m/s]


def show_help_literally(command: Any) -> None:
    """Escape the help texts of a program, its commands and their parameters, once after it was built."""
    for part in (command, *command.params):
        part.help = _literal(getattr(part, "help", None))
    for inner in getattr(command, "commands", {}).values():
        show_help_literally(inner)


def _literal(text: str | None) -> str | None:
    """Text that rich shows as this one."""
    return _TAG.sub(r"\1\1\\[", text) if text else text
