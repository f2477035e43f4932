"""How small disturbances of a periodic vibration grow from period to period, on lanes.

Between two instants the free structure moves exactly, each pair of states by itself; at each instant the contact's
momentary stiffness and damping kick it. Kicks and free motion each keep areas in phase space, so that errors bend
frequencies but hardly invent or hide growth. The period's matrix is then squared until only its largest multiplier is
left.
"""

import numba
import numpy as np

from sonolube.checks import Complexes, Floats
from sonolube.dynamics.contact_lanes import Law, contact_rows
from sonolube.dynamics.contact_port import ContactPort
from sonolube.dynamics.harmonic_kernel import Integers, finest
from sonolube.dynamics.lanes import INSIDE, KERNEL, LANES, ONCE, combine

_SQUARINGS = 22  # 2e-7 of growth a period are then told from none


@numba.njit(**KERNEL)
def growth_rates(
    port: ContactPort,
    law: Law,
    omega: Floats,
    load: Floats,
    resting: Floats,
    mean: Floats,
    harmonics: Complexes,
    count: Integers,
    steps: Integers,
    chosen: Integers,
    rates: Floats,
) -> None:
    """Write the logarithm of the largest modulus of the multipliers of each chosen point.

    Parameters
    ----------
    port : ContactPort
    law : Law
    omega, load, resting, mean : ndarray, shape (p,)
        Angular frequency, in rad/s, dead load, in N, `resting_place`, and mean displacement, in m.
    harmonics : ndarray of complex, shape (p, room)
    count, steps : ndarray of int, shape (p,)
        Harmonics of each motion, and kicks in a period.
    chosen : ndarray of int
        Points to judge, like beside like.
    rates : ndarray, shape (p,)
        Written at the chosen points.
    """
    size, most = 2 * port.trace.size, finest(count, chosen)
    period, square = np.empty((size, size, LANES)), np.empty((size, size, LANES))
    free, senses, rows = np.empty((2 * size, LANES)), np.empty((3, size, LANES)), np.empty((8, LANES))
    motion, turn = np.zeros((2, 2 * most + 2, LANES)), np.empty(2 * most + 2)
    for start in range(0, chosen.size, LANES):
        block = chosen[start : start + LANES]
        h, kicks = finest(count, block), finest(steps, block)
        for lane in range(LANES):
            point = block[min(lane, block.size - 1)]
            rows[0, lane], rows[1, lane] = omega[point], load[point]
            rows[2, lane], motion[0, 0, lane] = resting[point], mean[point]
            motion[:, h + 1, lane] = 0.0
            for k in range(1, h + 1):
                value = harmonics[point, k - 1] if k <= count[point] else 0j
                motion[0, k, lane], motion[0, h + 1 + k, lane] = value.real, value.imag
                motion[1, k, lane], motion[1, h + 1 + k, lane] = -k * value.imag, k * value.real
            _free_motion(port, 2 * np.pi / (kicks * omega[point]), lane, free)
        _one_period(port, law, motion, turn, h, kicks, free, period, senses, rows)
        _grow(period, square, rows[3], rows[4])
        for lane in range(block.size):
            rates[block[lane]] = rows[3, lane]


@numba.njit(**INSIDE)
def _free_motion(port: ContactPort, duration: float, lane: int, free: Floats) -> None:
    """Write exp(A duration) of every pair: A is half its trace plus a part whose square is a number."""
    for pair in range(port.trace.size):
        half = 0.5 * port.trace[pair]
        square = half * half - port.determinant[pair]
        angle = np.sqrt(abs(square)) * duration
        fading = np.exp(half * duration)
        even, odd = fading * np.cos(angle), fading * np.sin(angle)
        if square > 0:  # the slower and the faster exponential, neither of which overflows
            slow, fast = np.exp(half * duration + angle), np.exp(half * duration - angle)
            even, odd = 0.5 * (slow + fast), 0.5 * (slow - fast)
        odd = odd / angle * duration if angle > 1e-9 else fading * duration
        for i in range(2):
            for j in range(2):
                own = even - odd * half if i == j else 0.0
                free[4 * pair + 2 * i + j, lane] = own + odd * port.generator[pair, i, j]


