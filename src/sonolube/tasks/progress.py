"""Progress of a task, reported to who called it or under the cell of a notebook, and its cancellation."""

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager, nullcontext
from contextvars import ContextVar
from html import escape
from importlib import import_module
from typing import Any, TypeVar

from sonolube.errors import SonolubeError

T = TypeVar("T")

Advance = Callable[[str, int, int], None]
"""Called with the stage, the number done and their total, zero where it is unknown."""

Progress = Callable[[str, int, int], None]
"""Called with the stage and what is done in it, the number done and their total."""

Cancelled = Callable[[], bool]
"""Request to stop, which is looked at with every report of progress."""

Observer = Callable[[str], AbstractContextManager[Advance]]
"""Opened for each stage, by its title."""


class TaskCancelled(SonolubeError):
    """A task that was cancelled; it has written nothing."""


def _unseen(title: str) -> AbstractContextManager[Advance]:
    """Observer that shows nothing."""
    return nullcontext(lambda what, done, total: None)


_OBSERVER: ContextVar[Observer] = ContextVar("observer", default=_unseen)
_CANCELLED: ContextVar[Cancelled] = ContextVar("cancelled", default=lambda: False)


@contextmanager
def within(variable: ContextVar[T], value: T) -> Iterator[None]:
    """Set a variable of the context inside a `with` block."""
    before = variable.set(value)
    try:
        yield
    finally:
        variable.reset(before)


def observed(observer: Observer) -> AbstractContextManager[None]:
    """Show the progress of tasks by an observer inside a `with` block."""
    return within(_OBSERVER, observer)


@contextmanager
def watched(progress: Progress | None, cancelled: Cancelled | None) -> Iterator[None]:
    """Report progress to a function, and ask another whether to stop, inside a `with` block; where they are given."""
    with ExitStack() as stack:
        if progress is not None:

            def observer(title: str) -> AbstractContextManager[Advance]:
                return nullcontext(
                    lambda what, done, total: progress(f"{title}: {what}".removesuffix(": "), done, total)
                )

            stack.enter_context(observed(observer))
        if cancelled is not None:
            stack.enter_context(within(_CANCELLED, cancelled))
        yield


@contextmanager
def stage(title: str) -> Iterator[Advance]:
    """Report the progress of a stage of a task inside a `with` block.

    Parameters
    ----------
    title : str
        Such as "sweeping".

    Yields
    ------
    callable
        Called with what is done now, the number done and their total.

    Raises
    ------
    TaskCancelled
        By a report, or at the end, if the task is to stop.
    """
    cancelled = _CANCELLED.get()

    def stop_if_cancelled() -> None:
        if cancelled():
            raise TaskCancelled(f"{title}: cancelled")

    with _OBSERVER.get()(title) as advance:

        def report(what: str, done: int, total: int) -> None:
            stop_if_cancelled()
            advance(what, done, total)

        yield report
        stop_if_cancelled()


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
