"""Limits on what a measured file may hold, checked against the sizes that it states before anything is read.

A file states the sizes of its arrays, and a reader allocates what is stated. Without limits a damaged or hostile file
of a few kilobytes takes all memory: by shapes without stored values, by compressed zeros, by very many small arrays.
The limits keep every file below 10 MB within about 1 GB and 10 s, and grow with the size of larger ones. What is stored
without compression always lies within them.
"""

import io
from pathlib import Path

from sonolube.errors import InvalidInput

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
