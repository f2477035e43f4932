"""Progress bar of long work on standard error, so that results on standard output can be piped."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from sonolube.printable_text import printable

Advance = Callable[[str, int, int], None]


@contextmanager
def progress(title: str) -> Iterator[Advance]:
    """Show a progress bar inside a `with` block, where standard error is a terminal.

    Parameters
    ----------
    title : str
        Of the work, such as "sweeping".

    Yields
    ------
    callable
        Called with what is done now, the number done and their total.
    """
    console = Console(stderr=True)
    columns = (TextColumn("{task.description}", markup=False), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task(title, total=None)
        yield lambda what, done, total: bar.update(
            task, description=printable(f"{title}: {what}"), completed=done, total=total
        )
