"""The steady state of a structure that vibrates against its contact, by harmonic balance, for many points at once."""

from dataclasses import dataclass
from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.checks import (
    Complexes,
    Floats,
    require_finite,
    require_finite_complex,
    require_non_negative,
    require_positive,
)
from sonolube.dynamics.backend import Backend
from sonolube.dynamics.gap_law import GapLaw
from sonolube.dynamics.harmonic_balance.floquet_exponent import too_slow
from sonolube.dynamics.harmonic_balance.receptance import contact_port
from sonolube.dynamics.harmonic_balance.solver import Solutions
from sonolube.dynamics.sharing import Asked, shared
from sonolube.dynamics.structure import Structure
from sonolube.errors import InvalidInput


class Status(IntEnum):
    """What is known of a steady state."""

    PERIODIC = 0
    UNSTABLE = 1
    MULTISTABLE = 2
    NOT_CONVERGED = 3


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class SteadyStates:
    """Steady states of a batch of points; every array begins with the batch's shape.

    Numbers of a point that did not converge are NaN, and `reason` says why.

    Parameters
    ----------
    structure : Structure
    gap_law : GapLaw
    normal_load : ndarray, shape (...)
        Dead load F_N. [N]
    frequency : ndarray, shape (...)
        Frequency of the drive. [Hz]
    voltage_harmonics : ndarray of complex, shape (..., K)
        Harmonics of the drive, V = mean + Re sum V_k exp(2 pi i k f t), in V.
    voltage_offset : ndarray, shape (...)
        Mean of the drive. [V]
    status : ndarray of int, shape (...)
        Entries of `Status`.
    mean_displacement : ndarray, shape (...)
        Mean of the contact's displacement from rest under the dead load. [m]
    harmonics : ndarray of complex, shape (..., H)
        Harmonics X_k of the contact's displacement, x = mean + Re sum X_k exp(2 pi i k f t), in m; zero beyond those
        that a point needed.
    vibration_amplitude : ndarray, shape (...)
        Half of the displacement from peak to peak, all harmonics included. [m]
    mean_normal_force : ndarray, shape (...)
        Mean contact force. [N]
    highest_normal_force : ndarray, shape (...)
        Highest contact force. [N]
    lowest_normal_force : ndarray, shape (...)
        Lowest contact force. [N]
    contact_loss_fraction : ndarray, shape (...)
        Share of the period in which the contact force is below 0.01 F_N. []
    current_harmonics : ndarray of complex, shape (..., K)
        Harmonics of the current into the stack, in A.
    dissipated_power : ndarray, shape (...)
        Mean electrical power into the stack. [W]
    gap_closed : ndarray of bool, shape (...)
        Whether mean planes touch, where a separation at rest was given.
    turns : ndarray, shape (..., 2)
        Phases of the highest and the lowest displacement; NaN for a motion that turns more than twice in a period.
    harmonic_count : ndarray of int, shape (...)
        Harmonics of the contact that the point needed.
    coexisting_amplitude : ndarray, shape (...)
        Amplitude of another steady state under the same drive; NaN where none was found. [m]
    relative_tolerance : float
        Largest relative error of amplitude and force.
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
    turns: Floats
    harmonic_count: NDArray[np.int64]
    coexisting_amplitude: Floats
    relative_tolerance: float

    def reason(self, point: int | tuple[int, ...]) -> str:
        """Say what the status of one point means, and what to try.

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
                "unstable: the vibration repeats with the drive, but the smallest disturbance grows;"
                " march the point in time to see what it does instead"
            )
        if status is Status.MULTISTABLE:
            other, this = (
                float(values[point]) * 1e6 for values in (self.coexisting_amplitude, self.vibration_amplitude)
            )
            return (
                f"multistable: another vibration of {other:.4g} um is as possible as this one of {this:.4g} um;"
                " which one appears depends on how the voltage got there" + self.hopping(point)
            )
        if status is Status.NOT_CONVERGED and self.stability_undetermined(point):
            return (
                f"not_converged: {float(self.frequency[point]):.3g} Hz is too slow beside the structure's fastest mode"
                " for its stability to be judged; raise the frequency, or lump light masses together"
            )
        if status is Status.NOT_CONVERGED:
            return (
                "not_converged: no vibration at the drive's own period was found within 64 harmonics of the contact;"
                " follow it from a lower voltage with response_curve, add damping, or march the point in time"
            )
        return "periodic: the vibration repeats with the drive" + self.hopping(point)

    def stability_undetermined(self, point: int | tuple[int, ...]) -> bool:
        """Return whether one point's drive is too slow beside the fastest mode for its stability to be judged."""
        return bool(too_slow(contact_port(self.structure), 2 * np.pi * self.frequency[point]))

    def hopping(self, point: int | tuple[int, ...]) -> str:
        """Say for how long one point's contact is lost; empty where it is not.

        Parameters
        ----------
        point : int or tuple of int
            Index into the batch.

        Returns
        -------
        str
        """
        share = float(self.contact_loss_fraction[point])
        return f"; it hops, without contact for {share:.2%} of the time" if share > 0 else ""


