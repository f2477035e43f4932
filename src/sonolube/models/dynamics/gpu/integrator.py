"""Coefficients of the exponential integrator, by the GPU thread that marches with them.

They are those of `sonolube.models.dynamics.time_marching.integrator`. What does not depend on the frequency, the
weights of samples of force and voltage at the nodes of a step, comes from the CPU; each thread integrates the free
motion between the nodes at its own frequency.
"""

from typing import NamedTuple

import numpy as np

from sonolube.checks import Floats
from sonolube.models.dynamics.first_order_modes import FirstOrderModes
from sonolube.models.dynamics.gpu.device import on_device
from sonolube.models.dynamics.gpu.receptance import transition_factors
from sonolube.models.dynamics.time_marching.batch import MarchingProblem
from sonolube.models.dynamics.time_marching.integrator import PAST, force_weights, start_history, step_quadrature
from sonolube.models.dynamics.waveform import Sine, Waveform, waveform_value

HALF_TRACE, SQUARE, TRACELESS, CONTACT, DRIVE, X, V = 0, 1, 2, 6, 10, 14, 16
"""Rows of a pair of states; contact and drive input c and b have four rows each, with their images under B. []"""
FIRST_PART, SECOND_PART, COSINE, SINE, JUMP = range(5)
"""Rows of the table common to all trajectories, one column per step of a period. []"""
PREDICTED, AHEAD, WEIGHTS = PAST + 1, 2 * PAST + 1, 6 * PAST + 1
"""First weights of predicted forces and of forces ahead, and the number of weights. []"""
FIRST, SECOND, OLDEST, CONSTANT, HELD, RECENT, STEP = 0, 1, 2, 3, 6, 12, 12 + PAST
"""Rows of a step: those of every step, held in registers, then the drive of ramps and the recent forces. []"""
AT_CONTACT = PAST * PAST
"""Contributions of five forces at the contact: past ones one step ahead, those ahead at each of the next four. []"""


class StepTables(NamedTuple):
    """Tables that all threads read, independent of the frequency."""

    pairs: Floats  # (18, n): half the trace, square of the traceless part B, B, c and b with images, contact outputs
    nodes: Floats  # (q,): quadrature nodes within a step
    force_weights: Floats  # (31, q): of samples of the force, for corrected and predicted step, and for those ahead
    voltage_weights: Floats  # (9, q): of both parts of the waveform and of the offset, under ramps of 1, s and s^2
    backward: Floats  # (5, 5): extrapolation of the forces now and at the next four steps to the past
    phases: Floats  # (5, steps): two parts of the waveform, cosine and sine at the end, one before a jump


def step_tables(problem: MarchingProblem) -> StepTables:
    """Return the tables from which threads compute their steps.

    Parameters
    ----------
    problem : MarchingProblem
        With a waveform without corners within steps.

    Returns
    -------
    StepTables
    """
    schedule = problem.schedule
    nodes, weights = step_quadrature(problem.modes, steps=schedule.steps, slowest=float(problem.frequency.min()))
    force = force_weights(nodes, weights, schedule.steps)
    parts, shapes = _separated_waveform(schedule.waveform, schedule.steps, nodes)
    voltage = [weights * nodes**power * shape for power in range(3) for shape in (*shapes, np.ones_like(nodes))]
    ends = 2 * np.pi * np.arange(1, schedule.steps + 1) / schedule.steps
    jump = np.zeros(schedule.steps)
    jump[schedule.jump_steps] = 1.0
    return StepTables(
        _pair_rows(problem.modes, problem.contact_output),
        nodes,
        np.vstack([force.corrected.T, force.predicted.T, *force.ahead.swapaxes(1, 2)]),
        np.stack(voltage),
        start_history(schedule.steps),
        np.stack([*parts, np.cos(ends), np.sin(ends), jump]),
    )


def _pair_rows(modes: FirstOrderModes, contact_output: Floats) -> Floats:
    """Return the pairs of states as columns of one array, shape (18, n)."""
    middle = np.trace(modes.state_matrix, axis1=1, axis2=2) / 2
    traceless = modes.state_matrix - middle[:, np.newaxis, np.newaxis] * np.eye(2)
    rows = [middle, -np.linalg.det(traceless), traceless.reshape(-1, 4).T]
    for each in (modes.contact_input, modes.drive_input):
        rows += [each.T, np.einsum("pab,pb->ap", traceless, each)]
    return np.ascontiguousarray(np.vstack([*rows, contact_output[0].T, contact_output[1].T]))


