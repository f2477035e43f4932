from .attractor import (
    Attractors as Attractors,
    Beat as Beat,
    beat as beat,
    classify_attractor as classify_attractor,
    settling_time as settling_time,
)
from .chain import (
    GROUND as GROUND,
    Damper as Damper,
    LumpedChain as LumpedChain,
    Spring as Spring,
    chain_structure as chain_structure,
    modal_structure as modal_structure,
    pin_on_disc_chain as pin_on_disc_chain,
)
from .contact_spring import contact_resonances as contact_resonances, stiffness_at_resonance as stiffness_at_resonance
from .continuation import (
    ResponseCurve as ResponseCurve,
    reached_by_ramp as reached_by_ramp,
    response_curve as response_curve,
    solutions_at as solutions_at,
)
from .free_vibration import Backbone as Backbone, backbone as backbone
from .gap_laws.closed_form import (
    ExponentialGap as ExponentialGap,
    GapLaw as GapLaw,
    HertzGap as HertzGap,
    LinearGap as LinearGap,
    force_decay_length as force_decay_length,
)
from .gap_laws.table import GAP_LAWS as GAP_LAWS, TabulatedGap as TabulatedGap
from .kinematic_friction import FrictionAverages as FrictionAverages, friction_averages as friction_averages
from .linear import (
    Modes as Modes,
    StaticContact as StaticContact,
    equivalent_circuit as equivalent_circuit,
    modes as modes,
    poles as poles,
    static_contact as static_contact,
)
from .long_time_response import (
    LongTimeResponse as LongTimeResponse,
    march_until_settled as march_until_settled,
    settling_periods as settling_periods,
)
from .motions import (
    ContactSamples as ContactSamples,
    Envelope as Envelope,
    State as State,
    Status as Status,
    SteadyStates as SteadyStates,
    Trajectories as Trajectories,
    Trajectory as Trajectory,
    contact_motion as contact_motion,
)
from .sensitivities import (
    Sensitivities as Sensitivities,
    StructureChange as StructureChange,
    steady_state_sensitivities as steady_state_sensitivities,
)
from .steady_state_response import steady_state as steady_state
from .structure import (
    Structure as Structure,
    contact_receptance as contact_receptance,
    drive_receptance as drive_receptance,
    dynamic_stiffness as dynamic_stiffness,
    electrical_admittance as electrical_admittance,
    with_contact_spring as with_contact_spring,
)
from .transient import march as march, trajectory as trajectory
from .waveform import (
    RAMP_SHAPES as RAMP_SHAPES,
    WAVEFORMS as WAVEFORMS,
    PiecewiseLinear as PiecewiseLinear,
    Sine as Sine,
    StartUpRamp as StartUpRamp,
    Waveform as Waveform,
    drive_voltage as drive_voltage,
    fourier_coefficients as fourier_coefficients,
    jump_phases as jump_phases,
    ramp_factor as ramp_factor,
    sampled_waveform as sampled_waveform,
    waveform_extremes as waveform_extremes,
    waveform_value as waveform_value,
)
