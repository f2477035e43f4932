"""Files of measurements: their selection, the detection of their format, limits on what they hold, and numbers in text.

A file states the sizes of its arrays, and a reader allocates what is stated. Without limits a damaged or hostile file
of a few kilobytes takes all memory: by shapes without stored values, by compressed zeros, by very many small arrays.
The limits keep every file below 10 MB within about 1 GB and 10 s, and grow with the size of larger ones. What is stored
without compression always lies within them.
"""

import io
import json
import math
import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from fnmatch import fnmatch
from pathlib import Path
from typing import ClassVar, Final, Protocol, TypeVar

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.storage.user_files import LARGEST_INPUT, open_input, require_size

HEAD_SIZE = 8192
"""Number of bytes at the beginning of a file by which its format is detected."""


_MIN_ZEROS: Final = 512  # bytes of zero at the beginning of a file of no format
_LARGEST_WITHOUT_SIGNATURE: Final = 2**26  # bytes of a file whose format is judged by its name alone


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
    if len(head) >= _MIN_ZEROS and not any(head):
        raise InvalidInput(f"{path}: begins with {len(head)} bytes of zero, as no measured file does; copy it again")
    return head


def require_whole(path: Path) -> None:
    """Refuse a file that is too large to be read as a whole."""
    with refuse_unreadable(path):
        require_size(path, LARGEST_INPUT)


def detect_format(formats: Sequence[FormatT], head: bytes, path: Path) -> FormatT | None:
    """Format of a file: by signature, else by suffix, else the last of the table where it accepts the file.

    None where no format of the table fits.
    """
    *specific, fallback = formats
    for known in specific:
        if known.recognises(head, path):
            return known
    named = next((known for known in specific if path.suffix.lower() in known.suffixes), None)
    if named is not None:
        if len(head) >= HEAD_SIZE and not fallback.recognises(head, path):
            _refuse_large(path, named.name)
        return named
    return fallback if fallback.recognises(head, path) else None


def _refuse_large(path: Path, format_name: str) -> None:
    """Refuse a large file whose format is known by its suffix alone."""
    with refuse_unreadable(path):
        size = path.stat().st_size
    if size > _LARGEST_WITHOUT_SIGNATURE:
        raise InvalidInput(f"{path}: has {size:,} bytes, but does not begin as {format_name} does; copy it again")


def first_lines(head: bytes) -> list[str]:
    """First lines of a text file, decoded as UTF-8 with any byte order mark removed; the last may be cut."""
    text = head.decode("utf-8-sig", errors="ignore")
    return text.replace("\r\n", "\n").replace("\r", "\n").split("\n")


_PATTERN: Final = re.compile(r"[*?[]")  # of a shell, where it did not replace the pattern itself


def selected_files(given: Iterable[Path]) -> list[Path]:
    """Files, folders and patterns replaced by their files in the order of their names, numbers by their size."""
    files: list[Path] = []
    for path in given:
        is_pattern = _PATTERN.search(path.name) and path.parent.is_dir() and not path.exists()
        matches = [each for each in path.parent.iterdir() if fnmatch(each.name, path.name)] if is_pattern else []
        if matches:
            files += sorted(matches, key=_by_numbers)
            continue
        if not path.is_dir():
            files.append(path)
            continue
        inside = [each for each in path.iterdir() if each.is_file() and not each.name.startswith(".")]
        if path / "documents.jsonl" in inside:  # the folder of a run of the laboratory
            inside = [each for each in inside if each.suffix == ".nc" and not each.name.startswith("clock-")]
        inside.sort(key=_by_numbers)
        if not inside:
            raise InvalidInput(f"{path}: holds no file")
        files += inside
    return files


def _by_numbers(path: Path) -> list[tuple[int, str]]:
    """Sort key of a name by which part-2 comes before part-10."""
    return [(int(piece), "") if piece.isdecimal() else (-1, piece) for piece in re.split(r"(\d{1,18})", path.name)]


MAX_VALUES = 20_000_000
"""Numbers that a file of any size may hold: 160 MB as floats, below 1 GB with the copies of conversion and checks."""

MAX_VALUES_PER_BYTE = 2
"""Numbers that a byte of a large file may hold. A sampled signal with noise of a few steps of its converter has four
bits a sample however well it is compressed, and a number stored without compression a byte or more; compressed zeros
have a thousand numbers a byte."""

MAX_CHANNELS = 10_000
"""Columns, channels, variables or data sets of one file."""

MAX_POINTS = 500_000
"""Points of one impedance sweep, ten times as many as any analyser measures."""


def most_values(path: Path) -> int:
    """Largest number of values of a file: `MAX_VALUES`, or `MAX_VALUES_PER_BYTE` where that is more."""
    return max(MAX_VALUES, MAX_VALUES_PER_BYTE * path.stat().st_size)


def require_values(count: int, path: Path, *, part: str = "") -> None:
    """Refuse a file that states more values than one of its size may hold."""
    limit = most_values(path)
    if count > limit:
        raise InvalidInput(
            f"{path}: {part + ': ' if part else ''}states {_amount(count)} values, but a file of"
            f" {path.stat().st_size} bytes may hold {limit}; save it in parts or without compression"
        )


