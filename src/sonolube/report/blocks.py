"""Content of an answer as blocks: lines, rows of name and text, tables, and texts of files; and their text."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from html import escape
from typing import Final

from sonolube.text.plain_text import aligned, grid, wrapped

_MIN_BAR: Final = 20  # characters
_MAX_BAR: Final = 41

Row = tuple[str, str]
"""Name and value, both as text."""


@dataclass(frozen=True, slots=True)
class Rows:
    """Names and values, one below the other.

    Parameters
    ----------
    rows : sequence of pair of str
    """

    rows: Sequence[Row]


@dataclass(frozen=True, slots=True)
class Table:
    """Cells of text under heads.

    Parameters
    ----------
    heads : sequence of str
    rows : sequence of sequence of str
        As many cells a row as there are heads.
    """

    heads: Sequence[str]
    rows: Sequence[Sequence[str]]


@dataclass(frozen=True, slots=True)
class Verbatim:
    """Text of a file, whose lines are shown as they are.

    Parameters
    ----------
    text : str
    """

    text: str


@dataclass(frozen=True, kw_only=True, slots=True)
class Bar:
    """Interval of a share between 0 and 1, with its most probable half and its median; or a text alone.

    Parameters
    ----------
    name : str
    text : str
        Beside the bar, or in its place.
    ends : sequence of float
        Lower ends of the 80 and the 50 % interval, median, upper ends of the 50 and the 80 % interval; empty for none.
    """

    name: str
    text: str
    ends: Sequence[float] = ()

    def drawn(self, width: int) -> str:
        """Interval in characters: ``-`` of 80 %, ``=`` of 50 %, ``|`` the median; ``<`` where it goes on."""
        if not self.ends:
            return ""
        low, lower, middle, upper, high = (round(min(max(end, 0.0), 1.0) * (width - 1)) for end in self.ends)
        marks = [" "] * width
        marks[low : high + 1] = "-" * (high + 1 - low)
        marks[lower : upper + 1] = "=" * (upper + 1 - lower)
        if self.ends[0] < 0:
            marks[0] = "<"
        if self.ends[-1] > 1:
            marks[-1] = ">"
        marks[middle] = "|"
        return "[" + "".join(marks) + "]"


@dataclass(frozen=True, slots=True)
class Bars:
    """Bars on one scale.

    Parameters
    ----------
    scale : (str, str, str)
        Words at the left end, in the middle and at the right end.
    bars : sequence of Bar
    """

    scale: tuple[str, str, str]
    bars: Sequence[Bar]

    def lines(self, line_length: int | None = None) -> list[str]:
        """Scale and bars as lines of text."""
        names = max(len(bar.name) for bar in self.bars)
        texts = max((len(bar.text) for bar in self.bars if bar.ends), default=0)
        width = min(max((line_length or _MAX_BAR) - names - texts - 8, _MIN_BAR), _MAX_BAR)
        left, middle, right = self.scale
        half = f"{left}{middle:>{(width + len(middle)) // 2 - len(left)}}"
        lines = [f"  {'':<{names}}   {half}{right:>{width - len(half)}}"] if texts else []
        for bar in self.bars:
            beside = f"{bar.drawn(width)}  {bar.text}" if bar.ends else bar.text
            lines.append(f"  {bar.name:<{names}}  {beside}")
        return lines


Block = str | Rows | Table | Verbatim
"""Part of an answer; a text is one line, which is indented where it begins with spaces."""


ScreenBlock = Block | Bars
"""Part of a first screen."""


def text_lines(blocks: Iterable[ScreenBlock], *, line_length: int | None = None) -> list[str]:
    """Lines of text of blocks."""
    lines: list[str] = []
    for block in blocks:
        if isinstance(block, Rows):
            lines += aligned(block.rows, line_length=line_length)
        elif isinstance(block, Table):
            lines += grid([block.heads, *block.rows] if any(block.heads) else block.rows, line_length=line_length)
        elif isinstance(block, Verbatim):
            lines += block.text.splitlines()
        elif isinstance(block, Bars):
            lines += block.lines(line_length)
        else:
            lines += wrapped(block, line_length=line_length)
    return lines


def block_html(block: Block) -> str:
    """Block as HTML, all texts escaped."""
    if isinstance(block, Rows):
        rows = "".join(f"<tr><th>{escape(name)}</th><td>{escape(value)}</td></tr>" for name, value in block.rows)
        return f"<table><tbody>{rows}</tbody></table>"
    if isinstance(block, Table):
        heads = "".join(f"<th>{escape(head.strip())}</th>" for head in block.heads)
        rows = "".join(f"<tr>{''.join(f'<td>{escape(cell.strip())}</td>' for cell in row)}</tr>" for row in block.rows)
        return f"<table><thead><tr>{heads}</tr></thead><tbody>{rows}</tbody></table>"
    if isinstance(block, Verbatim):
        return f"<pre>{escape(block.text)}</pre>"
    return f"<p>{escape(block.strip())}</p>"
