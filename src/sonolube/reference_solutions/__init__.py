"""Reference solutions of rough contact: boundary elements on a height map, and contact laws compared with them."""

from sonolube.reference_solutions.boundary_element import (
    BoundaryElementContact,
    boundary_element_contact,
    mirror_extension,
)
from sonolube.reference_solutions.figures import comparison_figure, comparison_table, dimensionless_curve
from sonolube.reference_solutions.law_comparison import (
    QUANTITIES,
    REFERENCE_SOLUTION,
    LawComparison,
    LawCurve,
    compare_laws,
    deviation,
    validity_ranges,
)

__all__ = [
    "QUANTITIES",
    "REFERENCE_SOLUTION",
    "BoundaryElementContact",
    "LawComparison",
    "LawCurve",
    "boundary_element_contact",
    "compare_laws",
    "comparison_figure",
    "comparison_table",
    "deviation",
    "dimensionless_curve",
    "mirror_extension",
    "validity_ranges",
]
