"""Dynamics of a structure vibrating against its contact: steady states, transients, stability, friction averages."""

from sonolube.dynamics.attractor import Attractors, Beat, beat, classify_attractor, settling_time
from sonolube.dynamics.backend import Backend
from sonolube.dynamics.chain import (
    GROUND,
    Damper,
    LumpedChain,
    Spring,
    chain_structure,
    modal_structure,
    pin_on_disc_chain,
)
from sonolube.dynamics.continuation import ResponseCurve, reached_by_ramp, response_curve, solutions_at
from sonolube.dynamics.gap_laws.exponential import ExponentialGap
from sonolube.dynamics.gap_laws.hertz import HertzGap
from sonolube.dynamics.gap_laws.linear import LinearGap
from sonolube.dynamics.gap_laws.protocol import GapLaw, force_decay_length
from sonolube.dynamics.gap_laws.table import GAP_LAWS
from sonolube.dynamics.gap_laws.tabulated import TabulatedGap
from sonolube.dynamics.kinematic_friction import FrictionAverages, friction_averages, steady_friction
from sonolube.dynamics.linear import (
    Modes,
    StaticContact,
    equivalent_circuit,
    modes,
    poles,
    resonance_frequencies,
    static_contact,
)
from sonolube.dynamics.long_time_response import LongTimeResponse, march_until_settled, settling_periods
from sonolube.dynamics.sensitivities import Sensitivities, StructureChange, steady_state_sensitivities
from sonolube.dynamics.stability import floquet_multipliers
from sonolube.dynamics.steady_state_response import steady_state
from sonolube.dynamics.steady_states import Status, SteadyStates, contact_motion
from sonolube.dynamics.structure import (
    Structure,
    contact_receptance,
    drive_receptance,
    dynamic_stiffness,
    electrical_admittance,
    with_contact_spring,
)
from sonolube.dynamics.trajectories import (
    ContactMotion,
    Envelope,
    State,
    Trajectories,
    Trajectory,
    displacement_harmonics,
)
from sonolube.dynamics.transient import march, trajectory
from sonolube.dynamics.waveform import (
    RAMP_SHAPES,
    WAVEFORMS,
    PiecewiseLinear,
    Sine,
    StartUpRamp,
    Waveform,
    drive_voltage,
    fourier_coefficients,
    jump_phases,
    ramp_factor,
    sampled_waveform,
    waveform_extremes,
    waveform_value,
)

__all__ = [
    "GAP_LAWS",
    "GROUND",
    "RAMP_SHAPES",
    "WAVEFORMS",
    "Attractors",
    "Backend",
    "Beat",
    "ContactMotion",
    "Damper",
    "Envelope",
    "ExponentialGap",
    "FrictionAverages",
    "GapLaw",
    "HertzGap",
    "LinearGap",
    "LongTimeResponse",
    "LumpedChain",
    "Modes",
    "PiecewiseLinear",
    "ResponseCurve",
    "Sensitivities",
    "Sine",
    "Spring",
    "StartUpRamp",
    "State",
    "StaticContact",
    "Status",
    "SteadyStates",
    "Structure",
    "StructureChange",
    "TabulatedGap",
    "Trajectories",
    "Trajectory",
    "Waveform",
    "beat",
    "chain_structure",
    "classify_attractor",
    "contact_motion",
    "contact_receptance",
    "displacement_harmonics",
    "drive_receptance",
    "drive_voltage",
    "dynamic_stiffness",
    "electrical_admittance",
    "equivalent_circuit",
    "floquet_multipliers",
    "force_decay_length",
    "fourier_coefficients",
    "friction_averages",
    "jump_phases",
    "march",
    "march_until_settled",
    "modal_structure",
    "modes",
    "pin_on_disc_chain",
    "poles",
    "ramp_factor",
    "reached_by_ramp",
    "resonance_frequencies",
    "response_curve",
    "sampled_waveform",
    "settling_periods",
    "settling_time",
    "solutions_at",
    "static_contact",
    "steady_friction",
    "steady_state",
    "steady_state_sensitivities",
    "trajectory",
    "waveform_extremes",
    "waveform_value",
    "with_contact_spring",
]
