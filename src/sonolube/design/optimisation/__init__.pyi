from .design_output import design_text as design_text
from .drive_electronics import (
    CAPACITANCE_TOLERANCE as CAPACITANCE_TOLERANCE,
    DriveElectronics as DriveElectronics,
    MatchedNetwork as MatchedNetwork,
    design_rig as design_rig,
    required_electronics as required_electronics,
    stack_admittance as stack_admittance,
)
from .evaluation import (
    CONSTRAINTS as CONSTRAINTS,
    DEFAULT_MAXIMUM_SWING as DEFAULT_MAXIMUM_SWING,
    Evaluation as Evaluation,
    estimate_swings as estimate_swings,
    evaluate as evaluate,
    maximum_swing as maximum_swing,
    refine_swing as refine_swing,
)
from .gradient_search import (
    DesignPoint as DesignPoint,
    design_point_at as design_point_at,
    local_search as local_search,
    swing_sensitivities as swing_sensitivities,
)
from .optimum import (
    Optimum as Optimum,
    epsilon_bounds as epsilon_bounds,
    epsilon_constraint_front as epsilon_constraint_front,
    non_dominated as non_dominated,
    optimise as optimise,
)
from .requirements import (
    NOMINAL as NOMINAL,
    OBJECTIVES as OBJECTIVES,
    Aim as Aim,
    Deviation as Deviation,
    HalfWaveHorn as HalfWaveHorn,
    Limits as Limits,
    Tolerance as Tolerance,
    deviations as deviations,
    worst_or_quantile as worst_or_quantile,
)
from .screening import (
    DesignProblem as DesignProblem,
    ScreeningResult as ScreeningResult,
    enumerate_candidates as enumerate_candidates,
    evaluate_candidate as evaluate_candidate,
    evaluate_with_tolerance as evaluate_with_tolerance,
    screen as screen,
)
from .space import (
    OWN_ACTUATOR as OWN_ACTUATOR,
    Candidate as Candidate,
    DesignSpace as DesignSpace,
    candidate_rig as candidate_rig,
    candidate_stack as candidate_stack,
    candidate_structure as candidate_structure,
)
