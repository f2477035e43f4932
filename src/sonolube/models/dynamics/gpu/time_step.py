"""Time steps of one trajectory and its starts without history, by GPU threads.

The method is that of `sonolube.models.dynamics.time_marching.marching_kernel`. Loops over what every step reads have
bounds known at compile time, so that these arrays become registers. Loops over the rest run to the extent of an array,
so that they are not unrolled and do not compete for registers.
"""

import math

from sonolube.checks import Floats
from sonolube.models.dynamics.gpu.device import on_device
from sonolube.models.dynamics.gpu.integrator import CONSTANT, FIRST, FIRST_PART, HELD, RECENT, SECOND, SECOND_PART, V, X
from sonolube.models.dynamics.kernels.contact_kernel import EXPONENTIAL, HERTZ, LINEAR
from sonolube.models.dynamics.time_marching.integrator import PAST
from sonolube.models.dynamics.time_marching.marching_kernel import RAMP_EPSILON, SWEEPS, exponential

FREQUENCY, PEAK_TO_PEAK, OFFSET, LOAD = 0, 1, 2, 3
"""Rows of the settings of a point; the load is followed by three numbers of the contact law and its damping. []"""

exponential_on_device = on_device(exponential.py_func)


@on_device
def log_force_at(cells: Floats, position: float) -> float:
    """Return the logarithm of a tabulated force, in N: see `sonolube.models.dynamics.kernels.force_table`."""
    at, last = 0, cells.shape[0] - 1
    if position >= last - 1:
        at = last
    elif position >= 0.0:  # false for NaN
        at = int(math.floor(position)) + 1  # noqa: RUF046 - a GPU rounds to a float
    u = position - (at - 1)
    value: float = cells[at, 0] + u * (cells[at, 1] + u * (cells[at, 2] + u * cells[at, 3]))
    return value


@on_device
def contact_force(kind: int, damped: bool, cells: Floats, settings: Floats, point: int, x: float, v: float) -> float:
    """Return the contact force, in N; the rows of the law are those of `MarchingProblem.law_rows`."""
    load, first, second = settings[LOAD, point], settings[LOAD + 1, point], settings[LOAD + 2, point]
    force: float
    if kind == EXPONENTIAL:
        force = load * exponential_on_device(-x * first)
    elif kind == HERTZ:
        approach = max(second - x, 0.0)
        force = first * approach * math.sqrt(approach)
    elif kind == LINEAR:
        force = max(load - first * x, 0.0)
    else:
        force = load * exponential_on_device(log_force_at(cells, second + first * x) - settings[LOAD + 3, point])
    if damped:
        force *= max(1.0 - settings[LOAD + 4, point] * v, 0.0)
    return force


@on_device
def ramp_factor(time: float, ramp_steps: float, cosine_shaped: bool) -> float:
    """Return the ramp factor at a time in steps."""
    fraction = min((time + RAMP_EPSILON) / (ramp_steps + RAMP_EPSILON), 1.0)
    return 0.5 - 0.5 * math.cos(math.pi * fraction) if cosine_shaped else fraction


@on_device
def ramp_parabola(now: int, ramp_steps: float, cosine_shaped: bool) -> tuple[float, float, float]:
    """Return the coefficients of the ramp within a step, level + slope s + bend s^2 with s from 0 to 1."""
    if now > ramp_steps:
        return 1.0, 0.0, 0.0
    level = ramp_factor(now, ramp_steps, cosine_shaped)
    middle = ramp_factor(now + 0.5, ramp_steps, cosine_shaped)
    end = ramp_factor(now + 1.0, ramp_steps, cosine_shaped)
    return level, 4 * middle - 3 * level - end, 2 * (level - 2 * middle + end)


@on_device
def write_force_contributions(size: int, step: Floats, forces: Floats, added: Floats) -> None:
    """Write the contributions of the recent forces to each state."""
    for k in range(size):
        total = 0.0
        for j in range(PAST):
            total += step[RECENT + j, k] * forces[j]
        added[k] = total


