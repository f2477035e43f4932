"""Friction force from the current of the motor that drives the disc, with its uncertainty."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.facts.metrics import friction_from_current


@dataclass(frozen=True, kw_only=True, slots=True)
class MotorCalibration:
    """Torque constant and idle current of the motor that drives a disc, with their uncertainties.

    Parameters
    ----------
    torque_constant : float
        Torque at the disc per current, gear included. [N m/A]
    idle_current : float
        Current at the same speed with the pin lifted. [A]
    groove_diameter : float
        Diameter of the wear track under the pin. [m]
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


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class MotorFrictionTrace:
    """Friction force over time from the motor current.

    Parameters
    ----------
    time : ndarray, shape (windows,)
        Middle of each window. [s]
    friction_force : ndarray, shape (windows,)
        Mean in each window. [N]
    friction_force_uncertainty : ndarray, shape (windows,)
        Standard uncertainty, including the scatter of the current in the window. [N]
    """

    time: Floats
    friction_force: Floats
    friction_force_uncertainty: Floats


def friction_from_motor_current(
    motor: MotorCalibration, *, motor_current: ArrayLike, motor_current_uncertainty: ArrayLike = 0.0
) -> tuple[Floats, Floats]:
    r"""Friction force from the motor current at constant speed, and its standard uncertainty. [N]

    Parameters
    ----------
    motor : MotorCalibration
    motor_current : array_like, any shape
        Current of the motor. [A]
    motor_current_uncertainty : array_like, broadcast against `motor_current`
        Its standard uncertainty. [A]

    Returns
    -------
    friction_force : ndarray, shape of `motor_current`
        Negative below the idle current. [N]
    friction_force_uncertainty : ndarray, shape of the broadcast arguments
        Its standard uncertainty. [N]

    Raises
    ------
    InvalidInput
        If a current is not finite, or an uncertainty negative.

    See Also
    --------
    friction_from_current : the force for constants without a calibration record.

    Notes
    -----
    First-order propagation of uncertainty:

    .. math::

        F_t = \frac{k_m (I_m - I_0)}{D_g/2} , \qquad
        u_F^2 = \left( \frac{2}{D_g} \right)^2 \left[ k_m^2 (u_I^2 + u_{I0}^2) + (I_m - I_0)^2 u_K^2 \right] .

    At constant speed only: an accelerating disc takes current of its own, and the idle current belongs to one speed.

    References
    ----------
    .. [1] D 2.4.4, where the motor's current falls by 0.4 A with the friction.
    """
    current = require_finite(motor_current=motor_current)
    current_uncertainty = np.hypot(
        require_non_negative(motor_current_uncertainty=motor_current_uncertainty), motor.idle_current_uncertainty
    )
    torque_uncertainty = np.hypot(
        motor.torque_constant * current_uncertainty, motor.torque_constant_uncertainty * (current - motor.idle_current)
    )
    friction_force = friction_from_current(
        torque_constant=motor.torque_constant,
        motor_current=current,
        idle_current=motor.idle_current,
        groove_diameter=motor.groove_diameter,
    )
    return friction_force, np.asarray(torque_uncertainty / (motor.groove_diameter / 2))
