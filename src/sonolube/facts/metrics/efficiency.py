"""Efficiency coefficient of friction reduction (D 4.1), and power and friction by an efficiency line (D 4.2 to 4.4)."""

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
    r"""Efficiency coefficient: frictional power saved per nominal pressure and actuator power. [m2/N]

    Parameters
    ----------
    intrinsic_friction_force : array_like
        Friction force without vibration. [N]
    reduced_friction_force : array_like
        Friction force with vibration. [N]
    sliding_speed : array_like
        Sliding speed. [m/s]
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

    Notes
    -----
    .. math:: \eta = \frac{(F_{t0} - F_{t1})\, v_r A_n}{F_N P_a} \qquad \text{(D 4.1)}

    References
    ----------
    .. [1] D 4.1.

    Examples
    --------
    >>> from sonolube.facts.metrics import efficiency_coefficient
    >>> friction = {"intrinsic_friction_force": 1.0, "reduced_friction_force": 0.4, "sliding_speed": 0.1}
    >>> coefficient = efficiency_coefficient(**friction, nominal_area=1e-6, normal_load=3.0, actuator_power=2.0)
    >>> round(1e9 * float(coefficient), 3)  # mW mm2/(N W)
    10.0
    """
    saved = require_finite(intrinsic_friction_force=intrinsic_friction_force) - require_finite(
        reduced_friction_force=reduced_friction_force
    )
    v = require_non_negative(sliding_speed=sliding_speed)
    load, power = require_positive(normal_load=normal_load), require_positive(actuator_power=actuator_power)
    return saved * v * require_positive(nominal_area=nominal_area) / (load * power)  # D 4.1


@dataclass(frozen=True, kw_only=True, slots=True)
class EfficiencyLine:
    r"""The efficiency coefficient of one rig as a linear function of sliding speed.

    Parameters
    ----------
    slope : float
        Derivative of the coefficient with respect to speed, a; negative for D's rig. [m s/N]
    intercept : float
        Coefficient extrapolated to zero speed, b. [m2/N]

    Raises
    ------
    InvalidInput
        If a value is not finite, or the intercept not positive.

    Notes
    -----
    .. math:: \eta = a\, v_r + b \qquad \text{(D 4.2)}

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
    """Efficiency coefficient of an efficiency line at a sliding speed, D 4.2. [m2/N]

    Parameters
    ----------
    line : EfficiencyLine
    sliding_speed : array_like, any shape
        Sliding speed. [m/s]

    Returns
    -------
    ndarray, shape of `sliding_speed`

    Raises
    ------
    InvalidInput
        If a speed is negative or not finite.
    OutsideRange
        If a speed lies at or beyond the zero of the line, where vibration saves no friction.

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
    r"""Actuator power that reduces friction to a target force. [W]

    Parameters
    ----------
    line : EfficiencyLine
    intrinsic_friction_force : array_like
        Friction force without vibration. [N]
    reduced_friction_force : array_like
        Target friction force, at most the intrinsic one. [N]
    sliding_speed : array_like
        Sliding speed. [m/s]
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
        If a speed, area or load is not positive, or the target friction negative or above the intrinsic one.
    OutsideRange
        If a speed lies at or beyond the zero of the line.

    See Also
    --------
    friction_at_power : the inverse.

    Notes
    -----
    .. math:: P_a = \frac{(F_{t0} - F_{t1})\, v_r A_n}{F_N\, \eta} \qquad \text{(D 4.3)}

    References
    ----------
    .. [1] D 4.3.
    """
    intrinsic = require_positive(intrinsic_friction_force=intrinsic_friction_force)
    reduced = require_non_negative(reduced_friction_force=reduced_friction_force)
    _require_reduction(intrinsic, reduced)
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
    r"""Friction force that remains at an actuator power. [N]

    Parameters
    ----------
    line : EfficiencyLine
    intrinsic_friction_force : array_like
        Friction force without vibration. [N]
    actuator_power : array_like
        Power drawn by the actuator. [W]
    sliding_speed : array_like
        Sliding speed. [m/s]
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
        If a speed lies at or beyond the zero of the line, or a power exceeds the one that removes all friction.

    See Also
    --------
    power_for_friction : the inverse.

    Notes
    -----
    .. math:: F_{t1} = F_{t0} - \frac{F_N\, \eta\, P_a}{v_r A_n} \qquad \text{(D 4.4)}

    References
    ----------
    .. [1] D 4.4, which prints the two friction forces interchanged.
    """
    intrinsic = require_positive(intrinsic_friction_force=intrinsic_friction_force)
    power = require_non_negative(actuator_power=actuator_power)
    saved_per_power = _friction_saved_per_power(line, sliding_speed, nominal_area, normal_load)
    reduced = intrinsic - saved_per_power * power  # D 4.4
    excessive = reduced < -1e-12 * intrinsic  # tolerates rounding at exactly the sufficient power
    if np.any(excessive):
        sufficient = intrinsic / saved_per_power
        raise OutsideRange(
            f"actuator_power of {_first(power, excessive):.4g} W is more than the {_first(sufficient, excessive):.4g} W"
            " that remove all friction on this efficiency line"
        )
    return np.maximum(reduced, 0.0)


def _friction_saved_per_power(
    line: EfficiencyLine, sliding_speed: ArrayLike, nominal_area: ArrayLike, normal_load: ArrayLike
) -> Floats:
    """Friction force saved per actuator power, F_N eta/(v A_n), in N/W."""
    v = require_positive(sliding_speed=sliding_speed)
    load, area = require_positive(normal_load=normal_load), require_positive(nominal_area=nominal_area)
    return load * efficiency_at(line, sliding_speed=v) / (v * area)


def _require_reduction(intrinsic: Floats, reduced: Floats) -> None:
    """Refuse a target friction force above the intrinsic one."""
    above = reduced > intrinsic
    if np.any(above):
        raise InvalidInput(
            f"reduced_friction_force must not exceed intrinsic_friction_force, {_first(intrinsic, above):.4g} N,"
            f" got {_first(reduced, above):.4g} N"
        )


def _first(values: Floats, where: NDArray[np.bool_]) -> float:
    """First value at which a condition holds."""
    return float(np.broadcast_to(values, where.shape)[where].flat[0])
