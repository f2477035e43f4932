"""Friction as a commanded quantity: controllers tuned for a rig, run against it, and exported."""

from sonolube.design.control.amplifier import Amplifier, largest_swing, limiting
from sonolube.design.control.closed_loop import ControlRun, Disturbance, Drift, FrictionLoop, closed_loop
from sonolube.design.control.control_design import FEED_FORWARD, ControlSettings, ControlStudy, control_study
from sonolube.design.control.controller import (
    ControllerState,
    FrictionController,
    at_rest,
    designed_controller,
    next_voltage,
)
from sonolube.design.control.export import controller_source, lookup_table
from sonolube.design.control.friction_map import (
    FrictionMap,
    efficiency_map,
    friction_at,
    linear_map,
    modelled_map,
    voltage_for,
)
from sonolube.design.control.mass_on_belt import (
    DraggedMass,
    DraggedMotion,
    dragged_mass,
    dragged_motion,
    kinetic_friction,
    steady_sliding_damping,
)
from sonolube.design.control.process import Margins, PIGains, Process, loop_margins, loop_response, simc_gains
from sonolube.design.control.step_response import ControlEnergy, StepResponse, control_energy, step_response
from sonolube.design.control.tracking import FrequencyTracker, designed_tracker, next_frequency
from sonolube.design.control.vibration import (
    VibrationMode,
    capture_edge,
    driven_mode,
    impedance_phase,
    mode_admittance,
    next_envelope,
    sensed_phase,
    supposed_mode,
)

__all__ = [
    "FEED_FORWARD",
    "Amplifier",
    "ControlEnergy",
    "ControlRun",
    "ControlSettings",
    "ControlStudy",
    "ControllerState",
    "Disturbance",
    "DraggedMass",
    "DraggedMotion",
    "Drift",
    "FrequencyTracker",
    "FrictionController",
    "FrictionLoop",
    "FrictionMap",
    "Margins",
    "PIGains",
    "Process",
    "StepResponse",
    "VibrationMode",
    "at_rest",
    "capture_edge",
    "closed_loop",
    "control_energy",
    "control_study",
    "controller_source",
    "designed_controller",
    "designed_tracker",
    "dragged_mass",
    "dragged_motion",
    "driven_mode",
    "efficiency_map",
    "friction_at",
    "impedance_phase",
    "kinetic_friction",
    "largest_swing",
    "limiting",
    "linear_map",
    "lookup_table",
    "loop_margins",
    "loop_response",
    "mode_admittance",
    "modelled_map",
    "next_envelope",
    "next_frequency",
    "next_voltage",
    "sensed_phase",
    "simc_gains",
    "steady_sliding_damping",
    "step_response",
    "supposed_mode",
    "voltage_for",
]
