"""Plain text: text of users as it may be shown, so that no character of it acts, and lines wrapped or aligned."""

import re
from collections.abc import Sequence
from itertools import zip_longest
from textwrap import wrap
from typing import Final

# C0 and C1 controls but tab and newline, line separators, embeddings and overrides of the direction of writing,
# surrogates (bytes of a file name that are no UTF-8), and what is no character.
_ACTIVE = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u2028\u2029\u202a-\u202e\u2066-\u2069\ud800-\udfff\ufffe\uffff]")
_MICRO = re.compile(r"(?<=\d )u(?=[mNsVWFHgAPJ](?![a-z]))")


def printable(text: str) -> str:
    r"""Text in which every character that acts rather than prints is written as an escape, such as ``\x1b``.

    Encodable as UTF-8. Tabs and newlines stay.
    """
    return _ACTIVE.sub(lambda match: _escape(match[0]), text)


def active_character(text: str) -> str | None:
    """First character of a text that `printable` escapes, as "U+001B"; None for plain text."""
    match = _ACTIVE.search(text)
    return None if match is None else f"U+{ord(match[0]):04X}"


def _escape(character: str) -> str:
    """Escape of a character in the notation of Python."""
    code = ord(character)
    return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}"


def with_micro_sign(text: str) -> str:
    """Text for figures, with units such as um as µm."""
    return _MICRO.sub("µ", text)


_INDENT: Final = "  "
_GAP: Final = "  "
_BREAKS: Final = re.compile(r"\s+|(?<=[A-Za-z]-)(?=[A-Za-z]{2})")  # of lines of a cell
_MIN_ROOM: Final = 20  # characters of a value, whatever the width


def wrapped(line: str, *, line_length: int | None) -> list[str]:
    """Line wrapped to a width, what follows indented below its first word."""
    if line_length is None or len(line) <= line_length:
        return [line]
    indent = line[: len(line) - len(line.lstrip())]
    return wrap(line, line_length, subsequent_indent=indent + _INDENT, break_long_words=False, break_on_hyphens=False)


def aligned(rows: Sequence[tuple[str, str]], *, line_length: int | None = None) -> list[str]:
    """Names and values as lines of text, the values one under the other and wrapped to a width."""
    names, values = [name for name, _ in rows], [value for _, value in rows]
    widths = [max(map(len, names), default=0), max(map(len, values), default=0)]
    if line_length is not None:  # a value without spaces, such as a path, is wider than the others
        longest = max(map(_longest_word, names), default=0), max(map(_longest_word, values), default=0)
        _narrowed(widths, (longest[0], min(longest[1], _MIN_ROOM)), line_length - len(_INDENT) - len(_GAP))
    return [line for row in rows for line in row_lines(row, widths)]


def grid(rows: Sequence[Sequence[str]], *, line_length: int | None = None) -> list[str]:
    """Rows of cells as lines of text, columns aligned to the left; the widest columns are wrapped to a width."""
    if not rows:
        return []
    columns = list(zip(*rows, strict=True))
    widths = [max(map(len, column)) for column in columns]
    if line_length is not None:
        room = line_length - len(_INDENT) - len(_GAP) * (len(widths) - 1)
        if not _narrowed(widths, [max(map(_longest_word, column)) for column in columns], room):
            return _one_below_the_other(rows, line_length)
    return [line for row in rows for line in row_lines(row, widths)]


def _narrowed(widths: list[int], least: Sequence[int], room: int) -> bool:
    """Whether the columns fit into the room, the widest of them narrowed, none below its longest word."""
    while sum(widths) > room:
        wide = [place for place, width in enumerate(widths) if width > least[place]]
        if not wide:
            return False
        widths[max(wide, key=lambda place: widths[place])] -= 1
    return True


def row_lines(row: Sequence[str], widths: Sequence[int]) -> list[str]:
    """Lines of a row, whose cells are wrapped to the widths of their columns."""
    cells = [
        [cell] if len(cell) <= room else wrap(cell, room, break_long_words=False)
        for cell, room in zip(row, widths, strict=True)
    ]
    lines = []
    for pieces in zip_longest(*cells, fillvalue=""):
        text = _GAP.join(f"{piece:<{room}}" for piece, room in zip(pieces, widths, strict=True))
        lines.append((_INDENT + text).rstrip())
    return lines


def _one_below_the_other(rows: Sequence[Sequence[str]], line_length: int) -> list[str]:
    """Rows of a table that is too wide, each as its heads with its cells one below the other."""
    heads, *others = rows
    names = max(map(len, heads))
    lines = []
    for row in others:
        for head, cell in zip(heads, row, strict=True):
            lines += wrapped(f"{_INDENT}{head:<{names}}{_GAP}{cell}", line_length=line_length)
        lines.append("")
    return lines[:-1]


def _longest_word(cell: str) -> int:
    """Characters of the longest part of a cell that is not broken: a word, or a part of one with its hyphen."""
    return max(map(len, _BREAKS.split(cell)), default=0)
