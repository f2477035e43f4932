"""Wear grooves in height maps: detection, sections, volume with its uncertainty, and generated grooves."""
