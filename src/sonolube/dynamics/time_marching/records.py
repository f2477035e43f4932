"""Records of what a structure and its contact did over time."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Complexes, Floats
from sonolube.errors import InvalidInput


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class State:
    """Where all coordinates of a structure are and how fast they move.

    Parameters
    ----------
    coordinates : ndarray, shape (..., n)
    rates : ndarray, shape (..., n)
    """

    coordinates: Floats
    rates: Floats


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Envelope:
    """The contact over time, each entry over a window of whole periods; extremes are those of the steps.

    Parameters
    ----------
    time : ndarray, shape (..., windows)
        End of each window. [s]
    first_harmonic_amplitude : ndarray, shape (..., windows)
        Of the contact's displacement, in m.
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
class ContactMotion:
    """The contact at certain times.

    Parameters
    ----------
    displacement : ndarray, shape (..., times)
        Displacement of the contact. [m]
    velocity : ndarray, shape (..., times)
        Its velocity, in m/s.
    normal_force : ndarray, shape (..., times)
        Contact force. [N]
    """

    displacement: Floats
    velocity: Floats
    normal_force: Floats


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Trajectories:
    """What a batch of points did.

    Parameters
    ----------
    status : ndarray of str, shape (...)
        "marched"; "coarse" where steps are too long for three digits of the force; "diverged" where numbers ran away.
    advice : ndarray of str, shape (...)
        What to do about a status other than "marched", and what the numbers cannot show; often empty.
    step_error : ndarray, shape (...)
        Estimated error of the contact force over its largest value, from the last periods; infinite where diverged.
    envelope : Envelope
    last_periods : ContactMotion
        Each step of the periods recorded, at phases of whole steps, the last one at the end.
    strobed : ContactMotion
        The end of each of the last periods, oldest first.
    final_state : State
        From which to march on.
    """

    status: NDArray[np.str_]
    advice: NDArray[np.str_]
    step_error: Floats
    envelope: Envelope
    last_periods: ContactMotion
    strobed: ContactMotion
    final_state: State


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Trajectory:
    """One point, step by step from the start.

    Parameters
    ----------
    time : ndarray, shape (times,)
        From zero. [s]
    voltage : ndarray, shape (times,)
        Drive voltage in V; at a jump, what follows it.
    contact : ContactMotion
    states : State
        Of shape (times, n).
    status : str
        As in `Trajectories`.
    advice : str
        As in `Trajectories`.
    """

    time: Floats
    voltage: Floats
    contact: ContactMotion
    states: State
    status: str
    advice: str


def displacement_harmonics(motion: ContactMotion, *, steps_per_period: int, count: int) -> tuple[Floats, Complexes]:
    """Return mean and harmonics of the contact's displacement over the last period of a motion.

    Parameters
    ----------
    motion : ContactMotion
        The recorded periods of a march, which end at phase zero.
    steps_per_period : int
        Of that march.
    count : int
        Highest harmonic, less than half the steps a period.

    Returns
    -------
    mean : ndarray, shape (...)
        In m.
    harmonics : ndarray of complex, shape (..., count)
        X_k of x = mean + Re sum X_k exp(2 pi i k f t), in m.

    Raises
    ------
    InvalidInput
        If the count is not positive or too high.
    """
    if not 1 <= count < steps_per_period / 2:
        raise InvalidInput(f"count must lie between 1 and {(steps_per_period - 1) // 2}, got {count!r}")
    period = np.roll(motion.displacement[..., -steps_per_period:], 1, axis=-1)
    coefficients = np.fft.rfft(period) / steps_per_period
    return coefficients[..., 0].real, 2 * coefficients[..., 1 : count + 1]
