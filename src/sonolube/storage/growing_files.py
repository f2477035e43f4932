"""Files that grow: appended to by whole pieces, or held by a database; `files` writes everything else."""

import os
import time
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import closing, contextmanager, suppress
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, Final

from sonolube.errors import InvalidInput
from sonolube.operating_system import replace_file
from sonolube.storage.user_files import expect_target, refusal, refused_as

if TYPE_CHECKING:
    from sqlite3 import Connection as Connection

_FLAGS: Final = os.O_RDWR | getattr(os, "O_BINARY", 0) | getattr(os, "O_CLOEXEC", 0)
_SYNC_INTERVAL: Final = 1.0  # s, between two requests that the disk keeps what was appended
_MAX_NAMES: Final = 10_000


class AppendedFile:
    """File to whose end pieces are appended, each whole or not at all.

    Parameters
    ----------
    path : Path
        Of a new file, in a folder that exists.
    keep : int, optional
        Bytes of an existing file that are kept, which is continued instead.

    Raises
    ------
    InvalidInput
        If the file cannot be made or continued, as by `write_atomically`, or a new one exists already.

    Notes
    -----
    A piece is in the hands of the operating system when `append` returns, so that the end of this process loses
    nothing. About once a second, and at the end, the disk is asked to keep it; a loss of power costs the last second.
    """

    def __init__(self, path: Path, *, keep: int | None = None) -> None:
        self._path = path
        target = expect_target(path)
        with refused_as(path):
            self._handle = os.open(target, _FLAGS | (os.O_CREAT | os.O_EXCL if keep is None else 0), 0o666)
            if keep is not None:
                os.ftruncate(self._handle, keep)
        self.length = os.lseek(self._handle, 0, os.SEEK_END)
        self._syncing: Future[None] | None = None
        self._synced = time.monotonic()
        self._worker = ThreadPoolExecutor(1)

    def append(self, content: bytes) -> None:
        """Append a piece."""
        rest = memoryview(content)
        try:
            self._request_sync()
            while rest:
                rest = rest[os.write(self._handle, rest) :]
        except OSError as failure:
            with suppress(OSError):
                os.ftruncate(self._handle, self.length)
                os.lseek(self._handle, self.length, os.SEEK_SET)
            raise refusal(self._path, failure.strerror) from None
        self.length += len(content)

    def close(self) -> None:
        """Flush the file to the disk and close it; harmless where that was done before."""
        if self._handle < 0:
            return
        handle, self._handle = self._handle, -1
        self._worker.shutdown()
        try:
            with refused_as(self._path):
                if self._syncing is not None:
                    self._syncing.result()
                os.fsync(handle)
        finally:
            os.close(handle)

    def _request_sync(self) -> None:
        """Begin, once a second, to have the disk keep the file; raise what the last time has failed with."""
        if self._syncing is not None:
            if not self._syncing.done():
                return
            done, self._syncing = self._syncing, None
            done.result()
        if time.monotonic() - self._synced >= _SYNC_INTERVAL:
            self._synced = time.monotonic()
            self._syncing = self._worker.submit(os.fsync, self._handle)


def new_folder(parent: Path, name: str) -> Path:
    """Make a folder that did not exist before."""
    for number in count(1):
        folder = parent / (name if number == 1 else f"{name}-{number}")
        try:
            parent.mkdir(parents=True, exist_ok=True)
            folder.mkdir()
        except FileExistsError:
            if number < _MAX_NAMES and parent.is_dir():
                continue
            raise refusal(folder, "the name is taken") from None
        except OSError as failure:
            raise refusal(folder, failure.strerror) from None
        break
    return folder


@contextmanager
def database(path: Path | None) -> "Iterator[Connection]":
    """Provide a database of SQLite, made where it is missing; changes are kept at the end of the `with` block.

    With a log beside the file (WAL), so that readers need not wait for a writer.
    """
    import sqlite3

    if path is not None and path.exists() and not path.is_file():
        raise refusal(path, "it is no regular file")
    try:
        with closing(sqlite3.connect(":memory:" if path is None else path, timeout=10.0)) as connection:
            connection.execute("PRAGMA journal_mode=WAL")
            with connection:
                yield connection
    except sqlite3.Error as failure:
        raise InvalidInput(f"{path}: cannot be used as a database: {failure}") from None


def set_database_aside(path: Path) -> None:
    """Rename a damaged database, and remove its log."""
    with refused_as(path):
        replace_file(path, path.with_name(f"{path.name}.damaged"))
        for ending in ("-wal", "-shm"):
            path.with_name(path.name + ending).unlink(missing_ok=True)
