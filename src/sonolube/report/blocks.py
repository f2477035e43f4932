"""Content of an answer as blocks: lines, rows of name and text, tables, and texts of files; and their text."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from html import escape

from sonolube.text.plain_text import aligned, grid, wrapped

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


Block = str | Rows | Table | Verbatim
"""Part of an answer; a text is one line, which is indented where it begins with spaces."""


def text_lines(blocks: Iterable[Block], *, line_length: int | None = None) -> list[str]:
    """Lines of text of blocks."""
    lines: list[str] = []
    for block in blocks:
        if isinstance(block, Rows):
            lines += aligned(block.rows, line_length=line_length)
        elif isinstance(block, Table):
            lines += grid([block.heads, *block.rows] if any(block.heads) else block.rows, line_length=line_length)
        elif isinstance(block, Verbatim):
            lines += block.text.splitlines()
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
