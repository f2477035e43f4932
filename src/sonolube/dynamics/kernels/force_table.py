"""A falling force by a table of its logarithm: cubics between its points, straight lines beyond its ends.

Positions count cells from the table's first point. Row 0 of the cells is the line before it, row i + 1 the cubic after
the point i, and the last row the line after the last point; each holds its powers, lowest first, of the distance from
where it begins.
"""

import numba
import numpy as np

from sonolube.checks import Floats
from sonolube.dynamics.kernels.simd import INSIDE, KERNEL

_HALVINGS = 60


def table_cells(log_force: Floats, change: Floats) -> Floats:
    """Return the cells of a table.

    Parameters
    ----------
    log_force : ndarray, shape (n,)
        Logarithm of the force, in N, at evenly spaced points.
    change : ndarray, shape (n,)
        Its change per cell there.

    Returns
    -------
    ndarray, shape (n + 1, 4)
    """
    rise, before, after = np.diff(log_force), change[:-1], change[1:]
    cells = np.zeros((log_force.size + 1, 4))
    cells[1:, 0], cells[1:, 1] = log_force, change
    cells[0, :2] = log_force[0] - change[0], change[0]
    cells[1:-1, 2], cells[1:-1, 3] = 3 * rise - 2 * before - after, before + after - 2 * rise
    return cells


@numba.njit(**INSIDE)
def log_force_at(cells: Floats, position: float) -> tuple[float, float]:
    """Return the logarithm of the force, in N, and its change per cell."""
    row, last = np.floor(position) + 1.0, cells.shape[0] - 1.0
    row = row if row > 0.0 else 0.0  # also where the position is not a number
    row = row if row < last else last
    at, u = int(row), position - (row - 1.0)
    second, third = cells[at, 2], cells[at, 3]
    value = cells[at, 0] + u * (cells[at, 1] + u * (second + u * third))
    return value, cells[at, 1] + u * (2 * second + 3 * u * third)


@numba.njit(**INSIDE)
def position_of(cells: Floats, log_force: float) -> float:
    """Return where the logarithm of the force has a value."""
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
    for _ in range(_HALVINGS):  # Newton's method, or halving where it would leave the bracket
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
        if abs(step) < 1e-8:  # the next would be of the order of its square
            break
    return float(row - 1.0 + u)


@numba.njit(**KERNEL)
def log_forces(cells: Floats, positions: Floats, values: Floats, slopes: Floats) -> None:
    """Write what `log_force_at` returns.

    Parameters
    ----------
    cells : ndarray, shape (n + 1, 4)
    positions, values, slopes : ndarray, shape (m,)
    """
    for i in range(positions.size):
        values[i], slopes[i] = log_force_at(cells, positions[i])


@numba.njit(**KERNEL)
def positions_of(cells: Floats, log_forces: Floats, positions: Floats) -> None:
    """Write what `position_of` returns.

    Parameters
    ----------
    cells : ndarray, shape (n + 1, 4)
    log_forces, positions : ndarray, shape (m,)
    """
    for i in range(log_forces.size):
        positions[i] = position_of(cells, log_forces[i])
