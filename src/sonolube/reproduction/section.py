"""Sections of the reproduction, and their results: rows and figures of one section of the dissertation."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from sonolube.figure import ReportFigure
from sonolube.reproduction.claim import Finding
from sonolube.reproduction.row import Row


@dataclass(frozen=True, kw_only=True, slots=True)
class ChapterFigure(ReportFigure):
    """Figure of the reproduction report with its chapter.

    Parameters
    ----------
    chapter : int
        Chapter of the dissertation.
    """

    chapter: int


@dataclass(frozen=True, kw_only=True, slots=True)
class Reproduction:
    """Rows and figures of the reproduction, with the findings on the claims that the rows decide about.

    Parameters
    ----------
    findings : tuple of Finding
    rows : tuple of Row
    figures : tuple of ChapterFigure
    caveats : tuple of str
        What the rows rest on that the dissertation speaks against.
    """

    findings: tuple[Finding, ...]
    rows: tuple[Row, ...]
    figures: tuple[ChapterFigure, ...]
    caveats: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True, slots=True)
class Section:
    """Section of the dissertation with the functions that compute its rows and its figures.

    Parameters
    ----------
    number : str
        Number of the section, such as "2.3"; its first digit is the chapter of the figures.
    rows : callable
        Function that returns the rows.
    figures : callable
        Function that returns the figures.
    """

    number: str
    rows: Callable[[], Iterable[Row]] = tuple
    figures: Callable[[], Iterable[ReportFigure]] = tuple

    @property
    def chapter(self) -> int:
        """Chapter of the section."""
        return int(self.number[0])
