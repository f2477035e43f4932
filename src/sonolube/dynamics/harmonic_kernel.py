"""Harmonic balance on lanes: Newton's method on the contact's harmonics, many points side by side.

The unknowns of a point are the contact's mean displacement and harmonics X_1 to X_H,
x = mean + Re sum X_k exp(i k theta). They satisfy S_0 (mean - free mean) = mean F_n - F_N and
X_k = H_k V_k + G_k Phi_k, with Phi_k the harmonics of the contact force. Newton's method takes the mean and the first
harmonics together, as many as the contact couples noticeably; the harmonics beyond follow by substitution. Alternating
between time and frequency, a pair of samples theta and -theta share their cosines and sines.
"""

from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Complexes, Floats
from sonolube.dynamics.contact_lanes import Choice, Law, contact_rows, parallel
from sonolube.dynamics.contact_port import receptances
from sonolube.dynamics.lanes import INSIDE, KERNEL, LANES, ONCE, combine
from sonolube.dynamics.newton_kernel import newton_step

Integers = NDArray[np.int64]

# Rows of what a block of points brings along: angular frequency, dead load, the length over which the contact changes,
# where it rests, the mean displacement without contact; then sizes of the last step and of the motion.
OMEGA, LOAD, LENGTH, RESTING, FREE_MEAN, SIZE, SCALE = range(7)
CONVERGED, DIVERGED, NEEDS_HARMONICS, NEEDS_SAMPLES = 0, 1, 2, 3
# In tolerances, relative to the amplitude: the harmonics left out, and the last step of Newton's method.
TAIL, _EXACTLY = 0.3, 0.01
_LARGEST_STEP = 2.0  # in lengths over which the contact changes


class Points(NamedTuple):
    """Steady states to find, one column or entry to a point; harmonics hold the first guess and then the result."""

    given: Floats  # (5, p): rows OMEGA to FREE_MEAN
    free: Complexes  # (p, K) m, harmonics without contact
    mean: Floats  # (p,) m
    harmonics: Complexes  # (p, room) m
    force: Complexes  # (p, K) N, harmonics of the contact force, written


class Resolution(NamedTuple):
    """How finely each point is to be resolved, one entry of each array to a point."""

    harmonics: Integers
    coupled: Integers  # of them, those in Newton's matrix
    samples: Integers


class Workspace(NamedTuple):
    """Rows that a block of points is solved in."""

    lanes: Floats  # (7, lanes): rows OMEGA to SCALE
    answers: Floats  # (H + 1, 2, lanes): receptances of the contact
    linear: Floats  # (2, H + 1, lanes): motion without contact
    unknown: Floats  # (2, H + 1, lanes): motion
    step: Floats  # (2, H + 1, lanes)
    velocity: Floats  # (2, H + 1, lanes): over omega
    waves: Floats  # (2, instants, instants): cosines and sines of j k 2 pi / count
    tabulated: Integers  # (1,): the count of samples whose waves these are
    sums: Floats  # (3, 2, instants, lanes): weighted sums and differences of force, stiffness and damping
    spectra: Floats  # (3, 2, 2 H + 1, lanes): of force, stiffness and damping
    matrix: Floats  # (rows + 2, rows + 1, lanes): Newton's, and two rows to spare
    scratch: Floats  # (12, lanes)


def workspace(harmonics: int, coupled: int, samples: int) -> Workspace:
    """Return room for points of some resolution.

    Parameters
    ----------
    harmonics, coupled, samples : int
        The largest of `Resolution`.

    Returns
    -------
    Workspace
    """
    most, rows, instants = harmonics + 1, 2 * coupled + 1, samples // 2 + 1
    return Workspace(
        lanes=np.empty((7, LANES)),
        answers=np.empty((most, 2, LANES)),
        linear=np.empty((2, most, LANES)),
        unknown=np.empty((2, most, LANES)),
        step=np.empty((2, most, LANES)),
        velocity=np.empty((2, most, LANES)),
        waves=np.empty((2, instants, instants)),
        tabulated=np.zeros(1, dtype=np.int64),
        sums=np.empty((3, 2, instants, LANES)),
        spectra=np.empty((3, 2, 2 * most - 1, LANES)),
        matrix=np.empty((rows + 2, rows + 1, LANES)),
        scratch=np.empty((12, LANES)),
    )


