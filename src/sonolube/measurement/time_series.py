"""Validation of sampled signals: increasing time, equal lengths, and a uniform sample interval."""

from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.ndimage import median_filter, uniform_filter1d

from sonolube.checks import Complexes, Floats, require_finite
from sonolube.errors import InvalidInput

_INTERVAL_TOLERANCE = 0.05  # relative deviation of a sample interval from the mean
_LOCAL = 31  # intervals over which their local median is taken
_GAP = 2.5  # local medians, above which an interval is a gap
_OTHER_RATE = 1.5  # ratio of the local intervals from which the rate has changed
_SAME_RATE = 0.01  # relative deviation of the mean intervals of stretches of one rate
_ALONE = 3.0  # times as long as the intervals before and after it is a gap
_CROWDED = 0.02  # of the time, by which the clock may deviate from one of even samples
_ROUNDED = 1.0  # intervals by which a rounded clock deviates


def require_time_series(*, time: ArrayLike, **signals: ArrayLike) -> tuple[Floats, ...]:
    """Time and the signals over it as arrays, validated; NaN in a signal is a missing value and stays.

    The time, then the signals in their order.
    """
    t = require_finite(time=time)
    if t.ndim != 1 or t.size < 2:
        raise InvalidInput(f"time must be one-dimensional with at least two samples, got shape {t.shape}")
    decreasing = np.diff(t) <= 0
    if decreasing.any():
        raise InvalidInput(f"time must increase, got {t[int(np.argmax(decreasing)) + 1]:.10g} s after as much or more")
    return t, *(_signal(name, values, t.size) for name, values in signals.items())


def require_equal_length(**vectors: Floats | Complexes) -> None:
    """Refuse vectors that are not one-dimensional, equal in length and of one value at least."""
    shapes = [vector.shape for vector in vectors.values()]
    if len(shapes[0]) != 1 or len(set(shapes)) > 1 or shapes[0] == (0,):
        demand = f"{' and '.join(vectors)} must be one-dimensional and equal in length"
        raise InvalidInput(f"{demand}, got shapes {' and '.join(map(str, shapes))}")


def _signal(name: str, values: ArrayLike, samples: int) -> Floats:
    """Signal as a float array; refuse another length, infinite values and a signal of NaN only."""
    array = np.asarray(values)
    if array.dtype.kind not in "fiu" or array.shape != (samples,):
        raise InvalidInput(f"{name} must hold {samples} numbers, got shape {array.shape} of {array.dtype}")
    signal = array.astype(np.float64, copy=False)
    if np.isinf(signal).any():
        raise InvalidInput(f"{name} must be finite or NaN, got an infinite value")
    if np.isnan(signal).all():
        raise InvalidInput(f"{name} holds no value among {samples}")
    return signal


def constant_stretches(*columns: Floats | NDArray[np.bool_]) -> list[tuple[int, int]]:
    """First sample of each stretch in which no column changes, and the sample after its last one."""
    changes = np.zeros(max(columns[0].size - 1, 0), bool)
    for values in columns:
        changes |= (values[1:] != values[:-1]) & ~(np.isnan(values[1:]) & np.isnan(values[:-1]))
    edges = [0, *(np.flatnonzero(changes) + 1).tolist(), columns[0].size]
    return [(begin, end) for begin, end in pairwise(edges) if end > begin]


def uniform_sample_interval(*, time: Floats) -> float:
    """Sample interval of a uniformly sampled time; refuse one with gaps. [s]"""
    interval = float(time[-1] - time[0]) / (time.size - 1)
    uneven = np.abs(np.diff(time) - interval) > _INTERVAL_TOLERANCE * interval
    if uneven.any():
        at = float(time[int(np.argmax(uneven))])
        raise InvalidInput(f"time must be evenly spaced; after {at:.6g} s samples were dropped or the rate changes")
    return interval


def changes_rate(*, time: Floats) -> bool:
    """Whether the samples are crowded in a part of a recording; gaps between them do not count."""
    interval = np.diff(time)
    if interval.size < 2:
        return False
    spread = np.sqrt(interval.max() / max(interval.min(), np.finfo(float).tiny))
    if (spread - 1) / (spread + 1) < _CROWDED:  # no order of such intervals deviates by more
        return False
    beside = np.maximum(np.append(interval[1:], interval[-2]), np.insert(interval[:-1], 0, interval[1]))
    passed = np.cumsum(np.where(interval > _ALONE * beside, beside, interval))
    even = np.arange(1, passed.size + 1) / passed.size
    return bool(np.max(np.abs(passed / passed[-1] - even)) > _CROWDED)


def even_stretches(*, time: Floats, fewest: int) -> tuple[float, list[slice]]:
    """Sample interval of a recording, and the stretches that are sampled at it without a gap.

    Mean interval of the longest stretch. [s] Empty where there is none.

    A stretch ends where an interval exceeds 2.5 local medians, or where their median changes by half. A clock that was
    rounded or that jitters by less than that is even on average; stretches of other rates are left out.
    """
    interval = np.diff(time)
    if interval.size < fewest - 1:
        return float(np.median(interval)), []
    local = median_filter(interval, _LOCAL, mode="nearest")
    mean = uniform_filter1d(np.minimum(interval, _GAP * local), _LOCAL, mode="nearest")
    later = np.roll(mean, -_LOCAL)
    later[-_LOCAL:] = mean[-1]
    is_cut = (interval > _GAP * local) | (np.abs(np.log(later / mean)) > np.log(_OTHER_RATE))
    edges = np.concatenate([[0], np.flatnonzero(is_cut) + 1, [time.size]])
    found = [slice(int(a), int(b)) for a, b in pairwise(edges) if b - a >= fewest]
    if not found:
        return float(np.median(interval)), []
    rates = [float(time[part][-1] - time[part][0]) / (part.stop - part.start - 1) for part in found]
    own = rates[int(np.argmax([part.stop - part.start for part in found]))]
    return own, [part for part, rate in zip(found, rates, strict=True) if abs(rate / own - 1) < _SAME_RATE]


def evenly_sampled(*, time: Floats, signal: Floats, sample_interval: float) -> tuple[Floats, Floats]:
    """Stretch of a signal at even times: as it is where they are, else interpolated between its samples.

    Time and signal. Times that deviate from even ones by less than an interval are a rounded clock: the samples stay as
    they are.
    """
    even = np.linspace(time[0], time[-1], time.size)
    if np.max(np.abs(time - even)) < _ROUNDED * sample_interval:
        return even, signal
    even = np.arange(time[0], time[-1] + sample_interval / 2, sample_interval)
    return even, np.interp(even, time, signal)
