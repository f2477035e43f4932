"""Geometries of parts and transducers."""
