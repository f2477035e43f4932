"""Smallest and largest values of a long signal over ranges of its samples, by blocks of growing size.

A range of any length is answered from a few thousand numbers, so that a recording of millions of samples can be
looked at as it is moved.
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.errors import InvalidInput

_FIRST: Final = 16  # samples of the smallest blocks
_GROWTH: Final = 4  # of the blocks from one level to the next


def block_sizes(samples: int) -> list[int]:
    """Samples of a block of each level: 16, 64 and so on, as long as there are several blocks."""
    sizes, size = [], _FIRST
    while size < samples:
        sizes.append(size)
        size *= _GROWTH
    return sizes


def extremes(values: Floats) -> Floats:
    """Smallest and largest value of the blocks of every level, one level behind the other.

    Parameters
    ----------
    values : ndarray, shape (samples,)
        NaN is left out.

    Returns
    -------
    ndarray, shape (2, blocks)
        NaN for blocks without a value.
    """
    levels, low, high, before = [np.empty((2, 0))], values, values, 1
    for size in block_sizes(values.size):
        starts = np.arange(0, low.size, size // before)
        low, high, before = np.fmin.reduceat(low, starts), np.fmax.reduceat(high, starts), size
        levels.append(np.stack([low, high]))
    return np.concatenate(levels, axis=1)


def extremes_of_range(
    values: Floats, blocks: Floats, *, first: int, last: int, bins: int
) -> tuple[NDArray[np.int64], Floats]:
    """Smallest and largest value of a signal in each of up to `bins` parts of a range of its samples.

    Parameters
    ----------
    values : ndarray, shape (samples,)
    blocks : ndarray, shape (2, blocks)
        By `extremes` of them.
    first, last : int
        First sample of the range, and the one after its last.
    bins : int
        Largest number of parts.

    Returns
    -------
    edges : ndarray of int, shape (parts + 1,)
        First sample of each part, and the one after the last.
    ends : ndarray, shape (2, parts)
        Those of the samples of each part, exactly.

    Raises
    ------
    InvalidInput
        If the range holds no sample, or `bins` is below three.
    """
    if not 0 <= first < last <= values.size:
        raise InvalidInput(f"samples {first} to {last} are none of {values.size}")
    if bins < 3:
        raise InvalidInput(f"bins must be at least 3, got {bins}")
    sizes = block_sizes(values.size)
    level = max((place for place, size in enumerate(sizes) if size * bins <= last - first), default=None)
    if level is None:  # so short that the samples themselves are looked at
        edges = np.unique(np.linspace(first, last, min(bins, last - first) + 1).astype(np.int64))
        part = values[first:last]
        return edges, _reduced(part, part, edges[:-1] - first)
    size = sizes[level]
    begin, end = -(-first // size), last // size  # whole blocks; what is left at the ends is short
    offset = sum(-(-values.size // each) for each in sizes[:level])
    low, high = blocks[:, offset + begin : offset + end]
    starts = np.unique(np.linspace(0, end - begin, min(bins - 2, end - begin) + 1).astype(np.int64))
    inner = _reduced(low, high, starts[:-1])
    edges, ends = (begin + starts) * size, [inner]
    if first < edges[0]:
        ends.insert(0, _reduced(values[first : edges[0]], values[first : edges[0]], np.zeros(1, np.int64)))
        edges = np.concatenate([[first], edges])
    if last > edges[-1]:
        ends.append(_reduced(values[edges[-1] : last], values[edges[-1] : last], np.zeros(1, np.int64)))
        edges = np.concatenate([edges, [last]])
    return edges, np.concatenate(ends, axis=1)


def _reduced(low: Floats, high: Floats, starts: NDArray[np.int64]) -> Floats:
    """Smallest of the lower and largest of the higher values from each start to the next."""
    return np.stack([np.fmin.reduceat(low, starts), np.fmax.reduceat(high, starts)])
