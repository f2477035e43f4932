"""Friction saved for the power spent, and power or friction from it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.errors import InvalidInput, OutsideRange


def efficiency_coefficient(
    *,
    intrinsic_friction_force: ArrayLike,
    reduced_friction_force: ArrayLike,
    sliding_speed: ArrayLike,
    nominal_area: ArrayLike,
    normal_load: ArrayLike,
    actuator_power: ArrayLike,
) -> Floats:
    """Return the frictional power saved per nominal pressure and actuator power. [m2/N]

    Parameters
    ----------
    intrinsic_friction_force : array_like
        Friction without vibration. [N]
    reduced_friction_force : array_like
        Friction with vibration. [N]
    sliding_speed : array_like
        Speed of the sliding. [m/s]
    nominal_area : array_like
        Nominal contact area. [m2]
    normal_load : array_like
        Force pressing the bodies together. [N]
    actuator_power : array_like
        Power drawn by the actuator. [W]

    Returns
    -------
    ndarray, shape of the broadcast arguments
        D's unit, mW mm2/(N W), is 1e-9 m2/N.

    Raises
    ------
    InvalidInput
        If an area, load or power is not positive, a speed negative, or a value not finite.

    References
    ----------
    .. [1] D 4.1.
    """
    saved = require_finite(intrinsic_friction_force=intrinsic_friction_force) - require_finite(
        reduced_friction_force=reduced_friction_force
    )
    v = require_non_negative(sliding_speed=sliding_speed)
    load, power = require_positive(normal_load=normal_load), require_positive(actuator_power=actuator_power)
    return saved * v * require_positive(nominal_area=nominal_area) / (load * power)  # D 4.1


@dataclass(frozen=True, kw_only=True, slots=True)
class EfficiencyLine:
    """The efficiency coefficient of one rig as a line over sliding speed.

    Parameters
    ----------
    slope : float
        Change of the coefficient per speed; negative for D's rig. [m s/N]
    intercept : float
        Coefficient at the lowest speeds. [m2/N]

    Raises
    ------
    InvalidInput
        If a value is not finite, or the intercept not positive.

    References
    ----------
    .. [1] D 4.2: an empirical fit, to be calibrated for each rig.
    """

    slope: float
    intercept: float

    def __post_init__(self) -> None:
        require_finite(slope=self.slope)
        require_positive(intercept=self.intercept)


def efficiency_at(line: EfficiencyLine, *, sliding_speed: ArrayLike) -> Floats:
    """Return the efficiency coefficient that a line gives at a speed. [m2/N]

    Parameters
    ----------
    line : EfficiencyLine
    sliding_speed : array_like, any shape
        Speed of the sliding. [m/s]

    Returns
    -------
    ndarray, shape of `sliding_speed`

    Raises
    ------
    InvalidInput
        If a speed is negative or not finite.
    OutsideRange
        If a speed lies where the line has fallen to zero, and vibration would save nothing.

    References
    ----------
    .. [1] D 4.2.
    """
    v = require_non_negative(sliding_speed=sliding_speed)
    efficiency = line.slope * v + line.intercept
    if np.any(efficiency <= 0):
        raise OutsideRange(
            f"sliding_speed must stay below {-line.intercept / line.slope:.4g} m/s, where this efficiency line"
            f" reaches zero, got {float(np.max(v)):.4g} m/s"
        )
    return efficiency


def power_for_friction(
    line: EfficiencyLine,
    *,
    intrinsic_friction_force: ArrayLike,
    reduced_friction_force: ArrayLike,
    sliding_speed: ArrayLike,
    nominal_area: ArrayLike,
    normal_load: ArrayLike,
) -> Floats:
    """Return the actuator power that brings friction down to a wanted force. [W]

    Parameters
    ----------
    line : EfficiencyLine
    intrinsic_friction_force : array_like
        Friction without vibration. [N]
    reduced_friction_force : array_like
        Friction wanted, at most the intrinsic one. [N]
    sliding_speed : array_like
        Speed of the sliding. [m/s]
    nominal_area : array_like
        Nominal contact area. [m2]
    normal_load : array_like
        Force pressing the bodies together. [N]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a speed, area or load is not positive, or the wanted friction negative or above the intrinsic one.
    OutsideRange
        If a speed lies where the line has fallen to zero.

    References
    ----------
    .. [1] D 4.3.
    """
    intrinsic = require_positive(intrinsic_friction_force=intrinsic_friction_force)
    reduced = require_non_negative(reduced_friction_force=reduced_friction_force)
    _refuse_more_friction(intrinsic, reduced)
    return (intrinsic - reduced) / _friction_saved_per_power(line, sliding_speed, nominal_area, normal_load)  # D 4.3


def friction_at_power(
    line: EfficiencyLine,
    *,
    intrinsic_friction_force: ArrayLike,
    actuator_power: ArrayLike,
    sliding_speed: ArrayLike,
    nominal_area: ArrayLike,
    normal_load: ArrayLike,
) -> Floats:
    """Return the friction that an actuator power leaves. [N]

    Parameters
    ----------
    line : EfficiencyLine
    intrinsic_friction_force : array_like
        Friction without vibration. [N]
    actuator_power : array_like
        Power drawn by the actuator. [W]
    sliding_speed : array_like
        Speed of the sliding. [m/s]
    nominal_area : array_like
        Nominal contact area. [m2]
    normal_load : array_like
        Force pressing the bodies together. [N]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a speed, area or load is not positive, or a power negative.
    OutsideRange
        If a speed lies where the line has fallen to zero, or a power exceeds what takes all friction away.

    References
    ----------
    .. [1] D 4.4, which prints both friction forces in each other's place.
    """
    intrinsic = require_positive(intrinsic_friction_force=intrinsic_friction_force)
    power = require_non_negative(actuator_power=actuator_power)
    saved_per_power = _friction_saved_per_power(line, sliding_speed, nominal_area, normal_load)
    reduced = intrinsic - saved_per_power * power  # D 4.4
    needless = reduced < -1e-12 * intrinsic  # rounding must not refuse the very power that suffices
    if np.any(needless):
        sufficient = intrinsic / saved_per_power
        raise OutsideRange(
            f"actuator_power of {_first(power, needless):.4g} W is more than the {_first(sufficient, needless):.4g} W"
            " that take all friction away on this efficiency line"
        )
    return np.maximum(reduced, 0.0)


def _friction_saved_per_power(
    line: EfficiencyLine, sliding_speed: ArrayLike, nominal_area: ArrayLike, normal_load: ArrayLike
) -> Floats:
    v = require_positive(sliding_speed=sliding_speed)
    load, area = require_positive(normal_load=normal_load), require_positive(nominal_area=nominal_area)
    return load * efficiency_at(line, sliding_speed=v) / (v * area)


def _refuse_more_friction(intrinsic: Floats, reduced: Floats) -> None:
    above = reduced > intrinsic
    if np.any(above):
        raise InvalidInput(
            f"reduced_friction_force must not exceed intrinsic_friction_force, {_first(intrinsic, above):.4g} N,"
            f" got {_first(reduced, above):.4g} N"
        )


def _first(values: Floats, where: NDArray[np.bool_]) -> float:
    return float(np.broadcast_to(values, where.shape)[where].flat[0])
