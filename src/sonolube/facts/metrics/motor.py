"""Friction from the current of the DC motor that drives the disc, by the motor's voltage and torque equations."""

from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.errors import InvalidInput


@dataclass(frozen=True, kw_only=True, slots=True)
class DCMotor:
    r"""A DC motor at constant voltage, with its gear: torque constant and speed refer to the disc.

    Parameters
    ----------
    motor_voltage : float
        Supply voltage of the motor. [V]
    torque_constant : float
        Torque at the disc per current, equal to the back-EMF per angular speed of the disc. [N m/A]
    resistance : float
        Resistance of the motor and its leads. [ohm]

    Raises
    ------
    InvalidInput
        If a value is not positive.

    Notes
    -----
    .. math:: U_m = R I_m + k_m\, 2\pi n

    References
    ----------
    .. [1] A. Hughes and B. Drury, Electric Motors and Drives, 5th ed., Newnes (2019), chapter 3.
    """

    motor_voltage: float
    torque_constant: float
    resistance: float

    def __post_init__(self) -> None:
        require_positive(**asdict(self))


def motor_from_two_operating_points(
    *, motor_voltage: ArrayLike, motor_current: ArrayLike, rotation_speed: ArrayLike
) -> DCMotor:
    r"""Torque constant and resistance of a DC motor from two operating points at one voltage.

    Parameters
    ----------
    motor_voltage : float
        Supply voltage of the motor. [V]
    motor_current : array_like, shape (2,)
        Current of the motor at each operating point. [A]
    rotation_speed : array_like, shape (2,)
        Rotational speed of the disc at each operating point. [1/s]

    Returns
    -------
    DCMotor

    Raises
    ------
    InvalidInput
        If there are not two operating points, a value is not positive, or no motor of one voltage has both: the faster
        point must draw less current.

    Notes
    -----
    Solves :math:`U_m = R I_m + k_m 2\pi n` at both points for R and :math:`k_m`.
    """
    voltage = float(require_positive(motor_voltage=motor_voltage))
    current, speed = require_positive(motor_current=motor_current), require_positive(rotation_speed=rotation_speed)
    if current.shape != (2,) or speed.shape != (2,):
        raise InvalidInput(
            f"two operating points have two currents and two speeds, got shapes {current.shape} and {speed.shape}"
        )
    if not (current[0] - current[1]) * (speed[1] - speed[0]) > 0:
        raise InvalidInput(
            f"motor_current must fall where the speed rises, got {current.tolist()} A at {speed.tolist()} 1/s"
        )
    resistance, constant = np.linalg.solve(np.stack([current, 2 * np.pi * speed], axis=1), [voltage, voltage])
    return DCMotor(motor_voltage=voltage, torque_constant=float(constant), resistance=float(resistance))


def motor_speed(motor: DCMotor, *, motor_current: ArrayLike) -> Floats:
    r"""Rotational speed of the disc at a motor current. [1/s]

    Parameters
    ----------
    motor : DCMotor
    motor_current : array_like, any shape
        Current of the motor. [A]

    Returns
    -------
    ndarray, shape of `motor_current`

    Raises
    ------
    InvalidInput
        If a current is negative, or exceeds the stall current.

    Notes
    -----
    .. math:: n = \frac{U_m - R I_m}{2\pi k_m}
    """
    current = require_non_negative(motor_current=motor_current)
    stall_current = motor.motor_voltage / motor.resistance
    if np.any(current > stall_current):
        raise InvalidInput(f"motor_current must not exceed the stall current, {stall_current:.3g} A")
    return (motor.motor_voltage - motor.resistance * current) / (2 * np.pi * motor.torque_constant)


def friction_from_current(
    *, torque_constant: ArrayLike, motor_current: ArrayLike, idle_current: ArrayLike, groove_diameter: ArrayLike
) -> Floats:
    r"""Friction force from a motor current, over that of the idle motor. [N]

    Parameters
    ----------
    torque_constant : array_like
        Torque at the disc per current, gear included. [N m/A]
    motor_current : array_like, any shape
        Current of the motor. [A]
    idle_current : array_like, broadcast against `motor_current`
        Current of the motor with the surfaces apart; the current of another state gives the difference of the friction
        forces of both. [A]
    groove_diameter : array_like, broadcast against them
        Diameter of the circle on which the surfaces slide, twice the lever arm of friction. [m]

    Returns
    -------
    ndarray, shape of the broadcast arguments
        Negative below the idle current.

    Raises
    ------
    InvalidInput
        If the torque constant or a diameter is not positive, the idle current negative, or a value not finite.

    See Also
    --------
    motor_current_under_friction : the inverse.

    Notes
    -----
    .. math:: F_t = \frac{k_m (I_m - I_0)}{D_g/2}

    At constant speed only: an accelerating disc takes current of its own. The torque of bearings and brushes is taken
    to be that of the idle motor at any speed; losses that grow with speed hide part of a friction force that falls
    while the motor speeds up.

    References
    ----------
    .. [1] D 2.4.4, where the motor's current falls by 0.4 A with the friction.
    """
    current = require_finite(motor_current=motor_current) - require_non_negative(idle_current=idle_current)
    torque = require_positive(torque_constant=torque_constant) * current
    return 2 * torque / require_positive(groove_diameter=groove_diameter)


def motor_current_under_friction(
    motor: DCMotor, *, friction_force: ArrayLike, idle_current: ArrayLike, groove_diameter: ArrayLike
) -> Floats:
    r"""Motor current under a friction force on the disc. [A]

    Parameters
    ----------
    motor : DCMotor
    friction_force : array_like, any shape
        Friction force on the disc, relative to the state of the idle current; negative for less friction. [N]
    idle_current : array_like, broadcast against `friction_force`
        Current of the motor without that force. [A]
    groove_diameter : array_like, broadcast against them
        Diameter of the circle on which the surfaces slide, twice the lever arm of friction. [m]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a diameter is not positive, a current negative, or a force not finite.

    See Also
    --------
    friction_from_current : the inverse.

    Notes
    -----
    .. math:: I_m = I_0 + \frac{F_t D_g/2}{k_m}
    """
    torque = require_finite(friction_force=friction_force) * require_positive(groove_diameter=groove_diameter) / 2
    return require_non_negative(idle_current=idle_current) + torque / motor.torque_constant