def _separated_waveform(waveform: Waveform, steps: int, nodes: Floats) -> tuple[Floats, Floats]:
    """Return a waveform as a sum of two products: factors of each step, shape (2, steps), and shapes at the nodes."""
    theta = 2 * np.pi / steps
    starts = theta * np.arange(steps)
    if isinstance(waveform, Sine):
        within = theta * nodes
        return np.stack([np.sin(starts), np.cos(starts)]), 0.5 * np.stack([np.cos(within), np.sin(within)])
    early, late = (waveform_value(waveform, phase=starts + theta * part) for part in (0.25, 0.75))
    return np.stack([1.5 * early - 0.5 * late, 2 * (late - early)]), np.stack([np.ones_like(nodes), nodes])


@on_device
def write_sums(
    half_trace: float, square: float, duration: float, nodes: Floats, weights: Floats, inputs: Floats, sums: Floats
) -> None:
    """Write the contribution of each weighted input to a pair of states over a step, by quadrature."""
    for row in range(weights.shape[0]):
        sums[row, 0], sums[row, 1] = 0.0, 0.0
    for node in range(nodes.size):
        even, odd = transition_factors(half_trace, square, duration * (1 - nodes[node]))
        first, second = even * inputs[0] + odd * inputs[2], even * inputs[1] + odd * inputs[3]
        for row in range(weights.shape[0]):
            sums[row, 0] += weights[row, node] * (duration * first)
            sums[row, 1] += weights[row, node] * (duration * second)


@on_device
def write_step(
    pairs: Floats,
    nodes: Floats,
    force_weights: Floats,
    voltage_weights: Floats,
    duration: float,
    peak_to_peak: float,
    offset: float,
    sums: Floats,
    step: Floats,
    at_contact: Floats,
) -> None:
    """Write the coefficients of the step of one trajectory.

    Rows of the step are those of `ExponentialIntegrator`: propagator, contribution of the oldest force, drive, recent
    forces. At the contact there are the predictor of the past forces, then the contributions of forces ahead.
    """
    for which in range(2):
        for j in range(AT_CONTACT):
            at_contact[which, j] = 0.0
    for pair in range(pairs.shape[1]):
        one, two = 2 * pair, 2 * pair + 1
        half_trace, square = pairs[HALF_TRACE, pair], pairs[SQUARE, pair]
        write_sums(half_trace, square, duration, nodes, voltage_weights, pairs[DRIVE : DRIVE + 4, pair], sums)
        for part in range(voltage_weights.shape[0]):
            scale = offset if part % 3 == 2 else peak_to_peak
            step[CONSTANT + part, one], step[CONSTANT + part, two] = scale * sums[part, 0], scale * sums[part, 1]
        write_sums(half_trace, square, duration, nodes, force_weights, pairs[CONTACT : CONTACT + 4, pair], sums)
        even, odd = transition_factors(half_trace, square, duration)
        a, b = even + odd * pairs[TRACELESS, pair], odd * pairs[TRACELESS + 1, pair]
        c, d = odd * pairs[TRACELESS + 2, pair], even + odd * pairs[TRACELESS + 3, pair]
        step[FIRST, one], step[SECOND, one], step[FIRST, two], step[SECOND, two] = a, b, c, d
        first, second = 0.0, 0.0
        for j in range(PAST):  # filter W(q) = (1 - E q) V(q) + q^5 U, with the delay operator q
            first, second = sums[j, 0] + a * first + b * second, sums[j, 1] + c * first + d * second
            step[RECENT + j, one], step[RECENT + j, two] = first, second
            ahead_first, ahead_second = (
                sums[PREDICTED + j, 0] + a * first + b * second,
                sums[PREDICTED + j, 1] + c * first + d * second,
            )
            add_at_contact(pairs, pair, ahead_first, ahead_second, j, at_contact)
        first, second = sums[PAST, 0] + a * first + b * second, sums[PAST, 1] + c * first + d * second
        step[OLDEST, one], step[OLDEST, two] = first, second
        add_at_contact(pairs, pair, -first, -second, PAST - 1, at_contact)
        for j in range(PAST):
            first, second = 0.0, 0.0
            for step_ahead in range(PAST - 1):
                added = AHEAD + PAST * step_ahead + j
                first, second = sums[added, 0] + a * first + b * second, sums[added, 1] + c * first + d * second
                add_at_contact(pairs, pair, first, second, PAST * (step_ahead + 1) + j, at_contact)


@on_device
def add_at_contact(pairs: Floats, pair: int, first: float, second: float, place: int, at_contact: Floats) -> None:
    """Add the displacement and velocity of the contact due to one pair of states."""
    at_contact[0, place] += pairs[X, pair] * first + pairs[X + 1, pair] * second
    at_contact[1, place] += pairs[V, pair] * first + pairs[V + 1, pair] * second
