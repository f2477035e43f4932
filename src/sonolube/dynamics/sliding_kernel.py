"""Means of the friction of a contact that slides while it vibrates along its normal, for many sliding speeds at once.

The mean of v_r/sqrt(v_r^2 + v^2) over a period has branch points close to the real axis wherever the vibration velocity
v passes through zero, so that even samples converge slowly. For one sine, theta = am(u) with uniform u takes them away
from the axis, whatever the sliding speed; for a motion that turns twice, a Moebius map of the circle first moves its
two turns a half turn apart. What remains is analytic in a wide strip, and the trapezoidal rule converges geometrically.
"""

from functools import lru_cache
from typing import NamedTuple

import numba
import numpy as np
from scipy.special import ellipkm1

from sonolube.checks import Complexes, Floats
from sonolube.dynamics.contact_lanes import Choice, Law, contact_rows
from sonolube.dynamics.harmonic_kernel import Integers, finest
from sonolube.dynamics.lanes import INSIDE, KERNEL, LANES, ONCE

# Rows of a block of motions: the map of the circle, angular frequency, dead load, mean displacement and where the
# contact rests; the mapped point and its powers, the motion there, the point's weight, and the contact's force.
ALPHA, ALONG, ACROSS, OMEGA, LOAD, MEAN, RESTING = range(7)
Z_RE, Z_IM, P_RE, P_IM, PLACE, VELOCITY, WEIGHT, FORCE = range(7, 15)
_ROWS = 4  # steps of crowding to a decade of the ratio of the slowest sliding to the vibration's peak velocity
_STEEPEST = 24  # most such steps
_TOGETHER = 4  # points to add at once, which spares the sums' going to and fro
# Accelerations of the higher harmonics over that of the first, and up to each how many times as many points it takes.
_RICHNESS, _FINENESS = np.array([0.1, 1.0, 2.0]), np.array([1, 2, 4, 16])


class Crowded(NamedTuple):
    """Points exp(i phi) of the circle, crowded at +-i, one row to each step of crowding; weights sum to one."""

    cosine: Floats  # (rows, most)
    sine: Floats
    weight: Floats  # zero beyond the row's count
    count: Integers  # type: ignore[assignment]


class Scratch(NamedTuple):
    """Rows that a block of motions is averaged in."""

    rows: Floats  # (17, lanes): ALPHA to FORCE, and the contact's stiffness and damping
    motion: Floats  # (2, H + 1, lanes)
    few: Floats  # (4, 3, lanes): velocity squared, weight and weighted force of four points
    sums: Floats  # (2, s, lanes)


def scratch(harmonics: int, speeds: Floats) -> Scratch:
    """Return room for motions of so many harmonics, and for sums of the speeds' precision.

    Parameters
    ----------
    harmonics : int
    speeds : ndarray of float64 or float32, shape (s,)

    Returns
    -------
    Scratch
    """
    few, sums = np.empty((_TOGETHER, 3, LANES), speeds.dtype), np.empty((2, speeds.size, LANES), speeds.dtype)
    return Scratch(np.empty((17, LANES)), np.empty((2, harmonics + 1, LANES)), few, sums)


@lru_cache(maxsize=64)
def crowded_points(extra: int, tolerance: float = 1e-6) -> Crowded:
    """Return the points for each step of the ratio of sliding speed to peak velocity.

    Parameters
    ----------
    extra : int
        Points added for the sake of a steep contact force.
    tolerance : float
        Relative error to hold.

    Returns
    -------
    Crowded
    """
    ratios = 10.0 ** (-np.arange(_STEEPEST + 1) / _ROWS)
    digits = -np.log10(tolerance)  # each takes one point per e-fold
    count = _TOGETHER * np.ceil((digits * np.log(4 / ratios) + extra + 4) / _TOGETHER).astype(np.int64)
    cosine, sine, weight = np.zeros((3, ratios.size, count.max()))
    for row, (ratio, samples) in enumerate(zip(ratios, count, strict=True)):
        complement = ratio**2 / (1 + ratio**2)
        u = 4 * ellipkm1(complement) * (np.arange(samples) + 0.5) / samples
        phase = _jacobi_amplitude(u, complement)
        density = np.sqrt(complement + (1 - complement) * np.cos(phase) ** 2)
        cosine[row, :samples], sine[row, :samples] = np.cos(phase), np.sin(phase)
        weight[row, :samples] = density / density.sum()
    return Crowded(cosine, sine, weight, count)


