"""Contact force laws on SIMD rows: force, stiffness and damping of every point of a block at once.

`KernelLaw.kind` selects the branch at compile time: a kernel compiles one law only, and the laws that a user never
calls are never compiled. The classes behind the numbers are those of `sonolube.models.dynamics.gap_laws`.

A tabulated force is interpolated by cubics of its logarithm, with exponential extrapolation. The abscissa is the
position u in cells, counted from the table's first point. The coefficient table has one row per piece: row 0 the
straight line before the first point, row i + 1 the cubic after point i, and the last row the straight line after the
last point. A row holds the polynomial coefficients of ln F, lowest power first, in the distance from the start of its
piece.
"""

from typing import NamedTuple

import numpy as np

from sonolube.checks import Floats
from sonolube.execution.compilation import kernel
from sonolube.models.dynamics.kernels.simd import INNER, KERNEL, LANES, exponentials

_NEWTON_STEPS = 60


def table_cells(log_force: Floats, log_slope: Floats) -> Floats:
    r"""Coefficients of the cubic Hermite interpolant of ln F.

    Shape (n + 1, 4). One piece per row, as described in the module's docstring.

    With the values :math:`y_i` and slopes :math:`m_i` at the ends of a cell and :math:`\Delta = y_{i+1} - y_i`,

    .. math:: \ln F = y_i + m_i u + (3\Delta - 2 m_i - m_{i+1})\,u^2 + (m_i + m_{i+1} - 2\Delta)\,u^3 .
    """
    rise, before, after = np.diff(log_force), log_slope[:-1], log_slope[1:]
    cells = np.zeros((log_force.size + 1, 4))
    cells[1:, 0], cells[1:, 1] = log_force, log_slope
    cells[0, :2] = log_force[0] - log_slope[0], log_slope[0]
    cells[1:-1, 2], cells[1:-1, 3] = 3 * rise - 2 * before - after, before + after - 2 * rise
    return cells


@kernel(**INNER)
def log_force_at(cells: Floats, position: float) -> tuple[float, float]:
    """Logarithm of the force, in N, and its derivative per cell at one position."""
    row, last = np.floor(position) + 1.0, cells.shape[0] - 1.0
    row = row if row > 0.0 else 0.0  # NaN goes here too
    row = row if row < last else last
    at, u = int(row), position - (row - 1.0)
    second, third = cells[at, 2], cells[at, 3]
    value = cells[at, 0] + u * (cells[at, 1] + u * (second + u * third))
    return value, cells[at, 1] + u * (2 * second + 3 * u * third)


@kernel(**INNER)
def position_of(cells: Floats, log_force: float) -> float:
    """Position at which the logarithm of the force has a value, by bisection over cells, then Newton."""
    row, beyond = 0, cells.shape[0]
    while beyond - row > 1:
        middle = (row + beyond) // 2
        if cells[middle, 0] > log_force:
            row = middle
        else:
            beyond = middle
    u = (log_force - cells[row, 0]) / cells[row, 1]
    if row == 0 or row == cells.shape[0] - 1:
        return float(row - 1.0 + u)
    lower, upper = 0.0, 1.0
    for _ in range(_NEWTON_STEPS):  # bisection wherever Newton's step would leave the bracket
        if not lower <= u <= upper:
            u = 0.5 * (lower + upper)
        value, slope = log_force_at(cells, row - 1.0 + u)
        excess = value - log_force
        if excess > 0:
            lower = u
        else:
            upper = u
        step = excess / slope
        u -= step
        if abs(step) < 1e-8:  # quadratic convergence: the next step would be of the order of its square
            break
    return float(row - 1.0 + u)


@kernel(**KERNEL)
def log_forces(cells: Floats, positions: Floats, values: Floats, slopes: Floats) -> None:
    """Write the logarithm of the force, in N, and its derivative per cell at many positions.

    `cells` has shape (n + 1, 4).
    """
    for i in range(positions.size):
        values[i], slopes[i] = log_force_at(cells, positions[i])


@kernel(**KERNEL)
def positions_of(cells: Floats, log_forces: Floats, positions: Floats) -> None:
    """Write the positions at which the logarithm of the force has many values; `cells` has shape (n + 1, 4)."""
    for i in range(log_forces.size):
        positions[i] = position_of(cells, log_forces[i])


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
