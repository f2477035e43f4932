"""Harmonic balance: steady states of a structure with one nonlinear contact, by Newton's method over harmonics."""