@numba.njit(**KERNEL)
def balance(
    kind: Choice,
    damped: Choice,
    poles: Floats,
    static_stiffness: float,
    law: Law,
    points: Points,
    resolution: Integers,
    chosen: Integers,
    tolerance: float,
    iterations: int,
    outcome: Integers,
    work: Workspace,
) -> None:
    """Find the steady states of the chosen points.

    Parameters
    ----------
    kind, damped : tuple
        As of `sonolube.dynamics.contact_lanes.Compiled`.
    poles : ndarray, shape (4, m)
        Of the contact's receptance, as by `ContactPort.poles`.
    static_stiffness : float
        Of the structure at the contact, in N/m.
    law : Law
    points : Points
    resolution : ndarray of int, shape (3, p)
        Rows as the fields of `Resolution`; the harmonics that were used are written.
    chosen : ndarray of int
        Points to solve, like beside like: a block of lanes is resolved as finely as its most demanding point.
    tolerance : float
        Largest relative error of amplitude and force.
    iterations : int
        Most iterations.
    outcome : ndarray of int, shape (p,)
        Written at the chosen points: CONVERGED, DIVERGED (nothing else is written), NEEDS_HARMONICS or NEEDS_SAMPLES.
    work : Workspace
        For the finest of the chosen points' resolutions.
    """
    for start in range(0, chosen.size, LANES):
        block = chosen[start : start + LANES]
        _balance_block(
            kind, damped, poles, static_stiffness, law, points, resolution, block, tolerance, iterations, outcome, work
        )


