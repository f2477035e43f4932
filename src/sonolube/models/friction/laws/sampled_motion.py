"""Sampled motions: checks of the sample times, and the integration of a scalar friction law along many motions."""

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite
from sonolube.errors import InvalidInput


def require_increasing(*, time: ArrayLike) -> Floats:
    """Sample times as an array; refuse times that do not increase; shape (n,)."""
    times = require_finite(time=time)
    if times.ndim != 1 or times.size < 2:
        raise InvalidInput(f"time must be one-dimensional with at least two samples, got shape {times.shape}")
    steps = np.diff(times)
    if not np.all(steps > 0):
        first = int(np.argmin(steps > 0))
        raise InvalidInput(f"time must increase, got {times[first + 1]!s} s after {times[first]!s} s")
    return times


def integrate_rows(
    integrate: Callable[..., Floats], times: Floats, velocities: Floats, start: Floats, *constants: float
) -> Floats:
    """State of a friction law along each row of sampled velocities; `velocities` has shape (..., n)."""
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
    states = np.empty(motions.shape)
    for row, motion in enumerate(motions):
        states[row] = integrate(times, motion, starts[row], *constants)
    return states.reshape(*rows, times.size)
