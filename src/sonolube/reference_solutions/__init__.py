"""Referees of rough contact: boundary elements on the very surface, against which every law can be held."""

from sonolube.reference_solutions.boundary_element import PressedSurface, mirrored, press
from sonolube.reference_solutions.figures import comparison_figure, comparison_table, reduced_curve
from sonolube.reference_solutions.law_comparison import (
    QUANTITIES,
    REFEREE,
    LawComparison,
    LawCurve,
    compare_laws,
    deviation,
    where_laws_hold,
)

__all__ = [
    "QUANTITIES",
    "REFEREE",
    "LawComparison",
    "LawCurve",
    "PressedSurface",
    "compare_laws",
    "comparison_figure",
    "comparison_table",
    "deviation",
    "mirrored",
    "press",
    "reduced_curve",
    "where_laws_hold",
]
