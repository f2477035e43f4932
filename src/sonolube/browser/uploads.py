"""Files that pages upload: in a private folder under names of ours, within limits, as long as the server runs."""

import secrets
import shutil
import tempfile
from collections.abc import AsyncIterator, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path, PurePath
from typing import Any, Final

from sonolube.browser.requests import Places
from sonolube.errors import InvalidInput, SonolubeError
from sonolube.tasks.files import private_files, with_names_only

_LARGEST: Final = 256 * 2**20  # bytes of one file
_MOST: Final = 4 * _LARGEST  # of all files, beyond which the oldest go


def uploaded(file: Any, places: Places) -> tuple[str, Path]:
    """Name and path of an uploaded file of a request."""
    if not isinstance(file, Mapping) or not all(isinstance(file.get(key), str) for key in ("name", "upload")):
        raise InvalidInput("file: give an object with the name and the upload of a file", key="file")
    path = Path(places.uploads, PurePath(file["upload"]).name)
    if not places.uploads or not file["upload"].isalnum() or not path.is_file():
        raise InvalidInput(f"file: {file['name'][:80]!r} is no longer here; drop the file again", key="file")
    return PurePath(file["name"].replace("\\", "/")).name.lstrip(".") or "file", path


def companion(upload: Path, name: str) -> Path:
    """Path of what is kept beside an upload, and goes with it."""
    return upload.with_name(f"{upload.name}.{name}")


@contextmanager
def named_uploads() -> Iterator[None]:
    """Keep uploads as files under their own names inside a `with` block, whose refusals name them without folders."""
    with private_files():
        try:
            yield
        except SonolubeError as failure:
            raise InvalidInput(with_names_only(str(failure)), key=getattr(failure, "key", "")) from None


class Uploads:
    """Uploaded files.

    Parameters
    ----------
    largest : int
        Bytes of one file.
    """

    def __init__(self, *, largest: int = _LARGEST) -> None:
        self.folder = Path(tempfile.mkdtemp(prefix="sonolube-uploads-"))
        self._largest = largest

    async def keep(self, content: AsyncIterator[bytes], *, length: int | None) -> str:
        """Name here of a file that is written as its bytes come in."""
        if length is not None and length > self._largest:
            raise InvalidInput(self._refusal(length))
        name = secrets.token_hex(16)
        path, size = self.folder / name, 0
        try:
            with path.open("xb") as file:
                async for part in content:
                    size += len(part)
                    if size > self._largest:
                        raise InvalidInput(self._refusal(size))
                    file.write(part)
        except BaseException:
            path.unlink(missing_ok=True)
            raise
        self._forget_oldest()
        return name

    def _refusal(self, size: int) -> str:
        """Reason for which a file is not taken."""
        return f"{size / 2**20:.0f} MiB are more than the {self._largest / 2**20:.0f} MiB that a page may upload"

    def _forget_oldest(self) -> None:
        """Delete the oldest files beyond the limit of all."""
        files = sorted(self.folder.glob("[!.]*"), key=lambda path: path.stat().st_mtime_ns)
        total = sum(path.stat().st_size for path in files)
        uploads = [path for path in files if not path.suffix]
        for upload in uploads[:-1]:
            if total <= _MOST:
                return
            for path in [each for each in files if each.name.partition(".")[0] == upload.name]:
                total -= path.stat().st_size
                path.unlink(missing_ok=True)

    def end(self) -> None:
        """Delete all files."""
        shutil.rmtree(self.folder, ignore_errors=True)
