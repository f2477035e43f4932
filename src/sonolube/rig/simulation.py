"""Multi-scale simulation of a rig: steady vibration of structure and contact, and friction and wear under it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sonolube.actuator import stack_caveats
from sonolube.contact import GapMotion, contact_caveats
from sonolube.friction.models.range_check import OUTSIDE_MODEL_RANGE, CheckedRatio
from sonolube.rig.driven_rig import DrivenRig, driven_rig
from sonolube.rig.excitation import amplifier_power, voltage_harmonics, voltage_range
from sonolube.rig.friction_and_wear import friction_ratios, wear_model_of, wear_rate_ratio
from sonolube.rig.linear_response import rest_separation
from sonolube.rig.operating_point import FrictionPoint, WearPoint, friction_under, wear_under
from sonolube.rig.record import Rig
from sonolube.rig.vibration import SteadyVibration, steady_vibration


@dataclass(frozen=True, kw_only=True, slots=True)
class Simulation:
    """Steady vibration of a rig under its drive, with friction, wear and power.

    Parameters
    ----------
    status : str
        Status of the vibration; "outside_model_range" where the friction model has no meaning for it.
    reason : str
        Meaning of the status, and description of the motion.
    vibration : SteadyVibration
        Steady vibration of the tip: status, kind, amplitudes and sampled motion.
    friction : FrictionPoint
        Friction under it, and the power that a linear amplifier supplies, D 1.9.
    wear : WearPoint
        Wear under it, by the wear model of the friction model's name where there is one.
    caveats : tuple of str
        Reasons for caution about the numbers, one line each.
    """

    status: str
    reason: str
    vibration: SteadyVibration
    friction: FrictionPoint
    wear: WearPoint
    caveats: tuple[str, ...]


def simulate(rig: Rig) -> Simulation:
    """Return the steady vibration of a rig under its drive, and friction and wear under it.

    Parameters
    ----------
    rig : Rig
        With a stack, a structure and a drive voltage.

    Returns
    -------
    Simulation

    Raises
    ------
    InvalidInput
        If the rig has no structure, its voltage goes beyond the stack's limits, or no
        motion was found.

    Notes
    -----
    A vibration of the period of the drive is computed by harmonic balance; where that is unstable, not the only one or
    not found, the rig is marched in time from rest (see `steady_vibration`).
    """
    rig = driven_rig(rig)
    gap = rest_separation(rig)
    vibration = steady_vibration(rig)
    caveats = (*contact_caveats(rig.contact, separation=gap), *_caveats(rig, vibration))
    friction = friction_under(
        rig,
        ratio=_mean_friction(rig, vibration.motions),
        vibration_amplitude=vibration.vibration_amplitude,
        actuator_power=float(amplifier_power(rig.drive, capacitance=rig.stack.free_capacitance)),
        caveats=caveats,
    )
    return Simulation(
        status=OUTSIDE_MODEL_RANGE if friction.reason else vibration.status,
        reason=friction.reason or vibration.reason,
        vibration=vibration,
        friction=friction,
        wear=wear_under(
            rig,
            ratio=_mean([wear_rate_ratio(rig, motion) for motion in vibration.motions], vibration.motions),
            model=wear_model_of(rig),
            vibration_amplitude=vibration.vibration_amplitude,
            caveats=caveats,
            reason=friction.reason if wear_model_of(rig) == friction.friction_model else None,
        ),
        caveats=caveats,
    )


def _mean_friction(rig: DrivenRig, motions: tuple[GapMotion, ...]) -> CheckedRatio:
    """Return the mean friction ratio over several motions; that of the first outside the model's range withholds it."""
    every = [friction_ratios(rig, motion, sliding_speed=rig.sliding_speed) for motion in motions]
    raw = _mean([float(one.raw_friction_ratio) for one in every], motions)
    reason = next((str(one.reason) for one in every if one.reason), "")
    valid = np.asarray(np.nan if reason else raw)
    return CheckedRatio(friction_ratio=valid, raw_friction_ratio=np.asarray(raw), reason=np.asarray(reason))


def _mean(values: Sequence[float], motions: tuple[GapMotion, ...]) -> float:
    """Return the mean over time of a quantity of several motions of unequal duration."""
    return float(np.average(values, weights=[1 / motion.frequency for motion in motions]))


def _caveats(rig: DrivenRig, vibration: SteadyVibration) -> tuple[str, ...]:
    voltage = complex(voltage_harmonics(rig.drive)[0])
    caveats = stack_caveats(
        rig.stack,
        voltage_offset=float(sum(voltage_range(rig.drive))) / 2,
        voltage_peak_to_peak=rig.voltage_peak_to_peak,
        elongation=vibration.elongation * abs(voltage) / voltage if voltage else 0.0,
        frequency=rig.drive.frequency,
    )
    if vibration.gap_closed:
        caveats = (
            *caveats,
            "the mean planes touch within the period, where asperities interact and the contact law fails;"
            " lower the voltage",
        )
    return caveats