def steady_state(
    structure: Structure,
    gap_law: GapLaw,
    *,
    normal_load: ArrayLike,
    frequency: ArrayLike,
    voltage_amplitude: ArrayLike | None = None,
    voltage_harmonics: ArrayLike | None = None,
    voltage_offset: ArrayLike = 0.0,
    separation: ArrayLike | None = None,
    falling: bool = False,
    least_harmonics: int = 1,
    relative_tolerance: float = 1e-6,
    stability: bool = True,
    workers: int = 1,
    backend: Backend = "cpu",
) -> SteadyStates:
    """Return the periodic vibration of a structure against its contact.

    Parameters
    ----------
    structure : Structure
    gap_law : GapLaw
    normal_load : array_like
        Dead load on the contact. [N]
    frequency : array_like
        Frequency of the drive. [Hz]
    voltage_amplitude : array_like, optional
        Amplitude of a sinusoidal drive, which goes like a cosine. [V]
    voltage_harmonics : array_like of complex, optional
        Harmonics of any other drive along the last axis, V = mean + Re sum V_k exp(2 pi i k f t), in V; twice the
        coefficients of `sonolube.dynamics.waveform.harmonics` times the voltage peak to peak.
    voltage_offset : array_like
        Mean of the drive. [V]
    separation : array_like, optional
        Separation at rest under the dead load, to learn whether mean planes touch. [m]
    falling : bool
        Whether the voltage came down to its value rather than up, which matters where several vibrations are possible.
    least_harmonics : int
        Harmonics of the contact to take at least, from 1 to 64, and to couple fully; more than the point needs makes
        neighbouring points comparable to the last digit.
    relative_tolerance : float
        Largest error of amplitude and mean force relative to the equations' exact answer, from 1e-6 to 1e-3; a looser
        one takes fewer harmonics.
    stability : bool
        Whether to judge stability, which takes about as long as finding the vibration.
    workers : int
        Threads to share the work.
    backend : {"cpu", "gpu"}
        Whether an NVIDIA GPU takes the points that it can; the others, and all where there is none, are the
        processor's.

    Returns
    -------
    SteadyStates
        Of the shape of the broadcast arguments.

    Raises
    ------
    InvalidInput
        If a frequency or load is not positive, a value not finite, the drive not given in exactly one way, there are no
        points, or `least_harmonics` or `relative_tolerance` is out of its range.

    Warns
    -----
    GpuUnused
        If a GPU was asked for and there is none, or it does not serve this contact, structure or drive.

    Notes
    -----
    Only the contact is nonlinear, so that the unknowns are its mean and harmonics alone. The force is sampled in time
    and transformed, as many samples and harmonics as the point needs. The memory is bounded by working through chunks
    of points.

    Other vibrations of the same period are looked for where a single harmonic has several solutions. Motions of other
    periods beside a stable vibration are not: bouncing hard at a few hundred hertz, a start from rest can end in one.
    """
    return solved(
        structure,
        gap_law,
        normal_load=normal_load,
        frequency=frequency,
        drive=drive_harmonics(voltage_amplitude, voltage_harmonics),
        voltage_offset=voltage_offset,
        separation=separation,
        falling=falling,
        least_harmonics=least_harmonics,
        relative_tolerance=relative_tolerance,
        stability=stability,
        workers=workers,
        backend=backend,
    ).states


class Solved(NamedTuple):
    """Steady states, and of the points that a GPU did its means of friction."""

    states: SteadyStates
    means: Floats  # (2, p, s): plain and weighted by the force
    averaged: NDArray[np.bool_]  # (p,): which have them


