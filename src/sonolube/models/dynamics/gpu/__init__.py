"""Batches on an NVIDIA GPU, one thread per point: steady states with their friction, and time marching.

Imported on demand only, since it requires numba-cuda.
"""

from sonolube.models.dynamics.gpu.marching_batch import march_on_gpu, unsupported_march
from sonolube.models.dynamics.gpu.steady_state_batch import solve_on_gpu, unsupported_steady_state

__all__ = ["march_on_gpu", "solve_on_gpu", "unsupported_march", "unsupported_steady_state"]
