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

from sonolube.checks import Floats, Integers
from sonolube.dynamics.harmonic_balance.contact_kernel import Choice, Law, contact_rows, differentiate, parallel
from sonolube.dynamics.harmonic_balance.newton_kernel import newton_step
from sonolube.dynamics.harmonic_balance.receptance import receptances
from sonolube.dynamics.kernels.simd import (
    INSIDE,
    KERNEL,
    LANES,
    ONCE,
    add_size,
    blend,
    combine,
    gather,
    subtract_product,
)

# Rows of what a block of points brings along: angular frequency, dead load, the length over which the contact changes,
# where it rests, the mean displacement without contact; then sizes of the last step and of the motion.
OMEGA, LOAD, LENGTH, RESTING, FREE_MEAN, SIZE, SCALE = range(7)
CONVERGED, DIVERGED, NEEDS_HARMONICS, NEEDS_SAMPLES = 0, 1, 2, 3
# In tolerances, relative to the amplitude: the harmonics left out, and the last step of Newton's method.
TAIL, _EXACTLY = 0.3, 0.01
_LARGEST_STEP = 2.0  # in lengths over which the contact changes


class Points(NamedTuple):
    """Steady states to find, one row to a point; of harmonics, real and imaginary parts in turns."""

    given: Floats  # (p, 5): columns OMEGA to FREE_MEAN
    free: Floats  # (p, 2 K) m, harmonics without contact
    mean: Floats  # (p, 1) m
    harmonics: Floats  # (p, 2 room) m, the first guess and then the result
    force: Floats  # (p, 2 K) N, harmonics of the contact force, written


class Resolution(NamedTuple):
    """How finely each point is to be resolved, one entry of each array to a point."""

    harmonics: Integers
    coupled: Integers  # of them, those in Newton's matrix
    samples: Integers


