"""How small disturbances of a vibration on an exponential contact grow from period to period, by a thread.

The method is that of `sonolube.dynamics.harmonic_balance.floquet_kernel`: free motions and kicks, then squaring.
"""

import math

from sonolube.checks import Floats
from sonolube.dynamics.gpu.device import on_device
from sonolube.dynamics.gpu.extrema import swing
from sonolube.dynamics.gpu.structure_rows import (
    DETERMINANT,
    DISPLACEMENT,
    GENERATOR,
    MOST_PAIRS,
    PUSH,
    TRACE,
    free_motion,
)

SQUARES = 2 * (2 * MOST_PAIRS) ** 2  # entries of a period's matrix and of its square
FREE = 4 * MOST_PAIRS
_SQUARINGS = 22  # 2e-7 of growth a period are then told from none
_LARGEST_EXPONENT = 700.0


@on_device
def write_free_motion(pairs: Floats, duration: float, free: Floats) -> None:
    """Write exp(A duration) of every pair."""
    for pair in range(pairs.shape[1]):
        half = 0.5 * pairs[TRACE, pair]
        even, odd = free_motion(half, half * half - pairs[DETERMINANT, pair], duration)
        for i in range(4):
            own = even - odd * half if i == 0 or i == 3 else 0.0
            free[4 * pair + i] = own + odd * pairs[GENERATOR + i, pair]


@on_device
def write_period(
    pairs: Floats,
    omega: float,
    load: float,
    length: float,
    unknown: Floats,
    h: int,
    kicks: int,
    free: Floats,
    period: Floats,
) -> None:
    """Write the matrix of one period of alternating kicks and free motions."""
    size, duration = 2 * pairs.shape[1], 2 * math.pi / (kicks * omega)
    write_free_motion(pairs, duration, free)
    for i in range(size):
        for j in range(size):
            period[i * size + j] = 1.0 if i == j else 0.0
    for kick in range(kicks):
        phase = 2 * math.pi * kick / kicks
        x = unknown[0, 0] + swing(unknown, h, math.cos(phase), math.sin(phase))[0]
        pull = -duration * load / length * math.exp(min(max(-x / length, -_LARGEST_EXPONENT), _LARGEST_EXPONENT))
        for column in range(size):
            kick_column(pairs, pull, free, period, size, column)


@on_device
def kick_column(pairs: Floats, pull: float, free: Floats, period: Floats, size: int, column: int) -> None:
    """Kick one column of the period's matrix by the contact's pull, then let it move freely."""
    seen = 0.0
    for pair in range(size // 2):
        first, second = 2 * pair * size + column, (2 * pair + 1) * size + column
        seen += pairs[DISPLACEMENT, pair] * period[first] + pairs[DISPLACEMENT + 1, pair] * period[second]
    impulse = pull * seen
    for pair in range(size // 2):
        first, second = 2 * pair * size + column, (2 * pair + 1) * size + column
        one, two = period[first] + pairs[PUSH, pair] * impulse, period[second] + pairs[PUSH + 1, pair] * impulse
        period[first] = free[4 * pair] * one + free[4 * pair + 1] * two
        period[second] = free[4 * pair + 2] * one + free[4 * pair + 3] * two


@on_device
def growth_rate(
    pairs: Floats,
    omega: float,
    load: float,
    length: float,
    unknown: Floats,
    h: int,
    kicks: int,
    free: Floats,
    squares: Floats,
) -> float:
    """Return the logarithm of the largest modulus of the multipliers."""
    write_period(pairs, omega, load, length, unknown, h, kicks, free, squares)
    size = 2 * pairs.shape[1]
    entries = size * size
    own, other, rate, norm = 0, entries, 0.0, 0.0
    for squaring in range(_SQUARINGS + 1):
        if squaring > 0:
            square(squares, own, other, size)
            own, other = other, own
        norm = 0.0
        for i in range(own, own + entries):
            norm += squares[i] * squares[i]
        if squaring < _SQUARINGS:
            # kept near a norm of one by a power of two, which is the growth so far
            power = math.floor(0.5 * math.log2(norm))
            rate = 2 * rate + power
            for i in range(own, own + entries):
                squares[i] *= 2.0**-power
    return (rate * math.log(2.0) + 0.5 * math.log(norm)) / 2.0 ** (_SQUARINGS - 1)


@on_device
def square(squares: Floats, own: int, other: int, size: int) -> None:
    """Write the square of the matrix that begins at one place to another."""
    for i in range(size):
        for j in range(size):
            total = 0.0
            for k in range(size):
                total += squares[own + i * size + k] * squares[own + k * size + j]
            squares[other + i * size + j] = total
