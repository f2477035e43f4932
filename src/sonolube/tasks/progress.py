"""Progress of a task, reported to who called it, and its cancellation."""

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager, nullcontext
from contextvars import ContextVar
from typing import TypeVar

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
