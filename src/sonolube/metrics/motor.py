"""Friction from the current and speed of the DC motor that turns the disc."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.errors import InvalidInput


@dataclass(frozen=True, kw_only=True, slots=True)
class DCMotor:
    """A DC motor at constant voltage, gear included: constant and resistance are those felt at the disc.

    Parameters
    ----------
    motor_voltage : float
        Voltage of the motor. [V]
    torque_constant : float
        Torque at the disc per current; the same number is its voltage per angular speed. [N m/A]
    resistance : float
        Resistance of the motor and its leads. [ohm]

    Raises
    ------
    InvalidInput
        If a value is not positive.

    References
    ----------
    .. [1] A. Hughes and B. Drury, Electric Motors and Drives, 5th ed., Newnes (2019), chapter 3.
    """

    motor_voltage: float
    torque_constant: float
    resistance: float

    def __post_init__(self) -> None:
        require_positive(
            motor_voltage=self.motor_voltage, torque_constant=self.torque_constant, resistance=self.resistance
        )


def motor_from_two_operating_points(
    *, motor_voltage: ArrayLike, motor_current: ArrayLike, rotation_speed: ArrayLike
) -> DCMotor:
    """Return the motor that draws these currents at these speeds.

    Parameters
    ----------
    motor_voltage : float
        Voltage of the motor. [V]
    motor_current : array_like, shape (2,)
        Current of the motor in either state. [A]
    rotation_speed : array_like, shape (2,)
        Speed of the disc in either state. [1/s]

    Returns
    -------
    DCMotor

    Raises
    ------
    InvalidInput
        If there are not two states, a value is not positive, or no motor of one voltage runs in both: the faster state
        must draw less current.
    """
    voltage = float(require_positive(motor_voltage=motor_voltage))
    current, speed = require_positive(motor_current=motor_current), require_positive(rotation_speed=rotation_speed)
    if current.shape != (2,) or speed.shape != (2,):
        raise InvalidInput(f"a motor takes two currents and two speeds, got shapes {current.shape} and {speed.shape}")
    if not (current[0] - current[1]) * (speed[1] - speed[0]) > 0:
        raise InvalidInput(
            f"motor_current must fall where the speed rises, got {current.tolist()} A at {speed.tolist()} 1/s"
        )
    # U = R I + k omega in both states
    resistance, constant = np.linalg.solve(np.stack([current, 2 * np.pi * speed], axis=1), [voltage, voltage])
    return DCMotor(motor_voltage=voltage, torque_constant=float(constant), resistance=float(resistance))


def motor_speed(motor: DCMotor, *, motor_current: ArrayLike) -> Floats:
    """Return the speed of the disc at which the motor draws a current. [1/s]

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
        If a current is negative, or so large that the motor would not turn.
    """
    current = require_non_negative(motor_current=motor_current)
    stalled = motor.motor_voltage / motor.resistance
    if np.any(current > stalled):
        raise InvalidInput(f"motor_current must not exceed that of the stalled motor, {stalled:.3g} A")
    return (motor.motor_voltage - motor.resistance * current) / (2 * np.pi * motor.torque_constant)


def friction_from_current(
    *, torque_constant: ArrayLike, motor_current: ArrayLike, idle_current: ArrayLike, groove_diameter: ArrayLike
) -> Floats:
    """Return the friction that the motor overcomes besides what it bears idle. [N]

    Parameters
    ----------
    torque_constant : array_like
        Torque at the disc per current, gears included. [N m/A]
    motor_current : array_like, any shape
        Current of the motor. [A]
    idle_current : array_like, broadcast against `motor_current`
        Current of the motor with the surfaces apart; that of another state gives the difference of both frictions. [A]
    groove_diameter : array_like, broadcast against them
        Diameter of the circle on which the surfaces slide. [m]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If the torque constant or a diameter is not positive, the idle current negative, or a value not finite.

    Notes
    -----
    The torque that bearings and brushes take is that of the idle motor at any speed. Losses that grow with speed hide
    part of a friction that falls while the motor speeds up.
    """
    current = require_finite(motor_current=motor_current) - require_non_negative(idle_current=idle_current)
    torque = require_positive(torque_constant=torque_constant) * current
    return 2 * torque / require_positive(groove_diameter=groove_diameter)


def motor_current_under_friction(
    motor: DCMotor, *, friction_force: ArrayLike, idle_current: ArrayLike, groove_diameter: ArrayLike
) -> Floats:
    """Return the current that a friction adds to the idle one. [A]

    Parameters
    ----------
    motor : DCMotor
    friction_force : array_like, any shape
        Friction on the disc; negative for what a state has less than the one of the idle current. [N]
    idle_current : array_like, broadcast against `friction_force`
        Current of the motor without it. [A]
    groove_diameter : array_like, broadcast against them
        Diameter of the circle on which the surfaces slide. [m]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a diameter is not positive, a current negative, or a force not finite.
    """
    torque = require_finite(friction_force=friction_force) * require_positive(groove_diameter=groove_diameter) / 2
    return require_non_negative(idle_current=idle_current) + torque / motor.torque_constant