def _jacobi_amplitude(u: Floats, complement: float) -> Floats:
    """Return am(u | 1 - complement) by descending Landen steps, which a complement near zero does not disturb."""
    means, differences = [1.0], [0.0]
    root = np.sqrt(complement)
    while abs(means[-1] - root) > 1e-16 * means[-1] and len(means) < 12:
        differences.append(0.5 * (means[-1] - root))
        means, root = [*means, 0.5 * (means[-1] + root)], np.sqrt(means[-1] * root)
    phase = 2.0 ** (len(means) - 1) * means[-1] * u
    for mean, difference in zip(means[:0:-1], differences[:0:-1], strict=True):
        phase = 0.5 * (phase + np.arcsin(difference / mean * np.sin(phase)))
    return np.asarray(phase)


def turned_circle(turns: Floats) -> Floats:
    """Return what moves the points +-i of the circle to the two turns of each motion by (w + alpha)/(1 + alpha w).

    Parameters
    ----------
    turns : ndarray, shape (p, 2)
        Phases of the two turns.

    Returns
    -------
    ndarray, shape (3, p)
        alpha, and the turn of the circle that follows as cosine and sine.
    """
    half = 0.5 * (turns[:, 0] - turns[:, 1]) % np.pi
    return np.array([np.tan(0.25 * np.pi - 0.5 * half), np.cos(turns[:, 0] - half), np.sin(turns[:, 0] - half)])


@numba.njit(**KERNEL)
def sliding_means(
    kind: Choice,
    damped: Choice,
    law: Law,
    given: Floats,
    harmonics: Complexes,
    count: Integers,
    crowding: Integers,
    chosen: Integers,
    speeds: Floats,
    crowded: Crowded,
    room: Scratch,
    means: Floats,
) -> None:
    """Write the means of v_r/sqrt(v_r^2 + v^2), plain and weighted by the contact force over the dead load.

    Parameters
    ----------
    kind, damped : tuple
        As of `sonolube.dynamics.contact_lanes.Compiled`.
    law : Law
    given : ndarray, shape (7, p)
        Rows ALPHA to RESTING: what `turned_circle` returns, angular frequency, in rad/s, dead load, in N, mean
        displacement, in m, and `resting_place`.
    harmonics : ndarray of complex, shape (p, room)
    count : ndarray of int, shape (p,)
        Harmonics of each motion.
    crowding : ndarray of int, shape (p,)
        Row of `crowded` for each motion.
    chosen : ndarray of int
        Motions to treat, like beside like.
    speeds : ndarray of float64 or float32, shape (s,)
        Sliding speeds v_r, in m/s, none of them zero.
    crowded : Crowded
    room : Scratch
        Of the precision of the speeds, of which single holds 1e-5.
    means : ndarray, shape (2, p, s)
    """
    for start in range(0, chosen.size, LANES):
        block = chosen[start : start + LANES]
        _average_block(kind, damped, law, given, harmonics, count, crowding, block, speeds, crowded, room, means)


@numba.njit(**ONCE)
def _average_block(
    kind: Choice,
    damped: Choice,
    law: Law,
    given: Floats,
    harmonics: Complexes,
    count: Integers,
    crowding: Integers,
    block: Integers,
    speeds: Floats,
    crowded: Crowded,
    room: Scratch,
    means: Floats,
) -> None:
    rows, motion, few, sums = room.rows, room.motion, room.few, room.sums
    h, row = finest(count, block), finest(crowding, block)
    _gather(given, harmonics, count, block, h, rows, motion)
    sums[:] = 0.0
    for j in range(crowded.count[row]):
        _motion_at(crowded.cosine[row, j], crowded.sine[row, j], crowded.weight[row, j], motion, h, rows)
        contact_rows(kind, damped, law, rows[LOAD], rows[RESTING], rows[PLACE], rows[VELOCITY], rows[FORCE:])
        _note(rows, few[j % _TOGETHER])
        if j % _TOGETHER == _TOGETHER - 1:
            _add_ratios(speeds, few, sums)
    for lane in range(block.size):
        for s in range(speeds.size):
            for which in range(2):
                means[which, block[lane], s] = sums[which, s, lane]


@numba.njit(**INSIDE)
def _gather(
    given: Floats, harmonics: Complexes, count: Integers, block: Integers, h: int, rows: Floats, motion: Floats
) -> None:
    for lane in range(LANES):
        point = block[min(lane, block.size - 1)]
        for row in range(given.shape[0]):
            rows[row, lane] = given[row, point]
        for k in range(1, h + 1):
            value = harmonics[point, k - 1] if k <= count[point] else 0j
            motion[0, k, lane], motion[1, k, lane] = value.real, value.imag


