"""Choice of the processor that solves a batch: the CPU, or an NVIDIA GPU where one is available."""

import warnings
from functools import cache
from typing import Any, Literal, get_args

from sonolube.errors import GpuUnused, InvalidInput
from sonolube.extras import EXTRAS

Backend = Literal["cpu", "gpu"]
"""Processor of a batch: the CPU alone, or an NVIDIA GPU with the CPU for the points that it does not solve."""

_INSTALL = EXTRAS["gpu"].command


def usable_backend(backend: Backend) -> Backend:
    """Return the requested backend where it can be used, else "cpu" with a warning.

    Parameters
    ----------
    backend : {"cpu", "gpu"}

    Returns
    -------
    {"cpu", "gpu"}

    Raises
    ------
    InvalidInput
        If there is no such backend.

    Warns
    -----
    GpuUnused
        If a GPU was requested and none can be used.
    """
    if backend not in get_args(Backend):
        raise InvalidInput(f"backend must be cpu or gpu, got {backend!r}")
    if backend == "gpu" and not _gpu()[0]:
        return cpu_fallback(_gpu()[1])
    return backend


def cpu_fallback(reason: str) -> Backend:
    """Warn that the requested GPU is not used, and return "cpu"."""
    warnings.warn(f"computed on the CPU: {reason}", GpuUnused, stacklevel=3)
    return "cpu"


def device_name(backend: Backend) -> str:
    """Return the name of the GPU that a backend uses, an empty text where it uses none.

    Parameters
    ----------
    backend : {"cpu", "gpu"}

    Returns
    -------
    str
    """
    return _gpu()[0] if backend == "gpu" else ""


def gpu_obstacle() -> str:
    """Return the reason why no GPU can be used, with its remedy; an empty text where one can.

    Returns
    -------
    str
    """
    return _gpu()[1]


@cache
def _gpu() -> tuple[str, str]:
    """Return the name of the GPU and an empty text, or an empty text and the reason why no GPU can be used."""
    with warnings.catch_warnings():  # of the compiler, about numpy and about so small a test kernel
        warnings.simplefilter("ignore")
        try:
            return _tried_gpu()
        except ImportError:
            return "", f"numba-cuda is missing: {_INSTALL}"
        except Exception as failure:  # whatever driver or compiler raise: the CPU can still solve the batch
            lines = str(failure).strip().splitlines() or [type(failure).__name__]
            return "", f"the GPU cannot be used ({lines[0]}); install the extra with {_INSTALL}"


def _tried_gpu() -> tuple[str, str]:
    """Return what `_gpu` returns, by running a test kernel; errors of driver and compiler pass through."""
    import numba.cuda

    cuda: Any = numba.cuda  # numba.cuda has no types
    if not cuda.is_available():
        return "", f"no NVIDIA GPU with driver and CUDA was found; install the extra with {_INSTALL}"
    simulated = bool(getattr(numba.config, "ENABLE_CUDASIM", 0))
    if cuda.implementation == "Built-in" and not simulated:  # numba's own target is unmaintained
        return "", f"numba-cuda is missing: {_INSTALL}"
    from sonolube.models.dynamics.gpu.device import runs_test_kernel

    if not runs_test_kernel():
        return "", "a test kernel gave a wrong result on the GPU"
    name = "CUDA simulator" if simulated else cuda.get_current_device().name
    return (name.decode() if isinstance(name, bytes) else str(name)), ""
