"""Batches on an NVIDIA GPU, one thread to a point: steady states with their friction, and marches in time.

Loaded when asked for.
"""

from sonolube.dynamics.gpu.launch import Fused, solve_on_gpu, unserved
from sonolube.dynamics.gpu.marching import march_on_gpu, unmarched

__all__ = ["Fused", "march_on_gpu", "solve_on_gpu", "unmarched", "unserved"]
