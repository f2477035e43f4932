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
from sonolube.dynamics.contact_lanes import Law, contact_rows, parallel
from sonolube.dynamics.contact_port import ContactPort, receptances
from sonolube.dynamics.lanes import INSIDE, KERNEL, LANES, ONCE, combine
from sonolube.dynamics.newton_kernel import newton_step

Integers = NDArray[np.int64]

CONVERGED, DIVERGED, NEEDS_HARMONICS, NEEDS_SAMPLES = 0, 1, 2, 3
# In tolerances, relative to the amplitude: the harmonics left out, and the last step of Newton's method.
TAIL, _EXACTLY = 0.3, 0.01
_LARGEST_STEP = 2.0  # in lengths over which the contact changes


class Points(NamedTuple):
    """Steady states to find, one entry of each array to a point; harmonics hold the first guess and then the result."""

    omega: Floats  # (p,) rad/s
    load: Floats  # (p,) N
    length: Floats  # (p,) m, over which the contact changes
    resting: Floats  # (p,): where it rests, as by `resting_place`
    free_mean: Floats  # (p,) m, without contact
    free: Complexes  # (p, K) m, harmonics likewise
    mean: Floats  # (p,) m
    harmonics: Complexes  # (p, room) m
    force: Complexes  # (p, K) N, harmonics of the contact force, written


class Samples(NamedTuple):
    """The contact over one period: instants theta_j from 0 to pi, each with its mirror image -theta_j."""

    cosines: Floats  # (instants, instants): of j k 2 pi / count
    sines: Floats
    velocity: Floats  # (2, H + 1, lanes): harmonics of velocity over omega
    parts: Floats  # (2, 2, lanes): even and odd parts of displacement and velocity
    sides: Floats  # (2, 3, lanes): force, stiffness and damping, ahead and behind
    work: Floats  # (2, lanes)
    sums: Floats  # (3, 2, instants, lanes): weighted sums and differences of force, stiffness and damping


class Lanes(NamedTuple):
    """What a block of points brings along, one lane each."""

    omega: Floats
    load: Floats
    length: Floats  # over which the contact changes, in m
    resting: Floats  # where it rests
    free_mean: Floats
    size: Floats  # of the last step, in m
    scale: Floats  # of the motion, in m


class Resolution(NamedTuple):
    """How finely each point is to be resolved, one entry of each array to a point."""

    harmonics: Integers
    coupled: Integers  # of them, those in Newton's matrix
    samples: Integers


class Workspace(NamedTuple):
    """Rows that a block of points is solved in."""

    answers: Floats  # (H + 1, 2, lanes): receptances of the contact
    linear: Floats  # (2, H + 1, lanes): motion without contact
    unknown: Floats  # (2, H + 1, lanes): motion
    step: Floats  # (2, H + 1, lanes)
    spectra: Floats  # (3, 2, 2 H + 1, lanes): of force, stiffness and damping
    matrix: Floats  # (rows + 2, rows + 1, lanes): Newton's, and two rows to spare
    lanes: Lanes
    samples: Samples


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
        answers=np.empty((most, 2, LANES)),
        linear=np.empty((2, most, LANES)),
        unknown=np.empty((2, most, LANES)),
        step=np.empty((2, most, LANES)),
        spectra=np.empty((3, 2, 2 * most - 1, LANES)),
        matrix=np.empty((rows + 2, rows + 1, LANES)),
        lanes=Lanes(*np.empty((7, LANES))),
        samples=Samples(
            np.empty((instants, instants)),
            np.empty((instants, instants)),
            np.empty((2, most, LANES)),
            np.empty((2, 2, LANES)),
            np.empty((2, 3, LANES)),
            np.empty((2, LANES)),
            np.empty((3, 2, instants, LANES)),
        ),
    )


