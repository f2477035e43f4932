"""Calls that differ on Windows, by stand-ins that do what the documentation of Windows and CPython says."""

import ctypes
import select
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

from pytest import MonkeyPatch, fixture, mark, raises

from sonolube import operating_system
from sonolube.cli.console.options import Operator
from sonolube.errors import InvalidInput
from sonolube.facts.protocol import Prompt
from sonolube.laboratory import RunControl
from sonolube.storage import files, interruption
from sonolube.storage.files import locked_folder, write_atomically
from sonolube.storage.interruption import asked_by_signal, undone_at_signal

CLOSED, BREAK = 2, 1  # CTRL_CLOSE_EVENT, CTRL_BREAK_EVENT
ASKED = Prompt(kind="prompt", task="load", text="Add a weight.")


@fixture
def windows(monkeypatch: MonkeyPatch) -> MonkeyPatch:
    """Windows, whose `select` takes no file of a console."""

    def refused(*_: object) -> None:
        raise OSError(10038, "an operation was attempted on something that is not a socket")

    for module in (operating_system, files):
        monkeypatch.setattr(module, "ON_WINDOWS", True)
    monkeypatch.setattr(select, "select", refused)
    return monkeypatch


class Console(ModuleType):
    """Module msvcrt: keys that were pressed, what is shown, and locks of files."""

    LK_NBLCK = 2

    def __init__(self, keys: str) -> None:
        super().__init__("msvcrt")
        self.keys, self.shown, self.locked = list(keys), "", set[int]()

    def kbhit(self) -> bool:
        return bool(self.keys)

    def getwch(self) -> str:
        return self.keys.pop(0)

    def putwch(self, character: str) -> None:
        self.shown += character

    def locking(self, handle: int, mode: int, count: int) -> None:
        if self.locked:
            raise PermissionError(13, "Permission denied")
        self.locked.add(handle)


@mark.parametrize(
    ("keys", "is_confirmed"),
    [("\r", True), ("yes\r", True), ("n\r", False), ("m\x08\r", True), ("\xe0Hy\r", True), ("\x1a", False)],
)
def test_a_prompt_is_answered_by_the_keys_of_a_windows_console(
    windows: MonkeyPatch, keys: str, is_confirmed: bool
) -> None:
    console = Console(keys)
    windows.setitem(sys.modules, "msvcrt", console)
    assert Operator(RunControl())(ASKED) is is_confirmed
    assert console.shown.endswith("\r\n")


def test_a_request_to_end_is_heard_while_nobody_types(windows: MonkeyPatch) -> None:
    windows.setitem(sys.modules, "msvcrt", Console("ye"))
    control = RunControl()
    windows.setattr(time, "sleep", lambda wait: control.stop("interrupted"))
    assert Operator(control)(ASKED) is False


def opened_elsewhere(patch: MonkeyPatch, refusals: int) -> list[float]:
    """Let a program have the target open for a number of tries, and return the waits."""
    replace, waits = Path.replace, list[float]()

    def refused(source: Path, target: Path) -> Path:
        if len(waits) < refusals:
            raise PermissionError(13, "Access is denied", str(source), 5, str(target))
        return replace(source, target)

    patch.setattr(Path, "replace", refused)
    patch.setattr(time, "sleep", waits.append)
    return waits


def test_a_file_that_somebody_reads_is_replaced_when_it_is_closed(windows: MonkeyPatch, tmp_path: Path) -> None:
    waits = opened_elsewhere(windows, 3)
    assert write_atomically(tmp_path / "run.json", "new").read_text() == "new"
    assert len(waits) == 3


def test_a_file_that_stays_open_elsewhere_is_refused_in_one_line(windows: MonkeyPatch, tmp_path: Path) -> None:
    path = tmp_path / "run.json"
    path.write_text("old")
    waits = opened_elsewhere(windows, 1000)
    with raises(InvalidInput, match="cannot be written: another program has it open, or it is protected; close it"):
        write_atomically(path, "new")
    assert (path.read_text(), [each.name for each in tmp_path.iterdir()]) == ("old", ["run.json"])
    assert sum(waits) < 1.5


