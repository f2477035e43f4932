"""First screen of a long answer: at most 24 lines, caveats whole, other lines shortened or left out.

What is left out is said, and stands in the whole text, in JSON and on the page.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from sonolube.report.blocks import Rows, ScreenBlock, Table, text_lines
from sonolube.text.plain_text import row_lines, wrapped

MAX_LINES: Final = 24
"""Lines of a first screen, but for caveats beyond it."""

_MIN_CONTENT: Final = 8  # lines, however many the caveats are
_WHOLE: Final = 4  # rows at the beginning that are never shortened
_MAX_ASSUMPTIONS: Final = 6  # that are named, each in a line
_NAMED: Final = 3  # of more than those
_PAUSES: Final = ("; ", ", ", ": ", " (", ". ")  # at which a text is shortened
_MIN_SHARE: Final = 0.5  # of the room that a shortened text fills at least
_REST: Final = " ..."
_GAPS: Final = 4  # characters before and between two columns


@dataclass(frozen=True, kw_only=True, slots=True)
class LongAnswer:
    """Content of an answer that is longer than a screen.

    Parameters
    ----------
    blocks : sequence of ScreenBlock
        The title first, then what matters most.
    leading_caveats, caveats : sequence of str
        Below the title, and below the content.
    assumptions : mapping of str to str
        What was assumed, with its reason; what matters most first.
    files : sequence of str
        Lines on the files that were written.
    """

    blocks: Sequence[ScreenBlock]
    leading_caveats: Sequence[str] = ()
    caveats: Sequence[str] = ()
    assumptions: Mapping[str, str]
    files: Sequence[str] = ()

    def lines(self, *, line_length: int, rest: str) -> list[str]:
        """Lines of a first screen, the last of which says by what the rest is shown.

        Parameters
        ----------
        line_length : int
        rest : str
            Option or argument that shows all.
        """
        title, *others = self.blocks or [""]
        head = [*text_lines([title], line_length=line_length), *_caveat_lines(self.leading_caveats, line_length)]
        foot = [
            *_caveat_lines(self.caveats, line_length),
            *_assumption_lines(self.assumptions, line_length),
            *self.files,
        ]
        room = max(MAX_LINES - len(head) - len(foot) - 1, _MIN_CONTENT)
        content = _fitted([unit for block in others for unit in _units(block, line_length)], room)
        left_out = len(content) - room
        last = f"  {left_out} more lines, and the rest in full, by {rest}" if left_out > 0 else f"  in full by {rest}"
        return [*head, *content[:room], *foot, last]


def _caveat_lines(caveats: Sequence[str], line_length: int) -> list[str]:
    """Caveats, whole."""
    return [line for caveat in caveats for line in wrapped(f"  caveat: {caveat}", line_length=line_length)]


def _assumption_lines(assumptions: Mapping[str, str], line_length: int) -> list[str]:
    """Assumptions in a line each; of more than six their number and the first three."""
    named = list(assumptions.items())
    lines = [shortened(f"  assumed {key}: {reason}", line_length) for key, reason in named]
    if len(lines) <= _MAX_ASSUMPTIONS:
        return lines
    return [*lines[:_NAMED], f"  and {len(lines) - _NAMED} more assumptions"]


def file_lines(files: Sequence[Path], *, folder: Path) -> list[str]:
    """Files that were written as lines of text: several below a folder of the answer's own by their number."""
    below: dict[Path, list[Path]] = {}
    for path in files:
        place = path if path.parent == folder or folder not in path.parents else path.parent
        below.setdefault(place, []).append(path)
    return [f"  {paths[0]}" if len(paths) == 1 else f"  {place}: {len(paths)} files" for place, paths in below.items()]


def short_file_line(files: Sequence[Path]) -> list[str]:
    """Files that were written in one line: those of one name with their endings, else the first and their number."""
    if not files:
        return []
    first, *others = files
    if len({path.with_suffix("") for path in files}) > 1:
        return [f"  {first} and {len(others)} more file{'s' if len(others) > 1 else ''}"]
    return [" ".join([f"  {first}", *(path.suffix for path in others)])]


@dataclass(frozen=True, slots=True)
class _Unit:
    """Lines of a row, or of a block, and its form in one line, which may leave out the end."""

    lines: list[str]
    short: str


def _fitted(units: Sequence[_Unit], room: int) -> list[str]:
    """Lines of units in their order; as many as have to be, the last ones first, are in one line each."""
    shown = [unit.lines for unit in units]
    for place in reversed(range(min(_WHOLE, len(units)), len(units))):
        if sum(map(len, shown)) <= room:
            break
        shown[place] = [units[place].short]
    return [line for lines in shown for line in lines]


def _units(block: ScreenBlock, line_length: int) -> list[_Unit]:
    """Rows of a block, or its lines."""
    if isinstance(block, Rows):
        longest = max((len(name) for name, _ in block.rows), default=0)
        widths = [min(longest, line_length // 2), 0]
        widths[1] = line_length - widths[0] - _GAPS
        return [
            _Unit(
                row_lines(row, widths),
                shortened(f"  {shortened(row[0], widths[0]):<{widths[0]}}  {row[1]}", line_length),
            )
            for row in block.rows
        ]
    if isinstance(block, Table):
        lines = text_lines([block], line_length=None)
        return [_Unit([short], short) for line in lines for short in [shortened(line, line_length)]]
    lines = text_lines([block], line_length=line_length)
    if isinstance(block, str):
        return [_Unit(lines, shortened(block, line_length))]
    return [_Unit([line], line) for line in lines]


def shortened(text: str, room: int) -> str:
    """Text of one line that ends at a pause, or after a word, where it is longer than the room."""
    if len(text) <= room:
        return text
    cut = text[: room - len(_REST) + 1]
    pauses = [cut.rfind(pause) for pause in _PAUSES]
    end = max(pauses)
    if end < _MIN_SHARE * room:
        end = cut.rfind(" ")
    return f"{text[: end if end > 0 else room - len(_REST)].rstrip()}{_REST}"
