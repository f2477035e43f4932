"""Wear grooves in height maps: detection, unworn reference, cross-sections, volume with uncertainty; wear scars."""
