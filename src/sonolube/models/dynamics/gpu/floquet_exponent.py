"""Largest Floquet exponent of a vibration on an exponential contact, by GPU threads.

The method is that of `sonolube.models.dynamics.harmonic_balance.floquet_kernel`: kick-drift splitting, then squaring.
"""

import math

from sonolube.checks import Floats
from sonolube.models.dynamics.gpu.device import on_device
from sonolube.models.dynamics.gpu.extrema import phase_derivatives
from sonolube.models.dynamics.gpu.receptance import (
    CONTACT_INPUT,
    DETERMINANT,
    DISPLACEMENT_OUTPUT,
    MOST_PAIRS,
    STATE_MATRIX,
    TRACE,
    transition_factors,
)
from sonolube.models.dynamics.harmonic_balance.floquet_kernel import SQUARINGS

SQUARES = 2 * (2 * MOST_PAIRS) ** 2
"""Entries of a monodromy matrix and of its square. []"""
DRIFT = 4 * MOST_PAIRS
"""Entries of the state transition matrices of all pairs. []"""
_LARGEST_EXPONENT = 700.0


@on_device
def write_drift(pairs: Floats, duration: float, drift: Floats) -> None:
    """Write the state transition matrix exp(A dt) of every pair of states."""
    for pair in range(pairs.shape[1]):
        half = 0.5 * pairs[TRACE, pair]
        even, odd = transition_factors(half, half * half - pairs[DETERMINANT, pair], duration)
        for i in range(4):
            own = even - odd * half if i == 0 or i == 3 else 0.0
            drift[4 * pair + i] = own + odd * pairs[STATE_MATRIX + i, pair]


@on_device
def write_monodromy_matrix(
    pairs: Floats,
    omega: float,
    load: float,
    length: float,
    unknown: Floats,
    h: int,
    kicks: int,
    drift: Floats,
    matrix: Floats,
) -> None:
    """Write the monodromy matrix: one period of alternating kicks and drifts."""
    size, duration = 2 * pairs.shape[1], 2 * math.pi / (kicks * omega)
    write_drift(pairs, duration, drift)
    for i in range(size):
        for j in range(size):
            matrix[i * size + j] = 1.0 if i == j else 0.0
    for instant in range(kicks):
        phase = 2 * math.pi * instant / kicks
        x = unknown[0, 0] + phase_derivatives(unknown, h, math.cos(phase), math.sin(phase))[0]
        kick = -duration * load / length * math.exp(min(max(-x / length, -_LARGEST_EXPONENT), _LARGEST_EXPONENT))
        for column in range(size):
            kick_and_drift(pairs, kick, drift, matrix, size, column)


@on_device
def kick_and_drift(pairs: Floats, kick: float, drift: Floats, matrix: Floats, size: int, column: int) -> None:
    """Apply the impulse per displacement of the contact, then the drift, to one column of the monodromy matrix."""
    displacement = 0.0
    for pair in range(size // 2):
        first, second = 2 * pair * size + column, (2 * pair + 1) * size + column
        of_first = pairs[DISPLACEMENT_OUTPUT, pair] * matrix[first]
        displacement += of_first + pairs[DISPLACEMENT_OUTPUT + 1, pair] * matrix[second]
    impulse = kick * displacement
    for pair in range(size // 2):
        first, second = 2 * pair * size + column, (2 * pair + 1) * size + column
        one = matrix[first] + pairs[CONTACT_INPUT, pair] * impulse
        two = matrix[second] + pairs[CONTACT_INPUT + 1, pair] * impulse
        matrix[first] = drift[4 * pair] * one + drift[4 * pair + 1] * two
        matrix[second] = drift[4 * pair + 2] * one + drift[4 * pair + 3] * two


@on_device
def floquet_exponent(
    pairs: Floats,
    omega: float,
    load: float,
    length: float,
    unknown: Floats,
    h: int,
    kicks: int,
    drift: Floats,
    squares: Floats,
) -> float:
    """Return the largest Floquet exponent per period, the logarithm of the largest modulus of the multipliers."""
    write_monodromy_matrix(pairs, omega, load, length, unknown, h, kicks, drift, squares)
    size = 2 * pairs.shape[1]
    entries = size * size
    own, other, exponent, norm = 0, entries, 0.0, 0.0
    for squaring in range(SQUARINGS + 1):
        if squaring > 0:
            square(squares, own, other, size)
            own, other = other, own
        norm = 0.0
        for i in range(own, own + entries):
            norm += squares[i] * squares[i]
        if squaring < SQUARINGS:
            # scaled to a norm near one by a power of two, which is the growth so far
            power = math.floor(0.5 * math.log2(norm))
            exponent = 2 * exponent + power
            for i in range(own, own + entries):
                squares[i] *= 2.0**-power
    return (exponent * math.log(2.0) + 0.5 * math.log(norm)) / 2.0 ** (SQUARINGS - 1)


@on_device
def square(squares: Floats, own: int, other: int, size: int) -> None:
    """Write the square of the matrix that starts at index `own` to index `other`."""
    for i in range(size):
        for j in range(size):
            total = 0.0
            for k in range(size):
                total += squares[own + i * size + k] * squares[own + k * size + j]
            squares[other + i * size + j] = total
