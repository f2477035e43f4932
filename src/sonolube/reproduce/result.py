"""What a reproduction consists of: rows and figures."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from sonolube.reproduce.row import Row

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, kw_only=True, slots=True)
class ReportFigure:
    """A figure of the report.

    Parameters
    ----------
    name : str
        Its file's name, without ending.
    chapter : int
        Chapter of the source it belongs to.
    title : str
        What it shows.
    caption : str
        What to see in it, and where every point comes from.
    draw : callable
        Draws it.
    """

    name: str
    chapter: int
    title: str
    caption: str
    draw: "Callable[[], Figure]"


@dataclass(frozen=True, kw_only=True, slots=True)
class Reproduction:
    """Published beside computed: every row, every figure."""

    rows: tuple[Row, ...]
    figures: tuple[ReportFigure, ...]
