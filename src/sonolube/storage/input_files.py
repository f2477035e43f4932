"""Bytes of files that users name: of regular files and pipes, up to a bound; devices, folders and sockets are refused.

Refusals are `OSError`s whose `strerror` says what is wrong, as those of the operating system, so that every reader
states them in its own line.
"""

import errno
import io
import os
import stat
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Final

from sonolube.operating_system import ON_WINDOWS

LARGEST_INPUT: Final = 2**30
"""Bytes that a pipe may give; of regular files each reader has its own bound, or reads them in parts."""

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
    return _pipe_bytes(path, most) if _is_pipe(path) else path.read_bytes()


def open_input(path: Path, *, most: int = LARGEST_INPUT) -> io.BytesIO | io.BufferedReader:
    """Open a file or the bytes of a pipe for reading; parameters and errors as of `input_bytes`."""
    return io.BytesIO(_pipe_bytes(path, most)) if _is_pipe(path) else path.open("rb")


def input_text(path: Path, *, most: int = LARGEST_INPUT) -> str:
    """Text of a file or a pipe, UTF-8 with or without a byte order mark; errors as of `input_bytes`."""
    with io.TextIOWrapper(open_input(path, most=most), encoding="utf-8-sig") as stream:
        return stream.read()


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