@numba.njit(**KERNEL)
def balance(
    port: ContactPort,
    law: Law,
    points: Points,
    resolution: Resolution,
    chosen: Integers,
    tolerance: float,
    iterations: int,
    outcome: Integers,
    work: Workspace,
) -> None:
    """Find the steady states of the chosen points.

    Parameters
    ----------
    port : ContactPort
    law : Law
    points : Points
    resolution : Resolution
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
    answers, linear, unknown, step = work.answers, work.linear, work.unknown, work.step
    spectra, matrix, lanes, samples = work.spectra, work.matrix, work.lanes, work.samples
    tabulated = 0
    for start in range(0, chosen.size, LANES):
        block = chosen[start : start + LANES]
        h, n = finest(resolution.harmonics, block), finest(resolution.coupled, block)
        count = finest(resolution.samples, block)
        _gather(points, block, h, unknown, linear, lanes)
        for k in range(1, h + 1):
            receptances(port, port.constant[0], port.slope[0], lanes.omega, float(k), answers[k, 0], answers[k, 1])
        if count != tabulated:
            _trigonometry(count, samples)
            tabulated = count
        for _ in range(iterations):
            quantities = _sample(law, unknown, lanes, h, count, samples)
            _transform(samples, quantities, count, 0, h + n + 1, spectra)
            if quantities == 1:
                _follow_force(law, h + n + 1, spectra)
            _residual(port.static_stiffness, unknown, answers, linear, spectra, lanes, h, step)
            newton_step(port.static_stiffness, answers, spectra, law.damping > 0, lanes.omega, h, n, matrix, step)
            if _advance(unknown, step, h, lanes) <= _EXACTLY * tolerance:
                break
        _transform(samples, 1, count, h + n + 1, 2 * h + 1, spectra)
        # The samples mistake harmonic count - h for harmonic h. Those of an exponential force fall ever faster, which
        # bounds it by the highest one that they resolve: a_(count - h) <= a_k^((count - h)/k), a_0 = 1.
        aliased = tolerance ** ((0.5 * count - 1) / (count - h)) if parallel(law) else tolerance
        _judge(port, block, h, count, samples, spectra, lanes, tolerance, aliased, linear, outcome)
        _scatter(points, resolution, block, h, unknown, spectra, outcome)


@numba.njit(**INSIDE)
def finest(values: Integers, chosen: Integers) -> int:
    """Return the largest of the chosen points' values."""
    most = np.int64(0)
    for point in chosen:
        most = max(most, values[point])
    return int(most)


@numba.njit(**INSIDE)
def _gather(points: Points, block: Integers, h: int, unknown: Floats, linear: Floats, lanes: Lanes) -> None:
    for lane in range(LANES):
        point = block[min(lane, block.size - 1)]
        lanes.omega[lane], lanes.load[lane] = points.omega[point], points.load[point]
        lanes.length[lane], lanes.resting[lane] = points.length[point], points.resting[point]
        lanes.free_mean[lane] = points.free_mean[point]
        unknown[0, 0, lane], unknown[1, 0, lane] = points.mean[point], 0.0
        for k in range(1, h + 1):
            guess = points.harmonics[point, k - 1]
            unknown[0, k, lane], unknown[1, k, lane] = guess.real, guess.imag
            free = points.free[point, k - 1] if k <= points.free.shape[1] else 0j
            linear[0, k, lane], linear[1, k, lane] = free.real, free.imag