def require_channels(count: int, path: Path, *, kind: str = "channels") -> None:
    """Refuse a file with more channels (columns, variables, data sets) than `MAX_CHANNELS`."""
    if count > MAX_CHANNELS:
        raise InvalidInput(
            f"{path}: has {_amount(count)} {kind} or more, but at most {MAX_CHANNELS} are read;"
            " save only those that are needed"
        )


def require_unpacked_bytes(count: int, path: Path, *, part: str = "") -> None:
    """Refuse a compressed file that unpacks to more bytes than the values of `most_values` take as doubles."""
    limit = most_unpacked_bytes(path)
    if count > limit:
        raise InvalidInput(
            f"{path}: {part + ': ' if part else ''}unpacks to {_amount(count)} bytes or more, but a file of"
            f" {path.stat().st_size} bytes may unpack to {limit}; save it in parts or without compression"
        )


def require_points(count: int, path: Path, *, line: int) -> None:
    """Refuse an impedance file with more points than `MAX_POINTS`, naming the line that has or ends them."""
    if count > MAX_POINTS:
        raise InvalidInput(
            f"{path}: line {line}: is one of {count} lines or values, but a sweep has at most {MAX_POINTS} points;"
            " save the range about the resonance"
        )


def most_unpacked_bytes(path: Path) -> int:
    """To how many bytes a compressed file may unpack: doubles of `most_values`."""
    return 8 * most_values(path)


class ClippedReader(io.BufferedReader):
    """A file open for reading, whose reads allocate no more than the rest of the file, whatever a caller requests.

    Parameters
    ----------
    path : Path
        Of the file.

    Notes
    -----
    ``read(n)`` of Python allocates n bytes before it reads, so that a length stated in a damaged file takes as much
    memory, even where the file ends at once.
    """

    def __init__(self, path: Path) -> None:
        super().__init__(io.FileIO(path))
        self._size = path.stat().st_size

    def read(self, size: int | None = -1, /) -> bytes:
        """Up to `size` bytes, all of the rest where it is negative or None."""
        rest = max(0, self._size - self.tell())
        return super().read(rest if size is None or size < 0 else min(size, rest))


def _amount(count: int) -> str:
    """Count in digits, in powers of ten where it is long."""
    return str(count) if count < 10**12 else f"{float(min(count, 10**300)):.3g}"


_DECIMAL_NUMBER = re.compile(r"(?=[-+]?[.,]?\d)[-+]?\d*([.,])\d*(?:[eE][-+]?\d+)?", re.ASCII)
_EVIDENCE = 50  # decimal numbers by which the sign is told


def detected_decimal_sign(cells: Iterable[str]) -> str:
    """Decimal sign, "." or ",", that the first decimal numbers among cells of text have more often.

    "." where no cell has a decimal sign.
    """
    commas = points = 0
    for cell in cells:
        if ("," in cell or "." in cell) and (match := _DECIMAL_NUMBER.fullmatch(cell.strip())):
            commas, points = commas + (match[1] == ","), points + (match[1] == ".")
            if commas + points >= _EVIDENCE:
                break
    return "," if commas > points else "."


def parse_number(cell: str, *, decimal_sign: str) -> float | None:
    """Number in a cell of text, or None where it holds none."""
    text = cell.strip()
    if decimal_sign == ",":
        if "." in text:
            return None
        text = text.replace(",", ".")
    if "_" in text:  # float() accepts 1_000, which no instrument writes
        return None
    try:
        value = float(text)
    except ValueError:
        return None
    return value if text.isascii() else None


_GROUPED = {
    sign: re.compile(rf"[-+]?\d{{1,3}}(?:(?:\{other}\d{{3}})+\{sign}\d+|(?:\{other}\d{{3}}){{2,}})", re.ASCII)
    for sign, other in (".,", ",.")
}


def parse_grouped(cell: str, *, decimal_sign: str) -> float | None:
    """Number whose thousands are separated by the mark that is not its decimal sign; None where that is in doubt.

    One mark alone before three digits may be either.
    """
    text = cell.strip()
    if _GROUPED[decimal_sign].fullmatch(text) is None:
        return None
    return parse_number(text.replace({".": ",", ",": "."}[decimal_sign], ""), decimal_sign=decimal_sign)


def parse_numbers(cells: list[str], *, decimal_sign: str, missing: frozenset[str]) -> tuple[Floats, int | None]:
    """Numbers of a column of text, and the first row that holds neither a number nor a missing-value text.

    `values`: NaN for missing values; only the rows before `invalid_row` where there is one.
    """
    values = np.empty(len(cells))
    for row, cell in enumerate(cells):
        value = parse_number(cell, decimal_sign=decimal_sign)
        if value is None:
            value = parse_grouped(cell, decimal_sign=decimal_sign)
        if value is None:
            stripped = cell.strip()
            if stripped and stripped not in missing:
                return values[:row], row
            value = math.nan
        values[row] = value
    return values, None


_RECORD = "run.json"
_LARGEST = 1 << 24  # bytes


def change_since_recorded(path: Path, digest: str) -> tuple[str, ...]:
    """Caveat where a recording is not as the run of its folder wrote it.

    Empty where it is as it was written, or no record beside it tells.
    """
    record = path.parent / _RECORD
    try:
        if record.stat().st_size > _LARGEST:
            return ()
        kept = json.loads(record.read_text(encoding="utf-8"))["recordings"].get(path.name, digest)
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return ()
    return () if kept == digest else (f"{path.name} was changed after its run wrote it: its SHA-256 is another",)
