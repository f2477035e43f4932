"""Files that users name: bytes of inputs, up to a bound, and which file a path to be written stands for.

Inputs are regular files and pipes; devices, folders and sockets are refused by `OSError`s whose `strerror` says what is
wrong, as those of the operating system, so that every reader states them in its own line. A target of writing is none
of the files that a command reads.
"""

import errno
import io
import os
import stat
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from sonolube.errors import InvalidInput
from sonolube.operating_system import ON_WINDOWS

LARGEST_INPUT: Final = 2**30
"""Bytes that a pipe may give, and that a file may have which is read as a whole."""

_PATIENCE: Final = 60  # s without a byte, after which a pipe is given up
_BLOCK: Final = 2**20
_KINDS: Final[tuple[tuple[Callable[[int], bool], str], ...]] = (
    (stat.S_ISDIR, "is a folder, not a file"),
    (stat.S_ISCHR, "is a device, not a file"),
    (stat.S_ISBLK, "is a device, not a file"),
    (stat.S_ISSOCK, "is a socket, not a file"),
)
_PIPES: dict[tuple[Path, int, int], bytes] = {}  # what pipes gave, by path, device and inode


def input_bytes(path: Path, *, most: int = LARGEST_INPUT) -> bytes:
    """Bytes of a file or a pipe."""
    if _is_pipe(path):
        return _pipe_bytes(path, most)
    require_size(path, most)
    return path.read_bytes()


def open_input(path: Path, *, most: int = LARGEST_INPUT) -> io.BytesIO | io.BufferedReader:
    """Open a file or the bytes of a pipe for reading; parameters and errors as of `input_bytes`."""
    return io.BytesIO(_pipe_bytes(path, most)) if _is_pipe(path) else path.open("rb")


def input_text(path: Path, *, most: int = LARGEST_INPUT) -> str:
    """Text of a file or a pipe, UTF-8 with or without a byte order mark; errors as of `input_bytes`."""
    with io.TextIOWrapper(open_input(path, most=most), encoding="utf-8-sig") as stream:
        if not _is_pipe(path):
            require_size(path, most)
        return stream.read()


def require_size(path: Path, most: int) -> None:
    """Refuse a regular file that is too large to be read as a whole."""
    size = path.stat().st_size
    if size > most:
        raise OSError(errno.EFBIG, f"has {size:,} bytes, but at most {most:,} are read; save it in parts", str(path))


def require_file(path: Path) -> None:
    """Raise `OSError` for a path that is no regular file, a pipe too: for readers that need to go back in it."""
    if _is_pipe(path):
        raise OSError(errno.ESPIPE, "is a pipe, which this format cannot be read from; save it to a file", str(path))


def _is_pipe(path: Path) -> bool:
    """Whether a path is a pipe; refuse what is neither that nor a regular file."""
    mode = path.stat().st_mode
    for is_kind, reason in _KINDS:
        if is_kind(mode):
            raise OSError(errno.EINVAL, reason, str(path))
    return stat.S_ISFIFO(mode)


def _pipe_bytes(path: Path, most: int) -> bytes:
    """Bytes of a pipe until its writer closes it, kept from its first reading."""
    if ON_WINDOWS:
        raise OSError(errno.ESPIPE, "is a pipe, which cannot be read on Windows; save it to a file", str(path))
    found = path.stat()
    key = path, found.st_dev, found.st_ino
    if key not in _PIPES:
        handle = os.open(path, os.O_RDONLY | os.O_NONBLOCK)  # a pipe without a writer must not block
        try:
            _PIPES[key] = _until_closed(handle, path, most)
        finally:
            os.close(handle)
    return _PIPES[key]


def _until_closed(handle: int, path: Path, most: int) -> bytes:
    """Bytes of a pipe, with a line on the terminal where it lets wait."""
    from select import select

    content, silent = bytearray(), 0
    while True:
        if not select([handle], [], [], 1.0)[0]:
            silent += 1
            if silent == 1:
                sys.stderr.write(f"waiting for data from {path}\n")
            if silent >= _PATIENCE:
                raise OSError(errno.ETIMEDOUT, f"gave nothing for {_PATIENCE} s", str(path))
            continue
        block = os.read(handle, _BLOCK)
        if not block:
            return bytes(content)
        silent = 0
        content += block
        if len(content) > most:
            raise OSError(errno.EFBIG, f"gives more than {most:,} bytes; save it to a file", str(path))


_Identity = tuple[int, int]  # device and number of a file: the same through links

_NO_TARGETS = {
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
        raise refusal(path, _NO_TARGETS.get(stat.S_IFMT(found.st_mode), "it is no regular file"))
    if not os.access(path, os.W_OK):
        raise refusal(path, "it is write-protected")
    running = _RUNNING.get()
    if running is not None and (found.st_dev, found.st_ino) in running.inputs:
        raise _input_refused(path, running.inputs[found.st_dev, found.st_ino])
    return Path(os.path.realpath(path)) if path.is_symlink() else path


def refusal(path: Path, reason: str | None) -> InvalidInput:
    """Error of a file that cannot be written."""
    return InvalidInput(f"{path}: cannot be written: {reason}")


@contextmanager
def refused_as(path: Path) -> Iterator[None]:
    """Turn errors of the system into refusals of a path."""
    try:
        yield
    except OSError as failure:
        raise refusal(path, failure.strerror) from None


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
