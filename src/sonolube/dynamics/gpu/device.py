"""Functions that run in threads of a GPU."""

from collections.abc import Callable, Iterator
from threading import Lock
from typing import Any, TypeVar, cast

import numba.cuda
import numpy as np

Function = TypeVar("Function", bound=Callable[..., Any])

cuda: Any = numba.cuda  # which has no types

THREADS = 128
"""Threads to a block. []"""
TURN = Lock()
"""Held by who has a chunk on the GPU: one at a time, whatever the threads of the processor that ask."""
MOST_AT_ONCE = 262_144
"""Points on the GPU at a time, at most. []"""
_ROOM = 2**28  # numbers of all points on the GPU at a time, which bounds its memory at 2 GB


def on_device(function: Function) -> Function:
    """Return a function compiled for threads of the GPU, to be called by others there.

    Parameters
    ----------
    function : callable

    Returns
    -------
    callable
    """
    return cast(Function, cuda.jit(device=True)(function))


def chunks(points: int, numbers: int) -> Iterator[slice]:
    """Return the points to have on the GPU together, one chunk after another.

    Parameters
    ----------
    points : int
        All of them.
    numbers : int
        Numbers that come and go with a point.

    Yields
    ------
    slice
    """
    size = min(max(_ROOM // numbers // THREADS, 1) * THREADS, MOST_AT_ONCE)
    return (slice(first, min(first + size, points)) for first in range(0, points, size))


def trial() -> bool:
    """Return whether the GPU compiles and runs the least of kernels; what its driver raises goes through."""

    def count(numbers: Any) -> None:
        numbers[cuda.grid(1)] += 1

    numbers = cuda.to_device(np.zeros(1, dtype=np.int64))
    cuda.jit(count)[1, 1](numbers)
    return bool(numbers.copy_to_host()[0] == 1)
