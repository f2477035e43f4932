"""Faults in the calls to devices: which there are, and what they do where they are met."""

import ctypes
import json
import os
import signal
import time
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass
from itertools import product
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final, Self

from sonolube.laboratory.devices import DeviceError
from sonolube.operating_system import ON_WINDOWS

CALLS: Final[Mapping[str, tuple[str, ...]]] = MappingProxyType(
    {
        "acquisition": ("connect", "start", "read", "stop", "close"),
        "drive": ("connect", "drive", "off", "close"),
        "motor": ("connect", "turn", "off", "close"),
    }
)
"""Calls of a run to each device, by its role."""

_SIGNALS: Final = () if ON_WINDOWS else ("KILL", "STOP", "SEGV", "ABRT", "TERM", "INT", "QUIT", "TSTP", "USR1")
_RAISED: Final = (
    *("DeviceError", "OSError", "TimeoutError", "RuntimeError", "ValueError", "MemoryError"),
    *("SystemExit", "KeyboardInterrupt", "GeneratorExit"),
)
_EVERYWHERE: Final = (
    *("hang", "late 1", "late 3", "late 12", "held 8", "exit 0", "exit 1", "unspeakable"),
    *(f"signal SIG{each}" for each in _SIGNALS),
    *(f"raise {each}" for each in _RAISED),
)
_OF_BLOCKS: Final = ("doubled", "longer", "stale", "slowly", "whole numbers", "infinity")
_READ: Final = 3  # the block that is wrong: motor and drive are on
_QUICK: Final[Mapping[str, tuple[str, ...]]] = MappingProxyType(
    {
        "drive.connect": ("raise OSError",),
        "drive.drive": ("hang", "late 3", "raise RuntimeError", "signal SIGKILL"),
        "drive.off": ("raise TimeoutError", "raise SystemExit", "signal SIGTERM", "acts lies"),
        "drive.close": ("raise ValueError",),
        "motor.connect": ("raise DeviceError",),
        "motor.turn": ("late 1", "raise OSError", "exit 1", "signal SIGSTOP"),
        "motor.off": ("raise GeneratorExit", "raise KeyboardInterrupt", "unspeakable", "acts lies"),
        "motor.close": ("raise MemoryError",),
        "acquisition.connect": ("raise OSError",),
        "acquisition.start": ("acts slowly",),
        "acquisition.read": (
            *("raise ValueError", "acts doubled", "acts whole numbers", "acts infinity", "disk full", "clock back"),
            *("held 8", "signal SIGQUIT"),
        ),
    }
)


@dataclass(frozen=True, slots=True)
class Fault:
    """A fault in one of the calls to a device.

    Parameters
    ----------
    where : str
        Role and call, such as drive.off; empty for no fault.
    kind : str
        hang; late S, held S (seconds before the call, the second with the interpreter's lock); exit CODE; signal NAME;
        raise NAME; unspeakable (an exception whose words cannot be had); clock back; disk full; or acts and how, for
        the device that is wrapped: lies of `off`, and what blocks are.
    call : int
        Which one has it, from 1; 0 for all.
    """

    where: str = ""
    kind: str = ""
    call: int = 1

    @property
    def role(self) -> str:
        """Role of the device."""
        return self.where.partition(".")[0]

    @property
    def is_lie(self) -> bool:
        """Whether the device says that it is off where it is on."""
        return self.kind == "acts lies"


def faults_of(roles: Iterable[str], *, quick: bool = False) -> tuple[Fault, ...]:
    """Faults in every call to the devices of some roles.

    Parameters
    ----------
    roles : iterable of str
        Of acquisition, drive and motor.
    quick : bool
        Ten of each device.

    Returns
    -------
    tuple of Fault
    """
    roles = tuple(roles)
    if quick:
        chosen = [(where, kind) for where, kinds in _QUICK.items() for kind in kinds]
    else:
        chosen = [(f"{role}.{call}", kind) for role in roles for call, kind in product(CALLS[role], _EVERYWHERE)]
        chosen += [("acquisition.read", f"acts {each}") for each in _OF_BLOCKS]
        chosen += [("acquisition.read", "disk full"), ("acquisition.read", "clock back")]
        chosen += [("acquisition.start", "acts slowly")]
        chosen += [(f"{role}.off", "acts lies") for role in ("drive", "motor")]
    found = (Fault(where, kind, _call_of(where, kind)) for where, kind in chosen)
    return tuple(each for each in found if each.role in roles)


