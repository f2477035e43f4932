"""Which processor solves a batch: the CPU, or an NVIDIA GPU where there is one."""

import warnings
from functools import cache
from typing import Any, Literal, get_args

from sonolube.errors import GpuUnused, InvalidInput

Backend = Literal["cpu", "gpu"]
"""Who computes: the processor, or an NVIDIA GPU and the processor what the GPU leaves."""

_INSTALL = "pip install 'sonolube[gpu]'"


def available(backend: Backend) -> Backend:
    """Return the backend asked for, or with a warning the processor where there is no GPU.

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
        If a GPU was asked for and none can be used.
    """
    if backend not in get_args(Backend):
        raise InvalidInput(f"backend must be cpu or gpu, got {backend!r}")
    if backend == "gpu" and not _gpu()[0]:
        return unused(_gpu()[1])
    return backend


def unused(reason: str) -> Backend:
    """Warn that the GPU asked for is not used, and return the backend that is."""
    warnings.warn(f"computed on the CPU: {reason}", GpuUnused, stacklevel=3)
    return "cpu"


def device_name(backend: Backend) -> str:
    """Return the name of the GPU that a backend uses, empty where it uses none.

    Parameters
    ----------
    backend : {"cpu", "gpu"}

    Returns
    -------
    str
    """
    return _gpu()[0] if backend == "gpu" else ""


@cache
def _gpu() -> tuple[str, str]:
    """Return the name of the GPU, or empty and the reason why there is none."""
    with warnings.catch_warnings():  # of the compiler, about numpy and about so small a trial
        warnings.simplefilter("ignore")
        try:
            return _tried_gpu()
        except ImportError:
            return "", f"numba-cuda is missing: {_INSTALL}"
        except Exception as failure:  # whatever driver and compiler raise, the answers can still be had
            lines = str(failure).strip().splitlines() or [type(failure).__name__]
            return "", f"the GPU does not answer ({lines[0]}); the extra is {_INSTALL}"


def _tried_gpu() -> tuple[str, str]:
    import numba.cuda

    cuda: Any = numba.cuda  # which has no types
    if not cuda.is_available():
        return "", f"no NVIDIA GPU with its driver and CUDA was found; the extra is {_INSTALL}"
    simulated = bool(getattr(numba.config, "ENABLE_CUDASIM", 0))
    if cuda.implementation == "Built-in" and not simulated:  # which does not compile the kernels any more
        return "", f"numba-cuda is missing: {_INSTALL}"
    from sonolube.dynamics.gpu.device import trial

    if not trial():
        return "", "the GPU does not count to one"
    name = "CUDA simulator" if simulated else cuda.get_current_device().name
    return (name.decode() if isinstance(name, bytes) else str(name)), ""
