"""Actuators: what drives the vibration, and what carries it to the contact."""

from sonolube.actuator.as_published import as_published_impedance
from sonolube.actuator.drive_power import dissipated_power, driver_power, peak_current, power_factor
from sonolube.actuator.equivalent_circuit import (
    Branch,
    ButterworthVanDyke,
    Resonances,
    circuit_admittance,
    resonances,
)
from sonolube.actuator.flextensional import FlextensionalActuator, amplified, equivalent_stack
from sonolube.actuator.stack import (
    PiezoStack,
    blocked_admittance,
    blocked_force,
    free_admittance,
    free_stroke,
    require_allowed_voltage,
    stack_doubts,
    stack_force,
)
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
    "Branch",
    "ButterworthVanDyke",
    "FlextensionalActuator",
    "HalfWaveguide",
    "Locus",
    "PiezoStack",
    "Resonances",
    "amplified",
    "as_published_impedance",
    "axial_displacement",
    "blocked_admittance",
    "blocked_force",
    "circuit_admittance",
    "dissipated_power",
    "driver_power",
    "equivalent_stack",
    "free_admittance",
    "free_stroke",
    "in_plane_amplitude",
    "locus",
    "natural_frequency",
    "normal_amplitude",
    "normal_displacement",
    "peak_current",
    "power_factor",
    "require_allowed_voltage",
    "resonances",
    "stack_doubts",
    "stack_force",
]
