"""Validation of sampled signals: increasing time, equal lengths, and a uniform sample interval."""

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Complexes, Floats, require_finite
from sonolube.errors import InvalidInput

_INTERVAL_TOLERANCE = 0.05  # relative deviation of a sample interval from the mean


def require_time_series(*, time: ArrayLike, **signals: ArrayLike) -> tuple[Floats, ...]:
    """Return the time and the signals over it as arrays, validated; NaN in a signal is a missing value and stays.

    Parameters
    ----------
    time : array_like, shape (samples,)
        Increasing. [s]
    **signals : array_like, shape (samples,)
        By their names in the vocabulary.

    Returns
    -------
    tuple of ndarray
        The time, then the signals in their order.

    Raises
    ------
    InvalidInput
        If the time has fewer than two samples, is not finite or does not increase, or a signal has another length, an
        infinite value, or no value at all.
    """
    t = require_finite(time=time)
    if t.ndim != 1 or t.size < 2:
        raise InvalidInput(f"time must be one-dimensional with at least two samples, got shape {t.shape}")
    decreasing = np.diff(t) <= 0
    if decreasing.any():
        raise InvalidInput(f"time must increase, got {t[int(np.argmax(decreasing)) + 1]:.10g} s after as much or more")
    return t, *(_signal(name, values, t.size) for name, values in signals.items())


def require_equal_length(**vectors: Floats | Complexes) -> None:
    """Refuse vectors that are not one-dimensional, equal in length and of one value at least.

    Raises
    ------
    InvalidInput
        Naming the vectors and their shapes.
    """
    shapes = [vector.shape for vector in vectors.values()]
    if len(shapes[0]) != 1 or len(set(shapes)) > 1 or shapes[0] == (0,):
        demand = f"{' and '.join(vectors)} must be one-dimensional and equal in length"
        raise InvalidInput(f"{demand}, got shapes {' and '.join(map(str, shapes))}")


def _signal(name: str, values: ArrayLike, samples: int) -> Floats:
    """Return a signal as a float array; refuse another length, infinite values and a signal of NaN only."""
    array = np.asarray(values)
    if array.dtype.kind not in "fiu" or array.shape != (samples,):
        raise InvalidInput(f"{name} must hold {samples} numbers, got shape {array.shape} of {array.dtype}")
    signal = array.astype(np.float64, copy=False)
    if np.isinf(signal).any():
        raise InvalidInput(f"{name} must be finite or NaN, got an infinite value")
    if np.isnan(signal).all():
        raise InvalidInput(f"{name} holds no value among {samples}")
    return signal


def uniform_sample_interval(*, time: Floats) -> float:
    """Return the sample interval of a uniformly sampled time; refuse one with gaps. [s]

    Parameters
    ----------
    time : ndarray, shape (samples,)
        Increasing. [s]

    Returns
    -------
    float

    Raises
    ------
    InvalidInput
        If an interval differs from the mean by more than 5 %, with the time of the first one.
    """
    interval = float(time[-1] - time[0]) / (time.size - 1)
    uneven = np.abs(np.diff(time) - interval) > _INTERVAL_TOLERANCE * interval
    if uneven.any():
        at = float(time[int(np.argmax(uneven))])
        raise InvalidInput(f"time must be evenly spaced; after {at:.6g} s samples were dropped or the rate changes")
    return interval
