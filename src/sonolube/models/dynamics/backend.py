"""Choice of the processor that solves a batch: the CPU, or a GPU where JAX has one."""

import warnings
from functools import cache
from typing import Literal, get_args

from sonolube.errors import GpuUnused, InvalidInput
from sonolube.extras import EXTRAS

Backend = Literal["cpu", "gpu"]
"""Processor of a batch: the CPU, or the GPU of JAX with the CPU for initial guesses and measures."""


def usable_backend(backend: Backend) -> Backend:
    """Requested backend where it can be used, else "cpu" with a warning."""
    if backend not in get_args(Backend):
        raise InvalidInput(f"backend must be cpu or gpu, got {backend!r}")
    if backend == "gpu" and gpu_obstacle():
        warnings.warn(f"computed on the CPU: {gpu_obstacle()}", GpuUnused, stacklevel=3)
        return "cpu"
    return backend


def device_name(backend: Backend) -> str:
    """Name of the GPU that a backend uses, an empty text where it uses none."""
    return _gpu()[0] if backend == "gpu" else ""


def gpu_obstacle() -> str:
    """Reason why no GPU can be used, with its remedy; an empty text where one can."""
    return _gpu()[1]


@cache
def _gpu() -> tuple[str, str]:
    """Name of the GPU and an empty text, or an empty text and the reason why no GPU can be used."""
    if not EXTRAS["gpu"].is_installed:
        return "", f"JAX is missing: {EXTRAS['gpu'].command}"
    try:
        import jax

        names = [str(each.device_kind) for each in jax.devices() if each.platform == "gpu"]
    except Exception as failure:  # whatever JAX and its drivers raise: the CPU can still solve the batch
        lines = str(failure).strip().splitlines() or [type(failure).__name__]
        return "", f"JAX cannot be used ({lines[0]}); install it with {EXTRAS['gpu'].command}"
    if not names:
        return "", "JAX finds no GPU; for one of NVIDIA, pip install 'jax[cuda12]'"
    return names[0], ""
