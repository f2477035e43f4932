"""Records of motions in time: state of a structure, motion of its contact, envelopes, trajectories."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class State:
    """Coordinates of a structure and their velocities at an instant.

    Parameters
    ----------
    coordinates : ndarray, shape (..., n)
        Generalised coordinates x of the structure.
    velocities : ndarray, shape (..., n)
        Their time derivatives.
    """

    coordinates: Floats
    velocities: Floats


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Envelope:
    """Envelope of the contact's motion: statistics of its time steps over windows of whole drive periods.

    Parameters
    ----------
    time : ndarray, shape (..., windows)
        End of each window. [s]
    first_harmonic_amplitude : ndarray, shape (..., windows)
        Amplitude of the first harmonic of the contact's displacement, in m.
    mean_displacement : ndarray, shape (..., windows)
        Mean displacement of the contact. [m]
    highest_displacement : ndarray, shape (..., windows)
        Highest displacement of the contact, in m.
    lowest_displacement : ndarray, shape (..., windows)
        Lowest displacement of the contact, in m.
    mean_normal_force : ndarray, shape (..., windows)
        Mean contact force. [N]
    highest_normal_force : ndarray, shape (..., windows)
        Highest contact force. [N]
    lowest_normal_force : ndarray, shape (..., windows)
        Lowest contact force. [N]
    """

    time: Floats
    first_harmonic_amplitude: Floats
    mean_displacement: Floats
    highest_displacement: Floats
    lowest_displacement: Floats
    mean_normal_force: Floats
    highest_normal_force: Floats
    lowest_normal_force: Floats


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class ContactSamples:
    """Displacement, velocity and force of the contact at a series of instants.

    Parameters
    ----------
    displacement : ndarray, shape (..., times)
        Displacement of the contact. [m]
    velocity : ndarray, shape (..., times)
        Velocity of the contact, in m/s.
    normal_force : ndarray, shape (..., times)
        Contact force. [N]
    """

    displacement: Floats
    velocity: Floats
    normal_force: Floats


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Trajectories:
    """Trajectories of a batch of points by time marching.

    Parameters
    ----------
    status : ndarray of str, shape (...)
        "marched"; "coarse" where the steps are too long for three digits of the force or for stability; "diverged"
        where the solution ran away.
    advice : ndarray of str, shape (...)
        Remedy for a status other than "marched", and limits of the accuracy; often empty.
    step_error : ndarray, shape (...)
        Estimated error of the contact force over its largest value, from the last period; infinite where diverged.
    envelope : Envelope
    last_periods : ContactSamples
        Every step of the recorded periods, at phases of whole steps, the last one at the end.
    strobed : ContactSamples
        Stroboscopic (Poincare) samples: the end of each of the last periods, oldest first.
    final_state : State
        State at the end, from which marching can continue.
    """

    status: NDArray[np.str_]
    advice: NDArray[np.str_]
    step_error: Floats
    envelope: Envelope
    last_periods: ContactSamples
    strobed: ContactSamples
    final_state: State


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Trajectory:
    """Trajectory of one point, with every time step from the start.

    Parameters
    ----------
    time : ndarray, shape (times,)
        Time from the start. [s]
    voltage : ndarray, shape (times,)
        Drive voltage in V; at a jump, the value after it.
    contact : ContactSamples
        Motion of the contact, shape (times,).
    states : State
        State of the structure, shape (times, n).
    status, advice : str
        As in `Trajectories`.
    """

    time: Floats
    voltage: Floats
    contact: ContactSamples
    states: State
    status: str
    advice: str
