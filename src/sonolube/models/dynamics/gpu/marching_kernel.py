"""GPU kernel of time marching: one trajectory per thread.

A thread computes the step of its own frequency, marches, and keeps state, forces and sums in registers and local
memory; only requested results are written. Integers that must be known at compile time are fixed by `marching_kernel`.
"""

import math
from functools import cache
from typing import Any

from numba import float64

from sonolube.checks import Floats
from sonolube.models.dynamics.gpu.device import cuda
from sonolube.models.dynamics.gpu.integrator import (
    AT_CONTACT,
    COSINE,
    FIRST_PART,
    HELD,
    JUMP,
    OLDEST,
    SECOND_PART,
    SINE,
    STEP,
    WEIGHTS,
    V,
    X,
    write_step,
)
from sonolube.models.dynamics.gpu.time_step import (
    FREQUENCY,
    LOAD,
    OFFSET,
    PEAK_TO_PEAK,
    contact_force,
    contact_output,
    free_step,
    ramp_parabola,
    restart,
    write_force_contributions,
)
from sonolube.models.dynamics.time_marching.integrator import PAST

_AT_CONTACT = (2, AT_CONTACT)
_SUMS = (WEIGHTS, 2)
_OUTPUT = (2, PAST)


@cache
def marching_kernel(n: int, kind: int, damped: bool) -> Any:
    """Return the kernel for a number of pairs of states and a contact law.

    Parameters
    ----------
    n : int
        Number of pairs of states.
    kind : int
        `GapLaw.kind`.
    damped : bool
        Whether the contact is damped.

    Returns
    -------
    callable
    """
    return cuda.jit(cache=True)(marching_points(n, kind, damped))


