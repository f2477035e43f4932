"""Measures of experiments on ultrasonic lubrication: reductions, kinematics, efficiency and motor friction."""

from sonolube.metrics.efficiency import (
    EfficiencyLine,
    efficiency_at,
    efficiency_coefficient,
    friction_at_power,
    power_for_friction,
)
from sonolube.metrics.efficiency_fit import (
    MINIMUM_RUNS,
    EfficiencyFit,
    PowerEstimate,
    efficiency_confidence_band,
    efficiency_prediction_band,
    fit_efficiency,
    power_estimate,
    require_fitted_speed,
)
from sonolube.metrics.kinematics import (
    dot_spacing,
    indentation_spacing,
    linear_speed,
    peak_vibration_velocity,
    sliding_distance,
    superimposed_speed,
)
from sonolube.metrics.motor import (
    DCMotor,
    friction_from_current,
    motor_current_under_friction,
    motor_from_two_operating_points,
    motor_speed,
)
from sonolube.metrics.reduction import friction_reduction, wear_rate, wear_reduction

__all__ = [
    "MINIMUM_RUNS",
    "DCMotor",
    "EfficiencyFit",
    "EfficiencyLine",
    "PowerEstimate",
    "dot_spacing",
    "efficiency_at",
    "efficiency_coefficient",
    "efficiency_confidence_band",
    "efficiency_prediction_band",
    "fit_efficiency",
    "friction_at_power",
    "friction_from_current",
    "friction_reduction",
    "indentation_spacing",
    "linear_speed",
    "motor_current_under_friction",
    "motor_from_two_operating_points",
    "motor_speed",
    "peak_vibration_velocity",
    "power_estimate",
    "power_for_friction",
    "require_fitted_speed",
    "sliding_distance",
    "superimposed_speed",
    "wear_rate",
    "wear_reduction",
]
