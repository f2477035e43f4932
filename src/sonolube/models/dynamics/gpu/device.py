"""Compilation of GPU device functions, and chunks of a batch that fit into the memory of a GPU."""

from collections.abc import Callable, Iterator
from threading import Lock
from typing import Any, TypeVar, cast

import numba.cuda
import numpy as np

Function = TypeVar("Function", bound=Callable[..., Any])

cuda: Any = numba.cuda  # numba.cuda has no types

THREADS = 128
"""Threads per block. []"""
GPU_LOCK = Lock()
"""Lock held while a chunk is on the GPU: one at a time, whatever the number of CPU threads that request one."""
MOST_AT_ONCE = 262_144
"""Largest number of points on the GPU at a time. []"""
_CAPACITY = 2**28  # numbers of all points on the GPU at a time, which bounds its memory at 2 GB


def on_device(function: Function) -> Function:
    """Compile a function as a device function, to be called by GPU threads.

    Parameters
    ----------
    function : callable

    Returns
    -------
    callable
    """
    return cast(Function, cuda.jit(device=True)(function))


def chunks(points: int, numbers: int) -> Iterator[slice]:
    """Return the chunks of a batch to treat together on the GPU.

    Parameters
    ----------
    points : int
        Size of the batch.
    numbers : int
        Numbers transferred per point.

    Yields
    ------
    slice
    """
    size = min(max(_CAPACITY // numbers // THREADS, 1) * THREADS, MOST_AT_ONCE)
    return (slice(first, min(first + size, points)) for first in range(0, points, size))


def runs_test_kernel() -> bool:
    """Return whether the GPU compiles and runs a minimal kernel; exceptions of its driver pass through."""

    def count(numbers: Any) -> None:
        numbers[cuda.grid(1)] += 1

    numbers = cuda.to_device(np.zeros(1, dtype=np.int64))
    cuda.jit(count)[1, 1](numbers)
    return bool(numbers.copy_to_host()[0] == 1)
