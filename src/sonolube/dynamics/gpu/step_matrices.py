"""One time step of a structure, made by the thread that marches with it.

The matrices are those of `sonolube.dynamics.time_marching.integrator`. What a frequency does not change, the shares of
samples of force and voltage at the nodes of a step, comes from the processor; the free motion between nodes is the
thread's.
"""

from typing import NamedTuple

import numpy as np

from sonolube.checks import Floats
from sonolube.dynamics.first_order_modes import StatePairs
from sonolube.dynamics.gpu.device import on_device
from sonolube.dynamics.gpu.structure_rows import free_motion
from sonolube.dynamics.time_marching.batch import Schedule
from sonolube.dynamics.time_marching.integrator import PAST, force_shares, past_of_a_start, quadrature
from sonolube.dynamics.waveform import Sine, Waveform, value

MIDDLE, SQUARE, LEANING, CONTACT, DRIVE, X, V = 0, 1, 2, 6, 10, 14, 16
"""Rows of the structure's pairs: c and b, each followed by its image under the rest of A, are four rows each. []"""
FIRST_PART, SECOND_PART, COSINE, SINE, JUMP = range(5)
"""Rows of what the steps of a period share. []"""
FORESEEN, AHEAD, SHARES = PAST + 1, 2 * PAST + 1, 6 * PAST + 1
"""Where shares of the forces foreseen and of forces ahead start, and how many there are. []"""
FIRST, SECOND, OLDEST, STEADY, HELD, RECENT, STEP = 0, 1, 2, 3, 6, 12, 12 + PAST
"""Rows of a step: those used all the time, held in registers, then the drive of ramps and recent forces. []"""
AT_CONTACT = PAST * PAST
"""What five forces do at the contact: those so far one step ahead, those ahead at each of the next four. []"""


class Steps(NamedTuple):
    """What all threads read; none of it depends on the frequency."""

    pairs: Floats  # (18, n): half the trace, the square of the rest, and what it does to c, b and the states seen
    nodes: Floats  # (q,): where within a step its integrals are sampled
    force_shares: Floats  # (31, q): of samples of the force, for the corrected step, the one foreseen and those ahead
    voltage_shares: Floats  # (9, q): of the two parts of the waveform and of the offset, under ramps of 1, s and s^2
    backward: Floats  # (5, 5): the past that continues the forces now and at the next four steps
    phases: Floats  # (5, steps): two parts of the waveform, cosine and sine at the end, one where a step begins anew


def steps_of(pairs: StatePairs, contact_rows: Floats, schedule: Schedule, slowest: float) -> Steps:
    """Return what threads need to make their steps.

    Parameters
    ----------
    pairs : StatePairs
    contact_rows : ndarray, shape (2, n, 2)
        Displacement and velocity of the contact per state.
    schedule : Schedule
        Its waveform has no corners within steps.
    slowest : float
        Lowest frequency of the drive, in Hz.

    Returns
    -------
    Steps
    """
    nodes, weights = quadrature(pairs, steps=schedule.steps, slowest=slowest)
    force = force_shares(nodes, weights, schedule.steps)
    parts, shapes = _wave(schedule.waveform, schedule.steps, nodes)
    voltage = [weights * nodes**power * shape for power in range(3) for shape in (*shapes, np.ones_like(nodes))]
    ends = 2 * np.pi * np.arange(1, schedule.steps + 1) / schedule.steps
    jump = np.zeros(schedule.steps)
    jump[schedule.jump_steps] = 1.0
    return Steps(
        _rows_of(pairs, contact_rows),
        nodes,
        np.vstack([force.corrected.T, force.foreseen.T, *force.ahead.swapaxes(1, 2)]),
        np.stack(voltage),
        past_of_a_start(schedule.steps),
        np.stack([*parts, np.cos(ends), np.sin(ends), jump]),
    )


def _rows_of(pairs: StatePairs, contact_rows: Floats) -> Floats:
    middle = np.trace(pairs.generator, axis1=1, axis2=2) / 2
    leaning = pairs.generator - middle[:, np.newaxis, np.newaxis] * np.eye(2)
    turned = [np.einsum("pab,pb->ap", leaning, each) for each in (pairs.contact, pairs.drive)]
    return np.ascontiguousarray(
        np.vstack(
            [
                middle,
                -np.linalg.det(leaning),
                leaning.reshape(-1, 4).T,
                pairs.contact.T,
                turned[0],
                pairs.drive.T,
                turned[1],
                contact_rows[0].T,
                contact_rows[1].T,
            ]
        )
    )