def solved(
    structure: Structure,
    gap_law: GapLaw,
    *,
    normal_load: ArrayLike,
    frequency: ArrayLike,
    drive: Complexes,
    voltage_offset: ArrayLike = 0.0,
    separation: ArrayLike | None = None,
    falling: bool = False,
    least_harmonics: int = 1,
    relative_tolerance: float = 1e-6,
    stability: bool = True,
    workers: int = 1,
    backend: Backend = "cpu",
    speeds: Floats | None = None,
) -> Solved:
    """Return what `steady_state` does for the harmonics of a drive, and on a GPU means of friction at some speeds.

    Parameters
    ----------
    structure, gap_law, falling, least_harmonics, relative_tolerance, stability, workers, backend
        As `steady_state` takes them.
    normal_load : array_like
        Dead load on the contact. [N]
    frequency : array_like
        Frequency of the drive. [Hz]
    drive : ndarray of complex, shape (..., K)
        Harmonics of the drive, in V.
    voltage_offset : array_like
        Mean of the drive. [V]
    separation : array_like, optional
        Separation at rest under the dead load. [m]
    speeds : ndarray, shape (s,), optional
        Sliding speeds, in m/s, none of them zero.

    Returns
    -------
    Solved
    """
    if not 1 <= least_harmonics <= 64:
        raise InvalidInput(f"least_harmonics must lie between 1 and 64, got {least_harmonics!r}")
    if not 1e-6 <= relative_tolerance <= 1e-3:
        raise InvalidInput(f"relative_tolerance must lie between 1e-6 and 1e-3, got {relative_tolerance!r}")
    load, f = require_positive(normal_load=normal_load), require_positive(frequency=frequency)
    offset = require_finite(voltage_offset=voltage_offset)
    rest = None if separation is None else require_positive(separation=separation)
    shape = _batch(load.shape, f.shape, drive.shape[:-1], offset.shape, () if rest is None else rest.shape)
    port = contact_port(structure)

    def flat(values: Floats) -> Floats:
        return np.ascontiguousarray(np.broadcast_to(values, shape)).reshape(-1)

    voltage = np.ascontiguousarray(np.broadcast_to(drive, (*shape, drive.shape[-1]))).reshape(-1, drive.shape[-1])
    omega, loads = 2 * np.pi * flat(f), flat(load)
    static_displacement = port.displacement_per_volt * flat(offset)
    points = Asked(
        port,
        gap_law,
        omega,
        loads,
        voltage,
        static_displacement,
        least_harmonics,
        falling,
        stability,
        relative_tolerance,
    )
    answered = shared(points, np.empty(0) if speeds is None else speeds, workers=workers, backend=backend)
    found = answered.solutions
    current = 1j * omega[:, np.newaxis] * np.arange(1, voltage.shape[1] + 1) * found.charge
    closed = np.zeros(omega.size, dtype=bool) if rest is None else found.lowest_displacement <= -flat(rest)
    states = SteadyStates(
        structure=structure,
        gap_law=gap_law,
        normal_load=loads.reshape(shape),
        frequency=flat(f).reshape(shape),
        voltage_harmonics=voltage.reshape(*shape, -1),
        voltage_offset=flat(offset).reshape(shape),
        status=_status(found).reshape(shape),
        mean_displacement=found.mean.reshape(shape),
        harmonics=found.harmonics.reshape(*shape, -1),
        vibration_amplitude=found.amplitude.reshape(shape),
        mean_normal_force=found.mean_force.reshape(shape),
        highest_normal_force=found.force[:, 0].reshape(shape),
        lowest_normal_force=found.force[:, 1].reshape(shape),
        contact_loss_fraction=found.lost.reshape(shape),
        current_harmonics=current.reshape(*shape, -1),
        dissipated_power=(0.5 * np.sum((voltage * current.conj()).real, axis=1)).reshape(shape),
        gap_closed=closed.reshape(shape),
        turns=found.turns.reshape(*shape, 2),
        harmonic_count=found.count.reshape(shape),
        coexisting_amplitude=found.coexisting_amplitude.reshape(shape),
        relative_tolerance=relative_tolerance,
    )
    return Solved(states, answered.means, answered.done)


def _batch(*shapes: tuple[int, ...]) -> tuple[int, ...]:
    """Return the shape of the points that arguments of some shapes make together."""
    given = f"load, frequency, voltage, offset and gap{{}} shapes{{}} {', '.join(map(str, shapes))}"
    try:
        shape = np.broadcast_shapes(*shapes)
    except ValueError:
        raise InvalidInput(given.format(" must have matching", ", got")) from None
    if 0 in shape:
        raise InvalidInput(f"there are no points to compute: {given.format(' have', '')}")
    return shape


def drive_harmonics(amplitude: ArrayLike | None, harmonics: ArrayLike | None) -> Complexes:
    """Return the harmonics of a drive, given in exactly one way."""
    if (amplitude is None) == (harmonics is None):
        raise InvalidInput("give either voltage_amplitude or voltage_harmonics")
    if amplitude is not None:
        return require_non_negative(voltage_amplitude=amplitude)[..., np.newaxis].astype(np.complex128)
    assert harmonics is not None
    drive = require_finite_complex(voltage_harmonics=harmonics)
    if drive.ndim == 0 or not 1 <= drive.shape[-1] <= 64:
        raise InvalidInput(
            f"voltage_harmonics must have 1 to 64 harmonics along the last axis, got shape {drive.shape}"
        )
    return drive


def _status(found: Solutions) -> NDArray[np.int8]:
    status = np.full(found.mean.shape, Status.PERIODIC, dtype=np.int8)
    status[np.isfinite(found.coexisting_amplitude)] = Status.MULTISTABLE
    status[found.growing] = Status.UNSTABLE
    status[np.isnan(found.mean)] = Status.NOT_CONVERGED
    return status
