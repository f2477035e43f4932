"""What sliding feels of a steady vibration: the contact's motion, and means of the kinematic friction factor."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.checks import Floats, Integers, require_non_negative
from sonolube.dynamics.backend import Backend
from sonolube.dynamics.friction_average.elliptic_quadrature import (
    Crowded,
    crowded_points,
    crowding_of,
    fineness_of,
    turned_circle,
)
from sonolube.dynamics.friction_average.kernel import precision, scratch, sliding_means
from sonolube.dynamics.friction_average.tabulated import sliding_means_by_cells
from sonolube.dynamics.gap_law import GapLaw, length_of_change
from sonolube.dynamics.harmonic_balance.contact_kernel import HERTZ, LINEAR, equilibrium_displacement, law_of
from sonolube.dynamics.harmonic_balance.solver import MOST_HARMONICS
from sonolube.dynamics.sharing import in_threads
from sonolube.dynamics.steady_state import Status, SteadyStates, drive_harmonics, solved
from sonolube.dynamics.structure import Structure
from sonolube.errors import InvalidInput

# Points more for a steep force: for each decay length of amplitude, at least for laws with corners, and the choices.
_STEEP, _CORNERS = 2.0, {HERTZ: 1024.0, LINEAR: 1024.0}
_EXTRA = np.array([0, 4, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256, 1024])


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class ContactPeriod:
    """The contact over one period of the drive, at evenly spaced phases from zero.

    Parameters
    ----------
    displacement : ndarray, shape (samples,)
        Displacement of the contact. [m]
    velocity : ndarray, shape (samples,)
        Its velocity, in m/s.
    normal_force : ndarray, shape (samples,)
        Contact force. [N]
    """

    displacement: Floats
    velocity: Floats
    normal_force: Floats


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class SlidingMeans:
    """Means over a period of v_r/sqrt(v_r^2 + v^2), which turns friction out of the sliding direction.

    Parameters
    ----------
    kinematic : ndarray, shape (..., speeds)
        Plain mean: friction of a force that does not feel the vibration, over friction without vibration.
    loaded : ndarray, shape (..., speeds)
        Mean weighted by the contact force over the dead load.
    """

    kinematic: Floats
    loaded: Floats


def motion(states: SteadyStates, point: int | tuple[int, ...], *, samples: int = 512) -> ContactPeriod:
    """Return one point's contact over a period.

    Parameters
    ----------
    states : SteadyStates
    point : int or tuple of int
        Index into the batch.
    samples : int
        Number of phases, evenly spaced.

    Returns
    -------
    ContactPeriod

    Raises
    ------
    InvalidInput
        If the point did not converge or samples are fewer than two.
    """
    if samples < 2:
        raise InvalidInput(f"samples must be at least 2, got {samples!r}")
    if states.status[point] == Status.NOT_CONVERGED:
        raise InvalidInput(f"point {point} has no motion: {states.reason(point)}")
    harmonics = states.harmonics[point]
    orders = np.arange(1, harmonics.size + 1)
    turning = np.exp(2j * np.pi * np.multiply.outer(np.arange(samples) / samples, orders))
    omega = 2 * np.pi * states.frequency[point]
    x = states.mean_displacement[point] + (turning @ harmonics).real
    v = (turning @ (1j * omega * orders * harmonics)).real
    damping = np.maximum(1 - states.gap_law.force_damping * v, 0.0)
    return ContactPeriod(
        displacement=x, velocity=v, normal_force=damping * states.gap_law.force(x, states.normal_load[point])
    )


def steady_friction(
    structure: Structure,
    gap_law: GapLaw,
    *,
    sliding_speed: ArrayLike,
    normal_load: ArrayLike,
    frequency: ArrayLike,
    voltage_amplitude: ArrayLike | None = None,
    voltage_harmonics: ArrayLike | None = None,
    voltage_offset: ArrayLike = 0.0,
    relative_tolerance: float = 1e-6,
    stability: bool = True,
    workers: int = 1,
    backend: Backend = "cpu",
) -> tuple[SteadyStates, SlidingMeans]:
    """Return steady states and their kinematic friction factors, which a GPU finds in one go.

    Parameters
    ----------
    structure : Structure
    gap_law : GapLaw
    sliding_speed : array_like, shape (speeds,)
        Sliding speeds, each met with every state. [m/s]
    normal_load : array_like
        Dead load on the contact. [N]
    frequency : array_like
        Frequency of the drive. [Hz]
    voltage_amplitude : array_like, optional
        Amplitude of a sinusoidal drive. [V]
    voltage_harmonics : array_like of complex, optional
        Harmonics of any other drive along the last axis, in V.
    voltage_offset : array_like
        Mean of the drive. [V]
    relative_tolerance : float
        Largest error of amplitude and mean force.
    stability : bool
        Whether to judge stability.
    workers : int
        Threads to share the work of the processor.
    backend : {"cpu", "gpu"}
        Whether an NVIDIA GPU takes the points that it can.

    Returns
    -------
    SteadyStates
        As of `steady_state`.
    SlidingMeans
        As of `sliding_friction`.

    Raises
    ------
    InvalidInput
        As `steady_state` and `sliding_friction` do.

    Warns
    -----
    GpuUnused
        If a GPU was asked for and there is none, or it does not serve this contact, structure or drive.
    """
    speeds = _speeds(sliding_speed)
    moving = speeds > 0
    found = solved(
        structure,
        gap_law,
        normal_load=normal_load,
        frequency=frequency,
        drive=drive_harmonics(voltage_amplitude, voltage_harmonics),
        voltage_offset=voltage_offset,
        relative_tolerance=relative_tolerance,
        stability=stability,
        workers=workers,
        backend=backend,
        speeds=speeds[moving],
    )
    means = _friction(found.states, speeds, workers, ~found.averaged)
    if found.averaged.any():
        for values, ready in zip((means.kinematic, means.loaded), found.means, strict=True):
            values.reshape(-1, speeds.size)[np.ix_(found.averaged, moving)] = ready[found.averaged]
    return found.states, means


def sliding_friction(states: SteadyStates, *, sliding_speed: ArrayLike, workers: int = 1) -> SlidingMeans:
    """Return the kinematic friction factors of every steady state at every sliding speed.

    Parameters
    ----------
    states : SteadyStates
    sliding_speed : array_like, shape (speeds,)
        Sliding speeds, each met with every state. [m/s]
    workers : int
        Threads to share the work.

    Returns
    -------
    SlidingMeans
        NaN where a state did not converge.

    Raises
    ------
    InvalidInput
        If a speed is negative or not finite, or there is not at least one worker.

    Notes
    -----
    Where the force is smooth, errors of the means stay below 2e-5, down to a millionth of the vibration's peak
    velocity; for spheres and springs that lift off, and for motions that turn more than twice in a period, below 2e-4.
    States of a `relative_tolerance` from 1e-5 on are averaged to half of it.

    References
    ----------
    .. [1] D 3.46 and 3.48, with the resultant speed below the fraction line, as the text means it.
    """
    every = np.ones(states.frequency.size, dtype=bool)
    return _friction(states, _speeds(sliding_speed), workers, every)


def _speeds(sliding_speed: ArrayLike) -> Floats:
    speeds = np.atleast_1d(require_non_negative(sliding_speed=sliding_speed))
    if speeds.ndim != 1:
        raise InvalidInput(f"sliding_speed must be one number or one row of numbers, got shape {speeds.shape}")
    return speeds


def _friction(states: SteadyStates, speeds: Floats, workers: int, wanted: NDArray[np.bool_]) -> SlidingMeans:
    """Return the means of the states that are wanted; those of the others are zero."""
    shape, lost = states.mean_displacement.shape, states.status.reshape(-1) == Status.NOT_CONVERGED
    moving = speeds > 0
    if moving.all() and wanted.any():
        kinematic, loaded = _means(states, speeds, workers, wanted)
    else:
        kinematic, loaded = np.zeros((2, wanted.size, speeds.size))
        if moving.any() and wanted.any():
            kinematic[:, moving], loaded[:, moving] = _means(states, speeds[moving], workers, wanted)
    kinematic[lost] = loaded[lost] = np.nan
    return SlidingMeans(kinematic=kinematic.reshape(*shape, -1), loaded=loaded.reshape(*shape, -1))


def _means(states: SteadyStates, speeds: Floats, workers: int, wanted: NDArray[np.bool_]) -> tuple[Floats, Floats]:
    omega, turns = 2 * np.pi * states.frequency.reshape(-1), states.turns.reshape(-1, 2)
    harmonics = np.ascontiguousarray(states.harmonics).reshape(omega.size, -1)
    parts, count = harmonics.view(np.float64), states.harmonic_count.reshape(-1)
    load, mean = states.normal_load.reshape(-1), states.mean_displacement.reshape(-1)
    given = np.stack([*turned_circle(turns), omega, load, mean, equilibrium_displacement(states.gap_law, load)], axis=1)
    (compiled, law), twice = law_of(states.gap_law), np.isfinite(turns[:, 0])
    means = np.zeros((2, omega.size, speeds.size))
    ratio = speeds.min() / (omega * np.abs(harmonics[:, 0]) + 1e-300)
    crowding, fineness = crowding_of(ratio), fineness_of(harmonics)
    steepness = np.nan_to_num(states.vibration_amplitude.reshape(-1) / length_of_change(states.gap_law, load))
    level = np.searchsorted(_EXTRA[:-1], np.maximum(_STEEP * steepness, _CORNERS.get(states.gap_law.kind, 0.0)))
    group = np.where(twice & wanted, _EXTRA.size * fineness + level, 0)
    demand = crowding * (MOST_HARMONICS + 1) + count
    order = np.argsort(demand.astype(np.uint16), kind="stable")  # by counting, that is, at once
    precise: Floats = speeds.astype(precision(states.relative_tolerance))

    for own in np.flatnonzero(np.bincount(group[group > 0])):
        alike = order[(group == own)[order]]
        tolerance = max(0.1 * states.relative_tolerance, 1e-6) ** int(fineness[alike[0]])
        crowded = crowded_points(int(_EXTRA[level[alike[0]]]), tolerance)

        def part(points: slice, alike: Integers = alike, crowded: Crowded = crowded) -> None:
            room = scratch(int(count[alike].max()), precise)
            sliding_means(*compiled, law, given, parts, count, crowding, alike[points], precise, crowded, room, means)

        in_threads(part, alike.size, workers)
    if not twice[wanted].all():
        sliding_means_by_cells(*compiled, law, given, harmonics, count, np.flatnonzero(~twice & wanted), speeds, means)
    return means[0], means[1]
