"""Cubic splines on uniform grids of one or two axes, for tables of friction ratios."""

from collections.abc import Callable
from typing import Any, cast

import numpy as np

from sonolube.checks import Floats, Integers
from sonolube.execution.compilation import INNER, kernel

__all__: list[str] = []  # for the tables of this room

_CHUNK = 8192


def spline_coefficients(values: Floats) -> Floats:
    """Coefficients of the cubic B-splines through values at the nodes of a uniform grid, two more along each axis.

    The third derivative is continuous at the second node from either end too, so that the ends are as accurate as the
    inside.

    Shape (n + 2,).
    """
    coefficients = np.asarray(values, dtype=np.float64)
    for _ in range(coefficients.ndim):  # along the first axis, which then becomes the last
        coefficients = np.ascontiguousarray(_along_first_axis(coefficients).T)
    return coefficients


def _along_first_axis(values: Floats) -> Floats:
    """Coefficients c of (c_j + 4 c_j+1 + c_j+2)/6 = f_j along the first axis, in a time that grows with its length.

    As the fourth difference of c vanishes at either end, the second difference of c there is that of f, which gives
    the third coefficient from either end; between these the system is tridiagonal.
    """
    f, count = values, len(values)
    c = np.empty((count + 2, *f.shape[1:]))
    c[2] = f[1] - (f[0] - 2 * f[1] + f[2]) / 6
    c[-3] = f[-2] - (f[-3] - 2 * f[-2] + f[-1]) / 6
    pivots = [pivot := 0.0]
    for j in range(3, count - 1):
        pivot = 1 / (4 - pivot)
        pivots.append(pivot)
        c[j] = (6 * f[j - 1] - c[j - 1]) * pivot
    for j in range(count - 2, 2, -1):
        c[j] -= pivots[j - 2] * c[j + 1]
    for near in (1, 0):
        c[near] = 6 * f[near] - 4 * c[near + 1] - c[near + 2]
        c[-1 - near] = 6 * f[-1 - near] - 4 * c[-2 - near] - c[-3 - near]
    return c


def spline_values(coefficients: Floats, *places: Floats) -> Floats:
    """Values of a spline.

    `coefficients` has shape (n + 2,). Shape (p,).
    """
    below = [np.minimum(p.astype(np.int64), n - 4) for p, n in zip(places, coefficients.shape, strict=True)]
    weights = [_weights_of_many(p - i) for p, i in zip(places, below, strict=True)]
    table = coefficients.ravel()
    if len(places) == 1:
        return _row_values(table, below[0], weights[0])
    width = coefficients.shape[1]
    first = below[0] * width + below[1]
    total = np.zeros(first.shape)
    for row in range(4):
        values = _row_values(table[row * width :], first, weights[1])
        values *= weights[0][row]
        total += values
    return total


def in_chunks(function: Callable[[Floats, Floats], Floats], one: Floats, other: Floats) -> Floats:
    """Values of a function of two arrays, which broadcast, in chunks of points that stay in the cache of a core."""
    shape = np.broadcast_shapes(one.shape, other.shape)
    first, second = (np.broadcast_to(each, shape).ravel() for each in (one, other))
    values = np.empty(first.size)
    for start in range(0, values.size, _CHUNK):
        chunk = slice(start, start + _CHUNK)
        values[chunk] = function(first[chunk], second[chunk])
    return values.reshape(shape)


def _row_values(table: Floats, first: Integers, weights: tuple[Floats, ...]) -> Floats:
    """Sums of four neighbouring coefficients with their weights."""
    total, term = table.take(first), np.empty(first.shape)
    total *= weights[0]
    for column in range(1, 4):
        table[column:].take(first, out=term, mode="clip")  # places are inside; checked indices need another copy
        term *= weights[column]
        total += term
    return total


@kernel(error_model="numpy", _nrt=False, **INNER)
def bicubic_value(coefficients: Floats, row: float, column: float) -> float:
    """Value of a spline of two axes at one place, which `spline_values` gives for arrays."""
    rows, columns = coefficients.shape
    i, j = min(int(row), rows - 4), min(int(column), columns - 4)
    a, b, c, d = _weights(row - i)
    e, f, g, h = _weights(column - j)
    total = 0.0
    for k, weight in enumerate((a, b, c, d)):
        line = coefficients[i + k]
        total += weight * (e * line[j] + f * line[j + 1] + g * line[j + 2] + h * line[j + 3])
    return total


@kernel(error_model="numpy", _nrt=False, **INNER)
def _weights(t: float) -> tuple[float, float, float, float]:
    """Values of four neighbouring cubic B-splines at the share t of a step behind a node."""
    left = 1 - t
    first, last = left * left * left / 6, t * t * t / 6
    second = 2 / 3 - t * t * (0.5 + 0.5 * left)
    return first, second, 1 - first - second - last, last


_weights_of_many: Callable[[Floats], tuple[Floats, ...]] = cast("Any", _weights.py_func)
