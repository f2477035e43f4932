"""Calls that differ on Windows: replacing and locking files, typed lines, quoted words, a closing console.

Windows does what its documentation and that of CPython say: an open file can be neither replaced nor removed, `select`
takes sockets alone, and a process ends when the handler of a closing console returns, or after five seconds.
"""

import errno
import os
import select
import shlex
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from typing import Any, Final

ON_WINDOWS: Final = os.name == "nt"
"""Whether this is Windows, where an open file can be neither replaced nor removed."""

_WAITS: Final = (0.01, 0.02, 0.05, 0.1, 0.2, 0.3, 0.3)  # s, for scanners and readers that have a file open
_LOOK: Final = 0.02  # s, between two looks at the keys of a console
_CLOSING: Final = {2: "ended with its console", 5: "ended by a log-off", 6: "ended by a shutdown of the computer"}
_QUERY: Final = 0x1000  # PROCESS_QUERY_LIMITED_INFORMATION
_ALIVE: Final = 259  # STILL_ACTIVE
_KEPT: list[object] = []  # callbacks that the system calls


def replace_file(source: Path, target: Path) -> None:
    """Rename a file to another, which it replaces; on Windows again for a second while somebody has it open."""
    _patiently(lambda: source.replace(target))


def remove_file(path: Path) -> None:
    """Remove a file where it exists; on Windows again for a second while somebody has it open."""
    _patiently(lambda: path.unlink(missing_ok=True))


def lock_file(handle: int, *, wait: bool = False) -> bool | None:
    """Whether an open file could be locked; None on a file system without locks."""
    try:
        if ON_WINDOWS:
            console = import_module("msvcrt")
            console.locking(handle, console.LK_NBLCK, 1)
        else:
            locks = import_module("fcntl")
            locks.flock(handle, locks.LOCK_EX if wait else locks.LOCK_EX | locks.LOCK_NB)
    except (BlockingIOError, PermissionError):
        return False
    except OSError:
        return None
    return True


def quoted(word: str) -> str:
    """Word of a command as it is typed, in quotes where the shell needs them.

    For a POSIX shell; on Windows by the rules of its C runtime.
    """
    return subprocess.list2cmdline([word]) if ON_WINDOWS else shlex.quote(word)


class TypedLines:
    """Lines that are typed at a terminal, each waited for no longer than the caller says."""

    def __init__(self) -> None:
        self._typed = ""

    def next(self, within: float) -> str | None:
        """Next line with its end, empty at the end of input; None where it is not complete within a time. [s]"""
        if ON_WINDOWS:
            return self._by_keys(within)
        return sys.stdin.readline() if select.select([sys.stdin], [], [], within)[0] else None

    def _by_keys(self, within: float) -> str | None:
        """Next line by the keys of a Windows console, which are echoed."""
        console, latest = import_module("msvcrt"), time.monotonic() + within
        while True:
            while console.kbhit():
                key = console.getwch()
                if key in "\x00\xe0":  # of a function key, whose code follows
                    console.getwch()
                elif key == "\x03":
                    signal.raise_signal(signal.SIGINT)
                elif key == "\x08":
                    self._typed = self._typed[:-1]
                    _echo(console, "\b \b")
                elif key in "\r\n\x1a":  # \x1a ends the input
                    line, self._typed = self._typed + ("" if key == "\x1a" else "\n"), ""
                    _echo(console, "\r\n")
                    return line
                else:
                    self._typed += key
                    _echo(console, key)
            if time.monotonic() >= latest:
                return None
            time.sleep(_LOOK)


def at_console_close(act: Callable[[str], None]) -> Callable[[], None]:
    """Call a function before Windows ends this process: its console is closed, the user logs off, it shuts down.

    The function returned ends that.

    Windows reports neither log-off nor shutdown to a console program that has loaded user32 or gdi32.

    Source: Microsoft, "SetConsoleCtrlHandler function", Windows console documentation.
    """
    if not ON_WINDOWS:
        return lambda: None
    ctypes: Any = import_module("ctypes")
    kernel = ctypes.WinDLL("kernel32", use_last_error=True)

    def handle(event: int) -> bool:
        if event not in _CLOSING:
            return False
        act(_CLOSING[event])
        return True

    handler = ctypes.WINFUNCTYPE(ctypes.c_int, ctypes.c_uint32)(handle)
    _KEPT.append(handler)
    kernel.SetConsoleCtrlHandler(handler, 1)

    def forget() -> None:
        kernel.SetConsoleCtrlHandler(handler, 0)
        _KEPT.remove(handler)

    return forget


def home_folder() -> Path:
    """Home of this user, by the users of the system rather than by the environment."""
    if not ON_WINDOWS:
        with suppress(ImportError, KeyError):
            return Path(import_module("pwd").getpwuid(os.getuid()).pw_dir)
    return Path.home()


def process_start(process: int) -> str:
    """Time at which a process has started, as the system writes it; empty where there is none."""
    if ON_WINDOWS:
        return _windows_process_start(process)
    with suppress(OSError, IndexError):
        boot = Path("/proc/sys/kernel/random/boot_id").read_text(encoding="ascii").strip()
        state, *rest = Path(f"/proc/{process}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
        return "" if state == "Z" else f"{boot} {rest[18]}"
    with suppress(OSError, subprocess.SubprocessError):  # where the system keeps no /proc
        command = ["ps", "-o", "lstart=", "-p", str(process)]
        return subprocess.run(command, capture_output=True, text=True, check=False, timeout=5).stdout.strip()
    return ""


def _windows_process_start(process: int) -> str:
    """Time at which a process has started, in units of 100 ns since 1601; empty where none runs."""
    ctypes: Any = import_module("ctypes")
    kernel = ctypes.WinDLL("kernel32", use_last_error=True)
    kernel.OpenProcess.restype = ctypes.c_void_p
    opened = kernel.OpenProcess(_QUERY, 0, process)
    if not opened:
        return ""
    handle, code, times = ctypes.c_void_p(opened), ctypes.c_uint32(), [ctypes.c_uint64() for _ in range(4)]
    try:
        if not kernel.GetExitCodeProcess(handle, ctypes.byref(code)) or code.value != _ALIVE:
            return ""
        return str(times[0].value) if kernel.GetProcessTimes(handle, *map(ctypes.byref, times)) else ""
    finally:
        kernel.CloseHandle(handle)


def _patiently(act: Callable[[], object]) -> None:
    """Call a function of a file, on Windows repeatedly for a second where access to it is denied."""
    for wait in _WAITS if ON_WINDOWS else ():
        try:
            act()
        except PermissionError:
            time.sleep(wait)
        else:
            return
    try:
        act()
    except PermissionError:
        if not ON_WINDOWS:
            raise
        raise PermissionError(errno.EACCES, "another program has it open, or it is protected; close it there") from None


def _echo(console: Any, text: str) -> None:
    """Show characters on a Windows console."""
    for character in text:
        console.putwch(character)