@numba.njit(**ONCE)
def _one_period(
    port: ContactPort,
    law: Law,
    motion: Floats,
    turn: Floats,
    h: int,
    kicks: int,
    free: Floats,
    period: Floats,
    senses: Floats,
    rows: Floats,
) -> None:
    """Write the matrix of one period of alternating kicks and free motions."""
    size = period.shape[0]
    gain = 0.0
    for pair in range(port.trace.size):
        gain += port.velocity[pair, 0] * port.push[pair, 0] + port.velocity[pair, 1] * port.push[pair, 1]
    x, v, force, slope, drag = rows[3], rows[4], rows[5], rows[6], rows[7]
    period[:] = 0.0
    for j in range(size):
        period[j, j] = 1.0
        senses[0, j], senses[1, j] = port.displacement[j // 2, j % 2], port.velocity[j // 2, j % 2]
    for kick in range(kicks):
        for k in range(h + 1):
            phase = 2 * np.pi / kicks * kick * k
            turn[k], turn[h + 1 + k] = np.cos(phase), -np.sin(phase)
        combine(x, turn, motion[0], 2 * h + 1)
        if law.damping > 0:
            combine(v, turn, motion[1], 2 * h + 1)
            for lane in range(LANES):
                v[lane] *= rows[0, lane]
        contact_rows(law, rows[1], rows[2], x, v, force, slope, drag)
        for lane in range(LANES):
            slope[lane] *= -2 * np.pi / (kicks * rows[0, lane])
        if law.damping > 0:
            # velocity w at the contact becomes w exp(-g d t) - (1 - exp(-g d t)) stiffness x/d, g its gain per impulse
            for lane in range(LANES):
                duration = 2 * np.pi / (kicks * rows[0, lane])
                fade = gain * drag[lane] * duration
                held = (1 - np.exp(-fade)) / fade if fade > 1e-12 else 1.0
                slope[lane] *= held
                drag[lane] *= -duration * held
        for j in range(size):
            impulse, displacement, velocity = senses[2, j], senses[0, j], senses[1, j]
            for lane in range(LANES):
                impulse[lane] = slope[lane] * displacement[lane]
                displacement[lane] = 0.0
            if law.damping > 0:
                for lane in range(LANES):
                    impulse[lane] += drag[lane] * velocity[lane]
                    velocity[lane] = 0.0
            for pair in range(size // 2):
                _move(port, pair, free, period[2 * pair, j], period[2 * pair + 1, j], impulse, displacement)
                if law.damping > 0:
                    for lane in range(LANES):
                        first, second = period[2 * pair, j, lane], period[2 * pair + 1, j, lane]
                        velocity[lane] += port.velocity[pair, 0] * first + port.velocity[pair, 1] * second


@numba.njit(**INSIDE)
def _move(
    port: ContactPort, pair: int, free: Floats, first: Floats, second: Floats, impulse: Floats, displacement: Floats
) -> None:
    a, b, c, d = free[4 * pair], free[4 * pair + 1], free[4 * pair + 2], free[4 * pair + 3]
    push_first, push_second = port.push[pair, 0], port.push[pair, 1]
    see_first, see_second = port.displacement[pair, 0], port.displacement[pair, 1]
    for lane in range(LANES):
        one, two = first[lane] + push_first * impulse[lane], second[lane] + push_second * impulse[lane]
        moved, also = a[lane] * one + b[lane] * two, c[lane] * one + d[lane] * two
        first[lane], second[lane] = moved, also
        displacement[lane] += see_first * moved + see_second * also


@numba.njit(**INSIDE)
def _grow(matrix: Floats, square: Floats, rate: Floats, size: Floats) -> None:
    """Square the matrix again and again, kept near a norm of one by powers of two, and write the growth per period."""
    for lane in range(LANES):
        rate[lane] = 0.0  # so far: the power of two taken out
    for squaring in range(_SQUARINGS + 1):
        if squaring > 0:
            _square(matrix, square)
            matrix, square = square, matrix
        for lane in range(LANES):
            size[lane] = 0.0
        for i in range(matrix.shape[0]):
            for j in range(matrix.shape[0]):
                for lane in range(LANES):
                    size[lane] += matrix[i, j, lane] * matrix[i, j, lane]
        if squaring == _SQUARINGS:
            break
        bits = size.view(np.int64)
        for lane in range(LANES):
            power = ((bits[lane] >> 52) - 1023) >> 1
            rate[lane] = 2 * rate[lane] + power
            bits[lane] = (1023 - power) << 52
        for i in range(matrix.shape[0]):
            for j in range(matrix.shape[0]):
                for lane in range(LANES):
                    matrix[i, j, lane] *= size[lane]
    # log |M^(2n)| - log |M^n| is n times the rate wanted, whatever the eigenvectors; the latter's norm is within a
    # factor of two of the power of two taken out
    for lane in range(LANES):
        rate[lane] = (rate[lane] * np.log(2.0) + 0.5 * np.log(size[lane])) / 2.0 ** (_SQUARINGS - 1)


@numba.njit(**INSIDE)
def _square(matrix: Floats, square: Floats) -> None:
    size = matrix.shape[0]
    for i in range(size):
        for j in range(size):
            target, a, b, c, d = square[i, j], matrix[i, 0], matrix[0, j], matrix[i, 1], matrix[1, j]
            for lane in range(LANES):
                target[lane] = a[lane] * b[lane] + c[lane] * d[lane]
            for k in range(2, size, 2):
                a, b, c, d = matrix[i, k], matrix[k, j], matrix[i, k + 1], matrix[k + 1, j]
                for lane in range(LANES):
                    target[lane] += a[lane] * b[lane] + c[lane] * d[lane]
