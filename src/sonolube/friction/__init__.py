"""Friction: its laws, and what vibration makes of them."""

from sonolube.friction.coulomb import CoulombFriction, coulomb_friction, friction_coefficient
from sonolube.friction.dahl import DahlFriction, dahl_friction, dahl_friction_history
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
from sonolube.friction.models.asperity_stick_slip import mindlin_memory_length, stick_slip, stick_slip_ratio
from sonolube.friction.models.asperity_stick_slip_batch import SINE_TOLERANCE, stick_slip_ratios
from sonolube.friction.models.bristle_with_holder import Holder, coupled
from sonolube.friction.models.closures import (
    FRICTION_MODELS,
    as_published,
    kinematic,
    load_balanced,
    separating_half_period,
)
from sonolube.friction.models.dong_2015_sine import as_published_ratio, separating_half_period_ratio, steady_deformation
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
    "FRICTION_MODELS",
    "SINE_TOLERANCE",
    "ZINC_STRESS_RATIO",
    "BoundaryLubricant",
    "CoulombFriction",
    "DahlFriction",
    "DrivenSlide",
    "Holder",
    "LuGreFriction",
    "LuGreHistory",
    "Method",
    "MethodCoefficients",
    "Regime",
    "SpringContact",
    "StribeckCurve",
    "acoustic_intensity",
    "approximate_guided_ratio",
    "approximate_longitudinal_ratio",
    "approximate_oscillation_ratio",
    "approximate_transverse_ratio",
    "as_published",
    "as_published_ratio",
    "asperity_load_fraction",
    "balanced_approach",
    "best_method",
    "contact_fraction",
    "coulomb_friction",
    "coupled",
    "critical_speed",
    "dahl_friction",
    "dahl_friction_history",
    "dahl_under_vibration",
    "driven_slide",
    "elliptical_traction_ratio",
    "friction_coefficient",
    "guided_critical_speed",
    "guided_oscillation_ratio",
    "hersey_number",
    "intensity_for_stress_ratio",
    "kinematic",
    "load_balanced",
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
    "separating_half_period",
    "separating_half_period_ratio",
    "softened_stress_ratio",
    "static_plateau",
    "steady_deformation",
    "stick_slip",
    "stick_slip_ratio",
    "stick_slip_ratios",
    "stribeck_coefficient",
    "superposed_mean_stress",
    "transverse_static_ratio",
    "transverse_vibration_ratio",
]
