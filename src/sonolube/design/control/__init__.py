"""Friction control: controllers of the friction force, tuned for a rig, simulated in closed loop and exported as C."""

from sonolube.design.control.amplifier import Amplifier, active_limit, swing_limit
from sonolube.design.control.closed_loop_simulation import (
    ClosedLoopRun,
    Disturbance,
    FrictionLoop,
    ThermalDrift,
    simulate_closed_loop,
)
from sonolube.design.control.control_design import FEED_FORWARD, ControlDesign, ControlSettings, design_control
from sonolube.design.control.controller import (
    ControllerState,
    FrictionController,
    initial_state,
    next_voltage,
    tuned_controller,
)
from sonolube.design.control.export import controller_source, lookup_table
from sonolube.design.control.friction_characteristic import (
    FrictionCharacteristic,
    computed_characteristic,
    efficiency_characteristic,
    friction_at_voltage,
    linear_characteristic,
    voltage_for_friction,
)
from sonolube.design.control.performance import (
    ControlEnergy,
    StepResponseMetrics,
    control_energy,
    step_response_metrics,
)
from sonolube.design.control.process import (
    PIGains,
    Process,
    StabilityMargins,
    open_loop_response,
    simc_gains,
    stability_margins,
)
from sonolube.design.control.resonance_tracking import FrequencyTracker, next_frequency, tuned_tracker
from sonolube.design.control.stick_slip_oscillator import (
    MassOnBelt,
    StickSlipMotion,
    kinetic_friction,
    mass_on_belt,
    steady_sliding_damping,
    stick_slip_motion,
)
from sonolube.design.control.vibration_envelope import (
    VibrationMode,
    assumed_mode,
    capture_limit,
    impedance_phase,
    measured_phase,
    mode_admittance,
    mode_at_drive,
    next_envelope,
)

__all__ = [
    "FEED_FORWARD",
    "Amplifier",
    "ClosedLoopRun",
    "ControlDesign",
    "ControlEnergy",
    "ControlSettings",
    "ControllerState",
    "Disturbance",
    "FrequencyTracker",
    "FrictionCharacteristic",
    "FrictionController",
    "FrictionLoop",
    "MassOnBelt",
    "PIGains",
    "Process",
    "StabilityMargins",
    "StepResponseMetrics",
    "StickSlipMotion",
    "ThermalDrift",
    "VibrationMode",
    "active_limit",
    "assumed_mode",
    "capture_limit",
    "computed_characteristic",
    "control_energy",
    "controller_source",
    "design_control",
    "efficiency_characteristic",
    "friction_at_voltage",
    "impedance_phase",
    "initial_state",
    "kinetic_friction",
    "linear_characteristic",
    "lookup_table",
    "mass_on_belt",
    "measured_phase",
    "mode_admittance",
    "mode_at_drive",
    "next_envelope",
    "next_frequency",
    "next_voltage",
    "open_loop_response",
    "simc_gains",
    "simulate_closed_loop",
    "stability_margins",
    "steady_sliding_damping",
    "step_response_metrics",
    "stick_slip_motion",
    "swing_limit",
    "tuned_controller",
    "tuned_tracker",
    "voltage_for_friction",
]
