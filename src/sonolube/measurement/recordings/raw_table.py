"""Columns of a recording as a file reader returns them: labels and units of the file, before names and SI units.

Columns of one label are chosen by their numbers; units are converted as instruments write them (`written_units.toml`).
"""

import re
import tomllib
import warnings
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cache
from importlib.resources import files
from pathlib import Path
from types import MappingProxyType
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.errors import InvalidInput, SonolubeError, suggestion
from sonolube.text.units import COMMON_FACTORS, convert

_MAX_LISTED_COLUMNS = 12

ColumnT = TypeVar("ColumnT")


def numbered_labels(labels: Sequence[str]) -> list[str]:
    """Labels by which columns are chosen: where several have one label, with " #1", " #2", ... behind it.

    All different, but for empty ones, which name nothing.
    """
    times, taken, numbers = Counter(labels), set(labels), Counter[str]()
    numbered = []
    for label in labels:
        name = label
        while times[label] > 1 and label and name in taken:
            numbers[label] += 1
            name = f"{label} #{numbers[label]}"
        taken.add(name)
        numbered.append(name)
    return numbered


def column_of_label(columns: Mapping[str, ColumnT], label: str, path: Path) -> ColumnT:
    """Column of a label."""
    if label in columns:
        return columns[label]
    of_label = re.compile(re.escape(label) + r" #\d+")
    several = [known for known in columns if of_label.fullmatch(known)]
    if len(several) > 1:
        raise InvalidInput(
            f"{path}: {len(several)} columns are named {label!r}; choose one by its number, {several[0]!r}"
            f" to {several[-1]!r}"
        )
    known = [name for name in columns if name]
    hint = suggestion(label, known) or "it has " + ", ".join(known[:_MAX_LISTED_COLUMNS])
    raise InvalidInput(f"{path}: has no column {label!r}; {hint}")


_FAULT_VALUE = "value 0.0 "

_WRITTEN: dict[str, Any] = tomllib.loads(
    files("sonolube.measurement.recordings").joinpath("written_units.toml").read_text(encoding="utf-8")
)
_SPELLINGS = {text: (float(factor), str(unit)) for text, (factor, unit) in _WRITTEN["spellings"].items()}
_OTHER_MEANINGS = {text: tuple(map(tuple, meanings)) for text, meanings in _WRITTEN["other_meanings"].items()}


@cache
def _units() -> frozenset[str]:
    """Units of quantities as they are written."""
    return frozenset({*COMMON_FACTORS, *(unit for factors in COMMON_FACTORS.values() for unit in factors), "%"} - {""})


def is_written_unit(text: str) -> bool:
    """Whether a text is a unit of a channel as instruments write it."""
    plain = text.replace("µ", "u").replace("μ", "u")
    return plain in _units() or text in _OTHER_MEANINGS or text.lower() in _SPELLINGS


def is_unit_of(written: str, unit: str) -> bool:
    """Whether a written unit is of the kind of an SI unit."""
    try:
        si_conversion(written, unit=unit, name="")
    except InvalidInput:
        return False
    return True


def convert_to_si(values: Floats, *, written_unit: str, unit: str, name: str) -> Floats:
    """Values in an SI unit, converted from the unit in which an instrument wrote them."""
    gain, offset, _ = si_conversion(written_unit, unit=unit, name=name)
    return values if (gain, offset) == (1.0, 0.0) else values * gain + offset


def si_conversion(written_unit: str, *, unit: str, name: str) -> tuple[float, float, str]:
    """Gain and offset that convert values to an SI unit, and the unit as which the written one was understood.

    `gain, offset`: SI value = gain * written value + offset. `understood`: The unit; differs from the written one where
    its second meaning was taken, such as "gf" for "g".
    """
    written = " ".join(written_unit.split())
    first = _SPELLINGS.get(written.lower(), (1.0, written))
    if first == (1.0, unit):
        return 1.0, 0.0, written
    refusal = None
    for factor, spelled in (first, *_OTHER_MEANINGS.get(written, _OTHER_MEANINGS.get(written.lower(), ()))):
        try:
            offset = convert(0.0, from_unit=spelled, to_unit=unit)
            gain = (convert(1.0, from_unit=spelled, to_unit=unit) - offset) * factor
        except InvalidInput as failure:
            refusal = refusal or str(failure).removeprefix(_FAULT_VALUE)
            continue
        return gain, offset, written if (factor, spelled) == first else spelled
    raise InvalidInput(f"{name}: {refusal}")


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
