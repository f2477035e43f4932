r"""Kinematic friction factor of a sliding contact that vibrates along its normal: averages over a period.

Under a constant friction coefficient the friction force opposes the resultant of the sliding velocity :math:`v_r` and
the vibration velocity v; its mean component along the sliding direction falls by the average of
:math:`v_r/\sqrt{v_r^2 + v^2}`.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Complexes, Floats, Integers, require_non_negative
from sonolube.errors import InvalidInput
from sonolube.execution.threads import map_chunks
from sonolube.models.dynamics.friction_average.elliptic_kernel import (
    elliptic_averages,
    friction_workspace,
    sum_precision,
)
from sonolube.models.dynamics.friction_average.elliptic_quadrature import (
    EllipticNodes,
    elliptic_nodes,
    moebius_parameters,
    node_count_factor,
    node_table_row,
)
from sonolube.models.dynamics.gap_laws.closed_form import GapLaw, damped_force, force_decay_length
from sonolube.models.dynamics.gap_laws.table import kernel_law
from sonolube.models.dynamics.harmonic_balance.solver import MAX_HARMONICS
from sonolube.models.dynamics.motions import Status, SteadyStates

# Additional nodes for a steep force: per decay length of amplitude, at least for laws with corners, and the choices.
_NODES_PER_DECAY_LENGTH, _NODES_FOR_CORNERS = 2.0, 1024.0
_CELLS_PER_HARMONIC, _MIN_CELLS = 256, 4096  # of a period, for motions with more than two extrema
_LEVEL = 1e-6  # rise of the velocity in a cell over the sliding speed below which it is constant but for rounding
_EXTRA_NODES = np.array([0, 4, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256, 1024])


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class FrictionAverages:
    r"""Averages over a period of the kinematic friction factor v_r/sqrt(v_r^2 + v^2).

    Parameters
    ----------
    kinematic : ndarray, shape (..., speeds)
        Plain average: friction ratio where the friction force does not follow the vibrating normal force.
    force_weighted : ndarray, shape (..., speeds)
        Average weighted by the contact force over the dead load: friction ratio where it does.

    Notes
    -----
    .. math::
        \left\langle\frac{v_r}{\sqrt{v_r^2 + v^2}}\right\rangle, \qquad
        \left\langle\frac{F_n}{F_N}\,\frac{v_r}{\sqrt{v_r^2 + v^2}}\right\rangle
    """

    kinematic: Floats
    force_weighted: Floats


def friction_averages(states: SteadyStates, *, sliding_speed: ArrayLike, workers: int = 1) -> FrictionAverages:
    r"""Kinematic friction factors of every steady state at every sliding speed.

    Parameters
    ----------
    states : SteadyStates
    sliding_speed : array_like, shape (speeds,)
        Sliding speeds v_r, each combined with every state. [m/s]
    workers : int
        Number of threads.

    Returns
    -------
    FrictionAverages
        NaN where a state did not converge.

    Raises
    ------
    InvalidInput
        If a speed is negative or not finite, or there is not at least one worker.

    See Also
    --------
    steady_state

    Notes
    -----
    Motions with two extrema per period are averaged by elliptic quadrature, others cell by cell for a piecewise linear
    velocity. Errors of the averages stay below 2e-5 for smooth forces and sliding speeds down to a millionth of the
    peak vibration velocity, and below 2e-4 for spheres and springs that lift off and for motions with more than two
    extrema. States of a `relative_tolerance` from 1e-5 on are averaged to half of it.

    References
    ----------
    .. [1] D 3.46 and 3.48, with the resultant velocity in the denominator, as the text means it.
    """
    speeds = np.atleast_1d(require_non_negative(sliding_speed=sliding_speed))
    if speeds.ndim != 1:
        raise InvalidInput(f"sliding_speed must be one number or one row of numbers, got shape {speeds.shape}")
    shape, failed = states.mean_displacement.shape, states.status.reshape(-1) == Status.NOT_CONVERGED
    moving = speeds > 0
    if moving.all():
        kinematic, weighted = _averages(states, speeds, workers)
    else:
        kinematic, weighted = np.zeros((2, failed.size, speeds.size))
        if moving.any():
            kinematic[:, moving], weighted[:, moving] = _averages(states, speeds[moving], workers)
    kinematic[failed] = weighted[failed] = np.nan
    return FrictionAverages(kinematic=kinematic.reshape(*shape, -1), force_weighted=weighted.reshape(*shape, -1))


def _averages(states: SteadyStates, speeds: Floats, workers: int) -> tuple[Floats, Floats]:
    """Plain and force-weighted averages at positive speeds, each of shape (p, s).

    Motions with two extrema are grouped by the number of nodes that they require.
    """
    gap_law = states.gap_law
    omega, phases = 2 * np.pi * states.frequency.reshape(-1), states.extremum_phases.reshape(-1, 2)
    harmonics = np.ascontiguousarray(states.harmonics).reshape(omega.size, -1)
    parts, count = harmonics.view(np.float64), states.harmonic_count.reshape(-1)
    load, mean = states.normal_load.reshape(-1), states.mean_displacement.reshape(-1)
    settings = np.stack([*moebius_parameters(phases), omega, load, mean, gap_law.equilibrium_coordinate(load)], axis=1)
    law, has_two_extrema = kernel_law(gap_law), np.isfinite(phases[:, 0])
    averages = np.zeros((2, omega.size, speeds.size))
    ratio = speeds.min() / (omega * np.abs(harmonics[:, 0]) + 1e-300)
    rows, factor = node_table_row(ratio), node_count_factor(harmonics)
    steepness = np.nan_to_num(states.vibration_amplitude.reshape(-1) / force_decay_length(gap_law, load))
    for_corners = _NODES_FOR_CORNERS if gap_law.has_corner else 0.0
    level = np.searchsorted(_EXTRA_NODES[:-1], np.maximum(_NODES_PER_DECAY_LENGTH * steepness, for_corners))
    group = np.where(has_two_extrema, _EXTRA_NODES.size * factor + level, 0)
    demand = rows * (MAX_HARMONICS + 1) + count
    order = np.argsort(demand.astype(np.uint16), kind="stable")  # radix sort, in linear time
    precise: Floats = speeds.astype(sum_precision(states.relative_tolerance))

    for own in np.flatnonzero(np.bincount(group[group > 0])):
        alike = order[(group == own)[order]]
        tolerance = max(0.1 * states.relative_tolerance, 1e-6) ** int(factor[alike[0]])
        nodes = elliptic_nodes(int(_EXTRA_NODES[level[alike[0]]]), tolerance)

        def average(chunk: slice, alike: Integers = alike, nodes: EllipticNodes = nodes) -> None:
            work = friction_workspace(int(count[alike].max()), precise)
            chosen = alike[chunk]
            averages_of = elliptic_averages.for_points(chosen.size * speeds.size)
            averages_of(law, settings, parts, count, rows, chosen, precise, nodes, work, averages)

        map_chunks(average, alike.size, workers)
    for point in np.flatnonzero(~has_two_extrema):
        motion = harmonics[point, : count[point]]
        averages[:, point] = _piecewise_linear_averages(gap_law, load[point], omega[point], mean[point], motion, speeds)
    return averages[0], averages[1]


def _piecewise_linear_averages(
    gap_law: GapLaw, load: float, omega: float, mean: float, harmonics: Complexes, speeds: Floats
) -> tuple[Floats, Floats]:
    r"""Plain and force-weighted averages of a motion with any number of extrema, each of shape (s,).

    Over a cell in which the velocity changes linearly from :math:`v_1` to :math:`v_2`, the mean is

    .. math::
        \left\langle\frac{v_r}{\sqrt{v_r^2 + v^2}}\right\rangle
        = \frac{v_r}{v_2 - v_1} \left(\mathrm{arsinh}\frac{v_2}{v_r} - \mathrm{arsinh}\frac{v_1}{v_r}\right) .
    """
    cells, orders = max(_CELLS_PER_HARMONIC * harmonics.size, _MIN_CELLS), np.arange(1, harmonics.size + 1)
    spectra = np.zeros((2, cells // 2 + 1), dtype=np.complex128)
    spectra[:, 1 : harmonics.size + 1] = harmonics * (cells / 2), 1j * omega * orders * harmonics * (cells / 2)
    x, v = np.fft.irfft(spectra, cells)
    force = damped_force(gap_law, mean + x, v, load) / load
    rise, rapidity = np.roll(v, -1) - v, np.arcsinh(v / speeds[:, np.newaxis])
    nearly_level = np.abs(rise) <= _LEVEL * speeds[:, np.newaxis]
    steep = speeds[:, np.newaxis] * (np.roll(rapidity, -1, axis=1) - rapidity) / np.where(nearly_level, 1.0, rise)
    ratio = np.where(nearly_level, 1 / np.hypot(1.0, np.roll(v, -1) / speeds[:, np.newaxis]), steep)
    return ratio.mean(axis=1), ratio @ (force + np.roll(force, -1)) / (2 * cells)
