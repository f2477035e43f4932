"""Columns of a recording as a file reader returns them: labels and units of the file, before names and SI units."""

import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.errors import InvalidInput, SonolubeError
from sonolube.measurement.recordings.repeated_labels import numbered_labels


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class RawColumn:
    """One column of a file.

    Parameters
    ----------
    label : str
        Its label in the file; line breaks and runs of blanks are replaced by one blank.
    values : ndarray, shape (rows,)
        As written, in the unit of the file; NaN for missing values.
    unit : str or None
        As written; None where the file does not state it.
    start : float or None
        Time of the first value in seconds, where the file states it beside the values.
    interval : float or None
        Time between values in seconds, where the file states it beside the values.
    group : str
        Group of channels that holds it, with which its label may begin; empty where the file has no groups.
    """

    label: str
    values: Floats
    unit: str | None = None
    start: float | None = None
    interval: float | None = None
    group: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "label", one_line(self.label))


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class RawTable:
    """The columns of a file.

    Parameters
    ----------
    columns : tuple of RawColumn
    format_name : str
        Name of the file's format.
    lines : ndarray of int, shape (rows,), or None
        Line number of each row in the file; None for binary files.
    begun : str
        Start of the recording as the file states it; empty where it does not.
    first_row : int
        Number of rows of the file before this block, where it is read in blocks.
    incomplete : bool
        Whether the file ends before the data that it announces.
    origin : mapping of str to str
        Of a recording written by `write_recording`: title, name, format and SHA-256 of the original file.
    caveats : tuple of str
        What speaks against the values, one line each: assumptions of the reader and complaints of its library.
    by_label : mapping of str to RawColumn
        The columns by label, with their numbers where several have the same (`numbered_labels`).
    """

    columns: tuple[RawColumn, ...]
    format_name: str
    lines: NDArray[np.int64] | None = None
    begun: str = ""
    first_row: int = 0
    incomplete: bool = False
    origin: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    caveats: tuple[str, ...] = ()
    by_label: Mapping[str, RawColumn] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        labels = numbered_labels([column.label for column in self.columns])
        object.__setattr__(self, "by_label", dict(zip(labels, self.columns, strict=True)))

    def place(self, row: int) -> str:
        """Sample or line number of a row in the file, for messages."""
        return f"sample {self.first_row + row}" if self.lines is None else f"line {self.lines[row]}"


def one_line(label: str) -> str:
    """Label with line breaks and runs of blanks replaced by one blank."""
    return " ".join(label.split())


@contextmanager
def refuse_library_errors(path: Path, *, format_name: str, offset: Callable[[], int] | None = None) -> Iterator[None]:
    """Context in which any exception of a foreign reader becomes a refusal that names the file."""
    try:
        yield
    except SonolubeError:
        raise
    except Exception as failure:  # libraries raise exceptions of any type on damaged files
        place = f"byte {offset()}: " if offset is not None else ""
        reason = f"{type(failure).__name__}: {failure}".splitlines()[0]
        raise InvalidInput(f"{path}: {place}cannot be read as {format_name} ({reason[:200]})") from None


@contextmanager
def recorded_warnings() -> Iterator[list[str]]:
    """Context in which warnings are not printed but collected, each text once.

    One line each; complete when the context ends without an error.
    """
    texts: list[str] = []
    with warnings.catch_warnings(record=True) as issued:
        warnings.simplefilter("always")
        yield texts
    texts += dict.fromkeys(one_line(str(warning.message)) for warning in issued)
