"""Reproduction of the dissertation, its rows computed once for all tests of a process."""

from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import cache
from unittest.mock import patch

from dong2015 import SECTIONS, Reproduction, Row, chapters, reproduction
from dong2015.chapters import Section


def _computed_once(section: Section) -> Section:
    """Return a section whose rows are computed when they are first asked for."""
    rows: Callable[[], Iterable[Row]] = cache(lambda: tuple(section.rows()))
    return replace(section, rows=rows)


_SECTIONS = tuple(map(_computed_once, SECTIONS))


@cache
def reproduced(chapter: int | None = None) -> Reproduction:
    """Return `reproduction` of a chapter or of all, each section of which takes its time once, in all some 20 s."""
    with patch.object(chapters, "SECTIONS", _SECTIONS):
        return reproduction(chapter=chapter)


def reproduced_rows(chapter: int) -> dict[str, Row]:
    """Return the rows of a chapter by their names."""
    return {row.id: row for row in reproduced(chapter).rows}
