"""Progress of tasks in a notebook: one line under the cell, which changes and disappears."""

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from html import escape
from importlib import import_module
from typing import Any

from sonolube.tasks.progress import Advance

_SHORT = 1.0  # s of work that is not reported
_BETWEEN = 0.2  # s


def is_in_notebook() -> bool:
    """Whether this process is the kernel of a notebook."""
    ipython: Any = sys.modules.get("IPython")
    shell = None if ipython is None else ipython.get_ipython()
    return hasattr(shell, "kernel")


@contextmanager
def cell_progress(title: str) -> Iterator[Advance]:
    """Show a stage of a task under the running cell, once it has taken a second, until it ends."""
    ipython: Any = import_module("IPython.display")
    shown: list[Any] = []
    latest = time.monotonic() + _SHORT - _BETWEEN

    def advance(what: str, done: int, total: int) -> None:
        nonlocal latest
        if time.monotonic() < latest + _BETWEEN:
            return
        latest = time.monotonic()
        line = ipython.HTML(
            f"<small>{escape(' '.join(filter(None, (title, what))))}{f': {done} of {total}' if total else ''}</small>"
        )
        if shown:
            shown[0].update(line)
        else:
            shown.append(ipython.display(line, display_id=True))

    try:
        yield advance
    finally:
        if shown:
            shown[0].update(ipython.HTML(""))
