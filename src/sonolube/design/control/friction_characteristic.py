"""Static characteristic of the plant: steady friction force over the commanded quantity, and its inverse."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative
from sonolube.errors import InvalidInput, OutsideRange
from sonolube.facts.metrics import EfficiencyLine, friction_at_power, power_for_friction
from sonolube.prediction.chances import ReductionChances
from sonolube.rig import VOLTAGE, CommandedQuantity, Rig, commanded_quantity, level_settings, operating_points
from sonolube.rig.driven_rig import DriveVoltage, require_drive
from sonolube.text.units import format_si

_RESOLUTION = 1e-6  # of the intrinsic friction force, by which neighbouring points must differ


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class FrictionCharacteristic:
    """Steady friction force over the commanded quantity, falling and piecewise linear.

    Parameters
    ----------
    level : ndarray, shape (n,)
        Peak-to-peak drive voltages, or vibration amplitudes, increasing from zero, in V or m.
    friction_force : ndarray, shape (n,)
        Mean friction force at each, decreasing. [N]
    quantity : CommandedQuantity
        Voltage or amplitude.
    vibration_amplitude : ndarray, shape (n,), or None
        Amplitude at each, where it is known. [m]

    Raises
    ------
    InvalidInput
        If there are fewer than two points, levels do not increase, or forces do not decrease.

    See Also
    --------
    computed_characteristic, predicted_characteristic, efficiency_characteristic, linear_characteristic
    """

    level: Floats
    friction_force: Floats
    quantity: CommandedQuantity = VOLTAGE
    vibration_amplitude: Floats | None = None

    def __post_init__(self) -> None:
        levels = require_non_negative(**{self.quantity.name: self.level})
        force = require_non_negative(friction_force=self.friction_force)
        if levels.ndim != 1 or levels.shape != force.shape or levels.size < 2:
            raise InvalidInput(
                f"a friction characteristic needs two points or more, {self.quantity.word} and force of each, got"
                f" shapes {levels.shape} and {force.shape}"
            )
        if np.any(np.diff(levels) <= 0) or np.any(np.diff(force) >= 0):
            raise InvalidInput(
                f"{self.quantity.word}s must increase and forces decrease along a friction characteristic"
            )

    @property
    def highest_force(self) -> float:
        """Friction force without vibration, in N."""
        return float(self.friction_force[0])

    @property
    def lowest_force(self) -> float:
        """Lowest attainable friction force, in N."""
        return float(self.friction_force[-1])


def friction_at_level(characteristic: FrictionCharacteristic, *, level: ArrayLike) -> Floats:
    """Friction force at values of the commanded quantity by linear interpolation, constant beyond the last point. [N]

    Parameters
    ----------
    characteristic : FrictionCharacteristic
    level : array_like, any shape
        Peak-to-peak drive voltage, or vibration amplitude, in V or m.

    Returns
    -------
    ndarray, shape of `level`

    See Also
    --------
    level_for_friction
    """
    levels = require_non_negative(**{characteristic.quantity.name: level})
    return np.asarray(np.interp(levels, characteristic.level, characteristic.friction_force))


def level_for_friction(characteristic: FrictionCharacteristic, *, friction_force: ArrayLike) -> Floats:
    """Peak-to-peak drive voltage or amplitude for friction forces, by the inverse of the characteristic, in V or m.

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
    friction_at_level
    """
    force = require_non_negative(friction_force=friction_force)
    outside = (force > characteristic.highest_force) | (force < characteristic.lowest_force)
    if np.any(outside):
        raise OutsideRange(
            f"friction_force must lie between {characteristic.lowest_force:.4g} N, at"
            f" {format_si(characteristic.level[-1], characteristic.quantity.unit, digits=4)}, and"
            f" {characteristic.highest_force:.4g} N without vibration, got {force[outside].flat[0]:.4g} N"
        )
    return np.asarray(np.interp(force, characteristic.friction_force[::-1], characteristic.level[::-1]))


def computed_characteristic(rig: Rig, *, level_maximum: float, points: int = 41) -> FrictionCharacteristic:
    """Characteristic by the rig's friction model, under its vibration by the source of its amplitude.

    Parameters
    ----------
    rig : Rig
        With an amplitude; without a drive voltage that amplitude is the commanded quantity.
    level_maximum : float
        Highest peak-to-peak voltage, the offset scaled in the rig's own ratio, or highest amplitude, in V or m.
    points : int
        Number of voltages or amplitudes to compute.

    Returns
    -------
    FrictionCharacteristic
        Up to the voltage or amplitude at which a limit of stack, contact or friction model is reached, or the vibration
        drives the sliding.

    Raises
    ------
    InvalidInput
        If the rig has no amplitude, or none up to the highest reduces its friction.

    See Also
    --------
    efficiency_characteristic
    """
    quantity = commanded_quantity(rig)
    levels = _levels(quantity, level_maximum, points)
    vibrated = operating_points(rig, **level_settings(rig, levels[1:]))
    force = np.append(1.0, vibrated.friction_ratio) * rig.friction_coefficient * rig.normal_load
    amplitude = np.append(0.0, vibrated.vibration_amplitude)
    return _decreasing_part(rig, quantity, levels, force, amplitude=amplitude)


def drawn_forces(rig: Rig, plant: FrictionCharacteristic, chances: ReductionChances) -> Floats:
    """Friction forces of equally probable rigs at the levels of a characteristic, as `predict` has them, in N.

    Parameters
    ----------
    rig : Rig
    plant : FrictionCharacteristic
        By `computed_characteristic`.
    chances : ReductionChances
        Of the rig.

    Returns
    -------
    ndarray, shape (draws, n)

    Raises
    ------
    InvalidInput
        If the amplitude along the characteristic is not known.
    """
    if plant.vibration_amplitude is None:
        raise InvalidInput(f"{rig.title}: the amplitude along the friction characteristic is not known")
    ratio = chances.draws(vibration_amplitude=plant.vibration_amplitude)
    return np.asarray(ratio * chances.intrinsic_coefficients()[:, None] * rig.normal_load)


def predicted_characteristic(
    rig: Rig, plant: FrictionCharacteristic, chances: ReductionChances
) -> FrictionCharacteristic:
    """Characteristic by the median of the predicted friction ratio at the levels of another.

    Parameters
    ----------
    rig : Rig
    plant : FrictionCharacteristic
        By `computed_characteristic`.
    chances : ReductionChances
        Of the rig.

    Returns
    -------
    FrictionCharacteristic

    Raises
    ------
    InvalidInput
        If the amplitude along the characteristic is not known.

    See Also
    --------
    computed_characteristic
    """
    if plant.vibration_amplitude is None:
        raise InvalidInput(f"{rig.title}: the amplitude along the friction characteristic is not known")
    ratio = np.median(chances.draws(vibration_amplitude=plant.vibration_amplitude), axis=0)
    force = ratio * chances.friction.value * rig.normal_load
    return _decreasing_part(rig, plant.quantity, plant.level, force, amplitude=plant.vibration_amplitude)


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
    volts = _levels(VOLTAGE, voltage_maximum, points)
    power = DriveVoltage(drive=drive).charging_power(
        capacitance=rig.capacitance, voltage_peak_to_peak=volts, voltage_offset=drive.offset_ratio * volts
    )
    zero_friction_power = float(power_for_friction(line, reduced_friction_force=0.0, **conditions))
    # the power is proportional to the square of the voltage
    volts = np.minimum(volts, volts[-1] * np.sqrt(zero_friction_power / power[-1]))
    power = np.minimum(power, zero_friction_power)
    return _decreasing_part(rig, VOLTAGE, volts, friction_at_power(line, actuator_power=power, **conditions))


def linear_characteristic(characteristic: FrictionCharacteristic) -> FrictionCharacteristic:
    """Straight line between the ends of a characteristic, for control without a model.

    Parameters
    ----------
    characteristic : FrictionCharacteristic

    Returns
    -------
    FrictionCharacteristic
    """
    ends = [0, -1]
    return replace(
        characteristic,
        level=characteristic.level[ends],
        friction_force=characteristic.friction_force[ends],
        vibration_amplitude=None,
    )


def _levels(quantity: CommandedQuantity, highest: float, points: int) -> Floats:
    """Equally spaced voltages or amplitudes from zero."""
    if points < 2:
        raise InvalidInput(f"points must be at least 2, got {points}")
    return np.linspace(0, float(require_non_negative(**{quantity.name: highest})), points)


def _decreasing_part(
    rig: Rig, quantity: CommandedQuantity, levels: Floats, force: Floats, *, amplitude: Floats | None = None
) -> FrictionCharacteristic:
    """Characteristic up to the first NaN or driving force, without the points at which friction does not decrease."""
    intrinsic = rig.friction_coefficient * rig.normal_load
    kept = [0]
    for i in range(1, levels.size):
        if not force[i] >= 0:
            break
        if force[i] < force[kept[-1]] - _RESOLUTION * intrinsic:
            kept.append(i)
    if len(kept) < 2:
        highest = format_si(float(levels[-1]), quantity.unit, digits=6)
        raise InvalidInput(f"{rig.title}: no {quantity.word} up to {highest} reduces friction; raise its limit")
    moved = None if amplitude is None else amplitude[kept]
    return FrictionCharacteristic(
        level=levels[kept], friction_force=force[kept], quantity=quantity, vibration_amplitude=moved
    )
