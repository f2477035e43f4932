"""Execution: compiled kernels and threads."""
