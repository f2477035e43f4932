"""Contact force laws on SIMD rows: force, stiffness and damping of every point of a block at once.

`KernelLaw.kind` selects the branch at compile time: a kernel compiles one law only, and the laws that a user never
calls are never compiled. The classes behind the numbers are those of `sonolube.models.dynamics.gap_laws`.
"""

from typing import NamedTuple

import numpy as np

from sonolube.checks import Floats
from sonolube.execution.compilation import kernel
from sonolube.models.dynamics.kernels.force_table import log_force_at
from sonolube.models.dynamics.kernels.simd import INNER, LANES, exponentials

EXPONENTIAL, HERTZ, LINEAR, TABULATED = range(4)
"""Contact laws that the kernels evaluate, by `GapLaw.kind`. []"""

LARGEST_LOG_FORCE = 700.0
"""Largest magnitude of the logarithm of a force in N that tabulated laws return. []"""

CompileTimeInt = tuple[int, ...]
"""An integer that a kernel is compiled for, passed as the length of a tuple."""


class KernelLaw(NamedTuple):
    """A contact law as kernels take it; they are compiled for its kind and for whether it is damped."""

    kind: CompileTimeInt  # EXPONENTIAL to TABULATED
    damped: CompileTimeInt  # 1 with damping, 0 without
    parameter: float  # decay length, in m; Hertz coefficient, in N/m^1.5; stiffness, in N/m; or table cells per metre
    damping: float  # tau of F (1 - tau v), in s/m
    cells: Floats  # coefficients of the force table, empty for any other law


@kernel(**INNER)
def velocity_over_omega(law: KernelLaw, motion: Floats, h: int, velocity: Floats) -> None:
    """Write the harmonics i k X_k of the velocity over omega, in the rows of a motion; nothing without damping."""
    if len(law.damped) == 1:
        for k in range(1, h + 1):
            for lane in range(LANES):
                velocity[2 * k - 1, lane] = -k * motion[2 * k, lane]
                velocity[2 * k, lane] = k * motion[2 * k - 1, lane]


@kernel(**INNER)
def contact_force_rows(
    law: KernelLaw, load: Floats, equilibrium: Floats, x: Floats, v: Floats, results: Floats
) -> None:
    r"""Write the contact force, the stiffness -dF/dx and the damping -dF/dv.

    `results` has shape (3, lanes).

    .. math:: F_n = F(x)\,\max(1 - \tau v,\, 0), \qquad -\partial F_n/\partial x, \qquad -\partial F_n/\partial v
    """
    force, slope, drag = results[0], results[1], results[2]
    if len(law.kind) == EXPONENTIAL:
        for lane in range(LANES):
            slope[lane] = -x[lane] / law.parameter
        exponentials(slope, force)
        for lane in range(LANES):
            force[lane] *= load[lane]
            slope[lane] = force[lane] / law.parameter
    elif len(law.kind) == HERTZ:
        for lane in range(LANES):
            approach = max(equilibrium[lane] - x[lane], 0.0)
            slope[lane] = 1.5 * law.parameter * np.sqrt(approach)
            force[lane] = slope[lane] * approach / 1.5
    elif len(law.kind) == TABULATED:
        _tabulated_rows(law, equilibrium, x, force, slope, drag)
    else:
        for lane in range(LANES):
            touching = load[lane] - law.parameter * x[lane]
            force[lane] = max(touching, 0.0)
            slope[lane] = law.parameter if touching > 0 else 0.0
    if len(law.damped) == 1:
        for lane in range(LANES):
            factor = 1 - law.damping * v[lane]
            drag[lane] = law.damping * force[lane] if factor > 0 else 0.0
            factor = max(factor, 0.0)
            force[lane] *= factor
            slope[lane] *= factor


@kernel(**INNER)
def _tabulated_rows(
    law: KernelLaw, equilibrium: Floats, x: Floats, force: Floats, slope: Floats, scratch: Floats
) -> None:
    """Write force and stiffness of a tabulated law, whose position on the table starts from equilibrium."""
    for lane in range(LANES):
        slope[lane], scratch[lane] = log_force_at(law.cells, equilibrium[lane] + law.parameter * x[lane])
    exponentials(slope, force)
    for lane in range(LANES):
        slope[lane] = -law.parameter * scratch[lane] * force[lane]
