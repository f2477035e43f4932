"""The dissertation reproduced: each published number beside the number computed for it, one module a chapter."""

from sonolube.errors import UnknownName
from sonolube.figure import ReportFigure
from sonolube.reproduce.chapter2 import rows as chapter2
from sonolube.reproduce.chapter3 import rows as chapter3
from sonolube.reproduce.chapter4 import rows as chapter4
from sonolube.reproduce.closures import (
    comparison as closure_comparison,
    dynamics as closure_dynamics,
    error_figures as closure_error_figures,
    figures as closure_figures,
    tables_in_conflict as closure_dispute,
)
from sonolube.reproduce.result import Reproduction
from sonolube.reproduce.row import Row, Verdict
from sonolube.validation import figures as model_comparison_figures

__all__ = ["ReportFigure", "Reproduction", "Row", "Verdict", "reproduction"]

_CHAPTERS = {2: chapter2, 3: chapter3, 4: chapter4}


def reproduction(*, chapter: int | None = None) -> Reproduction:
    """Compute everything of the dissertation that models and formulas can give.

    Parameters
    ----------
    chapter : int, optional
        Only this chapter; all of them where absent.

    Returns
    -------
    Reproduction

    Raises
    ------
    UnknownName
        If no number of that chapter can be computed.
    """
    if chapter is not None and chapter not in _CHAPTERS:
        raise UnknownName.among(map(str, _CHAPTERS), kind="chapter", name=str(chapter))
    chosen = [_CHAPTERS[chapter]] if chapter is not None else list(_CHAPTERS.values())
    predictions = [
        row
        for module in (closure_comparison, closure_dispute, closure_dynamics)
        for row in module.rows()
        if chapter in (None, row.chapter)
    ]
    comparisons = [
        figure
        for module in (closure_figures, closure_error_figures, model_comparison_figures)
        for figure in module.figures()
        if chapter in (None, figure.chapter)
    ]
    return Reproduction(
        rows=(*[row for module in chosen for row in module.rows()], *predictions),
        figures=(*[figure for module in chosen for figure in module.figures()], *comparisons),
    )