@numba.njit(**INSIDE)
def _motion_at(cosine: float, sine: float, weight: float, motion: Floats, h: int, rows: Floats) -> None:
    """Write displacement, velocity and weight at a crowded point, mapped so that points crowd at the turns."""
    z_re, z_im, p_re, p_im, x, v = rows[Z_RE], rows[Z_IM], rows[P_RE], rows[P_IM], rows[PLACE], rows[VELOCITY]
    for lane in range(LANES):
        # z = exp(i ...) (w + alpha)/(1 + alpha w) for w = cosine + i sine
        alpha, along, across = rows[ALPHA, lane], rows[ALONG, lane], rows[ACROSS, lane]
        below = 1 / (1 + 2 * alpha * cosine + alpha * alpha)
        w_re = (cosine * (1 + alpha * alpha) + 2 * alpha) * below
        stretch = (1 - alpha * alpha) * below
        z_re[lane] = along * w_re - across * sine * stretch
        z_im[lane] = along * sine * stretch + across * w_re
        rows[WEIGHT, lane] = weight * stretch
        p_re[lane], p_im[lane] = 1.0, 0.0
        x[lane], v[lane] = rows[MEAN, lane], 0.0
    for k in range(1, h + 1):
        a, b = motion[0, k], motion[1, k]
        for lane in range(LANES):
            q_re = p_re[lane] * z_re[lane] - p_im[lane] * z_im[lane]
            q_im = p_re[lane] * z_im[lane] + p_im[lane] * z_re[lane]
            x[lane] += a[lane] * q_re - b[lane] * q_im
            v[lane] -= k * (a[lane] * q_im + b[lane] * q_re)
            p_re[lane], p_im[lane] = q_re, q_im
    for lane in range(LANES):
        v[lane] *= rows[OMEGA, lane]


@numba.njit(**INSIDE)
def _note(rows: Floats, noted: Floats) -> None:
    """Note velocity squared, the point's weight, and the contact force times that weight over the dead load."""
    for lane in range(LANES):
        noted[0, lane] = rows[VELOCITY, lane] * rows[VELOCITY, lane]
        noted[1, lane] = rows[WEIGHT, lane]
        noted[2, lane] = rows[FORCE, lane] * rows[WEIGHT, lane] / rows[LOAD, lane]


@numba.njit(**INSIDE)
def _add_ratios(speeds: Floats, few: Floats, sums: Floats) -> None:
    for s in range(speeds.size):
        speed, plain, weighed = speeds[s], sums[0, s], sums[1, s]
        for lane in range(LANES):
            for point in range(_TOGETHER):
                ratio = speed / np.sqrt(few[point, 0, lane] + speed * speed)
                plain[lane] += few[point, 1, lane] * ratio
                weighed[lane] += few[point, 2, lane] * ratio


def crowding_of(ratio: Floats) -> Integers:
    """Return the row of `crowded_points` for a ratio of sliding speed to peak velocity."""
    steps = np.ceil(-_ROWS * np.log10(np.fmax(ratio, 10.0 ** (-_STEEPEST / _ROWS))))  # also where it is not a number
    return np.asarray(np.maximum(steps, 0).astype(np.int64))


def fineness_of(harmonics: Complexes) -> Integers:
    """Return how many times as many points motions of two turns need, since their higher harmonics carry shoulders.

    Parameters
    ----------
    harmonics : ndarray of complex, shape (p, room)

    Returns
    -------
    ndarray of int, shape (p,)
        1, 2, 4 or 16.

    Notes
    -----
    A velocity that nearly vanishes between its turns brings further branch points near the axis. Doubling the points
    squares the error; the steps hold 1e-5 for speeds down to a thousandth of the peak velocity.
    """
    parts = np.abs(np.ascontiguousarray(harmonics).view(np.float64))
    accelerations = np.repeat(np.arange(1.0, harmonics.shape[1] + 1) ** 2, 2)
    first = parts[:, 0] + parts[:, 1]
    richness = (parts @ accelerations - first) / np.maximum(first, 1e-300)
    return np.asarray(_FINENESS[np.searchsorted(_RICHNESS, richness)])


def phases_of(turns: Floats, ratio: float, fineness: int) -> tuple[Complexes, Floats]:
    """Return points exp(i theta) and weights for means over one period, crowded at the turns where there are two.

    Parameters
    ----------
    turns : ndarray, shape (2,)
        Phases of the two turns, or NaN.
    ratio : float
        Least sliding speed over peak velocity.
    fineness : int
        As by `fineness_of`.

    Returns
    -------
    points, weights : ndarray, shape (samples,)
    """
    if np.isnan(turns[0]):
        samples = 2**15
        return np.exp(2j * np.pi * np.arange(samples) / samples), np.full(samples, 1 / samples)
    alpha, along, across = turned_circle(turns[np.newaxis])[:, 0]
    crowded = crowded_points(32, 1e-6**fineness)
    row = int(crowding_of(np.float64(ratio)))  # type: ignore[arg-type]
    inside = slice(0, crowded.count[row])
    w = crowded.cosine[row, inside] + 1j * crowded.sine[row, inside]
    density = (1 - alpha**2) / np.abs(1 + alpha * w) ** 2
    points = complex(along, across) * (w + alpha) / (1 + alpha * w)
    return points, crowded.weight[row, inside] * density
