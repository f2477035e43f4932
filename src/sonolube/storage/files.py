"""Writing of files: built beside their target, they replace it whole or not at all; locks of folders."""

import io
import os
import shutil
import stat
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from fnmatch import fnmatchcase
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from sonolube.errors import InvalidInput
from sonolube.operating_system import ON_WINDOWS, lock_file, replace_file
from sonolube.storage.interruption import undone_at_signal
from sonolube.storage.user_files import expect_target, refusal, refused_as, resolved_target

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer

_UNFINISHED = ".sonolube-"  # begins the names of files that are being built
_LOCK = ".sonolube.lock"
_FLAGS = os.O_RDWR | os.O_CREAT | getattr(os, "O_BINARY", 0) | getattr(os, "O_CLOEXEC", 0)


class UnfinishedFile(io.FileIO):
    """File that is built beside its target and replaces it when it is complete.

    Notes
    -----
    A write that fails is recorded and raised by `check` or `complete`, and what follows it is dropped: HDF5 ends the
    process with a segmentation fault where a write fails while it closes a file. The file is locked while it is
    open, so that `clear_unfinished` removes only what a dead process has left.
    """

    def __init__(self, path: Path, name: Path, mode: int) -> None:
        self._path, self._name, self._failure = path, name, None  # type: tuple[Path, Path, OSError | None]
        super().__init__(_created(name, mode), "r+b")

    def write(self, content: "ReadableBuffer", /) -> int:
        """Write all bytes, or record why that failed."""
        data = memoryview(content).cast("B")
        done = 0
        try:
            while done < len(data) and self._failure is None:
                done += super().write(data[done:])
        except OSError as failure:
            self._failure = failure
        if done < len(data):
            self.seek(len(data) - done, os.SEEK_CUR)
        return len(data)

    def truncate(self, size: int | None = None, /) -> int:
        """Set the size, or record why that failed."""
        size = self.tell() if size is None else size
        try:
            if self._failure is None:
                super().truncate(size)
        except OSError as failure:
            self._failure = failure
        return size

    def check(self) -> None:
        """Raise InvalidInput if a write has failed."""
        if self._failure is not None:
            raise refusal(self._path, self._failure.strerror)

    def complete(self) -> None:
        """Replace the target, whose permissions are kept."""
        self.check()
        with refused_as(self._path):
            os.fsync(self.fileno())  # network file systems refuse here what did not fit
            target = resolved_target(self._path)
            with suppress(FileNotFoundError):
                self._name.chmod(stat.S_IMODE(target.stat().st_mode))
            if ON_WINDOWS:
                self.close()  # an open file cannot be renamed
            replace_file(self._name, target)
            self.close()


def write_atomically(path: Path, content: bytes | str, *, is_private: bool = False) -> Path:
    """Write a file atomically: readers get either the old content or the new one, never a part of it.

    A private one that is new can be read by its owner alone.
    """
    with unfinished_file(path, mode=0o600 if is_private else 0o666) as file:
        file.write(content.encode() if isinstance(content, str) else content)
        file.complete()
    return path


def write_folder(folder: Path, contents: Mapping[str, str | None]) -> Path:
    """Make a folder with files, and with folders where the content is None; whole, or not at all.

    Raises
    ------
    InvalidInput
        If something of this name exists, or it cannot be written.
    """
    if folder.exists() or folder.is_symlink():
        raise refusal(folder, "it exists; name a new folder")
    with refused_as(folder):
        folder.parent.mkdir(parents=True, exist_ok=True)
        unfinished = Path(tempfile.mkdtemp(prefix=_UNFINISHED, dir=folder.parent))
    with undone_at_signal(partial(shutil.rmtree, unfinished, ignore_errors=True)):
        try:
            with refused_as(folder):
                for name, content in contents.items():
                    if content is None:
                        (unfinished / name).mkdir()
                    else:
                        (unfinished / name).write_text(content, encoding="utf-8", newline="\n")
                unfinished.chmod(0o777 & ~_mask())
                unfinished.rename(folder)
        finally:
            shutil.rmtree(unfinished, ignore_errors=True)
    return folder


def _mask() -> int:
    """Bits of the mode that new files of this process lack."""
    mask = os.umask(0)
    os.umask(mask)
    return mask


@contextmanager
def unfinished_file(path: Path, *, mode: int = 0o666) -> Iterator[UnfinishedFile]:
    """Provide a file that replaces another when its method `complete` is called, and is removed otherwise.

    Open for writing and reading; libraries that write to a file object take it.
    """
    target = resolved_target(path)
    with refused_as(path):
        target.parent.mkdir(parents=True, exist_ok=True)
        mode = stat.S_IMODE(target.stat().st_mode) if target.exists() else mode
    with _unfinished(path, target.parent, mode) as file:
        yield file


def expect_file(path: Path) -> None:
    """Raise, before anything is computed, if a file cannot be written."""
    expect_target(path)
    _require_writable(path.parent, path)


