"""One kernel from the settings of a trajectory to its statistics and its last periods: a thread to a trajectory.

A thread makes the step of its own frequency, marches, and keeps state, forces and sums in registers and memory of its
own; only what was asked for is written. What must be known at compile time is fixed by `marching_kernel`.
"""

import math
from functools import cache
from typing import Any

from numba import float64

from sonolube.checks import Floats
from sonolube.dynamics.gpu.device import cuda
from sonolube.dynamics.gpu.integrator import (
    FREQUENCY,
    LOAD,
    OFFSET,
    SWING,
    contact_force,
    move,
    ramp_parabola,
    seen,
    start_anew,
    write_recent,
)
from sonolube.dynamics.gpu.step_matrices import (
    AT_CONTACT,
    COSINE,
    FIRST_PART,
    HELD,
    JUMP,
    OLDEST,
    SECOND_PART,
    SHARES,
    SINE,
    STEP,
    V,
    X,
    write_step,
)
from sonolube.dynamics.time_marching.integrator import PAST

_AT_CONTACT = (2, AT_CONTACT)
_SUMS = (SHARES, 2)
_SEEN = (2, PAST)


@cache
def marching_kernel(n: int, kind: int, damped: bool) -> Any:
    """Return the kernel for a number of pairs of states and a contact law.

    Parameters
    ----------
    n : int
        Pairs of states.
    kind : int
        Of the contact law.
    damped : bool
        Whether the contact is.

    Returns
    -------
    callable
    """
    return cuda.jit(cache=True)(marching_points(n, kind, damped))


def marching_points(n: int, kind: int, damped: bool) -> Any:
    """Return what `marching_kernel` compiles."""
    m = 2 * n
    often, all_rows = (HELD, m), (STEP, m)

    def march_points(
        pairs: Floats,
        nodes: Floats,
        force_shares: Floats,
        voltage_shares: Floats,
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
        yielded: Floats,
    ) -> None:
        """March many trajectories, each by one thread; points are the last axis of every array that has them.

        Parameters
        ----------
        pairs, nodes, force_shares, voltage_shares, backward, phases : ndarray
            `Steps`.
        cells : ndarray, shape (c, 4)
            Table of a tabulated law, anything for any other.
        ramp_duration : float
            In s.
        cosine_shaped : bool
            Shape of the ramp.
        periods, window : int
            Periods to march, and to a window of the statistics.
        settings : ndarray, shape (8, p)
            Frequency, voltage peak to peak, offset, and the rows of the contact law.
        start : ndarray, shape (2 n, p)
            States.
        statistics : ndarray, shape (windows, 8, p)
            Written, as the other arrays are: see `sonolube.dynamics.time_marching.batch.Marched`.
        recorded : ndarray, shape (steps to record, 2 n + 1, p)
        strobed : ndarray, shape (periods to record, 2 n, p)
        final : ndarray, shape (2 n, p)
        yielded : ndarray, shape (2, p)
        """
        point = cuda.grid(1)
        if point >= settings.shape[1]:
            return
        # y, held, foreseen and forces become registers, as `stepping` says
        y, held, foreseen = (
            cuda.local.array(m, float64),
            cuda.local.array(often, float64),
            cuda.local.array(_SEEN, float64),
        )
        forces, state = cuda.local.array(PAST, float64), cuda.local.array(m, float64)
        step, at_contact = cuda.local.array(all_rows, float64), cuda.local.array(_AT_CONTACT, float64)
        added, sums = cuda.local.array(m, float64), cuda.local.array(_SUMS, float64)
        free, forces_ahead = cuda.local.array(_SEEN, float64), cuda.local.array(PAST, float64)

        steps, frequency = phases.shape[1], settings[FREQUENCY, point]
        ramp_steps, load = ramp_duration * frequency * steps, settings[LOAD, point]
        write_step(
            pairs,
            nodes,
            force_shares,
            voltage_shares,
            1 / (frequency * steps),
            settings[SWING, point],
            settings[OFFSET, point],
            sums,
            step,
            at_contact,
        )
        for row in range(HELD):
            for k in range(m):
                held[row, k] = step[row, k]
        for which in range(2):
            yielded[which, point] = 0.0
            for j in range(PAST):
                foreseen[which, j] = at_contact[which, j]
                yielded[which, point] += at_contact[which, PAST + j]
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
                    start_anew(
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
                move(m, pairs, held, step, ramp, phases[FIRST_PART, phase], phases[SECOND_PART, phase], added, y)
                for k in range(m):
                    y[k] += held[OLDEST, k] * forces[PAST - 1]
                x, v = seen(m, pairs, X, y), 0.0
                for j in range(PAST):
                    x += foreseen[0, j] * forces[j]
                if damped:
                    v = seen(m, pairs, V, y)
                    for j in range(PAST):
                        v += foreseen[1, j] * forces[j]
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
                    write_recent(pairs.shape[1] * 2, step, forces, added)
                    for k in range(m):
                        recorded[now - unrecorded, k, point] = y[k] + added[k]
                    recorded[now - unrecorded, m, point] = forces[0]
            if period >= unstrobed:
                write_recent(pairs.shape[1] * 2, step, forces, added)
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
        write_recent(pairs.shape[1] * 2, step, forces, added)
        for k in range(m):
            final[k, point] = y[k] + added[k]

    return march_points
