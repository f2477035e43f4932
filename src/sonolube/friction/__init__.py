"""Friction laws, and friction under vibration by prescribed motions, spring-coupled contacts and friction models."""

from sonolube.friction.bristle import RIGID, Holder
from sonolube.friction.coulomb import CoulombFriction, coulomb_friction, friction_coefficient
from sonolube.friction.dahl import DahlFriction, dahl_friction, dahl_friction_history
from sonolube.friction.dong_2015_sine import (
    dong_2015_deformation_ratio,
    dong_2015_half_period_ratio,
    steady_deformation,
)
from sonolube.friction.driven import DrivenSlide, driven_slide
from sonolube.friction.elliptical import contact_fraction, elliptical_traction_ratio
from sonolube.friction.forming import (
    ZINC_STRESS_RATIO,
    acoustic_intensity,
    intensity_for_stress_ratio,
    softened_stress_ratio,
    superposed_mean_stress,
)
from sonolube.friction.in_plane import oblique_vibration_ratio, parallel_vibration_ratio, transverse_vibration_ratio
from sonolube.friction.lubrication import (
    BoundaryLubricant,
    Method,
    MethodCoefficients,
    Regime,
    StribeckCurve,
    asperity_load_fraction,
    best_method,
    hersey_number,
    lubrication_regime,
    method_coefficients,
    stribeck_coefficient,
)
from sonolube.friction.lugre import LuGreFriction, LuGreHistory, lugre_friction_history, lugre_steady_friction
from sonolube.friction.models import FRICTION_MODELS, FrictionModel, MeanGap, ModelParameter, parameter
from sonolube.friction.models.asperity_stick_slip import AsperityStickSlip
from sonolube.friction.models.asperity_stick_slip_batch import SINE_TOLERANCE, batched_stick_slip_ratio
from sonolube.friction.models.asperity_stick_slip_sine import (
    EMPIRICAL_MEMORY_LENGTH,
    mindlin_memory_length,
    sine_stick_slip_ratio,
)
from sonolube.friction.models.bristle_with_holder import BristleWithHolder
from sonolube.friction.models.dong_2015 import Dong2015FullPeriod, Dong2015HalfPeriod, Dong2015LoadBalanced
from sonolube.friction.models.kinematic import Kinematic
from sonolube.friction.published_approximations import (
    approximate_guided_ratio,
    approximate_longitudinal_ratio,
    approximate_oscillation_ratio,
    approximate_transverse_ratio,
    longitudinal_static_ratio,
    transverse_static_ratio,
)
from sonolube.friction.spring_coupled import (
    SpringContact,
    balanced_approach,
    critical_speed,
    longitudinal_oscillation_ratio,
    normal_oscillation_ratio,
    static_plateau,
)
from sonolube.friction.spring_motion import guided_critical_speed, guided_oscillation_ratio, oscillation_ratio
from sonolube.friction.vibrated_dahl import dahl_under_vibration
from sonolube.friction.vibrated_lugre import lugre_under_vibration

__all__ = [
    "EMPIRICAL_MEMORY_LENGTH",
    "FRICTION_MODELS",
    "RIGID",
    "SINE_TOLERANCE",
    "ZINC_STRESS_RATIO",
    "AsperityStickSlip",
    "BoundaryLubricant",
    "BristleWithHolder",
    "CoulombFriction",
    "DahlFriction",
    "Dong2015FullPeriod",
    "Dong2015HalfPeriod",
    "Dong2015LoadBalanced",
    "DrivenSlide",
    "FrictionModel",
    "Holder",
    "Kinematic",
    "LuGreFriction",
    "LuGreHistory",
    "MeanGap",
    "Method",
    "MethodCoefficients",
    "ModelParameter",
    "Regime",
    "SpringContact",
    "StribeckCurve",
    "acoustic_intensity",
    "approximate_guided_ratio",
    "approximate_longitudinal_ratio",
    "approximate_oscillation_ratio",
    "approximate_transverse_ratio",
    "asperity_load_fraction",
    "balanced_approach",
    "batched_stick_slip_ratio",
    "best_method",
    "contact_fraction",
    "coulomb_friction",
    "critical_speed",
    "dahl_friction",
    "dahl_friction_history",
    "dahl_under_vibration",
    "dong_2015_deformation_ratio",
    "dong_2015_half_period_ratio",
    "driven_slide",
    "elliptical_traction_ratio",
    "friction_coefficient",
    "guided_critical_speed",
    "guided_oscillation_ratio",
    "hersey_number",
    "intensity_for_stress_ratio",
    "longitudinal_oscillation_ratio",
    "longitudinal_static_ratio",
    "lubrication_regime",
    "lugre_friction_history",
    "lugre_steady_friction",
    "lugre_under_vibration",
    "method_coefficients",
    "mindlin_memory_length",
    "normal_oscillation_ratio",
    "oblique_vibration_ratio",
    "oscillation_ratio",
    "parallel_vibration_ratio",
    "parameter",
    "sine_stick_slip_ratio",
    "softened_stress_ratio",
    "static_plateau",
    "steady_deformation",
    "stribeck_coefficient",
    "superposed_mean_stress",
    "transverse_static_ratio",
    "transverse_vibration_ratio",
]
