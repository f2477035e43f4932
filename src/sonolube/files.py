"""Files that appear whole or not at all."""

import os
import tempfile
from pathlib import Path

from sonolube.errors import InvalidInput


def write_atomically(path: Path, content: bytes | str) -> Path:
    """Write `content` to `path` in one step: a reader sees the old file or the new one, never a part.

    Parameters
    ----------
    path : Path
        Where to; the folder is made where it is missing.
    content : bytes or str
        What to write; text is encoded as UTF-8.

    Returns
    -------
    Path
        `path`.

    Raises
    ------
    InvalidInput
        If the place cannot be written to.
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
