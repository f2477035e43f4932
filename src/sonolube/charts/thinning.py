"""Curves of more values than a page resolves."""

import numpy as np

from sonolube.checks import Floats

_BINS = 1500  # more than a page resolves


def envelope(x: Floats, y: Floats, *, bins: int = _BINS) -> tuple[Floats, Floats]:
    """Curve through the lowest and highest value of each of some bins of equal numbers of values.

    Parameters
    ----------
    x : ndarray, shape (n,)
        Ascending.
    y : ndarray, shape (n,)
    bins : int

    Returns
    -------
    x, y : ndarray, shape (m,)
        As given where there are no more than two values a bin; else with both ends of a bin at its middle.
    """
    size = -(-x.size // bins)
    if size <= 2:
        return x, y
    starts = np.arange(0, x.size, size)
    middle = (x[starts] + x[np.minimum(starts + size, x.size) - 1]) / 2
    ends = np.column_stack([np.fmin.reduceat(y, starts), np.fmax.reduceat(y, starts)])
    return np.repeat(middle, 2), ends.ravel()