@numba.njit(**ONCE)
def _balance_block(
    kind: Choice,
    damped: Choice,
    poles: Floats,
    static_stiffness: float,
    law: Law,
    points: Points,
    resolution: Integers,
    block: Integers,
    tolerance: float,
    iterations: int,
    outcome: Integers,
    work: Workspace,
) -> None:
    lanes, answers, unknown, step = work.lanes, work.answers, work.unknown, work.step
    waves, sums, spectra, matrix, scratch = work.waves, work.sums, work.spectra, work.matrix, work.scratch
    h, n, count = finest(resolution[0], block), finest(resolution[1], block), finest(resolution[2], block)
    _gather(points, block, h, unknown, work.linear, lanes)
    for k in range(1, h + 1):
        receptances(poles, lanes[OMEGA], float(k), answers[k])
    if count != work.tabulated[0]:
        _tabulate(count, waves)
        work.tabulated[0] = count
    quantities = 3 if len(damped) == 1 else (1 if parallel(kind, damped) else 2)
    for _ in range(iterations):
        _differentiate(damped, unknown, h, work.velocity)
        for j in range(count // 2 + 1):
            weight = (0.5 if j == 0 or j == count // 2 else 1.0) / count
            _sample_pair(
                kind, damped, law, lanes, unknown, work.velocity, waves, h, j, weight, quantities, scratch, sums
            )
        _transform(waves, sums, count // 2, quantities, h + n + 1, spectra)
        if quantities == 1:
            _follow_force(law.parameter, h + n + 1, spectra)
        _residual(static_stiffness, unknown, answers, work.linear, spectra, lanes, h, step)
        newton_step(damped, static_stiffness, answers, spectra, lanes[OMEGA], h, n, matrix, step)
        if _advance(unknown, step, h, lanes, scratch[0]) <= _EXACTLY * tolerance:
            break
    # The samples mistake harmonic count - h for harmonic h. Those of an exponential force fall ever faster, which
    # bounds it by the highest one that they resolve: a_(count - h) <= a_k^((count - h)/k), a_0 = 1.
    aliased = tolerance ** ((0.5 * count - 1) / (count - h)) if quantities == 1 else tolerance
    _judge(poles, block, h, count, waves, sums, spectra[0, 0, 0], lanes, tolerance, aliased, scratch, outcome)
    _scatter(points, resolution[0], block, h, unknown, spectra, outcome)


@numba.njit(**INSIDE)
def finest(values: Integers, chosen: Integers) -> int:
    """Return the largest of the chosen points' values."""
    most = np.int64(0)
    for point in chosen:
        most = max(most, values[point])
    return int(most)


@numba.njit(**INSIDE)
def _gather(points: Points, block: Integers, h: int, unknown: Floats, linear: Floats, lanes: Floats) -> None:
    given, mean, harmonics, free = points.given, points.mean, points.harmonics, points.free
    for lane in range(LANES):
        point = block[min(lane, block.size - 1)]
        for row in range(given.shape[0]):
            lanes[row, lane] = given[row, point]
        unknown[0, 0, lane], unknown[1, 0, lane] = mean[point], 0.0
        for k in range(1, h + 1):
            guess = harmonics[point, k - 1]
            unknown[0, k, lane], unknown[1, k, lane] = guess.real, guess.imag
            alone = free[point, k - 1] if k <= free.shape[1] else 0j
            linear[0, k, lane], linear[1, k, lane] = alone.real, alone.imag


@numba.njit(**INSIDE)
def _tabulate(count: int, waves: Floats) -> None:
    for j in range(count // 2 + 1):
        for k in range(count // 2 + 1):
            phase = 2 * np.pi / count * (j * k % count)
            waves[0, j, k], waves[1, j, k] = np.cos(phase), np.sin(phase)


@numba.njit(**INSIDE)
def _differentiate(damped: Choice, unknown: Floats, h: int, velocity: Floats) -> None:
    if len(damped) == 1:
        for k in range(h + 1):
            for lane in range(LANES):
                velocity[0, k, lane] = -k * unknown[1, k, lane]
                velocity[1, k, lane] = k * unknown[0, k, lane]


@numba.njit(**INSIDE)
def _sample_pair(
    kind: Choice,
    damped: Choice,
    law: Law,
    lanes: Floats,
    unknown: Floats,
    velocity: Floats,
    waves: Floats,
    h: int,
    j: int,
    weight: float,
    quantities: int,
    scratch: Floats,
    sums: Floats,
) -> None:
    """Write weighted sums and differences of force, stiffness and damping at the j-th instant and its mirror image."""
    for part in range(2):
        combine(scratch[part], waves[part, j], unknown[part], h)
        if len(damped) == 1:
            combine(scratch[2 + part], waves[part, j], velocity[part], h)
    x, v = scratch[4], scratch[5]
    for side in range(2):
        sign = 2.0 * side - 1.0
        for lane in range(LANES):
            x[lane] = scratch[0, lane] + sign * scratch[1, lane]
        if len(damped) == 1:
            for lane in range(LANES):
                v[lane] = lanes[OMEGA, lane] * (scratch[2, lane] + sign * scratch[3, lane])
        contact_rows(kind, damped, law, lanes[LOAD], lanes[RESTING], x, v, scratch[6 + 3 * side : 9 + 3 * side])
    for quantity in range(quantities):
        for lane in range(LANES):
            sums[quantity, 0, j, lane] = weight * (scratch[9 + quantity, lane] + scratch[6 + quantity, lane])
            sums[quantity, 1, j, lane] = weight * (scratch[9 + quantity, lane] - scratch[6 + quantity, lane])


@numba.njit(**INSIDE)
def _transform(waves: Floats, sums: Floats, half: int, quantities: int, end: int, spectra: Floats) -> None:
    """Write (1/2 pi) int f exp(-i m theta) of force, stiffness and damping for the orders m before `end`."""
    for quantity in range(quantities):
        for part in range(2):
            for m in range(end):
                combine(spectra[quantity, part, m], waves[part, m], sums[quantity, part], half)


@numba.njit(**INSIDE)
def _follow_force(length: float, end: int, spectra: Floats) -> None:
    """Write the stiffness that goes with the force."""
    for part in range(2):
        for m in range(end):
            for lane in range(LANES):
                spectra[1, part, m, lane] = spectra[0, part, m, lane] / length


@numba.njit(**INSIDE)
def _residual(
    static_stiffness: float,
    unknown: Floats,
    answers: Floats,
    linear: Floats,
    spectra: Floats,
    lanes: Floats,
    h: int,
    step: Floats,
) -> None:
    """Write minus the residual of every equation."""
    force = spectra[0]
    for lane in range(LANES):
        step[0, 0, lane] = force[0, 0, lane] - lanes[LOAD, lane]
        step[0, 0, lane] -= static_stiffness * (unknown[0, 0, lane] - lanes[FREE_MEAN, lane])
    for k in range(1, h + 1):
        for lane in range(LANES):
            real, imaginary, re, im = answers[k, 0, lane], answers[k, 1, lane], force[0, k, lane], force[1, k, lane]
            step[0, k, lane] = linear[0, k, lane] - unknown[0, k, lane] + 2 * (real * re - imaginary * im)
            step[1, k, lane] = linear[1, k, lane] - unknown[1, k, lane] + 2 * (real * im + imaginary * re)


@numba.njit(**INSIDE)
def _advance(unknown: Floats, step: Floats, h: int, lanes: Floats, share: Floats) -> float:
    """Take the step, shortened where it exceeds what the contact's reach allows; return its largest relative size."""
    size, scale = lanes[SIZE], lanes[SCALE]
    for lane in range(LANES):
        size[lane], scale[lane] = abs(step[0, 0, lane]), 1e-3 * lanes[LENGTH, lane]
    for k in range(1, h + 1):
        for lane in range(LANES):
            size[lane] += abs(step[0, k, lane]) + abs(step[1, k, lane])
    for lane in range(LANES):
        share[lane] = min(1.0, _LARGEST_STEP * lanes[LENGTH, lane] / size[lane])
        unknown[0, 0, lane] += share[lane] * step[0, 0, lane]
    for k in range(1, h + 1):
        for lane in range(LANES):
            unknown[0, k, lane] += share[lane] * step[0, k, lane]
            unknown[1, k, lane] += share[lane] * step[1, k, lane]
            scale[lane] += abs(unknown[0, k, lane]) + abs(unknown[1, k, lane])
    largest = 0.0
    for lane in range(LANES):
        relative = size[lane] / scale[lane]
        if not relative <= largest:  # also when it is not a number
            largest = relative if relative < np.inf else np.inf
    return largest


@numba.njit(**INSIDE)
def _judge(
    poles: Floats,
    block: Integers,
    h: int,
    count: int,
    waves: Floats,
    sums: Floats,
    mean_force: Floats,
    lanes: Floats,
    tolerance: float,
    aliased: float,
    scratch: Floats,
    outcome: Integers,
) -> None:
    """Say which points converged, and which of them were resolved finely enough."""
    real, imaginary, tail, answer = scratch[0], scratch[1], scratch[2], scratch[3:5]
    for lane in range(LANES):
        tail[lane] = 0.0
    for order in range(h + 1, 2 * h + 2):
        m = order if order <= 2 * h else count // 2 - 1  # the last one is the highest that the samples resolve
        for part in range(2):
            combine(scratch[part], waves[part, m], sums[0, part], count // 2)
        if order <= 2 * h:
            receptances(poles, lanes[OMEGA], float(m), answer)
            for lane in range(LANES):
                receptance = answer[0, lane] ** 2 + answer[1, lane] ** 2
                tail[lane] = max(tail[lane], 4 * receptance * (real[lane] ** 2 + imaginary[lane] ** 2))
    for lane in range(block.size):
        highest = real[lane] ** 2 + imaginary[lane] ** 2
        verdict = CONVERGED
        if not lanes[SIZE, lane] <= _EXACTLY * tolerance * lanes[SCALE, lane]:
            verdict = DIVERGED
        elif highest > (aliased * max(mean_force[lane], 1e-3 * lanes[LOAD, lane])) ** 2:
            verdict = NEEDS_SAMPLES
        elif tail[lane] > (TAIL * tolerance * lanes[SCALE, lane]) ** 2:
            verdict = NEEDS_HARMONICS
        outcome[block[lane]] = verdict


@numba.njit(**INSIDE)
def _scatter(
    points: Points, used: Integers, block: Integers, h: int, unknown: Floats, spectra: Floats, outcome: Integers
) -> None:
    mean, harmonics, force = points.mean, points.harmonics, points.force
    for lane in range(block.size):
        point = block[lane]
        if outcome[point] == DIVERGED:
            continue
        used[point] = h
        mean[point] = unknown[0, 0, lane]
        for k in range(1, h + 1):
            harmonics[point, k - 1] = complex(unknown[0, k, lane], unknown[1, k, lane])
        for k in range(1, min(force.shape[1], h) + 1):
            force[point, k - 1] = complex(2 * spectra[0, 0, k, lane], 2 * spectra[0, 1, k, lane])
