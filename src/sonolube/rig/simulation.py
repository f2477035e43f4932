"""The multi-scale model of a rig: drive, structure and contact in one steady vibration, and what it does to sliding."""

from dataclasses import dataclass
from functools import partial

import numpy as np

from sonolube.actuator import stack_doubts
from sonolube.actuator.drive import Drive
from sonolube.actuator.drive_power import driver_power
from sonolube.contact import GapMotion, contact_doubts, separation
from sonolube.dynamics import WAVEFORMS, Structure, harmonics
from sonolube.dynamics.periodic import Status, SteadyStates, steady_state
from sonolube.dynamics.sliding import motion
from sonolube.errors import InvalidInput
from sonolube.friction import FRICTION_CLOSURES
from sonolube.rig.record import Rig
from sonolube.rig.response import gap_law_of, require_drive, require_structure
from sonolube.wear import WEAR_CLOSURES, cube_wear_rate

_VOLTAGE_HARMONICS = 64  # of a square wave the tip feels the 65th by less than 1e-5 of the first
_SAMPLES = 1024


@dataclass(frozen=True, kw_only=True, slots=True)
class Simulation:
    """What a rig does under its drive.

    Parameters
    ----------
    status : str
        "periodic", "unstable" or "several", as the steady state was found.
    reason : str
        What the status means, and what to try.
    vibration_amplitude : float
        Vibration of the tip, zero to peak. [m]
    mean_displacement : float
        Rise of the tip from rest under the load. [m]
    lost_contact_share : float
        Share of the period in which the contact carries less than a hundredth of the load. []
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
    closure : str
        Name of the closure that gave friction.
    wear_rate : float
        Volume of the softer body per sliding distance with vibration, by the cube over the separating half period. [m2]
    actuator_power : float
        Power a linear amplifier supplies, D 1.9. [W]
    dissipated_power : float
        Mean electrical power that stays in stack, dampers and contact. [W]
    doubts : tuple of str
        What speaks against trusting the numbers, each in one line.
    """

    status: str
    reason: str
    vibration_amplitude: float
    mean_displacement: float
    lost_contact_share: float
    friction_force: float
    friction_coefficient: float
    intrinsic_friction_force: float
    friction_ratio: float
    friction_reduction: float
    closure: str
    wear_rate: float
    actuator_power: float
    dissipated_power: float
    doubts: tuple[str, ...]


def simulate(rig: Rig) -> Simulation:
    """Return the steady vibration of a rig under its drive, and friction and wear under it.

    Parameters
    ----------
    rig : Rig
        With a stack, a structure and a drive voltage, its heights exponential.

    Returns
    -------
    Simulation

    Raises
    ------
    InvalidInput
        If the rig has no structure, its heights are not exponential, its voltage goes beyond the stack's limits, or no
        steady vibration was found.
    """
    structure, drive = require_structure(rig), require_drive(rig)
    gap = float(separation(rig.contact, normal_load=rig.normal_load))
    states = steady_state(
        structure,
        gap_law_of(rig),
        normal_load=rig.normal_load,
        frequency=drive.frequency,
        voltage_harmonics=_voltage_harmonics(drive),
        voltage_offset=drive.voltage_offset,
        separation=gap,
    )
    if states.status == Status.NOT_CONVERGED:
        raise InvalidInput(f"{rig.title}: {states.reason(())}")
    moving = _gap_motion(rig, states, drive)
    ratio = _friction_ratio(rig, moving)
    wear_ratio = float(WEAR_CLOSURES["separating_half_period"](rig.contact, moving))
    intrinsic = rig.friction_coefficient * rig.normal_load
    return Simulation(
        status=Status(int(states.status)).name.lower(),
        reason=states.reason(()),
        vibration_amplitude=float(states.vibration_amplitude),
        mean_displacement=float(states.mean_displacement),
        lost_contact_share=float(states.lost_contact_share),
        friction_force=ratio * intrinsic,
        friction_coefficient=ratio * rig.friction_coefficient,
        intrinsic_friction_force=intrinsic,
        friction_ratio=ratio,
        friction_reduction=1 - ratio,
        closure=rig.closure,
        wear_rate=wear_ratio * float(cube_wear_rate(rig.contact, normal_load=rig.normal_load)),
        actuator_power=_actuator_power(rig, drive),
        dissipated_power=float(states.dissipated_power),
        doubts=(*contact_doubts(rig.contact, separation=gap), *_doubts(rig, states, structure, drive)),
    )


def _friction_ratio(rig: Rig, moving: GapMotion) -> float:
    closure = FRICTION_CLOSURES[rig.closure]
    if rig.closure == "coupled":  # the one closure whose limit is the friction itself
        closure = partial(closure, friction_coefficient=rig.friction_coefficient)
    return float(closure(rig.contact, moving, sliding_speed=rig.sliding_speed))


def _voltage_harmonics(drive: Drive) -> np.ndarray[tuple[int], np.dtype[np.complex128]]:
    assert drive.voltage_peak_to_peak is not None
    count = 1 if drive.waveform == "sine" else _VOLTAGE_HARMONICS
    return 2 * drive.voltage_peak_to_peak * harmonics(WAVEFORMS[drive.waveform], count)[1:]


def _gap_motion(rig: Rig, states: SteadyStates, drive: Drive) -> GapMotion:
    period = motion(states, (), samples=_SAMPLES)
    return GapMotion(
        displacement=period.displacement,
        normal_force=period.normal_force,
        frequency=drive.frequency,
        normal_load=rig.normal_load,
    )


def _actuator_power(rig: Rig, drive: Drive) -> float:
    assert rig.stack is not None
    assert drive.voltage_peak_to_peak is not None
    return float(
        driver_power(
            capacitance=rig.stack.free_capacitance,
            voltage_maximum=abs(drive.voltage_offset) + drive.voltage_peak_to_peak / 2,
            voltage_peak_to_peak=drive.voltage_peak_to_peak,
            frequency=drive.frequency,
        )
    )


def _doubts(rig: Rig, states: SteadyStates, structure: Structure, drive: Drive) -> tuple[str, ...]:
    assert rig.stack is not None
    assert drive.voltage_peak_to_peak is not None
    # the stack's elongation in complex amplitude, from the charge on it: q = C_S V + b.x
    charge = complex(states.current_harmonics[0]) / (2j * np.pi * drive.frequency)
    voltage = complex(states.voltage_harmonics[0])
    elongation = (charge - structure.clamped_capacitance * voltage) / rig.stack.charge_per_elongation
    doubts = stack_doubts(
        rig.stack,
        voltage_offset=drive.voltage_offset,
        voltage_peak_to_peak=drive.voltage_peak_to_peak,
        elongation=elongation * abs(voltage) / voltage if voltage else 0.0,
        frequency=drive.frequency,
    )
    if bool(states.gap_closed):
        doubts = (
            *doubts,
            "the mean planes meet within the period: asperities no longer stand alone; lower the voltage",
        )
    return doubts
