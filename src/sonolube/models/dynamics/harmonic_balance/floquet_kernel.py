r"""Largest Floquet multiplier of a batch of periodic motions, by kick-drift splitting and repeated squaring.

The disturbance s of a periodic motion obeys the linear equation with periodic coefficients

.. math:: \dot s = A s - c\,\left[k(t)\,x(s) + d(t)\,v(s)\right],

with the momentary stiffness k and damping d of the contact. Over one period it is integrated by splitting: between
instants the free structure moves exactly (drift, each pair of states by itself); at each instant the contact acts as an
impulse (kick). Both steps are symplectic but for damping, so that their errors shift frequencies but hardly create or
hide growth. The monodromy matrix is then squared until only its largest multiplier remains.
"""

from typing import NamedTuple

import numpy as np

from sonolube.checks import Floats, Integers
from sonolube.execution.compilation import kernel
from sonolube.models.dynamics.kernels.contact_kernel import KernelLaw, contact_force_rows, velocity_over_omega
from sonolube.models.dynamics.kernels.simd import (
    INLINED,
    INNER,
    KERNEL,
    LANES,
    add_products,
    block_maximum,
    gather,
    weighted_row_sum,
)

# Rows of a block: angular frequency, dead load, equilibrium coordinate and mean displacement (columns of `settings`);
# displacement, velocity and force at an instant; stiffness and damping, then impulses of a kick per displacement and
# per velocity.
OMEGA, LOAD, EQUILIBRIUM, MEAN, DISPLACEMENT, VELOCITY, FORCE, STIFFNESS, DAMPING = range(9)
# Columns of a pair of states: contact input vector, and outputs of displacement and velocity of the contact.
INPUT, DISPLACEMENT_OUTPUT, VELOCITY_OUTPUT = 0, 2, 4
SQUARINGS = 22
"""Squarings of the monodromy matrix, which resolve a Floquet exponent of 2e-7 per period. []"""


class PeriodWorkspace(NamedTuple):
    """Rows in which a block of monodromy matrices is computed, for n states and motions of H harmonics."""

    rows: Floats  # (9, lanes): OMEGA to DAMPING
    drift: Floats  # (2 n, lanes): exp(A dt) of every pair
    motion: Floats  # (2, 2 H + 1, lanes): displacement and velocity over omega: mean, then parts of each harmonic
    wave: Floats  # (2, H + 1): cosines, and minus sines, at a kick
    contact: Floats  # (3, n, lanes): displacement, velocity and impulse of each disturbance at the contact
    matrix: Floats  # (n, n, lanes)
    square: Floats  # (n, n, lanes)
    size: Floats  # (2, lanes): exponent of the powers of two taken out of the matrix, and its norm


def period_workspace(states: int, harmonics: int) -> PeriodWorkspace:
    """Allocate the workspace of `monodromy_power_norms`."""
    return PeriodWorkspace(
        rows=np.empty((9, LANES)),
        drift=np.empty((2 * states, LANES)),
        motion=np.zeros((2, 2 * harmonics + 1, LANES)),
        wave=np.empty((2, harmonics + 1)),
        contact=np.empty((3, states, LANES)),
        matrix=np.empty((states, states, LANES)),
        square=np.empty((states, states, LANES)),
        size=np.empty((2, LANES)),
    )


@kernel(**KERNEL)
def monodromy_power_norms(
    law: KernelLaw,
    pairs: Floats,
    settings: Floats,
    drift: Floats,
    harmonics: Floats,
    count: Integers,
    kicks: Integers,
    chosen: Integers,
    work: PeriodWorkspace,
    powers: Floats,
    norms: Floats,
) -> None:
    """Write the norm of the monodromy matrix to the power 2^22 of each chosen point, in two parts.

    `pairs` has shape (m, 6). `settings` has shape (p, 4). `drift` has shape (p, 4 m). `harmonics` has shape (p, 2
    capacity).
    """
    for start in range(0, chosen.size, LANES):
        block = chosen[start : start + LANES]
        h = block_maximum(count, block)
        gather(settings, block, work.rows)
        gather(drift, block, work.drift)
        gather(harmonics, block, work.motion[0, 1 : 2 * h + 1])
        for lane in range(LANES):
            work.motion[0, 0, lane] = work.rows[MEAN, lane]
        velocity_over_omega(law, work.motion[0], h, work.motion[1])
        _monodromy_matrix(law, pairs, h, kicks[block[0]], work)
        _square_repeatedly(work.matrix, work.square, work.size)
        for lane in range(block.size):
            powers[block[lane]], norms[block[lane]] = work.size[0, lane], work.size[1, lane]


