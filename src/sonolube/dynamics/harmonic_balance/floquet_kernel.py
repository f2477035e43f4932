"""How small disturbances of a periodic vibration grow from period to period, on lanes.

Between two instants the free structure moves exactly, each pair of states by itself; at each instant the contact's
momentary stiffness and damping kick it. Kicks and free motion each keep areas in phase space, so that errors bend
frequencies but hardly invent or hide growth. The period's matrix is then squared until only its largest multiplier is
left.
"""

from typing import NamedTuple

import numba
import numpy as np

from sonolube.checks import Floats, Integers
from sonolube.dynamics.harmonic_balance.contact_kernel import Choice, Law, contact_rows, differentiate
from sonolube.dynamics.harmonic_balance.harmonic_kernel import finest
from sonolube.dynamics.kernels.simd import INSIDE, KERNEL, LANES, ONCE, add_products, combine, gather

# Rows of a block: angular frequency, dead load, where the contact rests, mean; motion, force and what a kick adds.
OMEGA, LOAD, RESTING, MEAN, PLACE, VELOCITY, FORCE, SLOPE, DRAG = range(9)
# Columns of a pair of states: what a force adds to each state per impulse, what each adds to displacement and velocity.
PUSH, SEE, MOVE = 0, 2, 4
SQUARINGS = 22  # 2e-7 of growth a period are then told from none


class Period(NamedTuple):
    """Rows that a block of periods is worked out in, for structures of n states and motions of H harmonics."""

    rows: Floats  # (9, lanes): OMEGA to DRAG
    free: Floats  # (2 n, lanes): exp(A duration) of every pair
    motion: Floats  # (2, 2 H + 1, lanes): displacement and velocity over omega, the mean and then each harmonic's parts
    turn: Floats  # (2, H + 1): cosines, and minus sines, at a kick
    senses: Floats  # (3, n, lanes): displacement, velocity and impulse of each disturbance
    matrix: Floats  # (n, n, lanes)
    square: Floats  # (n, n, lanes)
    size: Floats  # (2, lanes): powers of two taken out of the matrix, and its norm


def period_room(states: int, harmonics: int) -> Period:
    """Return room for structures of so many states and motions of so many harmonics.

    Parameters
    ----------
    states, harmonics : int

    Returns
    -------
    Period
    """
    return Period(
        rows=np.empty((9, LANES)),
        free=np.empty((2 * states, LANES)),
        motion=np.zeros((2, 2 * harmonics + 1, LANES)),
        turn=np.empty((2, harmonics + 1)),
        senses=np.empty((3, states, LANES)),
        matrix=np.empty((states, states, LANES)),
        square=np.empty((states, states, LANES)),
        size=np.empty((2, LANES)),
    )


@numba.njit(**KERNEL)
def growth_rates(
    kind: Choice,
    damped: Choice,
    law: Law,
    pairs: Floats,
    given: Floats,
    free: Floats,
    harmonics: Floats,
    count: Integers,
    kicks: Integers,
    chosen: Integers,
    room: Period,
    powers: Floats,
    norms: Floats,
) -> None:
    """Write how large the matrix of 2^22 periods is at each chosen point, in two parts.

    Parameters
    ----------
    kind, damped : tuple
        As of `sonolube.dynamics.harmonic_balance.contact_kernel.Compiled`.
    law : Law
    pairs : ndarray, shape (m, 6)
        Columns PUSH, SEE and MOVE of every pair.
    given : ndarray, shape (p, 4)
        Columns OMEGA to MEAN: angular frequency, in rad/s, dead load, in N, `equilibrium_displacement`, mean
        displacement, in m.
    free : ndarray, shape (p, 4 m)
        Row by row of each pair, exp(A duration) for the time between two kicks.
    harmonics : ndarray, shape (p, 2 room)
        Real and imaginary parts in turns, zero beyond `count`.
    count, kicks : ndarray of int, shape (p,)
        Harmonics of each motion, and kicks in a period, the same for all points of a block of lanes.
    chosen : ndarray of int
        Points to judge, like beside like.
    room : Period
    powers, norms : ndarray, shape (p,)
        Written at the chosen points: the sum of the powers of two taken out, each doubled with every squaring, and the
        square of the norm that was left at last.
    """
    for start in range(0, chosen.size, LANES):
        block = chosen[start : start + LANES]
        h = finest(count, block)
        gather(given, block, room.rows)
        gather(free, block, room.free)
        gather(harmonics, block, room.motion[0, 1 : 2 * h + 1])
        for lane in range(LANES):
            room.motion[0, 0, lane] = room.rows[MEAN, lane]
        differentiate(damped, room.motion[0], h, room.motion[1])
        _one_period(kind, damped, law, pairs, h, kicks[block[0]], room)
        _grow(room.matrix, room.square, room.size)
        for lane in range(block.size):
            powers[block[lane]], norms[block[lane]] = room.size[0, lane], room.size[1, lane]


