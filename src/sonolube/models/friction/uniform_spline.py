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
        count = len(coefficients)
        nodes = np.arange(count)
        system, known = np.zeros((count + 2, count + 2)), np.zeros((count + 2, *coefficients.shape[1:]))
        for shift, weight in enumerate((1 / 6, 2 / 3, 1 / 6)):
            system[nodes + 1, nodes + shift] = weight
        system[0, :5] = system[-1, -5:] = 1, -4, 6, -4, 1
        known[1:-1] = coefficients
        coefficients = np.ascontiguousarray(np.linalg.solve(system, known).T)
    return coefficients


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
