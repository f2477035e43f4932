"""Optimisation of a rig: actuator, frequency, waveform and structure for a target friction at minimum power or heat."""

from sonolube.design.optimisation.drive_electronics import (
    CAPACITANCE_TOLERANCE,
    DriveElectronics,
    MatchedNetwork,
    design_rig,
    required_electronics,
    stack_admittance,
)
from sonolube.design.optimisation.evaluation import CONSTRAINTS, Evaluation, evaluate
from sonolube.design.optimisation.gradient_search import DesignPoint, design_point_at, local_search, swing_sensitivities
from sonolube.design.optimisation.optimum import Optimum, optimise
from sonolube.design.optimisation.pareto import epsilon_bounds, epsilon_constraint_front, non_dominated
from sonolube.design.optimisation.required_voltage import (
    DEFAULT_MAXIMUM_SWING,
    estimate_swings,
    maximum_swing,
    refine_swing,
)
from sonolube.design.optimisation.requirements import OBJECTIVES, HalfWaveHorn, Limits
from sonolube.design.optimisation.rig_text import design_text
from sonolube.design.optimisation.screening import (
    DesignProblem,
    ScreeningResult,
    enumerate_candidates,
    evaluate_candidate,
    evaluate_with_tolerance,
    screen,
)
from sonolube.design.optimisation.space import (
    OWN_ACTUATOR,
    Candidate,
    DesignSpace,
    candidate_rig,
    candidate_stack,
    candidate_structure,
)
from sonolube.design.optimisation.tolerance import NOMINAL, Deviation, Tolerance, deviations, worst_or_quantile

__all__ = [
    "CAPACITANCE_TOLERANCE",
    "CONSTRAINTS",
    "DEFAULT_MAXIMUM_SWING",
    "NOMINAL",
    "OBJECTIVES",
    "OWN_ACTUATOR",
    "Candidate",
    "DesignPoint",
    "DesignProblem",
    "DesignSpace",
    "Deviation",
    "DriveElectronics",
    "Evaluation",
    "HalfWaveHorn",
    "Limits",
    "MatchedNetwork",
    "Optimum",
    "ScreeningResult",
    "Tolerance",
    "candidate_rig",
    "candidate_stack",
    "candidate_structure",
    "design_point_at",
    "design_rig",
    "design_text",
    "deviations",
    "enumerate_candidates",
    "epsilon_bounds",
    "epsilon_constraint_front",
    "estimate_swings",
    "evaluate",
    "evaluate_candidate",
    "evaluate_with_tolerance",
    "local_search",
    "maximum_swing",
    "non_dominated",
    "optimise",
    "refine_swing",
    "required_electronics",
    "screen",
    "stack_admittance",
    "swing_sensitivities",
    "worst_or_quantile",
]
