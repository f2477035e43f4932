"""Means of the friction of a contact that slides while it vibrates along its normal, for many sliding speeds at once.

Its points are those of `sonolube.dynamics.friction_average.elliptic_quadrature`.
"""

from typing import Any, NamedTuple

import numba
import numpy as np

from sonolube.checks import Floats, Integers
from sonolube.dynamics.friction_average.elliptic_quadrature import TOGETHER, Crowded
from sonolube.dynamics.harmonic_balance.contact_kernel import Choice, Law, contact_rows
from sonolube.dynamics.harmonic_balance.harmonic_kernel import finest
from sonolube.dynamics.kernels.simd import INSIDE, KERNEL, LANES, ONCE, gather

# Rows of a block of motions: the map of the circle, angular frequency, dead load, mean displacement and where the
# contact rests; the mapped point and its powers, the motion there, the point's weight, and the contact's force.
ALPHA, ALONG, ACROSS, OMEGA, LOAD, MEAN, RESTING = range(7)
Z_RE, Z_IM, P_RE, P_IM, PLACE, VELOCITY, WEIGHT, FORCE = range(7, 15)
_SINGLE = 1e-5  # tolerance from which single precision suffices


class Scratch(NamedTuple):
    """Rows that a block of motions is averaged in."""

    rows: Floats  # (17, lanes): ALPHA to FORCE, and the contact's stiffness and damping
    motion: Floats  # (2 H, lanes): real and imaginary parts of harmonics in turns
    few: Floats  # (4, 3, lanes): velocity squared, weight and weighted force of four points
    sums: Floats  # (2, s, lanes)


def precision(tolerance: float) -> type[np.floating[Any]]:
    """Return the type of number that sums are taken in for states of some relative tolerance."""
    return np.float32 if tolerance >= _SINGLE else np.float64


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
    few, sums = np.empty((TOGETHER, 3, LANES), speeds.dtype), np.empty((2, speeds.size, LANES), speeds.dtype)
    return Scratch(np.empty((17, LANES)), np.empty((2 * harmonics, LANES)), few, sums)


@numba.njit(**KERNEL)
def sliding_means(
    kind: Choice,
    damped: Choice,
    law: Law,
    given: Floats,
    harmonics: Floats,
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
        As of `sonolube.dynamics.harmonic_balance.contact_kernel.Compiled`.
    law : Law
    given : ndarray, shape (p, 7)
        Columns ALPHA to RESTING: what `turned_circle` returns, angular frequency, in rad/s, dead load, in N, mean
        displacement, in m, and `equilibrium_displacement`.
    harmonics : ndarray, shape (p, 2 room)
        Real and imaginary parts in turns, zero beyond `count`.
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
    harmonics: Floats,
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
    gather(given, block, rows)
    gather(harmonics, block, motion[: 2 * h])
    sums[:] = 0.0
    for j in range(crowded.count[row]):
        _motion_at(crowded.cosine[row, j], crowded.sine[row, j], crowded.weight[row, j], motion, h, rows)
        contact_rows(kind, damped, law, rows[LOAD], rows[RESTING], rows[PLACE], rows[VELOCITY], rows[FORCE:])
        _note(rows, few[j % TOGETHER])
        if j % TOGETHER == TOGETHER - 1:
            _add_ratios(speeds, few, sums)
    for lane in range(block.size):
        for s in range(speeds.size):
            for which in range(2):
                means[which, block[lane], s] = sums[which, s, lane]


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
        a, b = motion[2 * k - 2], motion[2 * k - 1]
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
            for point in range(TOGETHER):
                ratio = speed / np.sqrt(few[point, 0, lane] + speed * speed)
                plain[lane] += few[point, 1, lane] * ratio
                weighed[lane] += few[point, 2, lane] * ratio
