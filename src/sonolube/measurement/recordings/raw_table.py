"""What every reader of recordings hands over: columns as the file gives them, not yet named or in SI."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.errors import InvalidInput, SonolubeError


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class RawColumn:
    """One column of a file.

    Parameters
    ----------
    label : str
        What the file calls it; line breaks and runs of blanks become one blank.
    values : ndarray, shape (rows,)
        As written, in the written unit; NaN where the file has nothing.
    unit : str or None
        As written; None where the file does not say.
    start : float or None
        Time of the first value in seconds, where the file gives it beside the values.
    interval : float or None
        Seconds between values, where the file gives it beside the values.
    """

    label: str
    values: Floats
    unit: str | None = None
    start: float | None = None
    interval: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "label", one_line(self.label))


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class RawTable:
    """The columns of a file.

    Parameters
    ----------
    columns : tuple of Column
        All of one length.
    format : str
        Name of the file's format.
    lines : ndarray of int, shape (rows,), or None
        The line of the file on which each row stands; None for binary files.
    begun : str
        When the recording began, as the file says it; empty where it does not.
    first_row : int
        Rows of the file that went before, when it is read in blocks.
    incomplete : bool
        Whether the file ends before the data it announces.
    origin : mapping of str to str
        Of a recording written by `write_recording`: the title, name, format and SHA-256 of the file it came from.
    """

    columns: tuple[RawColumn, ...]
    format: str
    lines: NDArray[np.int64] | None = None
    begun: str = ""
    first_row: int = 0
    incomplete: bool = False
    origin: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))

    def place(self, row: int) -> str:
        """Where in the file a row stands, for messages."""
        return f"sample {self.first_row + row}" if self.lines is None else f"line {self.lines[row]}"


def one_line(label: str) -> str:
    """Return a label without line breaks, as messages and mappings write it."""
    return " ".join(label.split())


@contextmanager
def refuse_library_errors(path: Path, *, format_name: str, offset: Callable[[], int] | None = None) -> Iterator[None]:
    """Turn whatever a reader of a foreign library raises on a broken file into one clear line.

    Raises
    ------
    InvalidInput
        Naming the file, the byte at which reading stopped where it is known, and the reason.
    """
    try:
        yield
    except SonolubeError:
        raise
    except Exception as failure:  # parsers of broken files fail in every way there is
        place = f"byte {offset()}: " if offset is not None else ""
        reason = f"{type(failure).__name__}: {failure}".splitlines()[0]
        raise InvalidInput(f"{path}: {place}cannot be read as {format_name} ({reason[:200]})") from None
