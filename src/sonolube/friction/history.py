"""Sampled motions: their checks, and the marching of a scalar law along each of many."""

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite
from sonolube.errors import InvalidInput


def require_increasing(*, time: ArrayLike) -> Floats:
    """Return sample times as an array; refuse any that do not increase.

    Parameters
    ----------
    time : array_like, shape (n,)
        Times of the samples. [s]

    Raises
    ------
    InvalidInput
        If there are fewer than two times, or one is not later than the one before.
    """
    times = require_finite(time=time)
    if times.ndim != 1 or times.size < 2:
        raise InvalidInput(f"time must be one row of at least two samples, got shape {times.shape}")
    steps = np.diff(times)
    if not np.all(steps > 0):
        late = int(np.argmin(steps > 0))
        raise InvalidInput(f"time must increase, got {times[late + 1]!s} s after {times[late]!s} s")
    return times


def along_rows(
    march: Callable[..., Floats], times: Floats, velocities: Floats, start: Floats, *constants: float
) -> Floats:
    """Return what `march(times, row, start, *constants)` gives for each row of velocities, in their shape.

    Parameters
    ----------
    march : callable
        Gives the n values along one motion.
    times : ndarray, shape (n,)
    velocities : ndarray, shape (..., n)
    start : ndarray, shape (...)
        First value of each motion.
    *constants : float
        What the law needs besides.

    Returns
    -------
    ndarray, shape (..., n)

    Raises
    ------
    InvalidInput
        If a row has not as many samples as there are times, or the starts do not match the rows.
    """
    if velocities.ndim == 0 or velocities.shape[-1] != times.size:
        raise InvalidInput(
            f"relative_velocity must have one value for each of {times.size} times along its last axis,"
            f" got shape {velocities.shape}"
        )
    try:
        rows = np.broadcast_shapes(velocities.shape[:-1], start.shape)
    except ValueError:
        raise InvalidInput(f"{start.shape} starting values do not match {velocities.shape[:-1]} motions") from None
    motions = np.broadcast_to(velocities, (*rows, times.size)).reshape(-1, times.size)
    starts = np.broadcast_to(start, rows).ravel()
    marched = np.empty(motions.shape)
    for row, motion in enumerate(motions):
        marched[row] = march(times, motion, starts[row], *constants)
    return marched.reshape(*rows, times.size)
