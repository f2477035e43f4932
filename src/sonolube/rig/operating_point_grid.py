"""Operating points of one rig over arrays of settings: vibrations solved in one batch, friction and status each."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.checks import Floats
from sonolube.models.contact import separation
from sonolube.models.dynamics import SteadyStates
from sonolube.models.friction.models.range_check import OUTSIDE_MODEL_RANGE
from sonolube.rig.friction_and_wear import friction_at_speeds
from sonolube.rig.operating_conditions import (
    CONDITIONS,
    REFUSED,
    computed_vibrations,
    conditions_of,
    points_by_vibration,
    stated_vibrations,
    steady_states_of,
)
from sonolube.rig.power import larger_power
from sonolube.rig.record import AmplitudeSource, Rig
from sonolube.rig.resolved_rig import ResolvedRig, resolved_rig

VIBRATION_NUMBERS = (
    "vibration_amplitude",
    "vibration_velocity",
    "mean_displacement",
    "contact_loss_fraction",
    "dissipated_power",
    "apparent_power",
    "peak_current",
)
"""Numbers of the vibration of a point."""

Advance = Callable[[int, int], None]


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class OperatingPoints:
    """Operating points of a rig; every array has the shape of the broadcast settings.

    The numbers of a point that was refused or did not converge are NaN, and `reason` holds the cause; outside the range
    of the friction model those of friction are.

    Parameters
    ----------
    voltage_peak_to_peak : ndarray
        Peak-to-peak voltage of the drive. [V]
    voltage_offset : ndarray
        Mean voltage of the drive. [V]
    frequency : ndarray
        Frequency of the drive. [Hz]
    normal_load : ndarray
        Force pressing the bodies together. [N]
    sliding_speed : ndarray
        Macroscopic relative speed. [m/s]
    status : ndarray of str
        "periodic", "unstable", "multistable" or "not_converged" by harmonic balance; "refused" by a limit of stack or
        contact; "outside_model_range" where the friction model has no meaning for the vibration.
    reason : ndarray of str
        Meaning of the status, and advice.
    vibration_amplitude : ndarray
        Vibration of the tip, zero to peak. [m]
    vibration_velocity : ndarray
        Highest speed of the tip along the surface normal. [m/s]
    mean_displacement : ndarray
        Rise of the tip from rest under the load. [m]
    contact_loss_fraction : ndarray
        Share of the period in which the contact carries less than a hundredth of the load. []
    friction_ratio : ndarray
        Friction with vibration over friction without, by the rig's friction model. []
    raw_friction_ratio : ndarray
        That ratio by the formula of the model, also outside its range. []
    friction_reduction : ndarray
        One minus the friction ratio. []
    friction_coefficient : ndarray
        Mean friction force over the normal load. []
    friction_force : ndarray
        Mean friction force with vibration. [N]
    power_to_supply : ndarray
        Power that the amplifier has to supply, the larger of the two below, at least that which is known. [W]
    charging_power : ndarray
        Charge of the capacitance from the supply of a linear amplifier, D 1.9. [W]
    dissipated_power : ndarray
        Mean electrical power that stays in stack, dampers and contact; NaN for a sine, whose `reason` says so. [W]
    apparent_power : ndarray
        Root-mean-square voltage times root-mean-square current; NaN for a sine. [W]
    peak_current : ndarray
        Greatest magnitude of that current; NaN for a sine. [A]
    gap_closed : ndarray of bool
        Whether the mean planes touch within the period, where the contact model no longer holds.
    amplitude_source : {"measured", "computed", "waveguide", "per-volt"}
        Where the amplitude comes from.
    amplitude_origin : str
        The same in words.
    """

    voltage_peak_to_peak: Floats
    voltage_offset: Floats
    frequency: Floats
    normal_load: Floats
    sliding_speed: Floats
    status: NDArray[np.str_]
    reason: NDArray[np.str_]
    vibration_amplitude: Floats
    vibration_velocity: Floats
    mean_displacement: Floats
    contact_loss_fraction: Floats
    friction_ratio: Floats
    raw_friction_ratio: Floats
    friction_reduction: Floats
    friction_coefficient: Floats
    friction_force: Floats
    power_to_supply: Floats
    charging_power: Floats
    dissipated_power: Floats
    apparent_power: Floats
    peak_current: Floats
    gap_closed: NDArray[np.bool_]
    amplitude_source: AmplitudeSource
    amplitude_origin: str

    @property
    def failed(self) -> NDArray[np.bool_]:
        """Points without a friction ratio."""
        return np.isnan(self.friction_ratio)


def operating_points(
    rig: Rig | ResolvedRig,
    *,
    voltage_peak_to_peak: ArrayLike | None = None,
    voltage_offset: ArrayLike | None = None,
    frequency: ArrayLike | None = None,
    normal_load: ArrayLike | None = None,
    sliding_speed: ArrayLike | None = None,
    vibration_amplitude: ArrayLike | None = None,
    advance: Advance | None = None,
) -> OperatingPoints:
    """Operating points of a rig over arrays of settings; settings that are absent are the rig's own.

    Parameters
    ----------
    rig : Rig or ResolvedRig
        Its vibration is by the source of its amplitude: of a structure, or a sine.
    voltage_peak_to_peak : array_like, optional
        Peak-to-peak voltage of the drive. [V]
    voltage_offset : array_like, optional
        Mean voltage of the drive. [V]
    frequency : array_like, optional
        Frequency of the drive; a stated amplitude holds at the rig's own only. [Hz]
    normal_load : array_like, optional
        Force pressing the bodies together; the structure stays as it is. [N]
    sliding_speed : array_like, optional
        Macroscopic relative speed. [m/s]
    vibration_amplitude : array_like, optional
        Amplitude of the sine at any frequency, of a rig without a drive voltage. [m]
    advance : callable, optional
        Called with the number of vibrations done, and of all.

    Returns
    -------
    OperatingPoints

    Raises
    ------
    InvalidInput
        If the rig has no amplitude, a setting has no meaning or shapes do not match.
        Not for a point that is impossible, which has its status.

    Notes
    -----
    Steady vibrations are found in one batch, each drive and load once, whatever the number of sliding speeds.
    """
    resolved = resolved_rig(rig)
    rig, used = resolved.rig, resolved.vibration
    given = (voltage_peak_to_peak, voltage_offset, frequency, normal_load, sliding_speed)
    columns, speeds = conditions_of(rig, given, vibration_amplitude=vibration_amplitude)
    commanded = vibration_amplitude is not None
    shape = speeds.shape
    distinct, which = np.unique(columns.reshape(4, -1), axis=1, return_inverse=True)
    speeds = speeds.ravel()
    if used.driven is None:
        vibration_at = stated_vibrations(resolved, distinct, commanded=commanded)
    else:
        vibration_at = computed_vibrations(resolved, distinct)

    status, reason = np.full((2, speeds.size), REFUSED, dtype=object)
    numbers = np.full((len(VIBRATION_NUMBERS) + 3, speeds.size), np.nan)
    for setting, members in enumerate(points_by_vibration(np.arange(speeds.size), which.ravel())):
        vibration = vibration_at(setting)
        status[members], reason[members] = vibration.status, vibration.reason
        if vibration.motion is not None:
            found = friction_at_speeds(rig, vibration.motion, speeds[members])
            numbers[:-2, members] = np.reshape(vibration.numbers, (-1, 1))
            numbers[-2:, members] = found.friction_ratio, found.raw_friction_ratio
            status[members] = [friction_status(objection) or vibration.status for objection in found.reason]
            reason[members] = [objection or vibration.reason for objection in found.reason]
        if advance is not None:
            advance(setting + 1, distinct.shape[1])
    columns = columns.reshape(4, *shape)
    if commanded:
        columns[0] = 0.0  # without a voltage
    *found_vibration, closed, ratio, raw = numbers.reshape(-1, *shape)
    of_vibration = dict(zip(VIBRATION_NUMBERS, found_vibration, strict=True))
    return OperatingPoints(
        **dict(zip(CONDITIONS, columns, strict=True)),
        sliding_speed=speeds.reshape(shape),
        status=status.astype(np.str_).reshape(shape),
        reason=reason.astype(np.str_).reshape(shape),
        **of_vibration,
        **friction_of(resolved, columns, friction_ratio=ratio, raw_friction_ratio=raw),
        **supplied_power(resolved, columns, dissipated_power=of_vibration["dissipated_power"]),
        gap_closed=closed == 1,
        amplitude_source=used.source,
        amplitude_origin=used.text,
    )


def friction_of(
    resolved: ResolvedRig, columns: Floats, *, friction_ratio: Floats, raw_friction_ratio: Floats
) -> dict[str, Floats]:
    """Friction force, coefficient and reduction from friction ratio and settings, by name."""
    load, coefficient = columns[-1], resolved.rig.friction_coefficient
    return {
        "friction_ratio": friction_ratio,
        "raw_friction_ratio": raw_friction_ratio,
        "friction_reduction": 1 - friction_ratio,
        "friction_coefficient": friction_ratio * coefficient,
        "friction_force": friction_ratio * coefficient * load,
    }


def supplied_power(resolved: ResolvedRig, columns: Floats, *, dissipated_power: Floats) -> dict[str, Floats]:
    """Power to supply and the charge of the capacitance from settings and heat of the motion, by name."""
    u, offset, f, _ = columns
    known = resolved.charging_power(voltage_peak_to_peak=u, voltage_offset=offset, frequency=f)
    charge = np.full(u.shape, np.nan) if known is None else known
    larger = larger_power(charging_power=charge, dissipated_power=dissipated_power)
    return {"power_to_supply": larger, "charging_power": charge}


def steady_states(
    rig: Rig | ResolvedRig,
    *,
    voltage_peak_to_peak: ArrayLike | None = None,
    voltage_offset: ArrayLike | None = None,
    relative_tolerance: float = 1e-6,
) -> SteadyStates:
    """Steady vibrations of a rig under some voltages, harmonics and all.

    Parameters
    ----------
    rig : Rig or ResolvedRig
        With a stack, a structure and a drive voltage.
    voltage_peak_to_peak : array_like, optional
        Swing of the drive, of one axis. [V]
    voltage_offset : array_like, optional
        Mean voltage of the drive. [V]
    relative_tolerance : float
        Largest relative error of amplitude and mean force, from 1e-8 to 1e-3.

    Returns
    -------
    SteadyStates

    Raises
    ------
    InvalidInput
        If the rig has no structure, a setting has no meaning, or the tolerance is out of its range.
    """
    resolved = resolved_rig(rig)
    columns, _ = conditions_of(resolved.moved, (voltage_peak_to_peak, voltage_offset, None, None, None))
    columns = columns.reshape(4, -1)
    rest = separation(resolved.rig.contact, normal_load=columns[-1])
    return steady_states_of(resolved, columns, rest, relative_tolerance=relative_tolerance)


def friction_status(objection: str) -> str:
    """Status of a point without friction from the reason, empty where there is friction."""
    if not objection:
        return ""
    return OUTSIDE_MODEL_RANGE if objection.startswith(OUTSIDE_MODEL_RANGE) else REFUSED