@numba.njit(**ONCE)
def _one_period(kind: Choice, damped: Choice, law: Law, pairs: Floats, h: int, kicks: int, room: Period) -> None:
    """Write the matrix of one period of alternating kicks and free motions."""
    rows, matrix, senses = room.rows, room.matrix, room.senses
    size, gain = matrix.shape[0], 0.0
    for pair in range(pairs.shape[0]):
        gain += pairs[pair, MOVE] * pairs[pair, PUSH] + pairs[pair, MOVE + 1] * pairs[pair, PUSH + 1]
    for j in range(size):
        for lane in range(LANES):
            for i in range(size):
                matrix[i, j, lane] = 1.0 if i == j else 0.0
            senses[0, j, lane], senses[1, j, lane] = pairs[j // 2, SEE + j % 2], pairs[j // 2, MOVE + j % 2]
    for kick in range(kicks):
        _motion_at(damped, 2 * np.pi / kicks * kick, h, room.motion, room.turn, rows)
        contact_rows(kind, damped, law, rows[LOAD], rows[RESTING], rows[PLACE], rows[VELOCITY], rows[FORCE:])
        _weigh_kick(damped, gain, kicks, rows)
        for j in range(size):
            _kick(damped, rows, senses, j)
            for pair in range(pairs.shape[0]):
                _move(damped, pairs, pair, room.free, matrix, senses, j)


@numba.njit(**INSIDE)
def _motion_at(damped: Choice, phase: float, h: int, motion: Floats, turn: Floats, rows: Floats) -> None:
    """Write displacement and, where it matters, velocity; force and slope are scratch till then."""
    for k in range(h + 1):
        turn[0, k], turn[1, k] = np.cos(phase * k), -np.sin(phase * k)
    for part in range(2):
        combine(rows[FORCE + part], turn[part], motion[0], part, h)
    for lane in range(LANES):
        rows[PLACE, lane] = rows[FORCE, lane] + rows[SLOPE, lane]
    if len(damped) == 1:
        for part in range(2):
            combine(rows[FORCE + part], turn[part], motion[1], part, h)
        for lane in range(LANES):
            rows[VELOCITY, lane] = rows[OMEGA, lane] * (rows[FORCE, lane] + rows[SLOPE, lane])


@numba.njit(**INSIDE)
def _weigh_kick(damped: Choice, gain: float, kicks: int, rows: Floats) -> None:
    """Turn stiffness and damping into impulses of one kick per displacement and per velocity."""
    for lane in range(LANES):
        rows[SLOPE, lane] *= -2 * np.pi / (kicks * rows[OMEGA, lane])
    if len(damped) == 1:
        # velocity w at the contact becomes w exp(-g d t) - (1 - exp(-g d t)) stiffness x/d, g its gain per impulse
        for lane in range(LANES):
            duration = 2 * np.pi / (kicks * rows[OMEGA, lane])
            fade = gain * rows[DRAG, lane] * duration
            held = (1 - np.exp(-fade)) / fade if fade > 1e-12 else 1.0
            rows[SLOPE, lane] *= held
            rows[DRAG, lane] *= -duration * held


@numba.njit(**INSIDE)
def _kick(damped: Choice, rows: Floats, senses: Floats, j: int) -> None:
    """Write the j-th disturbance's impulse, and begin its displacement and velocity anew."""
    for lane in range(LANES):
        senses[2, j, lane] = rows[SLOPE, lane] * senses[0, j, lane]
        senses[0, j, lane] = 0.0
    if len(damped) == 1:
        for lane in range(LANES):
            senses[2, j, lane] += rows[DRAG, lane] * senses[1, j, lane]
            senses[1, j, lane] = 0.0


@numba.njit(**INSIDE)
def _move(damped: Choice, pairs: Floats, pair: int, free: Floats, matrix: Floats, senses: Floats, j: int) -> None:
    """Kick one pair of states of the j-th disturbance and let it move freely."""
    row, i = 4 * pair, 2 * pair
    for lane in range(LANES):
        one = matrix[i, j, lane] + pairs[pair, PUSH] * senses[2, j, lane]
        two = matrix[i + 1, j, lane] + pairs[pair, PUSH + 1] * senses[2, j, lane]
        first = free[row, lane] * one + free[row + 1, lane] * two
        second = free[row + 2, lane] * one + free[row + 3, lane] * two
        matrix[i, j, lane], matrix[i + 1, j, lane] = first, second
        senses[0, j, lane] += pairs[pair, SEE] * first + pairs[pair, SEE + 1] * second
        if len(damped) == 1:
            senses[1, j, lane] += pairs[pair, MOVE] * first + pairs[pair, MOVE + 1] * second


@numba.njit(**ONCE)
def _grow(matrix: Floats, square: Floats, size: Floats) -> None:
    """Square the matrix again and again, kept near a norm of one by powers of two; write those and the last norm."""
    states, taken, norm = matrix.shape[0], size[0], size[1]
    bits = norm.view(np.int64)
    for lane in range(LANES):
        taken[lane] = 0.0
    for squaring in range(SQUARINGS + 1):
        if squaring > 0:
            _square(matrix, square)
        for lane in range(LANES):
            norm[lane] = 0.0
        for i in range(states):
            for j in range(0, states, 2):
                add_products(matrix[i, j], matrix[i, j], matrix[i, j + 1], matrix[i, j + 1], norm)
        if squaring == SQUARINGS:
            break
        for lane in range(LANES):
            power = ((bits[lane] >> 52) - 1023) >> 1
            taken[lane] = 2 * taken[lane] + power
            bits[lane] = (1023 - power) << 52
        for i in range(states):
            for j in range(states):
                for lane in range(LANES):
                    matrix[i, j, lane] *= norm[lane]


@numba.njit(**INSIDE)
def _square(matrix: Floats, square: Floats) -> None:
    """Square the matrix in place."""
    size = matrix.shape[0]
    for i in range(size):
        for j in range(size):
            for lane in range(LANES):
                square[i, j, lane] = 0.0
            for k in range(0, size, 2):
                add_products(matrix[i, k], matrix[k, j], matrix[i, k + 1], matrix[k + 1, j], square[i, j])
    for i in range(size):
        for j in range(size):
            for lane in range(LANES):
                matrix[i, j, lane] = square[i, j, lane]
