"""Harmonic balance: periodic steady states by Newton's method on the harmonics of the contact's displacement."""
