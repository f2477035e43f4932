"""What a reproduction consists of: rows and figures."""

from dataclasses import dataclass

from sonolube.figure import ReportFigure
from sonolube.reproduce.row import Row


@dataclass(frozen=True, kw_only=True, slots=True)
class Reproduction:
    """Published beside computed: every row, every figure."""

    rows: tuple[Row, ...]
    figures: tuple[ReportFigure, ...]
