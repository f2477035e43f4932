"""Preisach's model of hysteresis: many relays, of which the history of the input decides which are up."""

from dataclasses import dataclass

import numba
import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.errors import InvalidInput


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class PreisachPlane:
    """Relays that go up at one input and down at a lower one, in square cells of equal density.

    Parameters
    ----------
    lowest : float
        Input at and below which all relays are down.
    highest : float
        Input at and above which all are up.
    levels : int
        Cells along each side of the triangle.

    Raises
    ------
    InvalidInput
        If the range is empty or there are fewer than 2 or more than 64 levels.
    """

    lowest: float
    highest: float
    levels: int

    def __post_init__(self) -> None:
        if not self.highest > self.lowest:
            raise InvalidInput(f"highest must exceed lowest, {self.lowest!r}, got {self.highest!r}")
        if not 2 <= self.levels <= 64:
            raise InvalidInput(f"levels must lie between 2 and 64, got {self.levels}")

    @property
    def cells(self) -> int:
        """Number of cells, those on the diagonal included."""
        return self.levels * (self.levels + 1) // 2


def relay_fractions(plane: PreisachPlane, values: Floats) -> Floats:
    """Return which share of each cell's relays is up along a history of the input.

    Parameters
    ----------
    plane : PreisachPlane
    values : ndarray, shape (samples,)
        History of the input, all relays down before it.

    Returns
    -------
    ndarray, shape (samples, cells)
        Cells by the level at which relays go up, then by that at which they go down.

    Notes
    -----
    Only the extremes that no later ones exceeded are remembered, which is the wiping-out property. [1]_

    References
    ----------
    .. [1] I. D. Mayergoyz, Mathematical Models of Hysteresis and Their Applications, Elsevier (2003), chapter 1.
    """
    shares = np.empty((values.size, plane.cells))
    _fill(_in_cells(plane, values), plane.levels, shares)
    return shares


def preisach_output(plane: PreisachPlane, weights: Floats, values: Floats) -> Floats:
    """Return the sum of the weights of all relays that are up, along a history of the input.

    Parameters
    ----------
    plane : PreisachPlane
    weights : ndarray, shape (cells,)
        Of all relays of each cell together.
    values : ndarray, shape (samples,)
        History of the input, all relays down before it.

    Returns
    -------
    ndarray, shape (samples,)
    """
    return np.asarray(_output(_in_cells(plane, values), plane.levels, np.ascontiguousarray(weights)))


def mean_relay_widths(plane: PreisachPlane) -> Floats:
    """Return how far apart going up and going down lie in each cell, on average, in units of the input.

    Parameters
    ----------
    plane : PreisachPlane

    Returns
    -------
    ndarray, shape (cells,)
    """
    up, down = _cells(plane.levels)
    apart = np.where(up == down, 1 / 3, up - down)  # the mean over a triangle is a third of its side
    return np.asarray((plane.highest - plane.lowest) / plane.levels * apart)


def _in_cells(plane: PreisachPlane, values: Floats) -> Floats:
    return np.ascontiguousarray((values - plane.lowest) / (plane.highest - plane.lowest) * plane.levels)


def _cells(levels: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    up, down = np.tril_indices(levels)
    return up, down


@numba.njit(cache=True)
def _add_triangle(high: float, low: float, levels: int, factor: float, shares: Floats) -> None:
    """Add the share of each cell with relays that go up by `high` and down not before `low`."""
    cell = 0
    for up in range(levels):
        a = min(max(high - up, 0.0), 1.0)
        for down in range(up + 1):
            b = min(max(down + 1 - low, 0.0), 1.0)
            if up > down:
                shares[cell] += factor * a * b
            elif a + b > 1:
                shares[cell] += factor * (a + b - 1) ** 2
            cell += 1


@numba.njit(cache=True)
def _advance(x: float, turns: Floats, last: int) -> int:
    """Take the input to x; `turns` are the bottom, a high, a low, ... and where the input is; returns its place.

    A high that is exceeded, or a low, goes with the turn that followed it.
    """
    if x == turns[last]:
        return last
    rising = x > turns[last]
    if rising != (last % 2 == 1):
        last += 1
    turns[last] = x
    while last >= 2 and (turns[last] >= turns[last - 2] if rising else turns[last] <= turns[last - 2]):
        turns[last - 2] = turns[last]
        last -= 2
    return last


@numba.njit(cache=True)
def _fill_row(turns: Floats, last: int, levels: int, row: Floats) -> None:
    row[:] = 0.0
    for place in range(1, last + 1):
        if place % 2 == 1:
            _add_triangle(turns[place], turns[place - 1], levels, 1.0, row)
        else:
            _add_triangle(turns[place - 1], turns[place], levels, -1.0, row)


@numba.njit(cache=True)
def _fill(x: Floats, levels: int, shares: Floats) -> None:
    turns, last = np.zeros(x.size + 2), 0
    for sample in range(x.size):
        last = _advance(min(max(x[sample], 0.0), float(levels)), turns, last)
        _fill_row(turns, last, levels, shares[sample])


@numba.njit(cache=True)
def _output(x: Floats, levels: int, weights: Floats) -> Floats:
    turns, last = np.zeros(x.size + 2), 0
    row, found = np.empty(weights.size), np.empty(x.size)
    for sample in range(x.size):
        last = _advance(min(max(x[sample], 0.0), float(levels)), turns, last)
        _fill_row(turns, last, levels, row)
        found[sample] = np.sum(row * weights)
    return found
