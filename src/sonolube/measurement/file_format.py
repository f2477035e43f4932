"""Detection of a file's format by its first bytes, then by the suffix of its name, from an ordered table of formats."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import ClassVar, Protocol, TypeVar

from sonolube.errors import InvalidInput
from sonolube.storage.input_files import open_input

HEAD_SIZE = 8192
"""Number of bytes at the beginning of a file by which its format is detected."""


class FileFormat(Protocol):
    """Name, signature and suffixes of one file format.

    Attributes
    ----------
    name : str
        Name of the format in results and messages; unique in its table.
    suffixes : tuple of str
        Usual suffixes of its files in lower case with the dot, such as ".tdms".
    """

    name: ClassVar[str]
    suffixes: ClassVar[tuple[str, ...]]

    def recognises(self, head: bytes, path: Path) -> bool:
        """Whether the first bytes of a file carry the signature of the format."""


FormatT = TypeVar("FormatT", bound=FileFormat)


@contextmanager
def refuse_unreadable(path: Path) -> Iterator[None]:
    """Raise InvalidInput, naming the file and the cause, where the operating system refuses to read the file."""
    try:
        yield
    except OSError as failure:
        raise InvalidInput(f"{path}: cannot be read: {failure.strerror or failure}") from None


def read_head(path: Path) -> bytes:
    """First `HEAD_SIZE` bytes of a file."""
    with refuse_unreadable(path), open_input(path) as stream:
        head = stream.read(HEAD_SIZE)
    if not head:
        raise InvalidInput(f"{path}: is empty")
    return head


def detect_format(formats: Sequence[FormatT], head: bytes, path: Path) -> FormatT | None:
    """Format of a file: by signature, else by suffix, else the last of the table where it accepts the file.

    None where no format of the table fits.
    """
    *specific, fallback = formats
    for known in specific:
        if known.recognises(head, path):
            return known
    for known in specific:
        if path.suffix.lower() in known.suffixes:
            return known
    return fallback if fallback.recognises(head, path) else None


def first_lines(head: bytes) -> list[str]:
    """First lines of a text file, decoded as UTF-8 with any byte order mark removed; the last may be cut."""
    text = head.decode("utf-8-sig", errors="ignore")
    return text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
