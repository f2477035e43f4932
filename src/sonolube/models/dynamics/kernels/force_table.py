r"""Tabulated contact force: piecewise cubic interpolation of its logarithm, with exponential extrapolation.

The abscissa is the position u in cells, counted from the table's first point. The coefficient table has one row per
piece: row 0 the straight line before the first point, row i + 1 the cubic after point i, and the last row the straight
line after the last point. A row holds the polynomial coefficients of ln F, lowest power first, in the distance from the
start of its piece.
"""

import numpy as np

from sonolube.checks import Floats
from sonolube.execution.compilation import kernel
from sonolube.models.dynamics.kernels.simd import INNER, KERNEL

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
