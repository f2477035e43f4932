"""Steady states on an NVIDIA GPU: one thread to a point, from its settings to its friction. Loaded when asked for."""

from sonolube.dynamics.gpu.launching import Fused, solve_on_gpu, unserved

__all__ = ["Fused", "solve_on_gpu", "unserved"]
