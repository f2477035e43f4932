"""Start-up transient of a rig from rest, by time marching."""

import math
from dataclasses import dataclass

from sonolube.checks import require_positive
from sonolube.errors import InvalidInput
from sonolube.models.dynamics.attractor import beat, settling_time
from sonolube.models.dynamics.trajectories import Trajectory
from sonolube.models.dynamics.transient import march, trajectory
from sonolube.rig.record import Rig
from sonolube.rig.resolved_rig import ResolvedRig, drive_and_load, resolved_rig

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
