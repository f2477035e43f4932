"""Friction over drive voltage at rest: what a controller looks its voltage up in."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative
from sonolube.errors import InvalidInput, OutsideRange
from sonolube.metrics import EfficiencyLine, friction_at_power, power_for_friction
from sonolube.rig import Rig, friction_ratios, operating_points
from sonolube.rig.driven_rig import require_drive
from sonolube.rig.excitation import amplifier_power
from sonolube.rig.friction_and_wear import prescribed_sine

_FLAT = 1e-6  # share of the intrinsic friction by which neighbouring points must differ


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class FrictionMap:
    """Friction force over drive voltage, a falling polygon.

    Parameters
    ----------
    voltage_peak_to_peak : ndarray, shape (n,)
        Swings of the drive, rising from zero. [V]
    friction_force : ndarray, shape (n,)
        Mean friction under each, falling. [N]

    Raises
    ------
    InvalidInput
        If there are fewer than two points, or voltages do not rise or forces do not fall throughout.
    """

    voltage_peak_to_peak: Floats
    friction_force: Floats

    def __post_init__(self) -> None:
        volts = require_non_negative(voltage_peak_to_peak=self.voltage_peak_to_peak)
        force = require_non_negative(friction_force=self.friction_force)
        if volts.ndim != 1 or volts.shape != force.shape or volts.size < 2:
            raise InvalidInput(f"a friction map needs two points or more, got shapes {volts.shape} and {force.shape}")
        if np.any(np.diff(volts) <= 0) or np.any(np.diff(force) >= 0):
            raise InvalidInput("in a friction map voltages must rise and forces fall throughout")

    @property
    def highest_force(self) -> float:
        """Friction without vibration, in N."""
        return float(self.friction_force[0])

    @property
    def lowest_force(self) -> float:
        """Least friction within reach, in N."""
        return float(self.friction_force[-1])


def friction_at(known: FrictionMap, *, voltage_peak_to_peak: ArrayLike) -> Floats:
    """Return the friction force under voltages, the ends of the map beyond its range. [N]

    Parameters
    ----------
    known : FrictionMap
    voltage_peak_to_peak : array_like, any shape
        Swing of the drive. [V]

    Returns
    -------
    ndarray, shape of `voltage_peak_to_peak`
    """
    volts = require_non_negative(voltage_peak_to_peak=voltage_peak_to_peak)
    return np.asarray(np.interp(volts, known.voltage_peak_to_peak, known.friction_force))


def voltage_for(known: FrictionMap, *, friction_force: ArrayLike) -> Floats:
    """Return the drive voltage, peak to peak, that gives friction forces. [V]

    Parameters
    ----------
    known : FrictionMap
    friction_force : array_like, any shape
        Friction wanted. [N]

    Returns
    -------
    ndarray, shape of `friction_force`

    Raises
    ------
    OutsideRange
        If a force lies beyond the ends of the map.
    """
    force = require_non_negative(friction_force=friction_force)
    if np.any((force > known.highest_force) | (force < known.lowest_force)):
        outside = force[(force > known.highest_force) | (force < known.lowest_force)].flat[0]
        raise OutsideRange(
            f"friction_force must lie between {known.lowest_force:.4g} N, at {known.voltage_peak_to_peak[-1]:.4g} V,"
            f" and {known.highest_force:.4g} N without vibration, got {outside:.4g} N"
        )
    return np.asarray(np.interp(force, known.friction_force[::-1], known.voltage_peak_to_peak[::-1]))


def modelled_map(rig: Rig, *, voltage_maximum: float, points: int = 41) -> FrictionMap:
    """Return the map that the rig's closure gives: under computed vibration, or where the structure is unknown a sine.

    Parameters
    ----------
    rig : Rig
        With a drive voltage, and either stack and structure or an amplitude.
    voltage_maximum : float
        Highest swing, peak to peak; the offset goes with it in the rig's own proportion. [V]
    points : int
        How many voltages to compute.

    Returns
    -------
    FrictionMap
        Up to the first voltage that a limit of stack, contact or closure rules out, or where friction stops falling.

    Raises
    ------
    InvalidInput
        If the rig has no drive voltage, or no voltage reduces its friction.
    """
    volts = _voltages(voltage_maximum, points)
    ratio = _computed_ratios(rig, volts) if rig.structure is not None else _sine_ratios(rig, volts)
    return _falling(rig, volts, ratio * rig.friction_coefficient * rig.normal_load)


def efficiency_map(rig: Rig, line: EfficiencyLine, *, voltage_maximum: float, points: int = 41) -> FrictionMap:
    """Return the map that an efficiency line gives for the power a linear amplifier supplies.

    Parameters
    ----------
    rig : Rig
        With a drive voltage and a capacitance.
    line : EfficiencyLine
        Calibrated for this rig.
    voltage_maximum : float
        Highest swing, peak to peak; the offset goes with it in the rig's own proportion. [V]
    points : int
        How many voltages to compute.

    Returns
    -------
    FrictionMap
        Up to the voltage that would take all friction away.

    Raises
    ------
    InvalidInput
        If the rig has no drive voltage or capacitance.
    OutsideRange
        If the line does not reach to the rig's sliding speed.

    References
    ----------
    .. [1] D 1.9, 4.2 and 4.4.
    """
    drive = require_drive(rig)
    if rig.capacitance is None:
        raise InvalidInput(f"{rig.title}: actuator.capacitance is missing; the efficiency line is over power")
    intrinsic = rig.friction_coefficient * rig.normal_load
    setting = {
        "intrinsic_friction_force": intrinsic,
        "sliding_speed": rig.sliding_speed,
        "nominal_area": rig.contact.nominal_area,
        "normal_load": rig.normal_load,
    }
    volts = _voltages(voltage_maximum, points)
    power = amplifier_power(
        drive,
        capacitance=rig.capacitance,
        voltage_peak_to_peak=volts,
        voltage_offset=drive.offset_ratio * volts,
    )
    enough = float(power_for_friction(line, reduced_friction_force=0.0, **setting))
    # power goes with the square of the voltage
    volts = np.minimum(volts, volts[-1] * np.sqrt(enough / power[-1]))
    power = np.minimum(power, enough)
    return _falling(rig, volts, friction_at_power(line, actuator_power=power, **setting))


def linear_map(known: FrictionMap) -> FrictionMap:
    """Return the straight line between the ends of a map: all that is known of a rig without a model."""
    return FrictionMap(
        voltage_peak_to_peak=known.voltage_peak_to_peak[[0, -1]], friction_force=known.friction_force[[0, -1]]
    )


def _voltages(highest: float, points: int) -> Floats:
    if points < 2:
        raise InvalidInput(f"points must be at least 2, got {points}")
    return np.linspace(0, float(require_non_negative(voltage_maximum=highest)), points)


def _computed_ratios(rig: Rig, volts: Floats) -> Floats:
    found = operating_points(rig, voltage_peak_to_peak=volts, voltage_offset=require_drive(rig).offset_ratio * volts)
    return found.friction_ratio


def _sine_ratios(rig: Rig, volts: Floats) -> Floats:
    """Return ratios of a rig of which only the amplitude under its own drive is known, taken for proportional."""
    drive = require_drive(rig)
    if not drive.voltage_peak_to_peak or not rig.vibration_amplitude:
        raise InvalidInput(f"{rig.title}: actuator.amplitude_per_volt and drive.voltage_peak_to_peak must be given")
    per_volt = rig.vibration_amplitude / drive.voltage_peak_to_peak
    ratios = np.ones(volts.size)
    for i in range(1, volts.size):
        vibrating = replace(rig, vibration_amplitude=per_volt * volts[i])
        try:
            motion = prescribed_sine(vibrating)
            ratios[i] = friction_ratios(vibrating, motion, sliding_speed=rig.sliding_speed)
        except OutsideRange:
            ratios[i] = np.nan
    return ratios


def _falling(rig: Rig, volts: Floats, force: Floats) -> FrictionMap:
    """Return the part of a map in which friction falls, from zero volts on."""
    intrinsic = rig.friction_coefficient * rig.normal_load
    kept = [0]
    for i in range(1, volts.size):
        if np.isnan(force[i]):
            break
        if force[i] < force[kept[-1]] - _FLAT * intrinsic:
            kept.append(i)
    if len(kept) < 2:
        raise InvalidInput(f"{rig.title}: no voltage up to {volts[-1]:g} V reduces friction; raise voltage_maximum")
    return FrictionMap(voltage_peak_to_peak=volts[kept], friction_force=force[kept])