def marching_points(n: int, kind: int, damped: bool) -> Any:
    """Return the Python function that `marching_kernel` compiles; arguments as there."""
    m = 2 * n
    held_rows, all_rows = (HELD, m), (STEP, m)

    def march_points(
        pairs: Floats,
        nodes: Floats,
        force_weights: Floats,
        voltage_weights: Floats,
        backward: Floats,
        phases: Floats,
        cells: Floats,
        ramp_duration: float,
        cosine_shaped: bool,
        periods: int,
        window: int,
        settings: Floats,
        start: Floats,
        statistics: Floats,
        recorded: Floats,
        strobed: Floats,
        final: Floats,
        step_response: Floats,
    ) -> None:
        """March many trajectories, each by one thread; points are the last axis of every array that has them.

        Parameters
        ----------
        pairs, nodes, force_weights, voltage_weights, backward, phases : ndarray
            `StepTables`.
        cells : ndarray, shape (c, 4)
            Coefficients of a tabulated law, arbitrary for any other.
        ramp_duration : float
            Duration of the ramp, in s.
        cosine_shaped : bool
            Shape of the ramp.
        periods, window : int
            Periods to march, and per window of the statistics.
        settings : ndarray, shape (8, p)
            Frequency, peak-to-peak voltage, offset, and the rows of the contact law.
        start : ndarray, shape (2 n, p)
            Initial states.
        statistics : ndarray, shape (windows, 8, p)
            Written, like the arrays that follow: see `MarchingSolution`.
        recorded : ndarray, shape (steps to record, 2 n + 1, p)
        strobed : ndarray, shape (periods to record, 2 n, p)
        final : ndarray, shape (2 n, p)
        step_response : ndarray, shape (2, p)
        """
        point = cuda.grid(1)
        if point >= settings.shape[1]:
            return
        # y, held, predictor and forces become registers, see `sonolube.models.dynamics.gpu.time_step`
        y, held, predictor = (
            cuda.local.array(m, float64),
            cuda.local.array(held_rows, float64),
            cuda.local.array(_OUTPUT, float64),
        )
        forces, state = cuda.local.array(PAST, float64), cuda.local.array(m, float64)
        step, at_contact = cuda.local.array(all_rows, float64), cuda.local.array(_AT_CONTACT, float64)
        added, sums = cuda.local.array(m, float64), cuda.local.array(_SUMS, float64)
        free, forces_ahead = cuda.local.array(_OUTPUT, float64), cuda.local.array(PAST, float64)

        steps, frequency = phases.shape[1], settings[FREQUENCY, point]
        ramp_steps, load = ramp_duration * frequency * steps, settings[LOAD, point]
        write_step(
            pairs,
            nodes,
            force_weights,
            voltage_weights,
            1 / (frequency * steps),
            settings[PEAK_TO_PEAK, point],
            settings[OFFSET, point],
            sums,
            step,
            at_contact,
        )
        for row in range(HELD):
            for k in range(m):
                held[row, k] = step[row, k]
        for which in range(2):
            step_response[which, point] = 0.0
            for j in range(PAST):
                predictor[which, j] = at_contact[which, j]
                step_response[which, point] += at_contact[which, PAST + j]
        for k in range(m):
            y[k] = start[k, point]
        for j in range(PAST):
            forces[j] = 0.0
        unrecorded, unstrobed = periods * steps - recorded.shape[0], periods - strobed.shape[0]
        highest, lowest, strongest, weakest = -math.inf, math.inf, -math.inf, math.inf
        total, cosine, sine, pushed = 0.0, 0.0, 0.0, 0.0
        for period in range(periods):
            for phase in range(steps):
                now = period * steps + phase
                if now == 0 or phases[JUMP, phase] > 0 or now >= ramp_steps > now - 1:
                    restart(
                        m,
                        kind,
                        damped,
                        cells,
                        settings,
                        point,
                        pairs,
                        phases,
                        backward,
                        now,
                        ramp_steps,
                        cosine_shaped,
                        held,
                        step,
                        at_contact,
                        y,
                        forces,
                        added,
                        state,
                        free,
                        forces_ahead,
                    )
                ramp = ramp_parabola(now, ramp_steps, cosine_shaped)
                free_step(m, pairs, held, step, ramp, phases[FIRST_PART, phase], phases[SECOND_PART, phase], added, y)
                for k in range(m):
                    y[k] += held[OLDEST, k] * forces[PAST - 1]
                x, v = contact_output(m, pairs, X, y), 0.0
                for j in range(PAST):
                    x += predictor[0, j] * forces[j]
                if damped:
                    v = contact_output(m, pairs, V, y)
                    for j in range(PAST):
                        v += predictor[1, j] * forces[j]
                force = contact_force(kind, damped, cells, settings, point, x, v)
                for j in range(PAST - 1, 0, -1):
                    forces[j] = forces[j - 1]
                forces[0] = force - load
                highest, lowest = max(highest, x), min(lowest, x)
                total, pushed = total + x, pushed + force
                cosine, sine = cosine + phases[COSINE, phase] * x, sine + phases[SINE, phase] * x
                if damped:  # otherwise the extremes of the force are those of the displacement
                    strongest, weakest = max(strongest, force), min(weakest, force)
                if now >= unrecorded:
                    write_force_contributions(pairs.shape[1] * 2, step, forces, added)
                    for k in range(m):
                        recorded[now - unrecorded, k, point] = y[k] + added[k]
                    recorded[now - unrecorded, m, point] = forces[0]
            if period >= unstrobed:
                write_force_contributions(pairs.shape[1] * 2, step, forces, added)
                for k in range(m):
                    strobed[period - unstrobed, k, point] = y[k] + added[k]
            if (period + 1) % window == 0 or period == periods - 1:
                place = period // window
                statistics[place, 0, point], statistics[place, 1, point] = highest, lowest
                statistics[place, 2, point] = total
                statistics[place, 3, point], statistics[place, 4, point] = cosine, sine
                statistics[place, 5, point] = pushed
                statistics[place, 6, point], statistics[place, 7, point] = strongest, weakest
                highest, lowest, strongest, weakest = -math.inf, math.inf, -math.inf, math.inf
                total, cosine, sine, pushed = 0.0, 0.0, 0.0, 0.0
        write_force_contributions(pairs.shape[1] * 2, step, forces, added)
        for k in range(m):
            final[k, point] = y[k] + added[k]

    return march_points
