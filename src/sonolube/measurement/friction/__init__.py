"""Friction in recordings: forces, steady state, voltage steps, friction loops, stick-slip and rotation."""
