"""Layout of a text file of heights, by which those text readers of SurfaceTopography are chosen that can read it."""

import codecs
from pathlib import Path

_SMALL = 1 << 14  # bytes; whatever such a file holds, the readers end within seconds
_MAX_HEADER_LINES = 200  # that the reader of coordinates skips
_MAX_OTHER_LINES = 1000  # of headers between the blocks of a matrix file
_LONGEST_OTHER_LINE = 4096
_MAX_ROWS = 1_000_000  # of numbers, which the readers take 6 us each
_COORDINATES = (2, 3)  # columns
_SEPARATORS = str.maketrans(",;", "  ")
_MISSING = ("bad", "nan", "inf", "infinite")


def text_readers(path: Path) -> tuple[str, ...]:
    """Which text readers of SurfaceTopography may read a file: "xyz" (coordinates), "asc" (matrix), or neither.

    The reader of coordinates parses the whole file once for each header line that it may have, and the reader of a
    matrix searches thirty expressions in every line that is no row of numbers. On a long text that is no table they
    take hours.
    """
    if path.stat().st_size <= _SMALL:
        return ("xyz", "asc")
    content = path.read_bytes()
    encoding = "utf-16" if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)) else "utf-8"
    text = content.decode(encoding, errors="replace")
    if "\0" in text:
        return ()
    lines = text.rstrip().split("\n")
    return () if text.count("\n") - len(lines) > _MAX_OTHER_LINES else _readers_of_lines(lines)


def _readers_of_lines(lines: list[str]) -> tuple[str, ...]:
    """Which readers may read some lines of text."""
    columns: set[int] = set()
    header_lines = other_lines = rows = 0
    for line in lines:
        words = line.translate(_SEPARATORS).split()
        if words and _is_row(words):
            columns.add(len(words))
            rows += 1
            continue
        header_lines += not columns
        other_lines += 1
        if other_lines > _MAX_OTHER_LINES or len(line) > _LONGEST_OTHER_LINE:
            return ()
    later_lines = other_lines - header_lines
    if rows > _MAX_ROWS:
        return ()
    is_table = len(columns) == 1 and columns <= set(_COORDINATES) and not later_lines
    return ("xyz", "asc") if is_table and header_lines <= _MAX_HEADER_LINES else ("asc",)


def _is_row(words: list[str]) -> bool:
    """Whether all words of a line are numbers or stand for a missing one."""
    try:
        for word in words:
            if word.lower() not in _MISSING:
                float(word)
    except ValueError:
        return False
    return True
