"""Interruption by a signal: what was begun is undone, one line is printed, the exit status is that of the signal."""

import os
import signal
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from threading import Event
from types import FrameType
from typing import Final

_MEANINGS: Final = {  # Windows has no SIGHUP, and alone SIGBREAK
    "SIGINT": "interrupted",
    "SIGTERM": "terminated",
    "SIGHUP": "ended with its terminal",
    "SIGBREAK": "interrupted by Ctrl-Break",
}
_OTHERS: Final = {  # that would end or stop the process too; SIGKILL and SIGSTOP cannot be heard
    "SIGQUIT": "ended by Ctrl-\\",
    "SIGTSTP": "suspended by Ctrl-Z",
    **{
        f"SIG{name}": f"ended by SIG{name}"
        for name in ("USR1", "USR2", "ALRM", "VTALRM", "XCPU", "PWR", "TTIN", "TTOU")
    },
}
_ORDERLY_END: Final = 2.0  # s, of the five that Windows leaves when it closes a console
_SHOW_CURSOR = b"\r\x1b[K\x1b[?25h"  # a progress bar has hidden it
_UNDO: dict[object, Callable[[], object]] = {}


@contextmanager
def undone_at_signal(undo: Callable[[], object]) -> Iterator[None]:
    """Call a function if a signal ends the program inside a `with` block."""
    key = object()
    _UNDO[key] = undo
    try:
        yield
    finally:
        del _UNDO[key]


@contextmanager
def asked_by_signal(ask: Callable[[str], object], *, is_final: bool = False) -> Iterator[None]:
    """Turn signals inside a `with` block into a request for an orderly end.

    After the first SIGINT, SIGTERM, SIGHUP and, on Windows, SIGBREAK, a second of them acts as outside, unless the
    block is the end of the program. Others that would end or stop the process, such as that of Ctrl-Z, are a request
    each time they come; SIGKILL, SIGSTOP and those of a broken process cannot be heard. Those that are ignored or
    handled stay so; outside the main thread of a process they change nothing. Where Windows closes the
    console, the block has two seconds to end; then what was begun is undone, and the process ends.
    """
    former: dict[int, signal._HANDLER] = {}
    usual = _heard_signals()

    def request(number: int, frame: FrameType | None) -> None:
        if not is_final:
            restore(usual)
        ask((_MEANINGS | _OTHERS)[signal.Signals(number).name])

    def restore(numbers: Iterable[int]) -> None:
        for number in numbers:
            if number in former:
                signal.signal(number, former.pop(number))

    others = [getattr(signal, name) for name in _OTHERS if hasattr(signal, name)]
    for number in (*usual, *(each for each in others if signal.getsignal(each) is signal.SIG_DFL)):
        with suppress(ValueError, OSError):
            former[number] = signal.signal(number, request)
    ended = Event()

    def close(meaning: str) -> None:
        ask(meaning)
        ended.wait(_ORDERLY_END)
        _undo_all()

    from sonolube.operating_system import at_console_close

    forget = at_console_close(close)
    try:
        yield
    finally:
        ended.set()
        forget()
        restore(list(former))


def end_program_at_signals() -> None:
    """End this process at SIGINT, SIGTERM, SIGHUP and SIGBREAK: one line, exit status 128 + number of the signal.

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
            _undo_all()
        if terminal is not None:
            line = f"sonolube: {_MEANINGS[signal.Signals(number).name]}\n".encode()
            with suppress(OSError):  # nobody may read it
                os.write(terminal, (_SHOW_CURSOR if os.isatty(terminal) else b"") + line)
        os._exit(128 + number)

    for number in _heard_signals():
        with suppress(ValueError):  # only the main thread of a process handles signals
            signal.signal(number, end)
    if os.name == "nt":
        from sonolube.operating_system import at_console_close

        at_console_close(lambda meaning: _undo_all())


def _heard_signals() -> list[int]:
    """Signals of this system that end a program and are not ignored."""
    known = [getattr(signal, name) for name in _MEANINGS if hasattr(signal, name)]
    return [each for each in known if signal.getsignal(each) is not signal.SIG_IGN]


def _undo_all() -> None:
    """Undo what was begun and is not complete."""
    for undo in list(_UNDO.values()):
        undo()
