"""Friction averages of motions with two extrema per period, by GPU threads.

The nodes are those of `sonolube.models.dynamics.friction_average.elliptic_quadrature`.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.models.dynamics.friction_average.elliptic_quadrature import elliptic_nodes
from sonolube.models.dynamics.gpu.device import on_device
from sonolube.models.dynamics.gpu.extrema import phase_derivatives

SPEEDS = 8
"""Sliding speeds averaged in one pass through the nodes. []"""
_EXTRA_NODES = (0, 8, 16, 32, 64)  # for a steep contact force
_NODES_PER_DECAY_LENGTH = 1.6  # additional nodes per decay length of amplitude
_ROWS_PER_DECADE, _LAST_ROW = 4, 24  # of the node tables
_LARGEST_EXPONENT = 700.0


class NodeTables(NamedTuple):
    """Tables of nodes for each steepness of the contact force and each ratio of sliding speed to peak velocity."""

    nodes: Floats  # (3, tables, rows, most): cosine, sine and weight
    sizes: NDArray[np.int64]  # (tables, rows): number of nodes


def node_tables(tolerance: float) -> NodeTables:
    """Return the tables of nodes that hold a relative error.

    Parameters
    ----------
    tolerance : float

    Returns
    -------
    NodeTables
    """
    tables = [elliptic_nodes(extra, tolerance) for extra in _EXTRA_NODES]
    most = max(table.cosine.shape[1] for table in tables)
    nodes = np.zeros((3, len(tables), tables[0].count.size, most))
    for which, table in enumerate(tables):
        for part, values in enumerate((table.cosine, table.sine, table.weight)):
            nodes[part, which, :, : values.shape[1]] = values
    return NodeTables(nodes, np.array([table.count for table in tables]))


@on_device
def table_of(steepness: float) -> int:
    """Return the index of the table for an amplitude in decay lengths."""
    table = 0
    for place in range(len(_EXTRA_NODES) - 1):
        if _NODES_PER_DECAY_LENGTH * steepness > _EXTRA_NODES[place]:
            table = place + 1
    return table


@on_device
def row_of(ratio: float) -> int:
    """Return the row of a table for a ratio of sliding speed to peak velocity."""
    steps = -_ROWS_PER_DECADE * math.log10(max(ratio, 10.0 ** (-_LAST_ROW / _ROWS_PER_DECADE)))
    # the logarithm of the smallest ratio may round to beyond the last row
    return min(max(int(math.ceil(steps)), 0), _LAST_ROW)  # noqa: RUF046 - a GPU rounds to a float


@on_device
def write_averages(
    omega: float,
    length: float,
    unknown: Floats,
    h: int,
    upper: float,
    lower: float,
    steepness: float,
    slowest: float,
    speeds: Floats,
    nodes: Floats,
    count: NDArray[np.int64],
    sums: Floats,
    point: int,
    averages: Floats,
) -> None:
    """Write the averages of v_r/sqrt(v_r^2 + v^2), plain and weighted by the contact force over the dead load."""
    size = math.sqrt(unknown[0, 1] ** 2 + unknown[1, 1] ** 2)
    table, row = table_of(steepness), row_of(slowest / (omega * size + 1e-300))
    half = 0.5 * (upper - lower)
    half -= math.pi * math.floor(half / math.pi)
    alpha = math.tan(0.25 * math.pi - 0.5 * half)
    re, im = math.cos(upper - half), math.sin(upper - half)
    for first in range(0, speeds.size, SPEEDS):
        last = min(first + SPEEDS, speeds.size)
        for s in range(last - first):
            sums[0, s], sums[1, s] = 0.0, 0.0
        for j in range(count[table, row]):
            cosine, sine = nodes[0, table, row, j], nodes[1, table, row, j]
            # z = exp(i gamma) (w + alpha)/(1 + alpha w) for w = cosine + i sine
            below = 1 / (1 + 2 * alpha * cosine + alpha * alpha)
            w_re, stretch = (cosine * (1 + alpha * alpha) + 2 * alpha) * below, (1 - alpha * alpha) * below
            z_re, z_im = re * w_re - im * sine * stretch, re * sine * stretch + im * w_re
            x, slope, _ = phase_derivatives(unknown, h, z_re, z_im)
            weight, v = nodes[2, table, row, j] * stretch, omega * slope
            weighted = weight * math.exp(min(max(-(unknown[0, 0] + x) / length, -_LARGEST_EXPONENT), _LARGEST_EXPONENT))
            for s in range(last - first):
                ratio = speeds[first + s] / math.sqrt(speeds[first + s] * speeds[first + s] + v * v)
                sums[0, s] += weight * ratio
                sums[1, s] += weighted * ratio
        for s in range(last - first):
            averages[0, first + s, point], averages[1, first + s, point] = sums[0, s], sums[1, s]