@numba.njit(**INSIDE)
def _trigonometry(count: int, samples: Samples) -> None:
    for j in range(count // 2 + 1):
        for k in range(count // 2 + 1):
            phase = 2 * np.pi / count * (j * k % count)
            samples.cosines[j, k], samples.sines[j, k] = np.cos(phase), np.sin(phase)


@numba.njit(**ONCE)
def _sample(law: Law, unknown: Floats, lanes: Lanes, h: int, count: int, samples: Samples) -> int:
    """Write the sums of samples of the force, and of stiffness and damping as far as they are functions of their own.

    Return how many of the three.
    """
    damped = law.damping > 0
    quantities = 3 if damped else (1 if parallel(law) else 2)
    half = count // 2
    if damped:
        for k in range(h + 1):
            for lane in range(LANES):
                samples.velocity[0, k, lane] = -k * unknown[1, k, lane]
                samples.velocity[1, k, lane] = k * unknown[0, k, lane]
    for j in range(half + 1):
        weight = (0.5 if j == 0 or j == half else 1.0) / count
        _sample_pair(law, unknown, lanes, h, j, weight, quantities, samples)
    return quantities


@numba.njit(**INSIDE)
def _transform(samples: Samples, quantities: int, count: int, first: int, end: int, spectra: Floats) -> None:
    """Write (1/2 pi) int f exp(-i m theta) of force, stiffness and damping for the orders m before `end`."""
    for quantity in range(quantities):
        for m in range(first, end):
            combine(spectra[quantity, 0, m], samples.cosines[m], samples.sums[quantity, 0], count // 2)
            combine(spectra[quantity, 1, m], samples.sines[m], samples.sums[quantity, 1], count // 2)


@numba.njit(**INSIDE)
def _follow_force(law: Law, end: int, spectra: Floats) -> None:
    """Write the stiffness that goes with the force."""
    rate = 1 / law.parameter
    for part in range(2):
        for m in range(end):
            for lane in range(LANES):
                spectra[1, part, m, lane] = spectra[0, part, m, lane] * rate


@numba.njit(**INSIDE)
def _sample_pair(
    law: Law, unknown: Floats, lanes: Lanes, h: int, j: int, weight: float, quantities: int, samples: Samples
) -> None:
    """Write weighted sums and differences of force, stiffness and damping at the j-th instant and its mirror image."""
    even, odd = samples.parts[0, 0], samples.parts[0, 1]
    combine(even, samples.cosines[j], unknown[0], h)
    combine(odd, samples.sines[j], unknown[1], h)
    if law.damping > 0:
        combine(samples.parts[1, 0], samples.cosines[j], samples.velocity[0], h)
        combine(samples.parts[1, 1], samples.sines[j], samples.velocity[1], h)
    x, v = samples.work[0], samples.work[1]
    for side in range(2):
        sign = 2.0 * side - 1.0
        for lane in range(LANES):
            x[lane] = even[lane] + sign * odd[lane]
        if law.damping > 0:
            for lane in range(LANES):
                v[lane] = lanes.omega[lane] * (samples.parts[1, 0, lane] + sign * samples.parts[1, 1, lane])
        force, slope, drag = samples.sides[side, 0], samples.sides[side, 1], samples.sides[side, 2]
        contact_rows(law, lanes.load, lanes.resting, x, v, force, slope, drag)
    for quantity in range(quantities):
        ahead, behind = samples.sides[0, quantity], samples.sides[1, quantity]
        total, difference = samples.sums[quantity, 0, j], samples.sums[quantity, 1, j]
        for lane in range(LANES):
            total[lane] = weight * (behind[lane] + ahead[lane])
            difference[lane] = weight * (behind[lane] - ahead[lane])


@numba.njit(**INSIDE)
def _residual(
    static_stiffness: float,
    unknown: Floats,
    answers: Floats,
    linear: Floats,
    spectra: Floats,
    lanes: Lanes,
    h: int,
    step: Floats,
) -> None:
    """Write minus the residual of every equation."""
    for lane in range(LANES):
        excess = spectra[0, 0, 0, lane] - lanes.load[lane]
        step[0, 0, lane] = excess - static_stiffness * (unknown[0, 0, lane] - lanes.free_mean[lane])
    for k in range(1, h + 1):
        g_re, g_im, re, im = answers[k, 0], answers[k, 1], spectra[0, 0, k], spectra[0, 1, k]
        for lane in range(LANES):
            own_re, own_im = linear[0, k, lane] - unknown[0, k, lane], linear[1, k, lane] - unknown[1, k, lane]
            step[0, k, lane] = own_re + 2 * (g_re[lane] * re[lane] - g_im[lane] * im[lane])
            step[1, k, lane] = own_im + 2 * (g_re[lane] * im[lane] + g_im[lane] * re[lane])


@numba.njit(**INSIDE)
def _advance(unknown: Floats, step: Floats, h: int, lanes: Lanes) -> float:
    """Take the step, shortened where it exceeds what the contact's reach allows; return its largest relative size."""
    size, scale = lanes.size, lanes.scale
    for lane in range(LANES):
        size[lane] = abs(step[0, 0, lane])
        scale[lane] = 1e-3 * lanes.length[lane]
    for k in range(1, h + 1):
        for lane in range(LANES):
            size[lane] += abs(step[0, k, lane]) + abs(step[1, k, lane])
    for lane in range(LANES):
        step[1, 0, lane] = min(1.0, _LARGEST_STEP * lanes.length[lane] / size[lane])
        unknown[0, 0, lane] += step[1, 0, lane] * step[0, 0, lane]
    for k in range(1, h + 1):
        for lane in range(LANES):
            unknown[0, k, lane] += step[1, 0, lane] * step[0, k, lane]
            unknown[1, k, lane] += step[1, 0, lane] * step[1, k, lane]
            scale[lane] += abs(unknown[0, k, lane]) + abs(unknown[1, k, lane])
    largest = 0.0
    for lane in range(LANES):
        relative = size[lane] / scale[lane]
        if not relative <= largest:  # also when it is not a number
            largest = relative if relative < np.inf else np.inf
    return largest


@numba.njit(**INSIDE)
def _judge(
    port: ContactPort,
    block: Integers,
    h: int,
    count: int,
    samples: Samples,
    spectra: Floats,
    lanes: Lanes,
    tolerance: float,
    aliased: float,
    work: Floats,
    outcome: Integers,
) -> None:
    """Say which points converged, and which of them were resolved finely enough."""
    half, tail, real, imaginary = count // 2, work[0, 0], work[0, 1], work[1, 1]
    tail[:] = 0.0
    for k in range(h + 1, 2 * h + 1):
        receptances(port, port.constant[0], port.slope[0], lanes.omega, float(k), real, imaginary)
        for lane in range(LANES):
            receptance = real[lane] ** 2 + imaginary[lane] ** 2
            force = spectra[0, 0, k, lane] ** 2 + spectra[0, 1, k, lane] ** 2
            tail[lane] = max(tail[lane], 4 * receptance * force)
    combine(real, samples.cosines[half - 1], samples.sums[0, 0], half)
    combine(imaginary, samples.sines[half - 1], samples.sums[0, 1], half)
    for lane in range(block.size):
        highest = real[lane] * real[lane] + imaginary[lane] * imaginary[lane]
        verdict = CONVERGED
        if not lanes.size[lane] <= _EXACTLY * tolerance * lanes.scale[lane]:
            verdict = DIVERGED
        elif highest > (aliased * max(spectra[0, 0, 0, lane], 1e-3 * lanes.load[lane])) ** 2:
            verdict = NEEDS_SAMPLES
        elif tail[lane] > (TAIL * tolerance * lanes.scale[lane]) ** 2:
            verdict = NEEDS_HARMONICS
        outcome[block[lane]] = verdict


@numba.njit(**INSIDE)
def _scatter(
    points: Points, resolution: Resolution, block: Integers, h: int, unknown: Floats, spectra: Floats, outcome: Integers
) -> None:
    for lane in range(block.size):
        point = block[lane]
        if outcome[point] == DIVERGED:
            continue
        resolution.harmonics[point] = h
        points.mean[point] = unknown[0, 0, lane]
        for k in range(1, h + 1):
            points.harmonics[point, k - 1] = complex(unknown[0, k, lane], unknown[1, k, lane])
        for k in range(1, min(points.force.shape[1], h) + 1):
            points.force[point, k - 1] = complex(2 * spectra[0, 0, k, lane], 2 * spectra[0, 1, k, lane])
