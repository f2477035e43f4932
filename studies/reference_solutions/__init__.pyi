from .boundary_element import (
    BoundaryElementContact as BoundaryElementContact,
    boundary_element_contact as boundary_element_contact,
)
from .law_comparison import (
    QUANTITIES as QUANTITIES,
    REFERENCE_SOLUTION as REFERENCE_SOLUTION,
    LawComparison as LawComparison,
    LawCurve as LawCurve,
    compare_laws as compare_laws,
    comparison_figure as comparison_figure,
    comparison_table as comparison_table,
    deviation as deviation,
    dimensionless_curve as dimensionless_curve,
    validity_ranges as validity_ranges,
)