@kernel(**INLINED)
def _monodromy_matrix(law: KernelLaw, pairs: Floats, h: int, kicks: int, work: PeriodWorkspace) -> None:
    """Write the monodromy matrix: one period of alternating kicks and drifts of every unit disturbance."""
    rows, matrix, contact = work.rows, work.matrix, work.contact
    size, gain = matrix.shape[0], 0.0
    for pair in range(pairs.shape[0]):
        first = pairs[pair, VELOCITY_OUTPUT] * pairs[pair, INPUT]
        gain += first + pairs[pair, VELOCITY_OUTPUT + 1] * pairs[pair, INPUT + 1]
    for j in range(size):
        for lane in range(LANES):
            for i in range(size):
                matrix[i, j, lane] = 1.0 if i == j else 0.0
            contact[0, j, lane] = pairs[j // 2, DISPLACEMENT_OUTPUT + j % 2]
            contact[1, j, lane] = pairs[j // 2, VELOCITY_OUTPUT + j % 2]
    for kick in range(kicks):
        _motion_at(law, 2 * np.pi / kicks * kick, h, work.motion, work.wave, rows)
        contact_force_rows(law, rows[LOAD], rows[EQUILIBRIUM], rows[DISPLACEMENT], rows[VELOCITY], rows[FORCE:])
        _impulses(law, gain, kicks, rows)
        for j in range(size):
            _kick(law, rows, contact, j)
            for pair in range(pairs.shape[0]):
                _drift(law, pairs, pair, work.drift, matrix, contact, j)


@kernel(**INNER)
def _motion_at(law: KernelLaw, phase: float, h: int, motion: Floats, wave: Floats, rows: Floats) -> None:
    """Write the displacement and, with damping, the velocity at a phase; force and stiffness serve as scratch."""
    for k in range(h + 1):
        wave[0, k], wave[1, k] = np.cos(phase * k), -np.sin(phase * k)
    for part in range(2):
        weighted_row_sum(rows[FORCE + part], wave[part], motion[0], part, h)
    for lane in range(LANES):
        rows[DISPLACEMENT, lane] = rows[FORCE, lane] + rows[STIFFNESS, lane]
    if len(law.damped) == 1:
        for part in range(2):
            weighted_row_sum(rows[FORCE + part], wave[part], motion[1], part, h)
        for lane in range(LANES):
            rows[VELOCITY, lane] = rows[OMEGA, lane] * (rows[FORCE, lane] + rows[STIFFNESS, lane])


@kernel(**INNER)
def _impulses(law: KernelLaw, gain: float, kicks: int, rows: Floats) -> None:
    r"""Replace stiffness and damping by the impulses of one kick per displacement and per velocity.

    Notes
    -----
    During a kick of duration dt the contact velocity w, with the gain g of velocity per impulse, obeys
    :math:`\dot w = -g\,(d\,w + k\,x)` at constant x, hence

    .. math:: w \to w\,e^{-g d\,dt} - \left(1 - e^{-g d\,dt}\right) k x/d .
    """
    for lane in range(LANES):
        rows[STIFFNESS, lane] *= -2 * np.pi / (kicks * rows[OMEGA, lane])
    if len(law.damped) == 1:
        for lane in range(LANES):
            duration = 2 * np.pi / (kicks * rows[OMEGA, lane])
            decay = gain * rows[DAMPING, lane] * duration
            factor = (1 - np.exp(-decay)) / decay if decay > 1e-12 else 1.0
            rows[STIFFNESS, lane] *= factor
            rows[DAMPING, lane] *= -duration * factor


@kernel(**INNER)
def _kick(law: KernelLaw, rows: Floats, contact: Floats, j: int) -> None:
    """Write the impulse on the j-th disturbance, and reset its displacement and velocity at the contact."""
    for lane in range(LANES):
        contact[2, j, lane] = rows[STIFFNESS, lane] * contact[0, j, lane]
        contact[0, j, lane] = 0.0
    if len(law.damped) == 1:
        for lane in range(LANES):
            contact[2, j, lane] += rows[DAMPING, lane] * contact[1, j, lane]
            contact[1, j, lane] = 0.0


@kernel(**INNER)
def _drift(law: KernelLaw, pairs: Floats, pair: int, drift: Floats, matrix: Floats, contact: Floats, j: int) -> None:
    """Apply the impulse to one pair of states of the j-th disturbance, then its free motion up to the next kick."""
    row, i = 4 * pair, 2 * pair
    for lane in range(LANES):
        one = matrix[i, j, lane] + pairs[pair, INPUT] * contact[2, j, lane]
        two = matrix[i + 1, j, lane] + pairs[pair, INPUT + 1] * contact[2, j, lane]
        first = drift[row, lane] * one + drift[row + 1, lane] * two
        second = drift[row + 2, lane] * one + drift[row + 3, lane] * two
        matrix[i, j, lane], matrix[i + 1, j, lane] = first, second
        contact[0, j, lane] += pairs[pair, DISPLACEMENT_OUTPUT] * first + pairs[pair, DISPLACEMENT_OUTPUT + 1] * second
        if len(law.damped) == 1:
            contact[1, j, lane] += pairs[pair, VELOCITY_OUTPUT] * first + pairs[pair, VELOCITY_OUTPUT + 1] * second


@kernel(**INLINED)
def _square_repeatedly(matrix: Floats, square: Floats, size: Floats) -> None:
    """Square the matrix 22 times, scaled to a norm near one by powers of two; write these and the last norm."""
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
        for lane in range(LANES):  # half the binary exponent of the squared norm, and its reciprocal power of two
            power = ((bits[lane] >> 52) - 1023) >> 1
            taken[lane] = 2 * taken[lane] + power
            bits[lane] = (1023 - power) << 52
        for i in range(states):
            for j in range(states):
                for lane in range(LANES):
                    matrix[i, j, lane] *= norm[lane]


@kernel(**INNER)
def _square(matrix: Floats, square: Floats) -> None:
    """Replace a matrix by its square."""
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
