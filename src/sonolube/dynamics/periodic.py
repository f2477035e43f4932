"""The steady state of a structure that vibrates against its contact, by harmonic balance, for many points at once."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from enum import IntEnum
from typing import TypeVar

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
from sonolube.dynamics.balancing import Solutions, solve
from sonolube.dynamics.contact_lanes import law_of
from sonolube.dynamics.contact_port import contact_port
from sonolube.dynamics.gap_law import GapLaw
from sonolube.dynamics.structure import Structure
from sonolube.errors import InvalidInput

Result = TypeVar("Result")

_CHUNK = 4096  # points solved together, to bound the memory


class Status(IntEnum):
    """What is known of a steady state."""

    PERIODIC = 0
    UNSTABLE = 1
    SEVERAL = 2
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
    lost_contact_share : ndarray, shape (...)
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
    rival_amplitude : ndarray, shape (...)
        Amplitude of another steady state under the same drive; NaN where none was found. [m]
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
    lost_contact_share: Floats
    current_harmonics: Complexes
    dissipated_power: Floats
    gap_closed: NDArray[np.bool_]
    turns: Floats
    harmonic_count: NDArray[np.int64]
    rival_amplitude: Floats

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
        if status is Status.SEVERAL:
            other, this = (float(values[point]) * 1e6 for values in (self.rival_amplitude, self.vibration_amplitude))
            return (
                f"several: another vibration of {other:.4g} um is as possible as this one of {this:.4g} um;"
                " which one appears depends on how the voltage got there" + self.hopping(point)
            )
        if status is Status.NOT_CONVERGED:
            return (
                "not_converged: no vibration at the drive's own period was found within 64 harmonics of the contact;"
                " follow it from a lower voltage with response_curve, add damping, or march the point in time"
            )
        return "periodic: the vibration repeats with the drive" + self.hopping(point)

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
        share = float(self.lost_contact_share[point])
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
    stability: bool = True,
    workers: int = 1,
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
    stability : bool
        Whether to judge stability, which takes about as long as finding the vibration.
    workers : int
        Threads to share the work.

    Returns
    -------
    SteadyStates
        Of the shape of the broadcast arguments.

    Raises
    ------
    InvalidInput
        If a frequency or load is not positive, a value not finite, or the drive not given in exactly one way.

    Notes
    -----
    Only the contact is nonlinear, so that the unknowns are its mean and harmonics alone. The force is sampled in time
    and transformed, as many samples and harmonics as the point needs; errors of amplitude and mean force relative to
    the equations stay below 1e-6. The memory is bounded by working through chunks of points.

    Other vibrations of the same period are looked for where a single harmonic has several solutions. Motions of other
    periods beside a stable vibration are not: bouncing hard at a few hundred hertz, a start from rest can end in one.
    """
    if not 1 <= least_harmonics <= 64:
        raise InvalidInput(f"least_harmonics must lie between 1 and 64, got {least_harmonics!r}")
    load, f = require_positive(normal_load=normal_load), require_positive(frequency=frequency)
    drive = _drive(voltage_amplitude, voltage_harmonics)
    offset = require_finite(voltage_offset=voltage_offset)
    rest = None if separation is None else require_positive(separation=separation)
    shape = np.broadcast_shapes(load.shape, f.shape, drive.shape[:-1], offset.shape, () if rest is None else rest.shape)
    port, law = contact_port(structure), law_of(gap_law)

    def flat(values: Floats) -> Floats:
        return np.ascontiguousarray(np.broadcast_to(values, shape)).reshape(-1)

    voltage = np.ascontiguousarray(np.broadcast_to(drive, (*shape, drive.shape[-1]))).reshape(-1, drive.shape[-1])
    omega, loads = 2 * np.pi * flat(f), flat(load)
    free_mean = port.displacement_per_volt * flat(offset)

    def part(chosen: slice) -> Solutions:
        return solve(
            port,
            law,
            omega[chosen],
            loads[chosen],
            voltage[chosen],
            free_mean[chosen],
            least=least_harmonics,
            falling=falling,
            stability=stability,
        )

    found = _gather(in_threads(part, omega.size, workers))
    current = 1j * omega[:, np.newaxis] * np.arange(1, voltage.shape[1] + 1) * found.charge
    closed = np.zeros(omega.size, dtype=bool) if rest is None else found.lowest_displacement <= -flat(rest)
    return SteadyStates(
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
        lost_contact_share=found.lost.reshape(shape),
        current_harmonics=current.reshape(*shape, -1),
        dissipated_power=(0.5 * np.sum((voltage * current.conj()).real, axis=1)).reshape(shape),
        gap_closed=closed.reshape(shape),
        turns=found.turns.reshape(*shape, 2),
        harmonic_count=found.count.reshape(shape),
        rival_amplitude=found.rival_amplitude.reshape(shape),
    )


def _drive(amplitude: ArrayLike | None, harmonics: ArrayLike | None) -> Complexes:
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


def in_threads(part: Callable[[slice], Result], points: int, workers: int) -> list[Result]:
    """Return what `part` makes of one chunk of the points after another, shared among threads."""
    if workers < 1:
        raise InvalidInput(f"workers must be at least 1, got {workers!r}")
    chunks = [slice(start, start + _CHUNK) for start in range(0, max(points, 1), _CHUNK)]
    if workers == 1:
        return [part(chunk) for chunk in chunks]
    with ThreadPoolExecutor(workers) as pool:
        return list(pool.map(part, chunks))


def _gather(parts: list[Solutions]) -> Solutions:
    if len(parts) == 1:
        return parts[0]
    room = max(part.harmonics.shape[1] for part in parts)
    harmonics = np.zeros((sum(part.mean.size for part in parts), room), dtype=np.complex128)
    start = 0
    for part in parts:
        harmonics[start : start + part.mean.size, : part.harmonics.shape[1]] = part.harmonics
        start += part.mean.size
    narrow = (part._replace(harmonics=part.harmonics[:0, :1]) for part in parts)
    gathered = Solutions(*(np.concatenate(columns) for columns in zip(*narrow, strict=True)))
    return gathered._replace(harmonics=harmonics)


def _status(found: Solutions) -> NDArray[np.int8]:
    status = np.full(found.mean.shape, Status.PERIODIC, dtype=np.int8)
    status[np.isfinite(found.rival_amplitude)] = Status.SEVERAL
    status[found.growing] = Status.UNSTABLE
    status[np.isnan(found.mean)] = Status.NOT_CONVERGED
    return status
