"""Friction laws, friction under vibration, and friction models of vibrated rough contacts."""

from sonolube.friction.bristle import RIGID, Holder
from sonolube.friction.elliptical_motion import contact_time_fraction, elliptical_traction_ratio
from sonolube.friction.laws.coulomb import CoulombFriction, coulomb_friction, friction_coefficient
from sonolube.friction.laws.coulomb_under_vibration import (
    oblique_vibration_ratio,
    parallel_vibration_ratio,
    transverse_vibration_ratio,
)
from sonolube.friction.laws.dahl import DahlFriction, dahl_friction, dahl_friction_history
from sonolube.friction.laws.dahl_under_vibration import dahl_under_vibration
from sonolube.friction.laws.lugre import LuGreFriction, LuGreHistory, lugre_friction_history, lugre_steady_friction
from sonolube.friction.laws.lugre_under_vibration import lugre_under_vibration
from sonolube.friction.laws.spring_driven_slider import DriveForce, spring_driven_slider_force
from sonolube.friction.lubrication import (
    BoundaryLubricant,
    LubricationCoefficients,
    LubricationMethod,
    LubricationRegime,
    StribeckCurve,
    asperity_load_fraction,
    best_lubrication_method,
    hersey_number,
    lubrication_coefficients,
    lubrication_regime,
    stribeck_coefficient,
)
from sonolube.friction.metal_forming import (
    ZINC_STRESS_RATIO,
    acoustic_intensity,
    acoustic_softening_ratio,
    reference_intensity_from_test,
    superposed_mean_stress,
)
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
from sonolube.friction.models.dong_2015_sine import (
    dong_2015_deformation_ratio,
    dong_2015_half_period_ratio,
    steady_deformation,
)
from sonolube.friction.models.kinematic import Kinematic
from sonolube.friction.oscillating_contact.approximations import (
    approximate_guided_ratio,
    approximate_longitudinal_ratio,
    approximate_normal_ratio,
    approximate_transverse_ratio,
)
from sonolube.friction.oscillating_contact.combined_oscillation import combined_oscillation_ratio
from sonolube.friction.oscillating_contact.compliant_guide import guided_critical_speed, guided_oscillation_ratio
from sonolube.friction.oscillating_contact.rigid_guide import longitudinal_oscillation_ratio, normal_oscillation_ratio
from sonolube.friction.oscillating_contact.spring_contact import SpringContact, critical_speed, load_balanced_approach
from sonolube.friction.oscillating_contact.static_friction import (
    longitudinal_static_ratio,
    normal_static_ratio,
    transverse_static_ratio,
)
from sonolube.friction.soft_counterface import FaceVibrationMode, exponential_layer_ratio, linear_layer_ratio

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
    "DriveForce",
    "FaceVibrationMode",
    "FrictionModel",
    "Holder",
    "Kinematic",
    "LuGreFriction",
    "LuGreHistory",
    "LubricationCoefficients",
    "LubricationMethod",
    "LubricationRegime",
    "MeanGap",
    "ModelParameter",
    "SpringContact",
    "StribeckCurve",
    "acoustic_intensity",
    "acoustic_softening_ratio",
    "approximate_guided_ratio",
    "approximate_longitudinal_ratio",
    "approximate_normal_ratio",
    "approximate_transverse_ratio",
    "asperity_load_fraction",
    "batched_stick_slip_ratio",
    "best_lubrication_method",
    "combined_oscillation_ratio",
    "contact_time_fraction",
    "coulomb_friction",
    "critical_speed",
    "dahl_friction",
    "dahl_friction_history",
    "dahl_under_vibration",
    "dong_2015_deformation_ratio",
    "dong_2015_half_period_ratio",
    "elliptical_traction_ratio",
    "exponential_layer_ratio",
    "friction_coefficient",
    "guided_critical_speed",
    "guided_oscillation_ratio",
    "hersey_number",
    "linear_layer_ratio",
    "load_balanced_approach",
    "longitudinal_oscillation_ratio",
    "longitudinal_static_ratio",
    "lubrication_coefficients",
    "lubrication_regime",
    "lugre_friction_history",
    "lugre_steady_friction",
    "lugre_under_vibration",
    "mindlin_memory_length",
    "normal_oscillation_ratio",
    "normal_static_ratio",
    "oblique_vibration_ratio",
    "parallel_vibration_ratio",
    "parameter",
    "reference_intensity_from_test",
    "sine_stick_slip_ratio",
    "spring_driven_slider_force",
    "steady_deformation",
    "stribeck_coefficient",
    "superposed_mean_stress",
    "transverse_static_ratio",
    "transverse_vibration_ratio",
]