def test_a_folder_is_locked_by_a_region_of_its_lock(windows: MonkeyPatch, tmp_path: Path) -> None:
    console = Console("")
    windows.setitem(sys.modules, "msvcrt", console)
    with (
        locked_folder(tmp_path, purpose="run"),
        raises(InvalidInput, match="another run is at work"),
        locked_folder(tmp_path, purpose="run"),
    ):
        pass
    assert list(tmp_path.iterdir()) == []


@mark.parametrize(
    ("word", "typed"),
    [(r"runs\2026 map", r'"runs\2026 map"'), (r"runs\map", r"runs\map"), ("it's", "it's"), ('a"b', r"a\"b")],
)
def test_words_are_quoted_by_the_rules_of_the_c_runtime(windows: MonkeyPatch, word: str, typed: str) -> None:
    assert operating_system.quoted(word) == typed


class Kernel:
    """kernel32: its list of handlers of console events, the last one first, and one process that runs."""

    def __init__(self) -> None:
        self.handlers: list[Callable[[int], int]] = []
        self.closed = 0
        self.OpenProcess = SimpleNamespaceCall(lambda access, inherits, process: 7 if process == 42 else 0)

    def SetConsoleCtrlHandler(self, handler: Callable[[int], int], add: int) -> int:
        (self.handlers.append if add else self.handlers.remove)(handler)
        return 1

    def happens(self, event: int) -> bool:
        """Whether a handler takes an event, after which Windows ends the process."""
        return any(handler(event) for handler in reversed(self.handlers))

    def GetExitCodeProcess(self, handle: Any, code: Any) -> int:
        code._obj.value = 259
        return 1

    def GetProcessTimes(self, handle: Any, created: Any, *others: Any) -> int:
        created._obj.value = 133_000_000_000_000_000
        return 1

    def CloseHandle(self, handle: Any) -> int:
        self.closed += 1
        return 1


class SimpleNamespaceCall(SimpleNamespace):
    """Function of a library, whose types can be set."""

    def __init__(self, function: Callable[..., int]) -> None:
        super().__init__(function=function)

    def __call__(self, *arguments: Any) -> int:
        return int(self.function(*arguments))


@fixture
def kernel(windows: MonkeyPatch) -> Kernel:
    found = Kernel()
    windows.setattr(ctypes, "WinDLL", lambda name, use_last_error: found, raising=False)
    windows.setattr(ctypes, "WINFUNCTYPE", ctypes.CFUNCTYPE, raising=False)
    return found


def test_a_closing_console_asks_for_an_end_and_then_switches_off(kernel: Kernel, windows: MonkeyPatch) -> None:
    windows.setattr(interruption, "_ORDERLY_END", 0.01)
    told: list[str] = []
    with undone_at_signal(lambda: told.append("off")), asked_by_signal(told.append):
        assert not kernel.happens(BREAK)
        assert told == []
        assert kernel.happens(CLOSED)
    assert (told, kernel.handlers) == (["ended with its console", "off"], [])


def test_ctrl_break_asks_for_an_orderly_end(windows: MonkeyPatch) -> None:
    windows.setattr(signal, "SIGBREAK", signal.SIGUSR1, raising=False)
    windows.setattr(signal, "Signals", lambda number: SimpleNamespace(name="SIGBREAK"))
    told: list[str] = []
    windows.setattr(operating_system, "ON_WINDOWS", False)  # without a console
    with asked_by_signal(told.append):
        signal.raise_signal(signal.SIGUSR1)
    assert told == ["interrupted by Ctrl-Break"]


def test_a_process_is_known_by_the_time_at_which_it_was_created(kernel: Kernel) -> None:
    assert operating_system.process_start(42) == "133000000000000000"
    assert operating_system.process_start(43) == ""
    assert kernel.closed == 1
