"""Measures by which experiments on ultrasonic lubrication are compared."""

from sonolube.metrics.efficiency import (
    EfficiencyLine,
    efficiency_at,
    efficiency_coefficient,
    friction_at_power,
    power_for_friction,
)
from sonolube.metrics.efficiency_fit import (
    FEWEST_RUNS,
    EfficiencyFit,
    PowerEstimate,
    efficiency_band,
    fit_efficiency,
    power_estimate,
    prediction_band,
    require_covered,
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
    current_under_friction,
    friction_from_current,
    motor_from_two_states,
    motor_speed,
)
from sonolube.metrics.reduction import friction_reduction, wear_rate, wear_reduction

__all__ = [
    "FEWEST_RUNS",
    "DCMotor",
    "EfficiencyFit",
    "EfficiencyLine",
    "PowerEstimate",
    "current_under_friction",
    "dot_spacing",
    "efficiency_at",
    "efficiency_band",
    "efficiency_coefficient",
    "fit_efficiency",
    "friction_at_power",
    "friction_from_current",
    "friction_reduction",
    "indentation_spacing",
    "linear_speed",
    "motor_from_two_states",
    "motor_speed",
    "peak_vibration_velocity",
    "power_estimate",
    "power_for_friction",
    "prediction_band",
    "require_covered",
    "sliding_distance",
    "superimposed_speed",
    "wear_rate",
    "wear_reduction",
]