class Workspace(NamedTuple):
    """Rows that a block of points is solved in.

    A motion of H harmonics has 2 H + 1 rows: its mean, and from row 2 k - 1 on real and imaginary part of harmonic k;
    so have spectra, and sums and differences at instants.
    """

    lanes: Floats  # (7, lanes): rows OMEGA to SCALE
    answers: Floats  # (H + 1, 2, lanes): receptances of the contact
    motions: Floats  # (4, 2 H + 1, lanes): the motion, the step to take, the motion without contact, velocity/omega
    waves: Floats  # (2, instants, instants): cosines and sines of j k 2 pi / count
    tabulated: Integers  # (1,): the count of samples whose waves these are
    sums: Floats  # (3, 2 instants - 1, lanes): weighted sums and differences of force, stiffness and damping
    spectra: Floats  # (3, 4 H + 1, lanes): of force, stiffness and damping
    matrix: Floats  # (rows + 2, rows, lanes): Newton's, and two rows to spare
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
    rows, instants = 2 * coupled + 1, samples // 2 + 1
    return Workspace(
        lanes=np.empty((7, LANES)),
        answers=np.empty((harmonics + 1, 2, LANES)),
        motions=np.zeros((4, 2 * harmonics + 1, LANES)),
        waves=np.empty((2, instants, instants)),
        tabulated=np.zeros(1, dtype=np.int64),
        sums=np.empty((3, 2 * instants - 1, LANES)),
        spectra=np.empty((3, 4 * harmonics + 1, LANES)),
        matrix=np.empty((rows + 2, rows, LANES)),
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
        As of `sonolube.dynamics.harmonic_balance.contact_kernel.Compiled`.
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
    lanes, answers, motions, waves = work.lanes, work.answers, work.motions, work.waves
    sums, spectra, scratch = work.sums, work.spectra, work.scratch
    unknown, step, linear, velocity = motions[0], motions[1], motions[2], motions[3]
    h, n, count = finest(resolution[0], block), finest(resolution[1], block), finest(resolution[2], block)
    gather(points.given, block, lanes)
    gather(points.mean, block, unknown[:1])
    gather(points.harmonics, block, unknown[1 : 2 * h + 1])
    gather(points.free, block, linear[1 : 2 * h + 1])
    for k in range(1, h + 1):
        receptances(poles, lanes[OMEGA], float(k), answers[k])
    if count != work.tabulated[0]:
        _tabulate(count, waves)
        work.tabulated[0] = count
    quantities = 3 if len(damped) == 1 else (1 if parallel(kind, damped) else 2)
    for _ in range(iterations):
        differentiate(damped, unknown, h, velocity)
        for j in range(count // 2 + 1):
            weight = (0.5 if j == 0 or j == count // 2 else 1.0) / count
            _sample_pair(kind, damped, law, lanes, unknown, velocity, waves, h, j, weight, quantities, scratch, sums)
        _transform(waves, sums, count // 2, quantities, 2 * (h + n) + 1, spectra)
        if quantities == 1:
            _follow_force(law.parameter, 2 * (h + n) + 1, spectra)
        _residual(static_stiffness, unknown, answers, linear, spectra[0], lanes, h, step)
        newton_step(damped, static_stiffness, answers, spectra, lanes[OMEGA], h, n, work.matrix, step)
        if _advance(unknown, step, 2 * h + 1, lanes, scratch[0], _EXACTLY * tolerance):
            break
    # The samples mistake harmonic count - h for harmonic h. Those of an exponential force fall ever faster, which
    # bounds it by the highest one that they resolve: a_(count - h) <= a_k^((count - h)/k), a_0 = 1.
    aliased = tolerance ** ((0.5 * count - 1) / (count - h)) if quantities == 1 else tolerance
    _judge(poles, block, h, count, waves, sums[0], spectra[0, 0], lanes, tolerance, aliased, scratch, outcome)
    _scatter(points, resolution[0], block, h, unknown, spectra[0], outcome)


@numba.njit(**INSIDE)
def finest(values: Integers, chosen: Integers) -> int:
    """Return the largest of the chosen points' values."""
    most = np.int64(0)
    for point in chosen:
        most = max(most, values[point])
    return int(most)


@numba.njit(**INSIDE)
def _tabulate(count: int, waves: Floats) -> None:
    for j in range(count // 2 + 1):
        for k in range(count // 2 + 1):
            phase = 2 * np.pi / count * (j * k % count)
            waves[0, j, k], waves[1, j, k] = np.cos(phase), np.sin(phase)


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
        combine(scratch[part], waves[part, j], unknown, part, h)
        if len(damped) == 1:
            combine(scratch[2 + part], waves[part, j], velocity, part, h)
    x, v = scratch[4], scratch[5]
    for side in range(2):
        sign = 2.0 * side - 1.0
        blend(scratch[0], 1.0, scratch[1], sign, x)
        if len(damped) == 1:
            blend(scratch[2], 1.0, scratch[3], sign, v)
            for lane in range(LANES):
                v[lane] *= lanes[OMEGA, lane]
        contact_rows(kind, damped, law, lanes[LOAD], lanes[RESTING], x, v, scratch[6 + 3 * side : 9 + 3 * side])
    for quantity in range(quantities):
        here, mirrored = scratch[9 + quantity], scratch[6 + quantity]
        if j > 0:
            blend(here, weight, mirrored, -weight, sums[quantity, 2 * j])
        blend(here, weight, mirrored, weight, sums[quantity, max(2 * j - 1, 0)])


@numba.njit(**INSIDE)
def _transform(waves: Floats, sums: Floats, half: int, quantities: int, rows: int, spectra: Floats) -> None:
    """Write (1/2 pi) int f exp(-i m theta) of force, stiffness and damping, so many rows."""
    for quantity in range(quantities):
        for row in range(rows):
            part = (row + 1) % 2 if row > 0 else 0
            combine(spectra[quantity, row], waves[part, (row + 1) // 2], sums[quantity], part, half)


@numba.njit(**INSIDE)
def _follow_force(length: float, rows: int, spectra: Floats) -> None:
    """Write the stiffness that goes with the force."""
    for row in range(rows):
        for lane in range(LANES):
            spectra[1, row, lane] = spectra[0, row, lane] / length


@numba.njit(**INSIDE)
def _residual(
    static_stiffness: float,
    unknown: Floats,
    answers: Floats,
    linear: Floats,
    force: Floats,
    lanes: Floats,
    h: int,
    step: Floats,
) -> None:
    """Write the residual of every equation."""
    for lane in range(LANES):
        pull = static_stiffness * (unknown[0, lane] - lanes[FREE_MEAN, lane])
        step[0, lane] = pull + lanes[LOAD, lane] - force[0, lane]
    for k in range(1, h + 1):
        r = 2 * k
        for lane in range(LANES):
            real, imaginary, re, im = answers[k, 0, lane], answers[k, 1, lane], force[r - 1, lane], force[r, lane]
            step[r - 1, lane] = unknown[r - 1, lane] - linear[r - 1, lane] - 2 * (real * re - imaginary * im)
            step[r, lane] = unknown[r, lane] - linear[r, lane] - 2 * (real * im + imaginary * re)


@numba.njit(**INSIDE)
def _advance(unknown: Floats, step: Floats, rows: int, lanes: Floats, share: Floats, allowed: float) -> bool:
    """Take the step back, shortened where it exceeds the contact's reach; return whether all were as small as allowed.

    The size of a step is relative to the motion's, both sums over the rows, the latter without the mean.
    """
    size, scale = lanes[SIZE], lanes[SCALE]
    for lane in range(LANES):
        size[lane], scale[lane] = 0.0, 1e-3 * lanes[LENGTH, lane]
    for row in range(rows):
        add_size(step[row], size)
    for lane in range(LANES):
        share[lane] = min(1.0, _LARGEST_STEP * lanes[LENGTH, lane] / size[lane])
    for row in range(rows):
        subtract_product(share, step[row], unknown[row])
        if row > 0:
            add_size(unknown[row], scale)
    small = 0
    for lane in range(LANES):
        small += size[lane] <= allowed * scale[lane]  # which what is not a number is not
    return small == LANES


@numba.njit(**INSIDE)
def _judge(
    poles: Floats,
    block: Integers,
    h: int,
    count: int,
    waves: Floats,
    force: Floats,
    mean_force: Floats,
    lanes: Floats,
    tolerance: float,
    aliased: float,
    scratch: Floats,
    outcome: Integers,
) -> None:
    """Say which points converged, and which of them were resolved finely enough."""
    real, imaginary, square, tail, answer = scratch[0], scratch[1], scratch[2], scratch[3], scratch[4:6]
    for lane in range(LANES):
        tail[lane] = 0.0
    for order in range(h + 1, 2 * h + 2):
        m = order if order <= 2 * h else count // 2 - 1  # the last one is the highest that the samples resolve
        for part in range(2):
            combine(scratch[part], waves[part, m], force, part, count // 2)
        for lane in range(LANES):
            square[lane] = real[lane] * real[lane] + imaginary[lane] * imaginary[lane]
        if order <= 2 * h:
            receptances(poles, lanes[OMEGA], float(m), answer)
            for lane in range(LANES):
                motion = 4 * square[lane] * (answer[0, lane] * answer[0, lane] + answer[1, lane] * answer[1, lane])
                tail[lane] = max(tail[lane], motion)
    for lane in range(block.size):
        verdict, allowed = CONVERGED, tolerance * lanes[SCALE, lane]
        if not lanes[SIZE, lane] <= _EXACTLY * allowed:
            verdict = DIVERGED
        elif np.sqrt(square[lane]) > aliased * max(mean_force[lane], 1e-3 * lanes[LOAD, lane]):
            verdict = NEEDS_SAMPLES
        elif np.sqrt(tail[lane]) > TAIL * allowed:
            verdict = NEEDS_HARMONICS
        outcome[block[lane]] = verdict


@numba.njit(**INSIDE)
def _scatter(
    points: Points, used: Integers, block: Integers, h: int, unknown: Floats, spectrum: Floats, outcome: Integers
) -> None:
    mean, harmonics, force = points.mean, points.harmonics, points.force
    for lane in range(block.size):
        point = block[lane]
        if outcome[point] == DIVERGED:
            continue
        used[point] = h
        mean[point, 0] = unknown[0, lane]
        for part in range(2 * h):
            harmonics[point, part] = unknown[part + 1, lane]
            if part < force.shape[1]:
                force[point, part] = 2 * spectrum[part + 1, lane]
