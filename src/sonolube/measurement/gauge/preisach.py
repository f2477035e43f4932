r"""Preisach's model of hysteresis: relays on a triangular plane, whose states follow from the history of the input.

A relay switches up when the input rises to its threshold alpha, and down when it falls to beta <= alpha. The plane of
(alpha, beta) is divided into square cells of uniform density; with the weight w of each cell and the fraction s of its
relays that are up, the output is

.. math:: y = \sum_c w_c\, s_c .
"""

from dataclasses import dataclass

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.execution.compilation import kernel

_FEW = {"most": 100_000, "at_first": 1_000_000}  # samples times cells, a microsecond and a half each as plain Python


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class PreisachPlane:
    """Preisach plane over a range of the input, divided into square cells of uniform relay density.

    Parameters
    ----------
    lowest : float
        Input at and below which all relays are down.
    highest : float
        Input at and above which all relays are up.
    levels : int
        Number of cells along each side of the triangle.

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
        """Number of cells, including the triangles on the diagonal."""
        return self.levels * (self.levels + 1) // 2


def relay_fractions(plane: PreisachPlane, values: Floats) -> Floats:
    """Fraction of each cell's relays that is up, along a history of the input.

    Parameters
    ----------
    plane : PreisachPlane
    values : ndarray, shape (samples,)
        History of the input, with all relays down before it.

    Returns
    -------
    ndarray, shape (samples, cells)
        Cells ordered by the level at which their relays switch up, then by that at which they switch down.

    See Also
    --------
    preisach_output : the weighted sum of these fractions.

    Notes
    -----
    Only the extrema of the input that no later ones exceeded are stored, which is the wiping-out property. [1]_

    References
    ----------
    .. [1] I. D. Mayergoyz, Mathematical Models of Hysteresis and Their Applications, Elsevier (2003), chapter 1.
    """
    fractions = np.empty((values.size, plane.cells))
    fill_fractions = _fill_fractions.for_points(fractions.size, **_FEW)
    fill_fractions(_in_levels(plane, values), plane.levels, fractions)
    return fractions


def preisach_output(plane: PreisachPlane, weights: Floats, values: Floats) -> Floats:
    """Output of Preisach's model, the sum of the weights of all relays that are up, along an input history.

    Parameters
    ----------
    plane : PreisachPlane
    weights : ndarray, shape (cells,)
        Weight of all relays of each cell together.
    values : ndarray, shape (samples,)
        History of the input, with all relays down before it.

    Returns
    -------
    ndarray, shape (samples,)

    See Also
    --------
    relay_fractions : the fractions that are summed.
    """
    output = _output.for_points(values.size * plane.cells, **_FEW)
    return np.asarray(output(_in_levels(plane, values), plane.levels, np.ascontiguousarray(weights)))


def mean_relay_widths(plane: PreisachPlane) -> Floats:
    """Mean width alpha - beta of the relays of each cell, in units of the input.

    Parameters
    ----------
    plane : PreisachPlane

    Returns
    -------
    ndarray, shape (cells,)
    """
    up, down = np.tril_indices(plane.levels)  # levels at which the relays of each cell switch up and down
    width = np.where(up == down, 1 / 3, up - down)  # over a triangle on the diagonal the mean is a third of its side
    return np.asarray((plane.highest - plane.lowest) / plane.levels * width)


def _in_levels(plane: PreisachPlane, values: Floats) -> Floats:
    """Input in units of the levels, from 0 at the lowest to `levels` at the highest."""
    return np.ascontiguousarray((values - plane.lowest) / (plane.highest - plane.lowest) * plane.levels)


@kernel(cache=True)
def _add_triangle(high: float, low: float, levels: int, factor: float, fractions: Floats) -> None:
    """Add the fraction of each cell with relays of alpha up to `high` and beta from `low` on."""
    cell = 0
    for up in range(levels):
        a = min(max(high - up, 0.0), 1.0)
        for down in range(up + 1):
            b = min(max(down + 1 - low, 0.0), 1.0)
            if up > down:
                fractions[cell] += factor * a * b
            elif a + b > 1:
                fractions[cell] += factor * (a + b - 1) ** 2
            cell += 1


@kernel(cache=True)
def _advance(x: float, extrema: Floats, last: int) -> int:
    """Move the input to x and return the place of the current input in `extrema`.

    `extrema` holds the bottom, then alternating maxima and minima, and last the current input. An extremum that is
    exceeded is wiped out together with the one that followed it.
    """
    if x == extrema[last]:
        return last
    rising = x > extrema[last]
    if rising != (last % 2 == 1):
        last += 1
    extrema[last] = x
    while last >= 2 and (extrema[last] >= extrema[last - 2] if rising else extrema[last] <= extrema[last - 2]):
        extrema[last - 2] = extrema[last]
        last -= 2
    return last


@kernel(cache=True)
def _fill_row(extrema: Floats, last: int, levels: int, row: Floats) -> None:
    """Fill a row with the fractions of all cells for the stored extrema."""
    row[:] = 0.0
    for place in range(1, last + 1):
        if place % 2 == 1:
            _add_triangle(extrema[place], extrema[place - 1], levels, 1.0, row)
        else:
            _add_triangle(extrema[place - 1], extrema[place], levels, -1.0, row)


@kernel(cache=True)
def _fill_fractions(x: Floats, levels: int, fractions: Floats) -> None:
    """Fill the fractions of all cells along a history of the input."""
    extrema, last = np.zeros(x.size + 2), 0
    for sample in range(x.size):
        last = _advance(min(max(x[sample], 0.0), float(levels)), extrema, last)
        _fill_row(extrema, last, levels, fractions[sample])


@kernel(cache=True)
def _output(x: Floats, levels: int, weights: Floats) -> Floats:
    """Weighted sum of the fractions along a history of the input."""
    extrema, last = np.zeros(x.size + 2), 0
    row, output = np.empty(weights.size), np.empty(x.size)
    for sample in range(x.size):
        last = _advance(min(max(x[sample], 0.0), float(levels)), extrema, last)
        _fill_row(extrema, last, levels, row)
        output[sample] = np.sum(row * weights)
    return output
