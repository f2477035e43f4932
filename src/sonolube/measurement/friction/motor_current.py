"""Friction forces of a test: their reduction with its uncertainty, and friction told by the motor's current."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.measurement.statistics.autocorrelation import correlated_mean
from sonolube.metrics import friction_from_current, friction_reduction


@dataclass(frozen=True, kw_only=True, slots=True)
class FrictionReductionEstimate:
    """How much friction a vibration takes away, and how well that is known.

    Parameters
    ----------
    friction_reduction : float
        Share of the friction taken away. []
    friction_reduction_uncertainty : float
        Its standard uncertainty. []
    intrinsic_friction_force : float
        Mean without vibration. [N]
    intrinsic_friction_force_uncertainty : float
        Its standard error. [N]
    reduced_friction_force : float
        Mean with vibration. [N]
    reduced_friction_force_uncertainty : float
        Its standard error. [N]
    """

    friction_reduction: float
    friction_reduction_uncertainty: float
    intrinsic_friction_force: float
    intrinsic_friction_force_uncertainty: float
    reduced_friction_force: float
    reduced_friction_force_uncertainty: float


def estimate_friction_reduction(
    *, intrinsic_friction_force: ArrayLike, reduced_friction_force: ArrayLike
) -> FrictionReductionEstimate:
    """Return the friction reduction between two stretches of a recording.

    Parameters
    ----------
    intrinsic_friction_force : array_like, shape (samples,)
        Evenly spaced samples without vibration; NaN is passed over. [N]
    reduced_friction_force : array_like, shape (samples,)
        Evenly spaced samples with vibration; NaN is passed over. [N]

    Returns
    -------
    ReductionEstimate

    Raises
    ------
    InvalidInput
        If a stretch holds fewer than two values, or the mean without vibration is not positive.

    Notes
    -----
    To first order, u^2 = (u1/F0)^2 + (F1 u0/F0^2)^2, the errors of the means heeding the correlation of the samples.
    Good while u0/F0 is below a tenth; `comparison.ratio_interval` needs no such limit.

    References
    ----------
    .. [1] D 2.1.
    """
    off, on = correlated_mean(intrinsic_friction_force), correlated_mean(reduced_friction_force)
    reduction = friction_reduction(intrinsic_friction_force=off.mean, reduced_friction_force=on.mean)
    return FrictionReductionEstimate(
        friction_reduction=float(reduction),
        friction_reduction_uncertainty=float(
            np.hypot(on.uncertainty / off.mean, on.mean * off.uncertainty / off.mean**2)
        ),
        intrinsic_friction_force=off.mean,
        intrinsic_friction_force_uncertainty=off.uncertainty,
        reduced_friction_force=on.mean,
        reduced_friction_force_uncertainty=on.uncertainty,
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class MotorCalibration:
    """What is known of a motor that drives a disc against friction.

    Parameters
    ----------
    torque_constant : float
        Torque at the disc per current, gears included. [N m/A]
    idle_current : float
        Current at the same speed with the pin lifted. [A]
    groove_diameter : float
        Diameter of the circle under the pin. [m]
    torque_constant_uncertainty : float
        Standard uncertainty. [N m/A]
    idle_current_uncertainty : float
        Standard uncertainty. [A]

    Raises
    ------
    InvalidInput
        If the torque constant or the diameter is not positive, or another value negative.
    """

    torque_constant: float
    idle_current: float
    groove_diameter: float
    torque_constant_uncertainty: float = 0.0
    idle_current_uncertainty: float = 0.0

    def __post_init__(self) -> None:
        require_positive(torque_constant=self.torque_constant, groove_diameter=self.groove_diameter)
        require_non_negative(
            idle_current=self.idle_current,
            torque_constant_uncertainty=self.torque_constant_uncertainty,
            idle_current_uncertainty=self.idle_current_uncertainty,
        )


def friction_from_motor_current(motor: MotorCalibration, *, motor_current: ArrayLike) -> Floats:
    """Return the friction force that a motor's current tells at steady speed. [N]

    Parameters
    ----------
    motor : MotorCalibration
    motor_current : array_like, any shape
        Current of the motor. [A]

    Returns
    -------
    ndarray, shape of `motor_current`
        Negative below the no-load current.

    Raises
    ------
    InvalidInput
        If a current is not finite.

    Notes
    -----
    F = K_T (I - I_0)/(D_g/2). Only while the disc keeps its speed: an accelerating disc takes current of its own, and
    the no-load current belongs to one speed.

    References
    ----------
    .. [1] D 2.4.4, where the motor's current falls by 0.4 A with the friction.
    """
    return friction_from_current(
        torque_constant=motor.torque_constant,
        motor_current=motor_current,
        idle_current=motor.idle_current,
        groove_diameter=motor.groove_diameter,
    )


def motor_friction_uncertainty(
    motor: MotorCalibration, *, motor_current: ArrayLike, motor_current_uncertainty: ArrayLike = 0.0
) -> Floats:
    """Return the standard uncertainty of the friction force that a motor's current tells. [N]

    Parameters
    ----------
    motor : MotorCalibration
    motor_current : array_like, any shape
        Current of the motor. [A]
    motor_current_uncertainty : array_like, broadcast against `motor_current`
        Its standard uncertainty. [A]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a current is not finite, or an uncertainty negative.
    """
    current = require_finite(motor_current=motor_current)
    of_currents = np.hypot(
        require_non_negative(motor_current_uncertainty=motor_current_uncertainty), motor.idle_current_uncertainty
    )
    torque = np.hypot(
        motor.torque_constant * of_currents,
        motor.torque_constant_uncertainty * (current - motor.idle_current),
    )
    return np.asarray(torque / (motor.groove_diameter / 2))
