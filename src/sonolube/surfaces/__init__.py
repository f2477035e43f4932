"""Surfaces: what a rough surface is to a contact model."""

from sonolube.surfaces.roughness import Roughness

__all__ = ["Roughness"]
