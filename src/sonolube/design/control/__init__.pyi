from .closed_loop_simulation import (
    ClosedLoopRun as ClosedLoopRun,
    Disturbance as Disturbance,
    FrictionLoop as FrictionLoop,
    ThermalDrift as ThermalDrift,
    simulate_closed_loop as simulate_closed_loop,
)
from .control_design import (
    FEED_FORWARD as FEED_FORWARD,
    ControlDesign as ControlDesign,
    ControlSettings as ControlSettings,
    design_control as design_control,
)
from .controller import (
    ControllerState as ControllerState,
    FrictionController as FrictionController,
    controller_source as controller_source,
    initial_state as initial_state,
    lookup_table as lookup_table,
    next_level as next_level,
    tuned_controller as tuned_controller,
)
from .friction_characteristic import (
    FrictionCharacteristic as FrictionCharacteristic,
    computed_characteristic as computed_characteristic,
    efficiency_characteristic as efficiency_characteristic,
    friction_at_level as friction_at_level,
    level_for_friction as level_for_friction,
    linear_characteristic as linear_characteristic,
    predicted_characteristic as predicted_characteristic,
)
from .performance import (
    ControlEnergy as ControlEnergy,
    StepResponseMetrics as StepResponseMetrics,
    control_energy as control_energy,
    step_response_metrics as step_response_metrics,
)
from .predicted_loop import (
    CautiousTuning as CautiousTuning,
    PosteriorLoop as PosteriorLoop,
    margins_at_gain as margins_at_gain,
    posterior_loop as posterior_loop,
)
from .process import (
    PIGains as PIGains,
    Process as Process,
    StabilityMargins as StabilityMargins,
    open_loop_response as open_loop_response,
    simc_gains as simc_gains,
    stability_margins as stability_margins,
)
from .rejection import DisturbanceRejection as DisturbanceRejection, disturbance_rejection as disturbance_rejection
from .resonance_tracking import (
    Amplifier as Amplifier,
    FrequencyTracker as FrequencyTracker,
    active_limit as active_limit,
    next_frequency as next_frequency,
    swing_limit as swing_limit,
    tuned_tracker as tuned_tracker,
)
from .stick_slip_oscillator import (
    MassOnBelt as MassOnBelt,
    StickSlipMotion as StickSlipMotion,
    kinetic_friction as kinetic_friction,
    mass_on_belt as mass_on_belt,
    steady_sliding_damping as steady_sliding_damping,
    stick_slip_motion as stick_slip_motion,
)
from .vibration_envelope import (
    VibrationMode as VibrationMode,
    amplitude_mode as amplitude_mode,
    assumed_mode as assumed_mode,
    capture_limit as capture_limit,
    impedance_phase as impedance_phase,
    measured_phase as measured_phase,
    mode_admittance as mode_admittance,
    mode_at_drive as mode_at_drive,
    next_envelope as next_envelope,
)
