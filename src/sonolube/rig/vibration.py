"""Steady vibration of the tip of a rig: by harmonic balance where periodic and stable, else by time marching."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from sonolube.errors import OutsideRange
from sonolube.models.actuator.drive import Drive
from sonolube.models.contact import ContactMotion, separation_range
from sonolube.models.dynamics import Status, SteadyStates, contact_motion, drive_receptance, steady_state
from sonolube.models.dynamics.long_time_response import LongTimeResponse, march_until_settled
from sonolube.models.friction.models import MeanGap
from sonolube.rig.driven_rig import DrivenRig
from sonolube.rig.friction_and_wear import prescribed_sine
from sonolube.rig.power import electrical_load
from sonolube.rig.record import AmplitudeSource, Rig
from sonolube.rig.resolved_rig import ResolvedRig, drive_and_load, resolved_rig
from sonolube.text.units import format_si

_MEAN_GAPS = {MeanGap.AT_REST: "at rest", MeanGap.LOAD_BALANCED: "that balances the load"}
_CONTACT_LOSS = 0.01  # force over load below which contact counts as lost
_SAMPLES = 1024
_SEGMENTS = 16  # of a motion whose beat is too fast or too slow to cut at
_LONGEST_SEGMENT = 40_000  # steps between cuts, from which period averages can still be refined
_SAME = 0.01  # relative difference of amplitude below which two vibrations count as the same


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class SteadyVibration:
    """Steady vibration of the tip after transients have decayed.

    Parameters
    ----------
    amplitude_source : {"measured", "computed", "waveguide", "per-volt"}
        Where the amplitude comes from.
    amplitude_origin : str
        The same in words, with the numbers behind it.
    prescribed : bool
        Whether it is a sine of a stated amplitude about the mean gap that the friction model is meant for.
    status : str
        "periodic", "unstable", "multistable" or "not_converged", as harmonic balance found it.
    reason : str
        Meaning of the status, and description of the motion.
    attractor : str
        "periodic", "subharmonic", "beating", "chaotic" or "settling".
    repetition_periods : int
        Periods of the drive after which the motion repeats, zero where it does not. []
    motions : tuple of ContactMotion
        One repetition; for a motion that does not repeat, segments from one widest gap to another, each made periodic.
    vibration_amplitude : float
        Half of the displacement from peak to peak, the mean over periods where these differ. [m]
    lowest_amplitude, highest_amplitude : float or None
        Lowest and highest amplitude of any period, where periods differ. [m]
    mean_displacement : float
        Mean displacement of the tip from rest under the load. [m]
    contact_loss_fraction : float
        Share of the time in which the contact carries less than a hundredth of the load. []
    beat_frequency : float or None
        Frequency of a slow motion beside the vibration. [Hz]
    beat_amplitude : float or None
        Its amplitude. [m]
    coexisting_amplitude : float or None
        Amplitude of another steady vibration under the same drive, where one was found. [m]
    dissipated_power : float or None
        Mean electrical power that stays in stack, dampers and contact; None for a prescribed sine. [W]
    apparent_power : float or None
        Root-mean-square voltage times root-mean-square current, of a motion at the period of the drive. [W]
    peak_current : float or None
        Greatest magnitude of that current. [A]
    elongation : complex
        First harmonic of the stack's elongation. [m]
    gap_closed : bool
        Whether the mean planes touch.
    """

    amplitude_source: AmplitudeSource
    amplitude_origin: str
    prescribed: bool
    status: str
    reason: str
    attractor: str = "periodic"
    repetition_periods: int = 1
    motions: tuple[ContactMotion, ...]
    vibration_amplitude: float
    lowest_amplitude: float | None = None
    highest_amplitude: float | None = None
    mean_displacement: float
    contact_loss_fraction: float
    beat_frequency: float | None = None
    beat_amplitude: float | None = None
    coexisting_amplitude: float | None = None
    dissipated_power: float | None = None
    apparent_power: float | None = None
    peak_current: float | None = None
    elongation: complex = 0j
    gap_closed: bool


def steady_vibration(rig: Rig | ResolvedRig) -> SteadyVibration:
    """Steady vibration of a rig by the source of its amplitude, after transients have decayed.

    Parameters
    ----------
    rig : Rig or ResolvedRig

    Returns
    -------
    SteadyVibration

    Raises
    ------
    InvalidInput
        If the rig has no such amplitude, or neither harmonic balance nor marching finds a motion of its structure.
    OutsideRange
        If the drive is too slow beside the structure's fastest mode, or a stated amplitude leaves the range of the
        height distribution.

    Notes
    -----
    A periodic vibration of a structure that is stable and the only one found is the answer. Otherwise the rig is
    marched in time from rest, with the start-up ramp of its drive, until transients have decayed.
    """
    resolved = resolved_rig(rig)
    used = resolved.vibration
    if used.driven is None:
        return _sine(resolved)
    if not resolved.motions:
        resolved.motions.append(_of_structure(resolved, used.driven))
    found: SteadyVibration = resolved.motions[0]
    return found


def _sine(resolved: ResolvedRig) -> SteadyVibration:
    """Sine of the stated amplitude, about the mean gap that the friction model is meant for."""
    rig, used = resolved.require_separation().rig, resolved.vibration
    assert used.sine_amplitude is not None
    motion = prescribed_sine(rig, vibration_amplitude=used.sine_amplitude)
    return SteadyVibration(
        amplitude_source=used.source,
        amplitude_origin=used.text,
        prescribed=True,
        status="periodic",
        reason=f"periodic: a sine about the mean gap {_MEAN_GAPS[rig.friction_model.mean_gap]}",
        motions=(motion,),
        vibration_amplitude=used.sine_amplitude,
        mean_displacement=float(motion.displacement.mean()),
        contact_loss_fraction=contact_loss_fraction(motion),
        gap_closed=bool(motion.displacement.min() <= -resolved.separation),
    )


def contact_loss_fraction(motion: ContactMotion) -> float:
    """Share of a period in which the contact carries less than a hundredth of the load. []"""
    return float(np.mean(motion.normal_force < _CONTACT_LOSS * motion.normal_load))


def _of_structure(resolved: ResolvedRig, rig: DrivenRig) -> SteadyVibration:
    """Steady vibration that the structure of a rig takes up under its drive, scaled where measured."""
    _refuse_drive_beyond_contact(resolved, rig)
    balanced = _balanced(resolved, rig, upper_branch=False)
    if balanced.status == Status.PERIODIC:
        return _of_balance(resolved, rig, balanced, balanced.reason(()))
    if balanced.stability_undetermined(()):
        raise OutsideRange(balanced.reason(()))
    attained = march_until_settled(rig.structure, resolved.gap_law, **drive_and_load(resolved))
    route = f"{_why_marched(balanced)}; {_from_rest(rig.drive)}"
    found = attained.attractor
    if balanced.status == Status.MULTISTABLE and found.order == 1:
        for states in (balanced, _balanced(resolved, rig, upper_branch=True)):
            if _same(states, attained):
                appears = format_si(float(states.vibration_amplitude), "m")
                reason = f"{route} that of {appears} appears{states.contact_loss_note(())}"
                return _of_balance(resolved, rig, states, reason)
    early = "" if attained.settled else f"; followed for {format_si(attained.marched_time, 's')}, before it has settled"
    return _of_march(resolved, rig, attained, balanced, f"{route} another motion appears: {found.description}{early}")


def _refuse_drive_beyond_contact(resolved: ResolvedRig, rig: DrivenRig) -> None:
    """Refuse a drive under which the tip, without contact, would move by more than the contact's force is defined for.

    The force of a rough contact grows as the exponential of the approach; beyond some hundred decay lengths, where the
    range of separations ends, it has no meaning, and marching such a motion in time takes minutes.
    """
    voltage = rig.drive.voltage_peak_to_peak or 0.0
    per_volt = float(np.abs(drive_receptance(rig.structure, frequency=np.array([rig.drive.frequency])))[0]) / 2
    reach = resolved.separation - separation_range(rig.contact)[0]
    if per_volt * voltage <= reach:
        return
    free, most = format_si(per_volt * voltage, "m"), format_si(reach, "m")
    raise OutsideRange(
        f"drive.voltage_peak_to_peak {format_si(voltage, 'V')} would move the tip by {free} without"
        f" contact, beyond the {most} for which the force of this contact is defined; take at most"
        f" {format_si(reach / per_volt, 'V', digits=2)}"
    )


def gap_motion(states: SteadyStates, point: int | tuple[int, ...]) -> ContactMotion:
    """One steady vibration as a sampled motion of the gap.

    Parameters
    ----------
    states : SteadyStates
    point : int or tuple of int
        Index into the batch.

    Returns
    -------
    ContactMotion

    Raises
    ------
    InvalidInput
        If the point did not converge.
    """
    period = contact_motion(states, point, samples=_SAMPLES)
    return ContactMotion(
        displacement=period.displacement,
        normal_force=period.normal_force,
        frequency=float(states.frequency[point]),
        normal_load=float(states.normal_load[point]),
    )


def _balanced(resolved: ResolvedRig, rig: DrivenRig, *, upper_branch: bool) -> SteadyStates:
    drive = rig.drive
    return steady_state(
        rig.structure,
        resolved.gap_law,
        normal_load=rig.normal_load,
        frequency=drive.frequency,
        voltage_harmonics=resolved.voltage.harmonics(),
        voltage_offset=drive.voltage_offset,
        separation=resolved.separation,
        upper_branch=upper_branch,
    )


def _why_marched(states: SteadyStates) -> str:
    this, other = (format_si(float(each), "m") for each in (states.vibration_amplitude, states.coexisting_amplitude))
    if states.status == Status.UNSTABLE:
        return f"unstable: small disturbances of the vibration of {this} at the period of the drive grow"
    if states.status == Status.MULTISTABLE:
        return f"multistable: vibrations of {this} and of {other} are both stable"
    return (
        "not_converged: no vibration at the drive's own period was found; a lower voltage or more damping may give one"
    )


def _from_rest(drive: Drive) -> str:
    if drive.ramp_duration == 0:
        return "switched on at once,"
    return f"with the voltage brought up by a {drive.ramp_shape} ramp of {format_si(drive.ramp_duration, 's')},"


def _same(states: SteadyStates, attained: LongTimeResponse) -> bool:
    own = float(states.vibration_amplitude)
    return bool(abs(attained.amplitudes[0] - own) <= _SAME * own)


def _of_balance(resolved: ResolvedRig, rig: DrivenRig, states: SteadyStates, reason: str) -> SteadyVibration:
    drive, amplitude, rival = rig.drive, float(states.vibration_amplitude), float(states.coexisting_amplitude)
    # the stack's elongation in complex amplitude, from the charge on it: q = C_S V + b.x
    charge = complex(states.current_harmonics[0]) / (2j * np.pi * drive.frequency)
    moved = charge - states.structure.clamped_capacitance * complex(states.voltage_harmonics[0])
    load = electrical_load(states)
    return SteadyVibration(
        amplitude_source=resolved.vibration.source,
        amplitude_origin=resolved.vibration.text,
        prescribed=False,
        status=Status(int(states.status)).name.lower(),
        reason=reason,
        motions=(gap_motion(states, ()),),
        vibration_amplitude=amplitude,
        mean_displacement=float(states.mean_displacement),
        contact_loss_fraction=float(states.contact_loss_fraction),
        coexisting_amplitude=rival if np.isfinite(rival) else None,
        dissipated_power=float(states.dissipated_power),
        apparent_power=float(load["apparent_power"]),
        peak_current=float(load["peak_current"]),
        elongation=moved / rig.stack.charge_per_elongation,
        gap_closed=bool(states.gap_closed),
    )


def _of_march(
    resolved: ResolvedRig, rig: DrivenRig, attained: LongTimeResponse, balanced: SteadyStates, reason: str
) -> SteadyVibration:
    found, drive, record = attained.attractor, rig.drive, attained.record
    slow, repeats = float(found.beat_frequency), int(found.order)
    x, force = record.contact.displacement, record.contact.normal_force
    elongation = record.states.coordinates[:-1] @ rig.structure.drive_vector / rig.stack.charge_per_elongation
    turning = np.exp(-2j * np.pi * drive.frequency * record.time[:-1])
    if repeats:
        motions: tuple[ContactMotion, ...] = (_segment(rig, x[:-1], force[:-1], drive.frequency / repeats),)
    else:
        motions = tuple(_segments(rig, x, force, attained, drive.frequency))
        periods = sum(drive.frequency / each.frequency for each in motions)
        reason += f"; friction and wear are means over {periods:.0f} periods of the drive in {len(motions)} segments"
    unstable = float(balanced.vibration_amplitude)
    return SteadyVibration(
        amplitude_source=resolved.vibration.source,
        amplitude_origin=resolved.vibration.text,
        prescribed=False,
        status=Status(int(balanced.status)).name.lower(),
        reason=reason,
        attractor=str(found.kind),
        repetition_periods=repeats,
        motions=motions,
        vibration_amplitude=float(attained.amplitudes.mean()),
        lowest_amplitude=float(attained.amplitudes.min()) if repeats != 1 else None,
        highest_amplitude=float(attained.amplitudes.max()) if repeats != 1 else None,
        mean_displacement=float(x[:-1].mean()),
        contact_loss_fraction=float(found.contact_loss_fraction),
        beat_frequency=slow if slow > 0 and repeats != 1 else None,
        beat_amplitude=float(found.beat_amplitude) if slow > 0 and repeats != 1 else None,
        coexisting_amplitude=unstable if np.isfinite(unstable) and balanced.status == Status.MULTISTABLE else None,
        dissipated_power=attained.dissipated_power,
        elongation=complex(2 * np.mean(elongation * turning)),
        gap_closed=bool(x.min() <= -resolved.separation),
    )


def _segments(
    rig: Rig, x: NDArray[np.float64], force: NDArray[np.float64], attained: LongTimeResponse, frequency: float
) -> list[ContactMotion]:
    """Segments of a motion that does not repeat, cut at the widest gaps and made periodic by a linear term."""
    steps, slow = attained.steps_per_period, float(attained.attractor.beat_frequency)
    whole = attained.periods * steps
    beat = round(steps * frequency / slow) if slow > 0 else whole
    if not 4 * steps <= beat <= min(whole // 3, _LONGEST_SEGMENT):
        beat = whole // _SEGMENTS
    cuts = [int(np.argmax(x[:beat]))]
    while cuts[-1] + 3 * beat // 2 <= whole:
        ahead = cuts[-1] + beat // 2
        cuts.append(ahead + int(np.argmax(x[ahead : ahead + beat])))
    found = []
    for first, last in pairwise(cuts):
        tilt = (x[last] - x[first]) * (np.arange(last - first) / (last - first) - 0.5)
        found.append(_segment(rig, x[first:last] - tilt, force[first:last], frequency * steps / (last - first)))
    return found


def _segment(rig: Rig, x: NDArray[np.float64], force: NDArray[np.float64], frequency: float) -> ContactMotion:
    return ContactMotion(displacement=x, normal_force=force, frequency=frequency, normal_load=rig.normal_load)
