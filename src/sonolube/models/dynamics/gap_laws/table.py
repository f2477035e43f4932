"""Table of the contact laws, and their form for the compiled kernels."""

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from sonolube.errors import InvalidInput
from sonolube.models.dynamics.gap_laws.exponential import ExponentialGap
from sonolube.models.dynamics.gap_laws.hertz import HertzGap
from sonolube.models.dynamics.gap_laws.linear import LinearGap
from sonolube.models.dynamics.gap_laws.protocol import GapLaw
from sonolube.models.dynamics.gap_laws.tabulated import TabulatedGap
from sonolube.models.dynamics.kernels.contact_kernel import KernelLaw

_NO_CELLS = np.empty((0, 4))


GAP_LAWS: Mapping[str, type[GapLaw]] = MappingProxyType(
    {"exponential": ExponentialGap, "hertz": HertzGap, "linear": LinearGap, "tabulated": TabulatedGap}
)
"""The contact laws that the compiled kernels evaluate, by name."""


def kernel_law(gap_law: GapLaw) -> KernelLaw:
    """Contact law in the form that the compiled kernels take.

    What kernels are compiled for. Numbers that they take at run time.
    """
    if not is_compiled(gap_law):
        raise InvalidInput(
            f"gap_law must be one of {', '.join(law.__name__ for law in GAP_LAWS.values())}, got {gap_law!r};"
            " tabulate any other law as a TabulatedGap"
        )
    cells = gap_law.cells if isinstance(gap_law, TabulatedGap) else _NO_CELLS
    kind, damped = (0,) * gap_law.kind, (0,) * (gap_law.force_damping > 0)
    return KernelLaw(kind, damped, gap_law.kernel_parameter, gap_law.force_damping, cells)


def is_compiled(gap_law: GapLaw) -> bool:
    """Whether a contact law is one of `GAP_LAWS`, which the compiled kernels evaluate."""
    return isinstance(gap_law, tuple(GAP_LAWS.values()))