def expect_files(folder: Path, patterns: Sequence[str]) -> None:
    """Refuse, before anything is computed, a folder that cannot be written; remove what killed runs left there."""
    for place in dict.fromkeys((folder, *(folder / Path(pattern).parent for pattern in patterns))):
        _require_writable(place, place)
    for pattern in map(folder.joinpath, patterns):
        inside = sorted(pattern.parent.iterdir()) if pattern.parent.is_dir() else []
        for path in inside:
            if fnmatchcase(path.name, pattern.name):
                expect_target(path)


def clear_unfinished(folder: Path, *patterns: str) -> None:
    """Remove the unfinished files that killed processes have left in a folder."""
    for pattern in (f"{_UNFINISHED}*", *patterns):
        for path in folder.glob(pattern):
            with suppress(OSError):
                _remove_unlocked(path)


@contextmanager
def locked_folder(folder: Path, *, purpose: str) -> Iterator[None]:
    """Keep other processes from working in a folder inside a `with` block; a dead process keeps nobody out."""
    place = folder / _LOCK
    with refused_as(folder):
        folder.mkdir(parents=True, exist_ok=True)
        handle = _lock_handle(place)
    if handle is None:
        raise InvalidInput(f"{folder}: another {purpose} is at work in it; wait for it, or name another folder")
    with undone_at_signal(partial(_remove_quietly, place)):
        try:
            yield
        finally:
            _release(handle, place)


def user_state_folder() -> Path:
    """Folder of states of this user, which outlive a program.

    `sonolube` below $XDG_STATE_HOME, %LOCALAPPDATA% or ~/.local/state.
    """
    base = os.environ.get("XDG_STATE_HOME") or (os.environ.get("LOCALAPPDATA") if ON_WINDOWS else None)
    return Path(base or Path.home() / ".local" / "state") / "sonolube"


def is_locked(folder: Path) -> bool:
    """Whether a process, this one included, is at work in a folder by `locked_folder`."""
    try:
        handle = os.open(folder / _LOCK, os.O_RDWR)
    except OSError:
        return False
    try:
        return lock_file(handle) is False
    finally:
        os.close(handle)


@contextmanager
def _unfinished(path: Path, folder: Path, mode: int) -> Iterator[UnfinishedFile]:
    """Yield a new file in a folder, which is removed at the end unless it has been completed."""
    name = folder / f"{_UNFINISHED}{os.urandom(8).hex()}"
    with undone_at_signal(partial(_remove_quietly, name)):
        try:
            with refused_as(path):
                file = UnfinishedFile(path, name, mode)
            with file:
                yield file
        finally:
            _remove_quietly(name)


def _require_writable(folder: Path, path: Path) -> None:
    """Raise if no file can be made in a folder or its missing parents; remove what a dead process left there."""
    with refused_as(path):
        missing = [path.name] if path != folder else []
        while not folder.exists():
            if folder.is_symlink():
                raise refusal(path, f"{folder} is a link to {folder.readlink()}, which does not exist; remove the link")
            missing.append(folder.name)
            folder = folder.parent
        if not folder.is_dir():
            raise refusal(path, "it is no folder" if folder == path else f"{folder} is no folder")
        for name in missing:
            with suppress(FileNotFoundError):
                (folder / name).lstat()  # refuses names that are too long
    clear_unfinished(folder)
    with _unfinished(path, folder, 0o666):
        pass


def _created(name: Path, mode: int) -> int:
    """Handle of a new file, locked."""
    while True:
        handle = os.open(name, _FLAGS | os.O_EXCL, mode)
        if ON_WINDOWS:
            return handle  # an open file cannot be removed
        lock_file(handle, wait=True)
        if os.fstat(handle).st_nlink:
            return handle
        os.close(handle)  # removed before it was locked


def _lock_handle(place: Path) -> int | None:
    """Handle of a locked file of this name; None where another process has locked it."""
    while True:
        handle = os.open(place, _FLAGS, 0o666)
        if lock_file(handle) is False:
            os.close(handle)
            return None
        with suppress(FileNotFoundError):
            if os.path.samestat(os.fstat(handle), place.stat()):
                return handle
        os.close(handle)  # removed by the process that had it locked


def _release(handle: int, place: Path) -> None:
    """Remove a locked file and its lock."""
    if ON_WINDOWS:
        os.close(handle)  # an open file cannot be removed
        _remove_quietly(place)
    else:
        _remove_quietly(place)
        os.close(handle)


def _remove_unlocked(path: Path) -> None:
    """Remove a regular file unless a process has locked it."""
    if not stat.S_ISREG(path.lstat().st_mode):
        return
    if ON_WINDOWS:
        path.unlink()  # fails while a process has it open
        return
    handle = os.open(path, os.O_RDWR)
    try:
        if lock_file(handle):
            path.unlink()
    finally:
        os.close(handle)


def _remove_quietly(path: Path) -> None:
    """Remove a file where that is possible."""
    with suppress(OSError):
        path.unlink(missing_ok=True)
