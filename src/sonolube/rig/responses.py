"""Linear frequency response and start-up transient of a rig, and labelled datasets of its results.

Amplitude per volt and electrical impedance with the contact linearised; start-up from rest by time marching.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput
from sonolube.models.contact import separation
from sonolube.models.contact.rough import normal_stiffness
from sonolube.models.dynamics import modes
from sonolube.models.dynamics.attractor import beat, settling_time
from sonolube.models.dynamics.motions import Trajectory
from sonolube.models.dynamics.structure import Structure, drive_receptance, electrical_admittance, with_contact_spring
from sonolube.models.dynamics.transient import march, trajectory
from sonolube.rig.datasets import LabelledArray, LabelledArrays, labelled, labels, result_quantities, result_texts
from sonolube.rig.driven_rig import driven_rig
from sonolube.rig.record import Rig
from sonolube.rig.resolved_rig import ResolvedRig, drive_and_load, resolved_rig
from sonolube.rig.simulation import Simulation
from sonolube.rig.vibration import SteadyVibration


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class FrequencyResponse:
    """Frequency response of a rig under its load, the contact linearised to its stiffness at rest.

    Parameters
    ----------
    frequency : ndarray, shape (n,)
        Frequency of the drive. [Hz]
    amplitude_per_volt : ndarray, shape (n,)
        Amplitude of the contact, zero to peak, per volt peak to peak. [m/V]
    impedance : ndarray, shape (n,)
        Magnitude of the stack's electrical impedance. [ohm]
    phase : ndarray, shape (n,)
        Its phase: voltage ahead of current. [rad]
    """

    frequency: Floats
    amplitude_per_volt: Floats
    impedance: Floats
    phase: Floats


def frequency_response(rig: Rig | ResolvedRig, *, frequency: ArrayLike) -> FrequencyResponse:
    """Frequency response of a rig to small voltages, with the contact linearised at rest.

    Parameters
    ----------
    rig : Rig or ResolvedRig
        With a stack and a structure.
    frequency : array_like, shape (n,)
        Frequencies of the drive. [Hz]

    Returns
    -------
    FrequencyResponse

    Raises
    ------
    InvalidInput
        If the rig has no structure, or a frequency is not positive.

    Notes
    -----
    D figure 3.12 in kind. Contact forces that are not small against the load need `simulate`.
    """
    f = np.atleast_1d(require_positive(frequency=frequency))
    touching = structure_in_contact(rig)
    impedance = 1 / electrical_admittance(touching, frequency=f)
    return FrequencyResponse(
        frequency=f,
        amplitude_per_volt=np.abs(drive_receptance(touching, frequency=f)) / 2,
        impedance=np.abs(impedance),
        phase=np.angle(impedance),
    )


def structure_in_contact(rig: Rig | ResolvedRig) -> Structure:
    """Structure of a rig with the contact as a spring of its stiffness at rest, which a tip in the plane does not have.

    Raises
    ------
    InvalidInput
        If the rig has no structure.
    OutsideRange
        If its load leaves no separation.
    """
    resolved = resolved_rig(rig)
    if resolved.rig.direction.is_in_plane:
        return driven_rig(resolved.rig).structure
    stiffness = float(normal_stiffness(resolved.rig.contact, separation=resolved.separation))
    return with_contact_spring(driven_rig(resolved.rig).structure, normal_stiffness=stiffness)


def frequency_grid(
    rig: Rig | ResolvedRig, *, lowest: float, highest: float, points: int = 2000, resonance_points: int = 201
) -> Floats:
    """Frequencies spaced evenly on a logarithmic axis, and more densely at the resonances.

    Parameters
    ----------
    rig : Rig or ResolvedRig
        With a stack and a structure.
    lowest, highest : float
        Ends of the range, in Hz.
    points : int
        Number spaced evenly.
    resonance_points : int
        Number at each resonance.

    Returns
    -------
    ndarray
        In Hz, rising.
    """
    even = np.geomspace(lowest, highest, points)
    natural = modes(structure_in_contact(rig))
    offsets = np.sinh(np.linspace(-6, 6, resonance_points)) / np.sinh(6)
    widths = np.maximum(20 * natural.damping_ratio, 1e-4)
    near = (natural.natural_frequency[:, np.newaxis] * (1 + widths[:, np.newaxis] * offsets)).ravel()
    inside = near[(near > lowest) & (near < highest)]
    return np.unique(np.concatenate([even, inside]))


_WINDOWS = 400
_LONGEST = 200_000  # periods whose every step still fits a figure's memory


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class StartUp:
    """Start-up transient of a rig: settling time, final amplitude and every time step.

    Parameters
    ----------
    status : str
        "marched", "coarse" or "diverged".
    reason : str
        Advice for a status other than "marched".
    settling_time : float
        Time after which the amplitude stays within 2 % of its last value. [s]
    vibration_amplitude : float
        Amplitude of the first harmonic of the tip at the end. [m]
    mean_displacement : float
        Mean displacement of the tip at the end. [m]
    beat_frequency : float
        Frequency of the slow oscillation beside the ultrasonic one. [Hz]
    trajectory : Trajectory
        Every time step.
    """

    status: str
    reason: str
    settling_time: float
    vibration_amplitude: float
    mean_displacement: float
    beat_frequency: float
    trajectory: Trajectory


def start_up(rig: Rig | ResolvedRig, *, duration: float) -> StartUp:
    """Start-up transient of a rig from rest, with the drive switched on at once or by its ramp.

    Parameters
    ----------
    rig : Rig or ResolvedRig
        With a stack, a structure and a drive voltage.
    duration : float
        Duration to compute. [s]

    Returns
    -------
    StartUp

    Raises
    ------
    InvalidInput
        If the rig has no structure, or the duration is not from 8 to 200 000 periods of the drive.

    Notes
    -----
    D figure 3.13 in kind.
    """
    resolved = resolved_rig(rig)
    structure, drive = resolved.moved.structure, resolved.moved.drive
    resolved.require_separation()
    periods = math.ceil(float(require_positive(duration=duration)) * drive.frequency)
    if not 8 <= periods <= _LONGEST:
        raise InvalidInput(f"duration must be from 8 to {_LONGEST} periods of the drive, got {periods}")
    law, window = resolved.gap_law, max(1, periods // _WINDOWS)
    marched = march(
        structure, law, periods=periods // window * window, periods_per_window=window, **drive_and_load(resolved)
    )
    every_step = trajectory(structure, law, periods=periods, **drive_and_load(resolved))
    envelope = marched.envelope
    slow = beat(displacement=envelope.mean_displacement, interval=window / drive.frequency)
    return StartUp(
        status=str(marched.status),
        reason=str(marched.advice),
        settling_time=float(settling_time(envelope)),
        vibration_amplitude=float(envelope.first_harmonic_amplitude[-1]),
        mean_displacement=float(envelope.mean_displacement[-1]),
        beat_frequency=float(slow.beat_frequency),
        trajectory=every_step,
    )


def simulation_arrays(rig: Rig, result: Simulation) -> LabelledArrays:
    """One repetition of the steady vibration, and the friction and wear under it.

    Displacement and contact force over `time`; every quantity of the result as a scalar, NaN outside the range of a
    model. Attributes hold the texts of the result, its caveats and the assumptions of the rig.
    """
    vibration = result.vibration
    motion = rig.direction.over_gap(vibration.motions[0])
    time = np.arange(motion.displacement.size) / (motion.displacement.size * motion.frequency)
    values = {"time": time, "displacement": motion.displacement, "normal_force": motion.normal_force}
    within = {"displacement_along": motion.along, "displacement_across": motion.across}
    values |= {name: moved for name, moved in within.items() if moved is not None}
    moving = labelled(values, along="time", title=f"Steady motion of {rig.title}")
    scalars = {
        name: LabelledArray(dims=(), values=np.asarray(np.nan if value is None else value), attrs=labels(name))
        for name, value in result_quantities(result).items()
        if name not in moving
    }
    about = result_texts(result) | {
        "result": "simulation",
        "rig": rig.title,
        "caveats": "\n".join(result.caveats),
        "assumptions": "\n".join(f"{key}: {reason}" for key, reason in rig.assumptions.items()),
        "interval": _interval_of(vibration),
        "attractor": vibration.attractor,
        "repetition_periods": vibration.repetition_periods,
        "normal_load_N": motion.normal_load,
        "separation_at_rest_m": float(separation(rig.contact, normal_load=rig.normal_load)),
        "mean_displacement_m": vibration.mean_displacement,
        "contact_loss_fraction": vibration.contact_loss_fraction,
    }
    return replace(moving, variables={**moving.variables, **scalars}).assign_attrs(**about)


def response_arrays(rig: Rig, result: FrequencyResponse) -> LabelledArrays:
    """Linear response over frequency: amplitude per volt, magnitude and phase of the impedance; over `frequency`."""
    names = ("frequency", "amplitude_per_volt", "impedance", "phase")
    values = {name: getattr(result, name) for name in names}
    return labelled(values, along="frequency", title=f"Linear response of {rig.title}")


def start_up_arrays(rig: Rig, result: StartUp) -> LabelledArrays:
    """Start-up from rest: displacement and contact force at every step of the time integration; over `time`."""
    values = {
        "time": result.trajectory.time,
        "displacement": result.trajectory.contact.displacement,
        "normal_force": result.trajectory.contact.normal_force,
    }
    return labelled(values, along="time", title=f"Start-up of {rig.title}")


def _interval_of(result: SteadyVibration) -> str:
    """Interval of a steady motion: a period, several periods, or part of an aperiodic motion."""
    if result.repetition_periods == 1:
        return "one period of the drive"
    if result.repetition_periods:
        return f"{result.repetition_periods} periods of the drive, after which the motion repeats"
    return f"a stretch of a motion that does not repeat: {result.attractor}"
