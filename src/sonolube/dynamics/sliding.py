"""What sliding feels of a steady vibration: the contact's motion, and means of the kinematic friction factor."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative
from sonolube.dynamics.balancing import MOST_HARMONICS
from sonolube.dynamics.contact_lanes import EXPONENTIAL, law_of
from sonolube.dynamics.periodic import Status, SteadyStates, in_threads
from sonolube.dynamics.sliding_kernel import (
    crowded_points,
    crowding_of,
    sliding_means,
    sliding_means_by_cells,
)
from sonolube.errors import InvalidInput

_STEEP, _STEEPEST = 1.6, 64  # points more for each decay length of amplitude, and at most


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
    Errors stay below 1e-5 down to a millionth of the vibration's peak velocity.

    References
    ----------
    .. [1] D 3.46 and 3.48, with the resultant speed below the fraction line, as the text means it.
    """
    speeds = np.atleast_1d(require_non_negative(sliding_speed=sliding_speed))
    if speeds.ndim != 1:
        raise InvalidInput(f"sliding_speed must be one number or one row of numbers, got shape {speeds.shape}")
    shape = states.mean_displacement.shape
    moving = speeds > 0
    if states.mean_displacement.size and moving.all():
        kinematic, loaded = _means(states, speeds, workers)
    else:
        kinematic, loaded = np.zeros((2, states.mean_displacement.size, speeds.size))
        if kinematic.size and moving.any():
            kinematic[:, moving], loaded[:, moving] = _means(states, speeds[moving], workers)
    lost = states.status.reshape(-1) == Status.NOT_CONVERGED
    kinematic[lost] = loaded[lost] = np.nan
    return SlidingMeans(kinematic=kinematic.reshape(*shape, -1), loaded=loaded.reshape(*shape, -1))


def _means(states: SteadyStates, speeds: Floats, workers: int) -> tuple[Floats, Floats]:
    law = law_of(states.gap_law)
    omega, turns = 2 * np.pi * states.frequency.reshape(-1), states.turns.reshape(-1, 2)
    harmonics, count = states.harmonics.reshape(omega.size, -1), states.harmonic_count.reshape(-1)
    motion = (omega, states.normal_load.reshape(-1), states.mean_displacement.reshape(-1), harmonics, count)
    kinematic, loaded = np.empty((2, omega.size, speeds.size))
    steepness = (
        np.nanmax(states.vibration_amplitude, initial=0.0) / law.parameter if law.kind == EXPONENTIAL else np.inf
    )
    crowding = crowding_of(speeds.min() / (omega * np.abs(harmonics[:, 0]) + 1e-300))
    twice = np.isfinite(turns[:, 0])
    chosen = np.argsort(crowding * (MOST_HARMONICS + 1) + count)
    chosen = chosen[twice[chosen]]
    crowded = crowded_points(int(min(np.ceil(_STEEP * steepness), _STEEPEST)))

    def part(points: slice) -> None:
        sliding_means(law, *motion, turns, crowding, chosen[points], speeds, crowded, kinematic, loaded)

    in_threads(part, chosen.size, workers)
    if not twice.all():
        sliding_means_by_cells(law, *motion, np.flatnonzero(~twice), speeds, kinematic, loaded)
    return kinematic, loaded
