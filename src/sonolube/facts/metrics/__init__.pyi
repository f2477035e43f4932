from .efficiency import (
    EfficiencyLine as EfficiencyLine,
    efficiency_at as efficiency_at,
    efficiency_coefficient as efficiency_coefficient,
    friction_at_power as friction_at_power,
    power_for_friction as power_for_friction,
)
from .efficiency_fit import (
    MINIMUM_RUNS as MINIMUM_RUNS,
    EfficiencyFit as EfficiencyFit,
    PowerEstimate as PowerEstimate,
    efficiency_confidence_band as efficiency_confidence_band,
    efficiency_prediction_band as efficiency_prediction_band,
    fit_efficiency as fit_efficiency,
    power_estimate as power_estimate,
    require_fitted_speed as require_fitted_speed,
)
from .kinematics import (
    dot_spacing as dot_spacing,
    friction_reduction as friction_reduction,
    indentation_spacing as indentation_spacing,
    linear_speed as linear_speed,
    peak_vibration_velocity as peak_vibration_velocity,
    sliding_distance as sliding_distance,
    superimposed_speed as superimposed_speed,
    wear_rate as wear_rate,
    wear_reduction as wear_reduction,
)
from .motor import (
    DCMotor as DCMotor,
    friction_from_current as friction_from_current,
    motor_current_under_friction as motor_current_under_friction,
    motor_from_two_operating_points as motor_from_two_operating_points,
    motor_speed as motor_speed,
)
