"""Every figure of the dissertation with its counterparts in the report, or why there is none."""

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from sonolube.facts.published import figures

_FILE: Final = Path(__file__).with_suffix(".toml")


@dataclass(frozen=True, kw_only=True, slots=True)
class FigureOfD:
    """A figure of the dissertation.

    Parameters
    ----------
    number : str
        Such as "2.13".
    content : str
        By its caption.
    counterparts : tuple of str
        Names of the figures of the report that show what it shows, or what is computed for it.
    why_none : str
        Where there are none.
    """

    number: str
    content: str
    counterparts: tuple[str, ...]
    why_none: str


def figures_of_d() -> tuple[FigureOfD, ...]:
    """All figures of the dissertation in their order."""
    listed = tomllib.loads(_FILE.read_text(encoding="utf-8"))
    return tuple(
        FigureOfD(
            number=each.number,
            content=each.content,
            counterparts=tuple(listed["counterparts"].get(each.number, ())),
            why_none=listed["none"].get(each.number, ""),
        )
        for each in figures()
    )
