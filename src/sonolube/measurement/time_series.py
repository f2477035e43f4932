"""Checks and time bases that every analysis of a signal over time needs."""

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite
from sonolube.errors import InvalidInput

_EVENNESS = 0.05  # share of the interval by which even samples may be early or late


def require_time_series(*, time: ArrayLike, **signals: ArrayLike) -> tuple[Floats, ...]:
    """Return the time and signals over it as arrays; NaN in a signal is no value and stays.

    Parameters
    ----------
    time : array_like, shape (samples,)
        Increasing. [s]
    **signals : array_like, shape (samples,)
        By their names in the vocabulary.

    Returns
    -------
    tuple of ndarray

    Raises
    ------
    InvalidInput
        If the time is empty, not finite or does not increase, or a signal has another length, an infinite value, or
        no value at all.
    """
    t = require_finite(time=time)
    if t.ndim != 1 or t.size < 2:
        raise InvalidInput(f"time must be a row of at least two samples, got shape {t.shape}")
    wrong = np.diff(t) <= 0
    if wrong.any():
        raise InvalidInput(f"time must increase, got {t[int(np.argmax(wrong)) + 1]:.10g} s after as much or more")
    return t, *(_signal(name, values, t.size) for name, values in signals.items())


def _signal(name: str, values: ArrayLike, samples: int) -> Floats:
    array = np.asarray(values)
    if array.dtype.kind not in "fiu" or array.shape != (samples,):
        raise InvalidInput(f"{name} must be a row of {samples} numbers, got shape {array.shape} of {array.dtype}")
    signal = array.astype(np.float64, copy=False)
    if np.isinf(signal).any():
        raise InvalidInput(f"{name} must be finite or NaN, got an infinite value")
    if np.isnan(signal).all():
        raise InvalidInput(f"{name} holds no value among {samples}")
    return signal


def uniform_sample_interval(*, time: Floats) -> float:
    """Return the time between samples; refuse a time with gaps. [s]

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
        Naming the first gap or uneven step.
    """
    interval = float(time[-1] - time[0]) / (time.size - 1)
    off = np.abs(np.diff(time) - interval) > _EVENNESS * interval
    if off.any():
        at = float(time[int(np.argmax(off))])
        raise InvalidInput(
            f"time must be evenly spaced here; after {at:.6g} s samples were dropped or the rate changes"
        )
    return interval
