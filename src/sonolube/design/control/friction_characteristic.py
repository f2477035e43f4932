"""Static characteristic of the plant: steady friction force over drive voltage, and its inverse for feed-forward."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative
from sonolube.errors import InvalidInput, OutsideRange
from sonolube.facts.metrics import EfficiencyLine, friction_at_power, power_for_friction
from sonolube.rig import Rig, operating_points
from sonolube.rig.driven_rig import require_drive
from sonolube.rig.excitation import amplifier_power

_RESOLUTION = 1e-6  # of the intrinsic friction force, by which neighbouring points must differ


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class FrictionCharacteristic:
    """Steady friction force over peak-to-peak drive voltage, falling and piecewise linear.

    Parameters
    ----------
    voltage_peak_to_peak : ndarray, shape (n,)
        Drive voltages, increasing from zero. [V]
    friction_force : ndarray, shape (n,)
        Mean friction force at each, decreasing. [N]

    Raises
    ------
    InvalidInput
        If there are fewer than two points, voltages do not increase, or forces do not decrease.

    See Also
    --------
    computed_characteristic, efficiency_characteristic, linear_characteristic
    """

    voltage_peak_to_peak: Floats
    friction_force: Floats

    def __post_init__(self) -> None:
        volts = require_non_negative(voltage_peak_to_peak=self.voltage_peak_to_peak)
        force = require_non_negative(friction_force=self.friction_force)
        if volts.ndim != 1 or volts.shape != force.shape or volts.size < 2:
            raise InvalidInput(
                "a friction characteristic needs two points or more, voltage and force of each, got shapes"
                f" {volts.shape} and {force.shape}"
            )
        if np.any(np.diff(volts) <= 0) or np.any(np.diff(force) >= 0):
            raise InvalidInput("voltages must increase and forces decrease along a friction characteristic")

    @property
    def highest_force(self) -> float:
        """Friction force without vibration, in N."""
        return float(self.friction_force[0])

    @property
    def lowest_force(self) -> float:
        """Lowest attainable friction force, in N."""
        return float(self.friction_force[-1])


def friction_at_voltage(characteristic: FrictionCharacteristic, *, voltage_peak_to_peak: ArrayLike) -> Floats:
    """Friction force at drive voltages by linear interpolation, constant beyond the last point. [N]

    Parameters
    ----------
    characteristic : FrictionCharacteristic
    voltage_peak_to_peak : array_like, any shape
        Peak-to-peak drive voltage. [V]

    Returns
    -------
    ndarray, shape of `voltage_peak_to_peak`

    See Also
    --------
    voltage_for_friction
    """
    volts = require_non_negative(voltage_peak_to_peak=voltage_peak_to_peak)
    return np.asarray(np.interp(volts, characteristic.voltage_peak_to_peak, characteristic.friction_force))


def voltage_for_friction(characteristic: FrictionCharacteristic, *, friction_force: ArrayLike) -> Floats:
    """Peak-to-peak drive voltage for friction forces, by the inverse of the characteristic. [V]

    Parameters
    ----------
    characteristic : FrictionCharacteristic
    friction_force : array_like, any shape
        Required friction force. [N]

    Returns
    -------
    ndarray, shape of `friction_force`

    Raises
    ------
    OutsideRange
        If a force lies beyond the ends of the characteristic.

    See Also
    --------
    friction_at_voltage
    """
    force = require_non_negative(friction_force=friction_force)
    outside = (force > characteristic.highest_force) | (force < characteristic.lowest_force)
    if np.any(outside):
        raise OutsideRange(
            f"friction_force must lie between {characteristic.lowest_force:.4g} N, at"
            f" {characteristic.voltage_peak_to_peak[-1]:.4g} V, and {characteristic.highest_force:.4g} N without"
            f" vibration, got {force[outside].flat[0]:.4g} N"
        )
    return np.asarray(np.interp(force, characteristic.friction_force[::-1], characteristic.voltage_peak_to_peak[::-1]))


def computed_characteristic(rig: Rig, *, voltage_maximum: float, points: int = 41) -> FrictionCharacteristic:
    """Characteristic by the rig's friction model, under its vibration by the source of its amplitude.

    Parameters
    ----------
    rig : Rig
        With a drive voltage and an amplitude, measured, computed or per volt.
    voltage_maximum : float
        Highest peak-to-peak voltage; the offset is scaled in the rig's own ratio. [V]
    points : int
        Number of voltages to compute.

    Returns
    -------
    FrictionCharacteristic
        Up to the voltage at which a limit of stack, contact or friction model is reached, or the vibration drives the
        sliding.

    Raises
    ------
    InvalidInput
        If the rig has no drive voltage, or no voltage reduces its friction.

    See Also
    --------
    efficiency_characteristic
    """
    volts = _voltages(voltage_maximum, points)
    return _decreasing_part(rig, volts, _ratios(rig, volts) * rig.friction_coefficient * rig.normal_load)


def efficiency_characteristic(
    rig: Rig, line: EfficiencyLine, *, voltage_maximum: float, points: int = 41
) -> FrictionCharacteristic:
    """Characteristic by an efficiency line and the power that a linear amplifier supplies (D 1.9, 4.2 and 4.4).

    Parameters
    ----------
    rig : Rig
        With a drive voltage and a capacitance.
    line : EfficiencyLine
        Calibrated for this rig.
    voltage_maximum : float
        Highest peak-to-peak voltage; the offset is scaled in the rig's own ratio. [V]
    points : int
        Number of voltages to compute.

    Returns
    -------
    FrictionCharacteristic
        Up to the voltage at which the line predicts no friction.

    Raises
    ------
    InvalidInput
        If the rig has no drive voltage or capacitance.
    OutsideRange
        If the line is not valid at the rig's sliding speed.

    See Also
    --------
    computed_characteristic

    References
    ----------
    .. [1] D 1.9, 4.2 and 4.4.
    """
    drive = require_drive(rig)
    if rig.capacitance is None:
        raise InvalidInput(f"{rig.title}: actuator.capacitance is missing; the efficiency line is over power")
    intrinsic = rig.friction_coefficient * rig.normal_load
    conditions = {
        "intrinsic_friction_force": intrinsic,
        "sliding_speed": rig.sliding_speed,
        "nominal_area": rig.contact.nominal_area,
        "normal_load": rig.normal_load,
    }
    volts = _voltages(voltage_maximum, points)
    power = amplifier_power(
        drive, capacitance=rig.capacitance, voltage_peak_to_peak=volts, voltage_offset=drive.offset_ratio * volts
    )
    zero_friction_power = float(power_for_friction(line, reduced_friction_force=0.0, **conditions))
    # the power is proportional to the square of the voltage
    volts = np.minimum(volts, volts[-1] * np.sqrt(zero_friction_power / power[-1]))
    power = np.minimum(power, zero_friction_power)
    return _decreasing_part(rig, volts, friction_at_power(line, actuator_power=power, **conditions))


def linear_characteristic(characteristic: FrictionCharacteristic) -> FrictionCharacteristic:
    """Straight line between the ends of a characteristic, for control without a model.

    Parameters
    ----------
    characteristic : FrictionCharacteristic

    Returns
    -------
    FrictionCharacteristic
    """
    volts, force = characteristic.voltage_peak_to_peak[[0, -1]], characteristic.friction_force[[0, -1]]
    return FrictionCharacteristic(voltage_peak_to_peak=volts, friction_force=force)


def _voltages(highest: float, points: int) -> Floats:
    """Equally spaced voltages from zero."""
    if points < 2:
        raise InvalidInput(f"points must be at least 2, got {points}")
    return np.linspace(0, float(require_non_negative(voltage_maximum=highest)), points)


def _ratios(rig: Rig, volts: Floats) -> Floats:
    """Friction ratios at each voltage, NaN where there is none; 1 without vibration."""
    offset = require_drive(rig).offset_ratio * volts[1:]
    vibrated = operating_points(rig, voltage_peak_to_peak=volts[1:], voltage_offset=offset)
    return np.concatenate([[1.0], vibrated.friction_ratio])


def _decreasing_part(rig: Rig, volts: Floats, force: Floats) -> FrictionCharacteristic:
    """Characteristic up to the first NaN or driving force, without the points at which friction does not decrease."""
    intrinsic = rig.friction_coefficient * rig.normal_load
    kept = [0]
    for i in range(1, volts.size):
        if not force[i] >= 0:
            break
        if force[i] < force[kept[-1]] - _RESOLUTION * intrinsic:
            kept.append(i)
    if len(kept) < 2:
        raise InvalidInput(f"{rig.title}: no voltage up to {volts[-1]:g} V reduces friction; raise voltage_maximum")
    return FrictionCharacteristic(voltage_peak_to_peak=volts[kept], friction_force=force[kept])
