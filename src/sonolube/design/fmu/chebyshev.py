"""Tensor products of Chebyshev polynomials: tables of smooth functions, made from values at nodes."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.polynomial.chebyshev import chebvander
from numpy.typing import ArrayLike

from sonolube.checks import Floats

Ends = tuple[float, float]
_GROWTH = 1.5  # of the number of nodes along an axis that has too few
_LARGEST_ORDER = 64  # nodes of a function of one variable
_LAST = 2  # coefficients along an axis by which its convergence is judged


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class ChebyshevTable:
    """Function of a few variables as a sum of products of Chebyshev polynomials.

    Parameters
    ----------
    ends : tuple of pair of float
        Lowest and highest value of each variable; equal where it is constant.
    coefficients : ndarray
        One axis for each variable.
    """

    ends: tuple[Ends, ...]
    coefficients: Floats

    def __call__(self, *point: ArrayLike) -> Floats:
        """Value at points, one array for each variable, all of one shape; the nearer end outside of the ends."""
        values = self.coefficients
        arrays = np.broadcast_arrays(*point)
        for place, (x, ends, order) in enumerate(zip(arrays, self.ends, self.coefficients.shape, strict=True)):
            basis = chebvander(_reduced(np.ravel(x), ends), order - 1)
            values = (
                np.tensordot(basis, values, axes=(1, 0)) if place == 0 else np.einsum("nk,nk...->n...", basis, values)
            )
        return np.asarray(values.reshape(arrays[0].shape))


def nodes(ends: Ends, count: int) -> Floats:
    """Chebyshev nodes of the first kind between two ends."""
    return np.asarray(np.mean(ends) + (ends[1] - ends[0]) / 2 * _unit_nodes(count))


def fitted(values: Floats, ends: Sequence[Ends]) -> ChebyshevTable:
    """Table through values at the nodes, one axis for each variable."""
    for axis, count in enumerate(values.shape):
        inverse = np.linalg.inv(chebvander(_unit_nodes(count), count - 1))
        values = np.moveaxis(np.tensordot(inverse, values, axes=(1, axis)), 0, axis)
    return ChebyshevTable(ends=tuple(ends), coefficients=values)


def trimmed(table: ChebyshevTable, tolerance: float) -> ChebyshevTable:
    """Table without the highest orders of each variable whose coefficients stay below a part of the greatest."""
    coefficients = table.coefficients
    limit = tolerance * np.abs(coefficients).max()
    for axis in range(coefficients.ndim):
        size = _along(coefficients, axis)
        kept = int(np.flatnonzero(size >= limit)[-1]) + 1
        coefficients = np.take(coefficients, range(kept), axis=axis)
    return ChebyshevTable(ends=table.ends, coefficients=coefficients)


def unconverged(table: ChebyshevTable) -> Floats:
    """Last coefficients along each variable over the greatest, zero for a variable that is constant."""
    sizes = [_along(table.coefficients, axis) for axis in range(table.coefficients.ndim)]
    return np.array(
        [
            size[-_LAST:].max() / size.max() if ends[0] < ends[1] and size.any() else 0.0
            for size, ends in zip(sizes, table.ends, strict=True)
        ]
    )


def grown(order: int) -> int:
    """Next larger number of nodes along an axis."""
    return int(_GROWTH * order) + 1


def of_one_variable(function: Callable[[Floats], Floats], ends: Ends, tolerance: float) -> ChebyshevTable:
    """Table of a function of one variable, with as many nodes as it takes."""
    order = 8 if ends[0] < ends[1] else 1
    while True:
        table = fitted(function(nodes(ends, order)), [ends])
        if unconverged(table)[0] <= tolerance or grown(order) > _LARGEST_ORDER:
            return trimmed(table, tolerance / 100)
        order = grown(order)


def _along(coefficients: Floats, axis: int) -> Floats:
    """Largest magnitude of the coefficients of each order of one variable."""
    return np.asarray(np.abs(np.moveaxis(coefficients, axis, 0)).reshape(coefficients.shape[axis], -1).max(axis=1))


def _unit_nodes(count: int) -> Floats:
    return np.asarray(np.cos(np.pi * (2 * np.arange(count) + 1) / (2 * count)))


def _reduced(x: Floats, ends: Ends) -> Floats:
    half = (ends[1] - ends[0]) / 2
    return np.clip((x - np.mean(ends)) / half, -1.0, 1.0) if half else np.zeros_like(x)