def _wave(waveform: Waveform, steps: int, nodes: Floats) -> tuple[Floats, Floats]:
    """Return a waveform as the sum of two products: parts of each step, of shape (2, steps), by shapes at the nodes."""
    theta = 2 * np.pi / steps
    begins = theta * np.arange(steps)
    if isinstance(waveform, Sine):
        return np.stack([np.sin(begins), np.cos(begins)]), 0.5 * np.stack(
            [np.cos(theta * nodes), np.sin(theta * nodes)]
        )
    early, late = (value(waveform, phase=begins + theta * part) for part in (0.25, 0.75))
    return np.stack([1.5 * early - 0.5 * late, 2 * (late - early)]), np.stack([np.ones_like(nodes), nodes])


@on_device
def write_sums(
    half_trace: float, square: float, duration: float, nodes: Floats, shares: Floats, push: Floats, sums: Floats
) -> None:
    """Write what each share of a push adds to a pair of states over a step."""
    for share in range(shares.shape[0]):
        sums[share, 0], sums[share, 1] = 0.0, 0.0
    for node in range(nodes.size):
        even, odd = free_motion(half_trace, square, duration * (1 - nodes[node]))
        first, second = even * push[0] + odd * push[2], even * push[1] + odd * push[3]
        for share in range(shares.shape[0]):
            sums[share, 0] += shares[share, node] * (duration * first)
            sums[share, 1] += shares[share, node] * (duration * second)


@on_device
def write_step(
    pairs: Floats,
    nodes: Floats,
    force_shares: Floats,
    voltage_shares: Floats,
    duration: float,
    swing: float,
    offset: float,
    sums: Floats,
    step: Floats,
    at_contact: Floats,
) -> None:
    """Write the step of a duration.

    Of `StepFilter`, rows of the step are what a state makes of its pair's two, what the oldest force adds, the drive
    and what recent forces add. At the contact stand what forces so far foretell, and then what forces ahead do.
    """
    for which in range(2):
        for j in range(AT_CONTACT):
            at_contact[which, j] = 0.0
    for pair in range(pairs.shape[1]):
        one, two = 2 * pair, 2 * pair + 1
        half_trace, square = pairs[MIDDLE, pair], pairs[SQUARE, pair]
        write_sums(half_trace, square, duration, nodes, voltage_shares, pairs[DRIVE : DRIVE + 4, pair], sums)
        for part in range(voltage_shares.shape[0]):
            scale = offset if part % 3 == 2 else swing
            step[STEADY + part, one], step[STEADY + part, two] = scale * sums[part, 0], scale * sums[part, 1]
        write_sums(half_trace, square, duration, nodes, force_shares, pairs[CONTACT : CONTACT + 4, pair], sums)
        even, odd = free_motion(half_trace, square, duration)
        a, b = even + odd * pairs[LEANING, pair], odd * pairs[LEANING + 1, pair]
        c, d = odd * pairs[LEANING + 2, pair], even + odd * pairs[LEANING + 3, pair]
        step[FIRST, one], step[SECOND, one], step[FIRST, two], step[SECOND, two] = a, b, c, d
        first, second = 0.0, 0.0
        for j in range(PAST):  # W(q) = (1 - E q) V(q) + q^5 U, q one step back
            first, second = sums[j, 0] + a * first + b * second, sums[j, 1] + c * first + d * second
            step[RECENT + j, one], step[RECENT + j, two] = first, second
            moved, also = sums[FORESEEN + j, 0] + a * first + b * second, sums[FORESEEN + j, 1] + c * first + d * second
            add_at_contact(pairs, pair, moved, also, j, at_contact)
        first, second = sums[PAST, 0] + a * first + b * second, sums[PAST, 1] + c * first + d * second
        step[OLDEST, one], step[OLDEST, two] = first, second
        add_at_contact(pairs, pair, -first, -second, PAST - 1, at_contact)
        for j in range(PAST):
            first, second = 0.0, 0.0
            for later in range(PAST - 1):
                added = AHEAD + PAST * later + j
                first, second = sums[added, 0] + a * first + b * second, sums[added, 1] + c * first + d * second
                add_at_contact(pairs, pair, first, second, PAST * (later + 1) + j, at_contact)


@on_device
def add_at_contact(pairs: Floats, pair: int, first: float, second: float, place: int, at_contact: Floats) -> None:
    """Add what a pair of states moves the contact by, and how fast."""
    at_contact[0, place] += pairs[X, pair] * first + pairs[X + 1, pair] * second
    at_contact[1, place] += pairs[V, pair] * first + pairs[V + 1, pair] * second
