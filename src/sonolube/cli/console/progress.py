"""Progress of long work on standard error: a bar with stage and time left on a terminal, plain lines elsewhere."""

import os
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from threading import Event, Thread
from typing import TYPE_CHECKING

from sonolube.text.printable_text import printable

if TYPE_CHECKING:
    from rich.progress import Task

Advance = Callable[[str, int, int], None]

SHORT = 2.0
"""Time of work that is not reported where standard error is no terminal. [s]"""
_BETWEEN_LINES = 10.0  # s


def progress(title: str) -> AbstractContextManager[Advance]:
    """Report the progress of the work inside a `with` block.

    Called with what is done now, the number done and their total.
    """
    is_terminal = sys.stderr.isatty() and os.environ.get("TERM") != "dumb"
    return _bar(title) if is_terminal else _lines(title)


def time_left(elapsed: float, done: int, total: int | None) -> str:
    """Time left in words if the rest goes on at the same pace, such as "about 12 s left"; empty while unknown."""
    if not total or not 0 < done <= total:
        return ""
    left = elapsed * (total - done) / done
    return f"about {left:.0f} s left" if left < 90 else f"about {left / 60:.0f} min left"


@contextmanager
def _bar(title: str) -> Iterator[Advance]:
    """Draw a bar with stage, count, time gone and time left; without a count while the total is unknown."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, ProgressColumn, TextColumn, TimeElapsedColumn
    from rich.text import Text

    class Count(ProgressColumn):
        def render(self, task: "Task") -> Text:
            if not task.total:
                return Text("")
            done = int(task.completed)
            left = time_left(task.elapsed or 0.0, done, int(task.total))
            return Text(f"{done}/{int(task.total)}  {left}".rstrip())

    columns = (TextColumn("{task.description}", markup=False), BarColumn(), TimeElapsedColumn(), Count())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(title, total=None)
        yield lambda what, done, total: bar.update(
            task, description=printable(f"{title}: {what}"), completed=done, total=total or None
        )


@contextmanager
def _lines(title: str) -> Iterator[Advance]:
    """Print a line after the first seconds and then every few, from a thread, until the work is done."""
    start, ended = time.monotonic(), Event()
    state: list[tuple[str, int, int]] = [("", 0, 0)]

    def print_lines() -> None:
        wait = SHORT
        while not ended.wait(wait):
            what, done, total = state[0]
            gone = time.monotonic() - start
            parts = [f"{done} of {total}" if total else "", f"{gone:.0f} s", time_left(gone, done, total)]
            stage = f"{title}: {what}" if what else title
            sys.stderr.write(printable(f"{stage} ({', '.join(filter(None, parts))})") + "\n")
            wait = _BETWEEN_LINES

    def advance(what: str, done: int, total: int) -> None:
        state[0] = (what, done, total)

    thread = Thread(target=print_lines, daemon=True)
    thread.start()
    try:
        yield advance
    finally:
        ended.set()
        thread.join()
