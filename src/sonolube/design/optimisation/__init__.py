"""Optimisation: which actuator, frequency, waveform and masses give a friction for the least power, heat or voltage."""

from sonolube.design.optimisation.assessment import CONSTRAINTS, Assessment, assess
from sonolube.design.optimisation.electrical import (
    CAPACITANCE_TOLERANCE,
    Electrical,
    Matched,
    admittance_of,
    design_rig,
    electrical,
)
from sonolube.design.optimisation.local_search import Point, descended, point_at, tangent
from sonolube.design.optimisation.optimum import Optimum, optimise
from sonolube.design.optimisation.pareto import bounds_between, epsilon_front, non_dominated
from sonolube.design.optimisation.requirements import OBJECTIVES, Horn, Limits
from sonolube.design.optimisation.rig_text import design_text
from sonolube.design.optimisation.screening import Landscape, Task, choices_of, looked_over, of_choice, worst_of
from sonolube.design.optimisation.space import OWN, Choice, DesignSpace, rig_of, stack_of, structure_of
from sonolube.design.optimisation.target import HIGHEST_SWING, exact_swing, highest_swing, swings_for_ratio
from sonolube.design.optimisation.tolerance import NOMINAL, Deviation, Tolerance, deviations, over_deviations

__all__ = [
    "CAPACITANCE_TOLERANCE",
    "CONSTRAINTS",
    "HIGHEST_SWING",
    "NOMINAL",
    "OBJECTIVES",
    "OWN",
    "Assessment",
    "Choice",
    "DesignSpace",
    "Deviation",
    "Electrical",
    "Horn",
    "Landscape",
    "Limits",
    "Matched",
    "Optimum",
    "Point",
    "Task",
    "Tolerance",
    "admittance_of",
    "assess",
    "bounds_between",
    "choices_of",
    "descended",
    "design_rig",
    "design_text",
    "deviations",
    "electrical",
    "epsilon_front",
    "exact_swing",
    "highest_swing",
    "looked_over",
    "non_dominated",
    "of_choice",
    "optimise",
    "over_deviations",
    "point_at",
    "rig_of",
    "stack_of",
    "structure_of",
    "swings_for_ratio",
    "tangent",
    "worst_of",
]
