"""Means of the friction of a contact that slides while it vibrates, by a thread.

Phases crowd at the two turns of the motion, as in `sonolube.dynamics.friction_average.elliptic_quadrature`.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.dynamics.friction_average.elliptic_quadrature import crowded_points
from sonolube.dynamics.gpu.device import on_device
from sonolube.dynamics.gpu.extrema import swing

SPEEDS = 8
"""Sliding speeds that share one motion through the phases. []"""
_LEVELS = (0, 8, 16, 32, 64)  # phases more for the sake of a steep force
_STEEP = 1.6  # phases more for each decay length of amplitude
_STEPS, _ROWS = 4, 24  # of crowding: to a decade of speed over peak velocity, and at most
_LARGEST_EXPONENT = 700.0


class CrowdedLevels(NamedTuple):
    """Phases for each steepness of the force and each step of crowding."""

    phases: Floats  # (3, levels, rows, most): cosine, sine and weight
    numbers: NDArray[np.int64]  # (levels, rows): how many


def crowded_levels(tolerance: float) -> CrowdedLevels:
    """Return the phases that hold a relative error."""
    tables = [crowded_points(extra, tolerance) for extra in _LEVELS]
    most = max(table.cosine.shape[1] for table in tables)
    phases = np.zeros((3, len(tables), tables[0].count.size, most))
    for level, table in enumerate(tables):
        for part, values in enumerate((table.cosine, table.sine, table.weight)):
            phases[part, level, :, : values.shape[1]] = values
    return CrowdedLevels(phases, np.array([table.count for table in tables]))


@on_device
def level_of(steepness: float) -> int:
    """Return the place among the levels for an amplitude in decay lengths."""
    level = 0
    for place in range(len(_LEVELS) - 1):
        if _STEEP * steepness > _LEVELS[place]:
            level = place + 1
    return level


@on_device
def row_of(ratio: float) -> int:
    """Return the step of crowding for a ratio of sliding speed to peak velocity."""
    steps = -_STEPS * math.log10(max(ratio, 10.0 ** (-_ROWS / _STEPS)))
    # the least ratio's logarithm may round to beyond the last row
    return min(max(int(math.ceil(steps)), 0), _ROWS)  # noqa: RUF046 - a GPU rounds to a float


@on_device
def write_means(
    omega: float,
    length: float,
    unknown: Floats,
    h: int,
    upper: float,
    lower: float,
    steepness: float,
    slowest: float,
    speeds: Floats,
    phases: Floats,
    count: NDArray[np.int64],
    sums: Floats,
    point: int,
    means: Floats,
) -> None:
    """Write the means of v_r/sqrt(v_r^2 + v^2), plain and weighted by the contact force over the dead load."""
    size = math.sqrt(unknown[0, 1] ** 2 + unknown[1, 1] ** 2)
    level, row = level_of(steepness), row_of(slowest / (omega * size + 1e-300))
    half = 0.5 * (upper - lower)
    half -= math.pi * math.floor(half / math.pi)
    alpha = math.tan(0.25 * math.pi - 0.5 * half)
    re, im = math.cos(upper - half), math.sin(upper - half)
    for first in range(0, speeds.size, SPEEDS):
        last = min(first + SPEEDS, speeds.size)
        for s in range(last - first):
            sums[0, s], sums[1, s] = 0.0, 0.0
        for j in range(count[level, row]):
            cosine, sine = phases[0, level, row, j], phases[1, level, row, j]
            # z = exp(i ...) (w + alpha)/(1 + alpha w) for w = cosine + i sine
            below = 1 / (1 + 2 * alpha * cosine + alpha * alpha)
            w_re, stretch = (cosine * (1 + alpha * alpha) + 2 * alpha) * below, (1 - alpha * alpha) * below
            z_re, z_im = re * w_re - im * sine * stretch, re * sine * stretch + im * w_re
            x, rate, _ = swing(unknown, h, z_re, z_im)
            share, v = phases[2, level, row, j] * stretch, omega * rate
            pressed = share * math.exp(min(max(-(unknown[0, 0] + x) / length, -_LARGEST_EXPONENT), _LARGEST_EXPONENT))
            for s in range(last - first):
                ratio = speeds[first + s] / math.sqrt(speeds[first + s] * speeds[first + s] + v * v)
                sums[0, s] += share * ratio
                sums[1, s] += pressed * ratio
        for s in range(last - first):
            means[0, first + s, point], means[1, first + s, point] = sums[0, s], sums[1, s]
