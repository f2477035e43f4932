"""Functions that run in threads of a GPU."""

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba.cuda
import numpy as np

Function = TypeVar("Function", bound=Callable[..., Any])

cuda: Any = numba.cuda  # which has no types


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


def trial() -> bool:
    """Return whether the GPU compiles and runs the least of kernels; what its driver raises goes through."""

    def count(numbers: Any) -> None:
        numbers[cuda.grid(1)] += 1

    numbers = cuda.to_device(np.zeros(1, dtype=np.int64))
    cuda.jit(count)[1, 1](numbers)
    return bool(numbers.copy_to_host()[0] == 1)
