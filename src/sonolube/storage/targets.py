"""Targets of writing: which file a path stands for, and that it is none of the files that a command reads."""

import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from pathlib import Path

from sonolube.errors import InvalidInput

_Identity = tuple[int, int]  # device and number of a file: the same through links

_KINDS = {
    stat.S_IFDIR: "it is a folder; name a file",
    stat.S_IFIFO: "it is a named pipe, which would be replaced; name a file",
    stat.S_IFCHR: "it is a device, which would be replaced; name a file",
    stat.S_IFBLK: "it is a device, which would be replaced; name a file",
    stat.S_IFSOCK: "it is a socket, which would be replaced; name a file",
}


@dataclass(slots=True)
class _CommandFiles:
    """Files that a running command reads, and those that stand where it will write."""

    inputs: dict[_Identity, Path] = field(default_factory=dict)
    outputs: dict[_Identity, Path] = field(default_factory=dict)


_RUNNING: ContextVar[_CommandFiles | None] = ContextVar("running command", default=None)


@contextmanager
def command_files() -> Iterator[None]:
    """Record the inputs and outputs of one command inside a `with` block; without it neither is recorded."""
    token = _RUNNING.set(_CommandFiles())
    try:
        yield
    finally:
        _RUNNING.reset(token)


def record_input(path: Path) -> None:
    """Record a file that the running command reads, so that the command does not write to it."""
    running = _RUNNING.get()
    if running is None:
        return
    for each in _files(path):
        identity = _identity(each)
        if identity is None:
            continue
        if identity in running.outputs:
            raise _input_refused(running.outputs[identity], each)
        running.inputs[identity] = each


def expect_target(path: Path) -> Path:
    """Record a file that the running command will write, and return the file that will be replaced.

    As from `resolved_target`.
    """
    target, running = resolved_target(path), _RUNNING.get()
    identity = _identity(target)
    if running is not None and identity is not None:
        other = running.outputs.setdefault(identity, path)
        if _entry(other) != _entry(path):
            raise refusal(path, f"it and {other}, which is written too, are one file; remove one of the links")
    return target


def resolved_target(path: Path) -> Path:
    """Regular file that is replaced, or made, by writing to a path: the path itself or what its link leads to."""
    try:
        found = path.stat()
    except FileNotFoundError:
        if path.is_symlink():
            raise refusal(path, f"it is a link to {path.readlink()}, which does not exist; remove the link") from None
        return path
    except OSError as failure:
        raise refusal(path, failure.strerror) from None
    if not stat.S_ISREG(found.st_mode):
        raise refusal(path, _KINDS.get(stat.S_IFMT(found.st_mode), "it is no regular file"))
    if not os.access(path, os.W_OK):
        raise refusal(path, "it is write-protected")
    running = _RUNNING.get()
    if running is not None and (found.st_dev, found.st_ino) in running.inputs:
        raise _input_refused(path, running.inputs[found.st_dev, found.st_ino])
    return Path(os.path.realpath(path)) if path.is_symlink() else path


def refusal(path: Path, reason: str | None) -> InvalidInput:
    """Error of a file that cannot be written."""
    return InvalidInput(f"{path}: cannot be written: {reason}")


def _input_refused(path: Path, read: Path) -> InvalidInput:
    """Error of an output that is an input."""
    same = "it is" if _entry(path) == _entry(read) else f"it is {read},"
    return refusal(path, f"{same} an input of this command; name another file")


def _entry(path: Path) -> Path:
    """Entry of a folder, in one spelling, whether it is a link or not."""
    return path.parent.resolve() / path.name


def _files(path: Path) -> list[Path]:
    """A file, or the files of a folder."""
    try:
        return list(path.iterdir()) if path.is_dir() else [path]
    except OSError:
        return []


def _identity(path: Path) -> _Identity | None:
    """Device and number of a regular file; None where there is none."""
    try:
        found = path.stat()
    except (OSError, ValueError):
        return None
    return (found.st_dev, found.st_ino) if stat.S_ISREG(found.st_mode) else None
