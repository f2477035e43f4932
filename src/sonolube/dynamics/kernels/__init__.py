"""Compiled building blocks shared by the solvers: SIMD rows, tabulated force laws, peak velocities."""