def _call_of(where: str, kind: str) -> int:
    """Number of the call that has a fault."""
    if kind == "acts lies":
        return 0
    return _READ if where == "acquisition.read" and kind.startswith(("acts", "disk", "clock")) else 1


class _UnspeakableError(Exception):
    """Exception whose words cannot be had."""

    def __str__(self) -> str:
        raise RuntimeError("no words")


@dataclass(frozen=True, slots=True)
class Injector:
    """Log of the calls to devices, and the fault of one of them.

    Parameters
    ----------
    log : str
        File to which a line is appended for each call, and for each value of an output, by every process.
    fault : Fault
    """

    log: str
    fault: Fault

    @classmethod
    def of(cls, content: Mapping[str, Any]) -> Self:
        """Injector of what another process was told."""
        return cls(content["log"], Fault(**content["fault"]))

    def content(self) -> dict[str, Any]:
        """What another process has to be told."""
        return {"log": self.log, "fault": asdict(self.fault)}

    def write(self, *words: str | float) -> None:
        """Append a line: time, process, words."""
        line = json.dumps([time.monotonic(), os.getpid(), *words]).encode() + b"\n"
        with suppress(OSError):  # where the fault is a full disk
            handle = os.open(self.log, os.O_WRONLY | os.O_CREAT | os.O_APPEND)
            os.write(handle, line)
            os.close(handle)

    def meet(self, where: str) -> str:
        """Count a call and do what its fault says before it goes on; how the device then acts, empty for as ever."""
        self.write("call", where)
        fault = self.fault
        if fault.where != where or fault.call not in (0, self._calls_of(where)):
            return ""
        self.write("fault", where)
        kind, _, value = fault.kind.partition(" ")
        if kind == "acts":
            return value
        _DONE[kind](value)
        return ""

    def _calls_of(self, where: str) -> int:
        return sum(line[2:] == ["call", where] for line in lines_of(Path(self.log)))


def lines_of(log: Path) -> list[list[Any]]:
    """Lines of a log; none of one that nobody has begun."""
    with suppress(FileNotFoundError):
        return [json.loads(line) for line in log.read_text(encoding="utf-8").splitlines()]
    return []


def _hold(seconds: str) -> None:
    """Sleep as a library does that keeps the lock of the interpreter."""
    ctypes.PyDLL(None).usleep(int(1e6 * float(seconds)))


def _signal(name: str) -> None:
    """Send this process a signal."""
    os.kill(os.getpid(), getattr(signal, name))
    time.sleep(0.3)


def _raise(name: str) -> None:
    """Raise an exception by its name."""
    import builtins

    raise DeviceError("pretended fault") if name == "DeviceError" else getattr(builtins, name)("pretended fault")


def _raise_unspeakable(_: str) -> None:
    """Raise what has no words."""
    raise _UnspeakableError


def _fill_disk(_: str) -> None:
    """Have every write of this process to a file fail from now on."""
    import resource

    resource.setrlimit(resource.RLIMIT_FSIZE, (0, resource.getrlimit(resource.RLIMIT_FSIZE)[1]))


def _set_clock(_: str) -> None:
    """Have the time of day be an hour ago from now on."""
    now = time.time
    time.time = lambda: now() - 3600.0


_DONE: Final = {
    "hang": lambda _: time.sleep(1e4),
    "late": lambda seconds: time.sleep(float(seconds)),
    "held": _hold,
    "exit": lambda code: os._exit(int(code)),
    "signal": _signal,
    "raise": _raise,
    "unspeakable": _raise_unspeakable,
    "disk": _fill_disk,
    "clock": _set_clock,
}
