"""Interruption by a signal: what was begun is undone, one line is printed, the exit status is that of the signal."""

import os
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from types import FrameType

_MEANINGS = {"SIGINT": "interrupted", "SIGTERM": "terminated", "SIGHUP": "ended with its terminal"}
_SHOW_CURSOR = b"\r\x1b[K\x1b[?25h"  # a progress bar has hidden it
_UNDO: dict[object, Callable[[], object]] = {}


@contextmanager
def undone_at_signal(undo: Callable[[], object]) -> Iterator[None]:
    """Call a function if a signal ends the program inside a `with` block.

    Parameters
    ----------
    undo : callable
        Such as the removal of an unfinished file. It runs between two instructions of the block and must not raise.
    """
    key = object()
    _UNDO[key] = undo
    try:
        yield
    finally:
        del _UNDO[key]


@contextmanager
def asked_by_signal(ask: Callable[[str], object]) -> Iterator[None]:
    """Let the first SIGINT, SIGTERM or SIGHUP inside a `with` block ask for an orderly end; a second acts as outside.

    Parameters
    ----------
    ask : callable
        Takes what the signal means, such as "interrupted". It runs between two instructions of the block.

    Notes
    -----
    Signals that are ignored stay ignored; outside the main thread of a process nothing changes.
    """
    former: dict[int, signal._HANDLER] = {}

    def first(number: int, frame: FrameType | None) -> None:
        restore()
        ask(_MEANINGS[signal.Signals(number).name])

    def restore() -> None:
        while former:
            signal.signal(*former.popitem())

    for name in _MEANINGS:
        number = getattr(signal, name, None)  # Windows has no SIGHUP
        if number is not None and signal.getsignal(number) is not signal.SIG_IGN:
            with suppress(ValueError):
                former[number] = signal.signal(number, first)
    try:
        yield
    finally:
        restore()


def end_program_at_signals() -> None:
    """Let SIGINT, SIGTERM and SIGHUP end this process with one line and the exit status 128 + number of the signal.

    Notes
    -----
    The handler ends the process itself. An exception would pass through modules that are being imported and through
    callbacks of libraries, which print or swallow it. A signal that is ignored, as SIGINT is in background jobs, stays
    ignored.
    """
    try:
        terminal: int | None = os.dup(2)  # a library may redirect standard error
    except OSError:
        terminal = None

    process = os.getpid()

    def end(number: int, frame: FrameType | None) -> None:
        if os.getpid() == process:  # what a forked process began is in its parent's hands
            for undo in list(_UNDO.values()):
                undo()
        if terminal is not None:
            line = f"sonolube: {_MEANINGS[signal.Signals(number).name]}\n".encode()
            with suppress(OSError):  # nobody may read it
                os.write(terminal, (_SHOW_CURSOR if os.isatty(terminal) else b"") + line)
        os._exit(128 + number)

    for name in _MEANINGS:
        number = getattr(signal, name, None)  # Windows has no SIGHUP
        if number is not None and signal.getsignal(number) is not signal.SIG_IGN:
            with suppress(ValueError):  # only the main thread of a process handles signals
                signal.signal(number, end)
