"""Records of motions: trajectories in time, a batch of periodic steady states, and the contact over one period."""

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Complexes, Floats
from sonolube.errors import InvalidInput
from sonolube.models.dynamics.gap_laws.closed_form import GapLaw, damped_force
from sonolube.models.dynamics.harmonic_balance.equations import pole_residue_model
from sonolube.models.dynamics.harmonic_balance.floquet_exponent import stability_undetermined
from sonolube.models.dynamics.structure import Structure


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


class Status(IntEnum):
    """Outcome of the computation of a steady state.

    Attributes
    ----------
    PERIODIC
        A vibration of the drive's period, the only one found; stable, unless stability was not requested.
    UNSTABLE
        The vibration has a Floquet multiplier outside the unit circle.
    MULTISTABLE
        Another stable vibration coexists under the same drive.
    NOT_CONVERGED
        No vibration of the drive's period was found, or its stability could not be computed.
    """

    PERIODIC = 0
    UNSTABLE = 1
    MULTISTABLE = 2
    NOT_CONVERGED = 3


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class SteadyStates:
    r"""Steady states of a batch of points; every array starts with the shape of the batch.

    Numbers of a point that did not converge are NaN, and `reason` explains the status.

    Parameters
    ----------
    structure : Structure
    gap_law : GapLaw
    normal_load : ndarray, shape (...)
        Dead load F_N. [N]
    frequency : ndarray, shape (...)
        Frequency f of the drive. [Hz]
    voltage_harmonics : ndarray of complex, shape (..., K)
        Harmonics V_k of the drive, in V.
    voltage_offset : ndarray, shape (...)
        Mean of the drive. [V]
    status : ndarray of int, shape (...)
        Entries of `Status`.
    mean_displacement : ndarray, shape (...)
        Mean displacement of the contact from equilibrium under the dead load. [m]
    harmonics : ndarray of complex, shape (..., H)
        Harmonics X_k of the contact's displacement, in m; zero beyond those that a point requires.
    vibration_amplitude : ndarray, shape (...)
        Half of the peak-to-peak displacement, all harmonics included. [m]
    mean_normal_force : ndarray, shape (...)
        Mean contact force. [N]
    highest_normal_force : ndarray, shape (...)
        Highest contact force. [N]
    lowest_normal_force : ndarray, shape (...)
        Lowest contact force. [N]
    contact_loss_fraction : ndarray, shape (...)
        Fraction of the period in which the contact force is below 0.01 F_N. []
    current_harmonics : ndarray of complex, shape (..., K)
        Harmonics of the current into the stack, in A.
    dissipated_power : ndarray, shape (...)
        Mean electrical power into the stack. [W]
    gap_closed : ndarray of bool, shape (...)
        Whether the mean planes touch within the period, where a separation at equilibrium was given.
    extremum_phases : ndarray, shape (..., 2)
        Phases of maximum and minimum displacement, in rad; NaN for a motion with more than two extrema per period.
    harmonic_count : ndarray of int, shape (...)
        Number of harmonics of the contact that the point requires.
    coexisting_amplitude : ndarray, shape (...)
        Amplitude of another stable steady state under the same drive; NaN where none was found. [m]
    relative_tolerance : float
        Largest relative error of amplitude and force.

    Notes
    -----
    .. math::
        V = U_0 + \mathrm{Re}\sum_k V_k e^{2\pi i k f t}, \qquad
        x = \bar x + \mathrm{Re}\sum_k X_k e^{2\pi i k f t}
    """

    structure: Structure
    gap_law: GapLaw
    normal_load: Floats
    frequency: Floats
    voltage_harmonics: Complexes
    voltage_offset: Floats
    status: NDArray[np.int8]
    mean_displacement: Floats
    harmonics: Complexes
    vibration_amplitude: Floats
    mean_normal_force: Floats
    highest_normal_force: Floats
    lowest_normal_force: Floats
    contact_loss_fraction: Floats
    current_harmonics: Complexes
    dissipated_power: Floats
    gap_closed: NDArray[np.bool_]
    extremum_phases: Floats
    harmonic_count: NDArray[np.int64]
    coexisting_amplitude: Floats
    relative_tolerance: float

    def reason(self, point: int | tuple[int, ...]) -> str:
        """Meaning of the status of one point, with a remedy where it is not periodic.

        Parameters
        ----------
        point : int or tuple of int
            Index into the batch.

        Returns
        -------
        str
        """
        status = Status(int(self.status[point]))
        if status is Status.UNSTABLE:
            return (
                "unstable: the vibration has the period of the drive, but small disturbances of it grow;"
                " march the point in time to find the motion that replaces it"
            )
        if status is Status.MULTISTABLE:
            other, this = float(self.coexisting_amplitude[point]) * 1e6, float(self.vibration_amplitude[point]) * 1e6
            return (
                f"multistable: a vibration of {other:.4g} um coexists with this one of {this:.4g} um;"
                " which one occurs depends on how the voltage was raised or lowered to its value"
                + self.contact_loss_note(point)
            )
        if status is Status.NOT_CONVERGED and self.stability_undetermined(point):
            return (
                f"not_converged: {float(self.frequency[point]):.3g} Hz is too slow beside the structure's fastest mode"
                " to compute stability; raise the frequency, or lump small masses together"
            )
        if status is Status.NOT_CONVERGED:
            return (
                "not_converged: no vibration of the drive's period was found within 64 harmonics of the contact;"
                " follow it from a lower voltage with response_curve, add damping, or march the point in time"
            )
        return "periodic: the vibration has the period of the drive" + self.contact_loss_note(point)

    def stability_undetermined(self, point: int | tuple[int, ...]) -> bool:
        """Whether one point's drive is too slow beside the fastest mode to compute its stability."""
        return bool(stability_undetermined(pole_residue_model(self.structure), 2 * np.pi * self.frequency[point]))

    def contact_loss_note(self, point: int | tuple[int, ...]) -> str:
        """Note on the fraction of the period without contact of one point; empty where contact is kept.

        Parameters
        ----------
        point : int or tuple of int
            Index into the batch.

        Returns
        -------
        str
        """
        fraction = float(self.contact_loss_fraction[point])
        return f"; contact is lost for {fraction:.2%} of the time" if fraction > 0 else ""


def contact_motion(states: SteadyStates, point: int | tuple[int, ...], *, samples: int = 512) -> ContactSamples:
    """Motion of one point's contact over a period of the drive.

    Parameters
    ----------
    states : SteadyStates
    point : int or tuple of int
        Index into the batch.
    samples : int
        Number of equally spaced phases from zero.

    Returns
    -------
    ContactSamples

    Raises
    ------
    InvalidInput
        If the point did not converge or samples are fewer than two.
    """
    if samples < 2:
        raise InvalidInput(f"samples must be at least 2, got {samples!r}")
    if states.status[point] == Status.NOT_CONVERGED:
        raise InvalidInput(f"point {point} has no motion: {states.reason(point)}")
    harmonics = states.harmonics[point][: int(states.harmonic_count[point])]
    orders = np.arange(1, harmonics.size + 1)
    omega = 2 * np.pi * states.frequency[point]
    spectra = np.zeros((2, samples), dtype=np.complex128)
    for spectrum, values in zip(spectra, (harmonics, 1j * omega * orders * harmonics), strict=True):
        np.add.at(spectrum, orders % samples, values)  # orders beyond the samples fall on lower ones
    x, v = np.fft.ifft(spectra, norm="forward").real
    x += states.mean_displacement[point]
    force = damped_force(states.gap_law, x, v, states.normal_load[point])
    return ContactSamples(displacement=x, velocity=v, normal_force=force)
