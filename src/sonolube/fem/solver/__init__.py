"""Meshes, assembly, eigenvalue and harmonic solvers for elastic and piezoelectric bodies."""
