"""Files as arguments of tasks: a path, or a name with its bytes."""

import os
import re
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from pathlib import Path, PurePath

from sonolube.errors import InvalidInput
from sonolube.tasks.progress import within


@dataclass(frozen=True, slots=True)
class NamedBytes:
    """Content of a file that lies nowhere on this machine.

    Parameters
    ----------
    name : str
        Of the file; its ending tells the format.
    content : bytes
    """

    name: str
    content: bytes


InputFile = str | Path | NamedBytes
"""A file to read: its path, or its name with its bytes."""

_NONE = "none"
_PREFIX = "sonolube-bytes-"
_REST = re.compile(rf"\w+{re.escape(os.sep)}")
_BEFORE_A_PATH = (" ", "'", '"', "(", "\t", "\n")
_OPEN: ContextVar[ExitStack | None] = ContextVar("open", default=None)


def file_path(file: InputFile) -> Path:
    """Path of a file; bytes are written into a private folder that lasts as long as the running task.

    Raises
    ------
    InvalidInput
        If bytes have a name with a folder, or are given outside a task.
    """
    if not isinstance(file, NamedBytes):
        return Path(file)
    stack = _OPEN.get()
    if stack is None or not file.name or PurePath(file.name).name != file.name:
        raise InvalidInput(f"{file.name!r}: bytes need the name of a file, without a folder, in a call of a task")
    path = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix=_PREFIX)), file.name)
    path.write_bytes(file.content)
    return path


def is_none(file: object) -> bool:
    """Whether an argument is the word none, which leaves out what the folder of a rig has."""
    return isinstance(file, str | Path) and str(file) == _NONE


def with_names_only(text: str) -> str:
    """Text in which files whose bytes were given stand by their names, without their private folders."""
    first, *others = text.split(_PREFIX)
    pieces = [first]
    for each in others:
        if rest := _REST.match(each):
            before = pieces[-1]
            pieces[-1] = before[: max(before.rfind(sign) for sign in _BEFORE_A_PATH) + 1]
            pieces.append(each[rest.end() :])
        else:
            pieces[-1] += _PREFIX + each
    return "".join(pieces)


@contextmanager
def private_files() -> Iterator[None]:
    """Keep bytes of arguments as files inside a `with` block."""
    with ExitStack() as stack, within(_OPEN, stack):
        yield
