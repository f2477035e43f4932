"""The steady motion of a rig's tip: balanced where a period of the drive repeats, marched in time where not."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from sonolube.actuator.drive import Drive
from sonolube.contact import GapMotion, separation
from sonolube.dynamics.long_time_response import Attained, attained_motion
from sonolube.dynamics.steady_friction import motion
from sonolube.dynamics.steady_state import Status, SteadyStates, steady_state
from sonolube.errors import OutsideRange
from sonolube.rig.driven_rig import DrivenRig, driven_rig
from sonolube.rig.excitation import ramp_of, voltage_harmonics, waveform_of
from sonolube.rig.linear_response import gap_law_of
from sonolube.rig.record import Rig
from sonolube.units import format_si

_SAMPLES = 1024
_STRETCHES = 16  # of a motion whose beat is too fast or too slow to cut by
_LONGEST_STRETCH = 40_000  # steps between cuts; half as many again is what means over it can still be refined from
_SAME = 0.01  # relative difference of amplitude within which two vibrations are one


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class SteadyMotion:
    """What the tip does when transients are gone.

    Parameters
    ----------
    status : str
        "periodic", "unstable", "multistable" or "not_converged", as harmonic balance found it.
    reason : str
        What the status means, and what the tip does.
    attractor : str
        "periodic", "subharmonic", "beating", "chaotic" or "settling".
    repetition_periods : int
        Periods of the drive after which the motion repeats, zero where it does not. []
    motions : tuple of GapMotion
        One repetition; of a motion that does not repeat, stretches from one widest gap to another, each closed.
    vibration_amplitude : float
        Half of the displacement from peak to peak, the mean over periods where these differ. [m]
    lowest_amplitude, highest_amplitude : float
        The least and the largest of any period. [m]
    mean_displacement : float
        Rise of the tip from rest under the load. [m]
    contact_loss_fraction : float
        Share of the time in which the contact carries less than a hundredth of the load. []
    beat_frequency : float or None
        Frequency of a slow motion beside the vibration. [Hz]
    beat_amplitude : float or None
        Its amplitude. [m]
    coexisting_amplitude : float or None
        Amplitude of another vibration under the same drive, where one was found. [m]
    dissipated_power : float
        Mean electrical power that stays in stack, dampers and contact. [W]
    elongation : complex
        First harmonic of the stack's elongation. [m]
    gap_closed : bool
        Whether the mean planes meet.
    """

    status: str
    reason: str
    attractor: str
    repetition_periods: int
    motions: tuple[GapMotion, ...]
    vibration_amplitude: float
    lowest_amplitude: float
    highest_amplitude: float
    mean_displacement: float
    contact_loss_fraction: float
    beat_frequency: float | None
    beat_amplitude: float | None
    coexisting_amplitude: float | None
    dissipated_power: float
    elongation: complex
    gap_closed: bool


def steady_motion(rig: Rig) -> SteadyMotion:
    """Return what a rig's tip does under its drive when transients are gone.

    Parameters
    ----------
    rig : Rig
        With a stack, a structure and a drive voltage.

    Returns
    -------
    SteadyMotion

    Raises
    ------
    InvalidInput
        If the rig has no structure, or neither harmonic balance nor marching finds a motion.
    OutsideRange
        If the drive is too slow beside the structure's fastest mode.

    Notes
    -----
    Where the balanced vibration is stable and alone it is what appears. Anything else is marched from rest, the voltage
    coming up as the rig's drive says, until transients have died out.
    """
    rig = driven_rig(rig)
    balanced = _balanced(rig, falling=False)
    if balanced.status == Status.PERIODIC:
        return _of_balance(rig, balanced, balanced.reason(()))
    if balanced.stability_undetermined(()):
        raise OutsideRange(balanced.reason(()))
    attained = _marched(rig)
    told = f"{_why_marched(balanced)}; {_from_rest(rig.drive)}"
    found = attained.attractor
    if balanced.status == Status.MULTISTABLE and found.order == 1:
        for states in (balanced, _balanced(rig, falling=True)):
            if _same(states, attained):
                appears = format_si(float(states.vibration_amplitude), "m")
                return _of_balance(rig, states, f"{told} that of {appears} appears{states.hopping(())}")
    early = "" if attained.settled else f"; followed for {format_si(attained.marched_time, 's')}, before all is settled"
    return _of_march(rig, attained, balanced, f"{told} the tip ends up otherwise: {found.description}{early}")


def gap_motion(states: SteadyStates, point: int | tuple[int, ...]) -> GapMotion:
    """Return one steady vibration as a sampled motion of the gap.

    Parameters
    ----------
    states : SteadyStates
    point : int or tuple of int
        Index into the batch.

    Returns
    -------
    GapMotion

    Raises
    ------
    InvalidInput
        If the point did not converge.
    """
    period = motion(states, point, samples=_SAMPLES)
    return GapMotion(
        displacement=period.displacement,
        normal_force=period.normal_force,
        frequency=float(states.frequency[point]),
        normal_load=float(states.normal_load[point]),
    )


def _balanced(rig: DrivenRig, *, falling: bool) -> SteadyStates:
    drive = rig.drive
    return steady_state(
        rig.structure,
        gap_law_of(rig),
        normal_load=rig.normal_load,
        frequency=drive.frequency,
        voltage_harmonics=voltage_harmonics(drive),
        voltage_offset=drive.voltage_offset,
        separation=separation(rig.contact, normal_load=rig.normal_load),
        falling=falling,
    )


def _marched(rig: DrivenRig) -> Attained:
    drive = rig.drive
    return attained_motion(
        rig.structure,
        gap_law_of(rig),
        normal_load=rig.normal_load,
        frequency=drive.frequency,
        voltage_peak_to_peak=rig.voltage_peak_to_peak,
        voltage_offset=drive.voltage_offset,
        waveform=waveform_of(drive),
        ramp=ramp_of(drive),
    )


def _why_marched(states: SteadyStates) -> str:
    this, other = (format_si(float(each), "m") for each in (states.vibration_amplitude, states.coexisting_amplitude))
    if states.status == Status.UNSTABLE:
        return f"unstable: of the vibration of {this} that repeats with the drive the smallest disturbance grows"
    if states.status == Status.MULTISTABLE:
        return f"multistable: vibrations of {this} and of {other} are both possible"
    return "not_converged: no vibration at the drive's own period was found; less voltage or more damping may give one"


def _from_rest(drive: Drive) -> str:
    if drive.ramp_duration == 0:
        return "switched on at once,"
    return f"with the voltage brought up by a {drive.ramp_shape} ramp of {format_si(drive.ramp_duration, 's')},"


def _same(states: SteadyStates, attained: Attained) -> bool:
    own = float(states.vibration_amplitude)
    return bool(abs(attained.amplitudes[0] - own) <= _SAME * own)


def _of_balance(rig: DrivenRig, states: SteadyStates, reason: str) -> SteadyMotion:
    drive, amplitude, rival = rig.drive, float(states.vibration_amplitude), float(states.coexisting_amplitude)
    # the stack's elongation in complex amplitude, from the charge on it: q = C_S V + b.x
    charge = complex(states.current_harmonics[0]) / (2j * np.pi * drive.frequency)
    moved = charge - states.structure.clamped_capacitance * complex(states.voltage_harmonics[0])
    return SteadyMotion(
        status=Status(int(states.status)).name.lower(),
        reason=reason,
        attractor="periodic",
        repetition_periods=1,
        motions=(gap_motion(states, ()),),
        vibration_amplitude=amplitude,
        lowest_amplitude=amplitude,
        highest_amplitude=amplitude,
        mean_displacement=float(states.mean_displacement),
        contact_loss_fraction=float(states.contact_loss_fraction),
        beat_frequency=None,
        beat_amplitude=None,
        coexisting_amplitude=rival if np.isfinite(rival) else None,
        dissipated_power=float(states.dissipated_power),
        elongation=moved / rig.stack.charge_per_elongation,
        gap_closed=bool(states.gap_closed),
    )


def _of_march(rig: DrivenRig, attained: Attained, balanced: SteadyStates, reason: str) -> SteadyMotion:
    found, drive, record = attained.attractor, rig.drive, attained.record
    slow, repeats = float(found.beat_frequency), int(found.order)
    x, force = record.contact.displacement, record.contact.normal_force
    elongation = record.states.coordinates[:-1] @ rig.structure.drive_vector / rig.stack.charge_per_elongation
    turning = np.exp(-2j * np.pi * drive.frequency * record.time[:-1])
    if repeats:
        motions: tuple[GapMotion, ...] = (_stretch(rig, x[:-1], force[:-1], drive.frequency / repeats),)
    else:
        motions = tuple(_stretches(rig, x, force, attained, drive.frequency))
        told = sum(drive.frequency / each.frequency for each in motions)
        reason += f"; friction and wear are means over {told:.0f} periods of the drive in {len(motions)} stretches"
    unstable = float(balanced.vibration_amplitude)
    return SteadyMotion(
        status=Status(int(balanced.status)).name.lower(),
        reason=reason,
        attractor=str(found.kind),
        repetition_periods=repeats,
        motions=motions,
        vibration_amplitude=float(attained.amplitudes.mean()),
        lowest_amplitude=float(attained.amplitudes.min()),
        highest_amplitude=float(attained.amplitudes.max()),
        mean_displacement=float(x[:-1].mean()),
        contact_loss_fraction=float(found.contact_loss_fraction),
        beat_frequency=slow if slow > 0 and repeats != 1 else None,
        beat_amplitude=float(found.beat_amplitude) if slow > 0 and repeats != 1 else None,
        coexisting_amplitude=unstable if np.isfinite(unstable) and balanced.status == Status.MULTISTABLE else None,
        dissipated_power=attained.dissipated_power,
        elongation=complex(2 * np.mean(elongation * turning)),
        gap_closed=bool(x.min() <= -float(separation(rig.contact, normal_load=rig.normal_load))),
    )


def _stretches(
    rig: Rig, x: NDArray[np.float64], force: NDArray[np.float64], attained: Attained, frequency: float
) -> list[GapMotion]:
    """Cut a motion that does not repeat into beats, where the gap is widest and velocities close; tilt gaps shut."""
    steps, slow = attained.steps_per_period, float(attained.attractor.beat_frequency)
    whole = attained.periods * steps
    beat = round(steps * frequency / slow) if slow > 0 else whole
    if not 4 * steps <= beat <= min(whole // 3, _LONGEST_STRETCH):
        beat = whole // _STRETCHES
    cuts = [int(np.argmax(x[:beat]))]
    while cuts[-1] + 3 * beat // 2 <= whole:
        ahead = cuts[-1] + beat // 2
        cuts.append(ahead + int(np.argmax(x[ahead : ahead + beat])))
    found = []
    for first, last in pairwise(cuts):
        tilt = (x[last] - x[first]) * (np.arange(last - first) / (last - first) - 0.5)
        found.append(_stretch(rig, x[first:last] - tilt, force[first:last], frequency * steps / (last - first)))
    return found


def _stretch(rig: Rig, x: NDArray[np.float64], force: NDArray[np.float64], frequency: float) -> GapMotion:
    return GapMotion(displacement=x, normal_force=force, frequency=frequency, normal_load=rig.normal_load)
