"""Atomic writing of files."""

import os
import tempfile
from pathlib import Path

from sonolube.errors import InvalidInput


def write_atomically(path: Path, content: bytes | str) -> Path:
    """Write a file atomically: readers get either the old content or the new one, never a part of it.

    Parameters
    ----------
    path : Path
        Path of the file; a missing folder is created.
    content : bytes or str
        Content; text is encoded as UTF-8.

    Returns
    -------
    Path
        `path`.

    Raises
    ------
    InvalidInput
        If the file cannot be written.
    """
    data = content.encode() if isinstance(content, str) else content
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
        try:
            with os.fdopen(handle, "wb") as stream:
                stream.write(data)
            Path(name).chmod(0o644)
            Path(name).replace(path)
        except BaseException:
            Path(name).unlink(missing_ok=True)
            raise
    except OSError as failure:
        raise InvalidInput(f"{path}: cannot be written: {failure.strerror}") from None
    return path
