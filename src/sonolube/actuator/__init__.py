"""Actuators: what drives the vibration, and what carries it to the contact."""

from sonolube.actuator.drive_power import driver_power
from sonolube.actuator.waveguide import (
    HalfWaveguide,
    Locus,
    axial_displacement,
    in_plane_amplitude,
    locus,
    natural_frequency,
    normal_amplitude,
    normal_displacement,
)

__all__ = [
    "HalfWaveguide",
    "Locus",
    "axial_displacement",
    "driver_power",
    "in_plane_amplitude",
    "locus",
    "natural_frequency",
    "normal_amplitude",
    "normal_displacement",
]
