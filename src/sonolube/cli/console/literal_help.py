"""Help texts shown as they are written: brackets about units are no markup of rich."""

import re
from typing import Any

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
