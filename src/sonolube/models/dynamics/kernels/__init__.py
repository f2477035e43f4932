"""Compiled kernels shared by the solvers: SIMD rows, contact force laws, tabulated forces, peak velocities."""