@on_device
def write_ramp_contributions(
    size: int, step: Floats, slope: float, bend: float, first_part: float, second_part: float, added: Floats
) -> None:
    """Write the contributions of slope and bend of the ramp within a step to each state."""
    for k in range(size):
        linear = first_part * step[HELD, k] + second_part * step[HELD + 1, k] + step[HELD + 2, k]
        quadratic = first_part * step[HELD + 3, k] + second_part * step[HELD + 4, k] + step[HELD + 5, k]
        added[k] = slope * linear + bend * quadratic


@on_device
def free_step(
    size: int,
    pairs: Floats,
    held: Floats,
    step: Floats,
    ramp: tuple[float, float, float],
    first_part: float,
    second_part: float,
    added: Floats,
    y: Floats,
) -> None:
    """Advance states by a step without contact force, under both parts of the waveform and the offset."""
    level, slope, bend = ramp
    for k in range(0, size, 2):
        first, second = y[k], y[k + 1]
        for i in range(k, k + 2):
            constant = first_part * held[CONSTANT, i] + second_part * held[CONSTANT + 1, i] + held[CONSTANT + 2, i]
            y[i] = held[FIRST, i] * first + held[SECOND, i] * second + level * constant
    if slope != 0.0 or bend != 0.0:
        write_ramp_contributions(pairs.shape[1] * 2, step, slope, bend, first_part, second_part, added)
        for k in range(size):
            y[k] += added[k]


@on_device
def contact_output(size: int, pairs: Floats, row: int, states: Floats) -> float:
    """Return displacement (row X) or velocity (row V) of the contact."""
    total = 0.0
    for k in range(0, size, 2):
        total += pairs[row, k // 2] * states[k] + pairs[row + 1, k // 2] * states[k + 1]
    return total


@on_device
def collocate(
    kind: int,
    damped: bool,
    cells: Floats,
    settings: Floats,
    point: int,
    at_contact: Floats,
    past: int,
    free: Floats,
    forces_ahead: Floats,
) -> None:
    """Write the forces now and at the next four steps, consistent with the motion under them, by fixed-point sweeps."""
    load = settings[LOAD, point]
    force = contact_force(kind, damped, cells, settings, point, free[0, 0], free[1, 0]) - load
    for j in range(past):
        forces_ahead[j] = force
    for _ in range(SWEEPS):
        for i in range(past - 1):
            x, v = free[0, i + 1], free[1, i + 1]
            for j in range(past):
                x += at_contact[0, past * (i + 1) + j] * forces_ahead[j]
                v += at_contact[1, past * (i + 1) + j] * forces_ahead[j]
            forces_ahead[i + 1] = contact_force(kind, damped, cells, settings, point, x, v) - load


@on_device
def restart(
    size: int,
    kind: int,
    damped: bool,
    cells: Floats,
    settings: Floats,
    point: int,
    pairs: Floats,
    phases: Floats,
    backward: Floats,
    now: int,
    ramp_steps: float,
    cosine_shaped: bool,
    held: Floats,
    step: Floats,
    at_contact: Floats,
    y: Floats,
    forces: Floats,
    added: Floats,
    state: Floats,
    free: Floats,
    forces_ahead: Floats,
) -> None:
    """Replace the force history by the smooth continuation of the next four steps into the past; keep the state."""
    write_force_contributions(pairs.shape[1] * 2, step, forces, added)
    for k in range(size):
        y[k] += added[k]
        state[k] = y[k]
    for i in range(backward.shape[0]):
        free[0, i], free[1, i] = contact_output(size, pairs, X, state), contact_output(size, pairs, V, state)
        phase, ramp = (now + i) % phases.shape[1], ramp_parabola(now + i, ramp_steps, cosine_shaped)
        free_step(size, pairs, held, step, ramp, phases[FIRST_PART, phase], phases[SECOND_PART, phase], added, state)
    collocate(kind, damped, cells, settings, point, at_contact, backward.shape[0], free, forces_ahead)
    for j in range(PAST):
        forces[j] = 0.0
        for i in range(backward.shape[0]):
            forces[j] += backward[j, i] * forces_ahead[i]
    write_force_contributions(pairs.shape[1] * 2, step, forces, added)
    for k in range(size):
        y[k] -= added[k]
