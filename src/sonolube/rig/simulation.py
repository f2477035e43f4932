"""The multi-scale model of a rig: drive, structure and contact in one steady vibration, and what it does to sliding."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from sonolube.actuator import stack_caveats
from sonolube.contact import GapMotion, contact_caveats
from sonolube.rig.driven_rig import DrivenRig, driven_rig
from sonolube.rig.excitation import amplifier_power, voltage_harmonics, voltage_range
from sonolube.rig.friction_and_wear import friction_ratio, wear_model_of, wear_rate_ratio
from sonolube.rig.linear_response import rest_separation
from sonolube.rig.record import Rig
from sonolube.rig.steady_vibration import SteadyMotion, steady_motion
from sonolube.wear import cube_wear_rate


@dataclass(frozen=True, kw_only=True, slots=True)
class Simulation:
    """What a rig does under its drive.

    Parameters
    ----------
    status : str
        "periodic", "unstable", "multistable" or "not_converged", as harmonic balance found it.
    reason : str
        What the status means, what the tip does, and what to try.
    attractor : str
        What the tip's motion is: "periodic", "subharmonic", "beating", "chaotic" or "settling".
    repetition_periods : int
        Periods of the drive after which the motion repeats, zero where it does not. []
    vibration_amplitude : float
        Vibration of the tip, zero to peak; the mean over periods of the drive where these differ. [m]
    lowest_amplitude, highest_amplitude : float or None
        The least and the largest of any period, where these differ. [m]
    coexisting_amplitude : float or None
        Vibration of the tip in another steady motion under the same drive, where one was found. [m]
    beat_frequency : float or None
        Frequency of a slow motion of the tip beside the vibration. [Hz]
    beat_amplitude : float or None
        Its amplitude. [m]
    mean_displacement : float
        Rise of the tip from rest under the load. [m]
    contact_loss_fraction : float
        Share of the time in which the contact carries less than a hundredth of the load. []
    friction_force : float
        Mean friction force with vibration. [N]
    friction_coefficient : float
        That force over the normal load. []
    intrinsic_friction_force : float
        Friction force without vibration. [N]
    friction_ratio : float
        Friction with vibration over friction without. []
    friction_reduction : float
        One minus that ratio. []
    friction_model : str
        Name of the friction model.
    citation : str
        Source of the friction model.
    wear_model : str
        Name of the wear model: that of the friction model's name where there is one.
    wear_rate : float
        Volume of the softer body per sliding distance with vibration, by the cube over the separating half period. [m2]
    actuator_power : float
        Power a linear amplifier supplies, D 1.9. [W]
    dissipated_power : float
        Mean electrical power that stays in stack, dampers and contact. [W]
    caveats : tuple of str
        What speaks against trusting the numbers, each in one line.
    motion : GapMotion
        One repetition of the tip's motion, or a stretch of one that does not repeat.
    """

    status: str
    reason: str
    attractor: str
    repetition_periods: int
    vibration_amplitude: float
    lowest_amplitude: float | None
    highest_amplitude: float | None
    coexisting_amplitude: float | None
    beat_frequency: float | None
    beat_amplitude: float | None
    mean_displacement: float
    contact_loss_fraction: float
    friction_force: float
    friction_coefficient: float
    intrinsic_friction_force: float
    friction_ratio: float
    friction_reduction: float
    friction_model: str
    citation: str
    wear_rate: float
    wear_model: str
    actuator_power: float
    dissipated_power: float
    caveats: tuple[str, ...]
    motion: GapMotion


def simulate(rig: Rig) -> Simulation:
    """Return the steady motion of a rig under its drive, and friction and wear under it.

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
    A vibration that repeats with the drive is found by harmonic balance; where that is unstable, not the only one or
    not found, the rig is marched from rest, as `steady_motion` says.
    """
    rig = driven_rig(rig)
    gap = rest_separation(rig)
    moving = steady_motion(rig)
    ratio = _mean(partial(friction_ratio, rig), moving.motions)
    wear_ratio = _mean(partial(wear_rate_ratio, rig), moving.motions)
    intrinsic = rig.friction_coefficient * rig.normal_load
    return Simulation(
        status=moving.status,
        reason=moving.reason,
        attractor=moving.attractor,
        repetition_periods=moving.repetition_periods,
        vibration_amplitude=moving.vibration_amplitude,
        lowest_amplitude=moving.lowest_amplitude if moving.repetition_periods != 1 else None,
        highest_amplitude=moving.highest_amplitude if moving.repetition_periods != 1 else None,
        coexisting_amplitude=moving.coexisting_amplitude,
        beat_frequency=moving.beat_frequency,
        beat_amplitude=moving.beat_amplitude,
        mean_displacement=moving.mean_displacement,
        contact_loss_fraction=moving.contact_loss_fraction,
        friction_force=ratio * intrinsic,
        friction_coefficient=ratio * rig.friction_coefficient,
        intrinsic_friction_force=intrinsic,
        friction_ratio=ratio,
        friction_reduction=1 - ratio,
        friction_model=rig.friction_model.name,
        citation=rig.friction_model.citation,
        wear_rate=wear_ratio * float(cube_wear_rate(rig.contact, normal_load=rig.normal_load)),
        wear_model=wear_model_of(rig),
        actuator_power=float(amplifier_power(rig.drive, capacitance=rig.stack.free_capacitance)),
        dissipated_power=moving.dissipated_power,
        caveats=(*contact_caveats(rig.contact, separation=gap), *_caveats(rig, moving)),
        motion=moving.motions[0],
    )


def _mean(of: Callable[[GapMotion], float], motions: tuple[GapMotion, ...]) -> float:
    """Return the mean over time, which stretches of a motion share unequally."""
    return float(np.average([of(motion) for motion in motions], weights=[1 / motion.frequency for motion in motions]))


def _caveats(rig: DrivenRig, moving: SteadyMotion) -> tuple[str, ...]:
    voltage = complex(voltage_harmonics(rig.drive)[0])
    caveats = stack_caveats(
        rig.stack,
        voltage_offset=float(sum(voltage_range(rig.drive))) / 2,
        voltage_peak_to_peak=rig.voltage_peak_to_peak,
        elongation=moving.elongation * abs(voltage) / voltage if voltage else 0.0,
        frequency=rig.drive.frequency,
    )
    if moving.gap_closed:
        caveats = (
            *caveats,
            "the mean planes meet within the period: asperities no longer stand alone; lower the voltage",
        )
    return caveats
