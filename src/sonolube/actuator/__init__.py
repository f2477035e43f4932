"""Piezoelectric actuators: stacks, their drive and electrical matching, horns and waveguides, and a catalogue."""

from sonolube.actuator.amplifier import AmplifierRequirements, amplifier_requirements
from sonolube.actuator.catalogue import (
    ACTUATOR_KINDS,
    CatalogueActuator,
    catalogue_actuator,
    catalogue_names,
    catalogue_stack,
    read_catalogue,
)
from sonolube.actuator.dong_2015 import dong_2015_impedance
from sonolube.actuator.drive import Drive
from sonolube.actuator.drive_power import dissipated_power, linear_amplifier_power, peak_current, power_factor
from sonolube.actuator.equivalent_circuit import (
    ButterworthVanDyke,
    CircuitResonances,
    MotionalBranch,
    circuit_admittance,
    circuit_resonances,
)
from sonolube.actuator.flextensional import FlextensionalActuator, equivalent_stack, lever_amplified_stack
from sonolube.actuator.matching import (
    AdmittanceFunction,
    MatchingNetwork,
    input_admittance,
    l_match,
    matched_band,
    matched_power_factor,
    parallel_inductor,
    series_inductor,
    voltage_gain,
)
from sonolube.actuator.preload_bolt import BoltStresses, PreloadBolt, bolt_stresses, bolted_stack
from sonolube.actuator.stack import (
    PiezoStack,
    blocked_admittance,
    blocked_force,
    free_admittance,
    free_stroke,
    require_allowed_voltage,
    stack_caveats,
    stack_force,
)
from sonolube.actuator.thin_horn import ThinHorn, thin_conical_horn, thin_exponential_horn, thin_stepped_horn
from sonolube.actuator.waveguide import (
    BarWaveguide,
    SurfaceTrajectory,
    axial_displacement,
    free_bar_frequency,
    in_plane_amplitude,
    normal_amplitude,
    normal_displacement,
    surface_trajectory,
)

__all__ = [
    "ACTUATOR_KINDS",
    "AdmittanceFunction",
    "AmplifierRequirements",
    "BarWaveguide",
    "BoltStresses",
    "ButterworthVanDyke",
    "CatalogueActuator",
    "CircuitResonances",
    "Drive",
    "FlextensionalActuator",
    "MatchingNetwork",
    "MotionalBranch",
    "PiezoStack",
    "PreloadBolt",
    "SurfaceTrajectory",
    "ThinHorn",
    "amplifier_requirements",
    "axial_displacement",
    "blocked_admittance",
    "blocked_force",
    "bolt_stresses",
    "bolted_stack",
    "catalogue_actuator",
    "catalogue_names",
    "catalogue_stack",
    "circuit_admittance",
    "circuit_resonances",
    "dissipated_power",
    "dong_2015_impedance",
    "equivalent_stack",
    "free_admittance",
    "free_bar_frequency",
    "free_stroke",
    "in_plane_amplitude",
    "input_admittance",
    "l_match",
    "lever_amplified_stack",
    "linear_amplifier_power",
    "matched_band",
    "matched_power_factor",
    "normal_amplitude",
    "normal_displacement",
    "parallel_inductor",
    "peak_current",
    "power_factor",
    "read_catalogue",
    "require_allowed_voltage",
    "series_inductor",
    "stack_caveats",
    "stack_force",
    "surface_trajectory",
    "thin_conical_horn",
    "thin_exponential_horn",
    "thin_stepped_horn",
    "voltage_gain",
]
