"""Numbers of a large text table by the parser of pandas, where every row has all cells and every cell is a number.

Anything else is left to the reader of `text_recordings`, which tells lines and cells in its refusals.
"""

from collections.abc import Collection, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.measurement.recordings.text_tables import TextTable

LARGE = 1 << 20
"""Bytes from which a text is large."""

_BEGINNING, _MIDDLE = 1 << 15, 1 << 13  # bytes by which the layout is told
_PART = 1 << 18  # bytes


def ends_of_large_text(path: Path) -> str | None:
    """Whole lines of the beginning and of the middle of a large text in UTF-8; None for any other."""
    size = path.stat().st_size
    if size < LARGE:
        return None
    with path.open("rb") as stream:
        head = stream.read(_BEGINNING)
        stream.seek(size // 2)
        middle = stream.read(_MIDDLE)
    if b"\n" not in head:
        return None
    ends = head.rpartition(b"\n")[0] + b"\n" + middle.partition(b"\n")[2].rpartition(b"\n")[0] + b"\n"
    try:
        return ends.decode("utf-8-sig")
    except UnicodeDecodeError:
        return None


def numbers_of_large_text(
    path: Path, table: TextTable, places: Sequence[int], *, decimal_sign: str, missing: Collection[str]
) -> list[Floats] | None:
    """Columns of numbers at places of a table whose beginning is known; None where a row is of another form."""
    from pandas import read_csv

    first = table.rows[0][0]
    try:
        frame = read_csv(
            path,
            sep=table.separator,
            decimal=decimal_sign,
            header=None,
            skiprows=first - 1,
            usecols=None if len(places) == len(table.labels) else sorted(places),  # to choose all takes twice the time
            dtype=np.float64,
            na_values=["", *missing],
            keep_default_na=False,
            skip_blank_lines=False,
            quoting=3,
            encoding="utf-8",
            memory_map=True,
        )
    except (ValueError, OverflowError):  # ParserError is one
        return None
    content = np.memmap(path, np.uint8, mode="r")
    above = content[:_BEGINNING].tobytes()
    separators = _count(content[_end_of_line(above, first - 1) :], ord(table.separator))
    if separators != len(frame) * (len(table.rows[0][1]) - 1):
        return None
    return [frame[place].to_numpy() for place in places]


def _count(content: NDArray[np.uint8], byte: int) -> int:
    """Number of bytes of a value, counted in parts that a processor keeps at hand."""
    parts = (content[at : at + _PART] for at in range(0, content.size, _PART))
    return sum(int(np.count_nonzero(part == byte)) for part in parts)


def _end_of_line(content: bytes, line: int) -> int:
    """Offset behind a line, from 1; 0 for none."""
    at = 0
    for _ in range(line):
        at = content.index(b"\n", at) + 1
    return at
