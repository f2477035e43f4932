"""Steps of one trajectory and its starts without a past, by a thread; the method is `dynamics.marching_kernel`'s.

Loops over what every step needs run to numbers known when the kernel is compiled: these arrays become registers.
Loops over the rest run to the extent of an array, lest they be unrolled and crowd the registers too.
"""

import math

from sonolube.checks import Floats
from sonolube.dynamics.gpu.device import on_device
from sonolube.dynamics.gpu.step_matrices import FIRST, FIRST_PART, HELD, RECENT, SECOND, SECOND_PART, STEADY, V, X
from sonolube.dynamics.time_marching.integrator import PAST
from sonolube.dynamics.time_marching.marching_kernel import INSTANT, SWEEPS, exponential

FREQUENCY, SWING, OFFSET, LOAD = 0, 1, 2, 3
"""Rows of the settings of a point; after the load come three constants of the contact law and its damping. []"""

power_of_e = on_device(exponential.py_func)


@on_device
def log_force_at(cells: Floats, position: float) -> float:
    """Return the logarithm of the force by a table, as `sonolube.dynamics.kernels.force_table` does."""
    at, last = 0, cells.shape[0] - 1
    if position >= last - 1:
        at = last
    elif position >= 0.0:  # neither where it is not a number
        at = int(math.floor(position)) + 1  # noqa: RUF046 - a GPU rounds to a float
    u = position - (at - 1)
    value: float = cells[at, 0] + u * (cells[at, 1] + u * (cells[at, 2] + u * cells[at, 3]))
    return value


@on_device
def contact_force(kind: int, damped: bool, cells: Floats, settings: Floats, point: int, x: float, v: float) -> float:
    """Return the contact force of an instant."""
    load, first, second = settings[LOAD, point], settings[LOAD + 1, point], settings[LOAD + 2, point]
    force: float
    if kind == 0:
        force = load * power_of_e(-x * first)
    elif kind == 1:
        approach = max(second - x, 0.0)
        force = first * approach * math.sqrt(approach)
    elif kind == 2:
        force = max(load - first * x, 0.0)
    else:
        force = load * power_of_e(log_force_at(cells, second + first * x) - settings[LOAD + 3, point])
    if damped:
        force *= max(1.0 - settings[LOAD + 4, point] * v, 0.0)
    return force


@on_device
def ramp_share(time: float, ramp_steps: float, cosine_shaped: bool) -> float:
    """Return the share of the full drive at a time, in steps."""
    share = min((time + INSTANT) / (ramp_steps + INSTANT), 1.0)
    return 0.5 - 0.5 * math.cos(math.pi * share) if cosine_shaped else share


@on_device
def ramp_parabola(now: int, ramp_steps: float, cosine_shaped: bool) -> tuple[float, float, float]:
    """Return the ramp within a step as level + slope s + bend s^2."""
    if now > ramp_steps:
        return 1.0, 0.0, 0.0
    level = ramp_share(now, ramp_steps, cosine_shaped)
    middle = ramp_share(now + 0.5, ramp_steps, cosine_shaped)
    end = ramp_share(now + 1.0, ramp_steps, cosine_shaped)
    return level, 4 * middle - 3 * level - end, 2 * (level - 2 * middle + end)


@on_device
def write_recent(size: int, step: Floats, forces: Floats, added: Floats) -> None:
    """Write what recent forces add to each state."""
    for k in range(size):
        total = 0.0
        for j in range(PAST):
            total += step[RECENT + j, k] * forces[j]
        added[k] = total


@on_device
def write_ramped(size: int, step: Floats, slope: float, bend: float, one: float, other: float, added: Floats) -> None:
    """Write what the drive adds to each state for the slope and the bend of its ramp within a step."""
    for k in range(size):
        sloping = one * step[HELD, k] + other * step[HELD + 1, k] + step[HELD + 2, k]
        bending = one * step[HELD + 3, k] + other * step[HELD + 4, k] + step[HELD + 5, k]
        added[k] = slope * sloping + bend * bending


@on_device
def move(
    size: int,
    pairs: Floats,
    held: Floats,
    step: Floats,
    ramp: tuple[float, float, float],
    one: float,
    other: float,
    added: Floats,
    y: Floats,
) -> None:
    """Move states by a step of the free structure under two parts of the waveform and the offset."""
    level, slope, bend = ramp
    for k in range(0, size, 2):
        first, second = y[k], y[k + 1]
        for i in range(k, k + 2):
            steady = one * held[STEADY, i] + other * held[STEADY + 1, i] + held[STEADY + 2, i]
            y[i] = held[FIRST, i] * first + held[SECOND, i] * second + level * steady
    if slope != 0.0 or bend != 0.0:
        write_ramped(pairs.shape[1] * 2, step, slope, bend, one, other, added)
        for k in range(size):
            y[k] += added[k]


@on_device
def seen(size: int, pairs: Floats, row: int, states: Floats) -> float:
    """Return displacement or velocity of the contact."""
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
    """Write the forces now and at the next four steps, each by the motion that all of them bring about."""
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
def start_anew(
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
    """Replace the past by one that continues the forces of the next four steps; the state is not touched."""
    write_recent(pairs.shape[1] * 2, step, forces, added)
    for k in range(size):
        y[k] += added[k]
        state[k] = y[k]
    for i in range(backward.shape[0]):
        free[0, i], free[1, i] = seen(size, pairs, X, state), seen(size, pairs, V, state)
        phase, ramp = (now + i) % phases.shape[1], ramp_parabola(now + i, ramp_steps, cosine_shaped)
        move(size, pairs, held, step, ramp, phases[FIRST_PART, phase], phases[SECOND_PART, phase], added, state)
    collocate(kind, damped, cells, settings, point, at_contact, backward.shape[0], free, forces_ahead)
    for j in range(PAST):
        forces[j] = 0.0
        for i in range(backward.shape[0]):
            forces[j] += backward[j, i] * forces_ahead[i]
    write_recent(pairs.shape[1] * 2, step, forces, added)
    for k in range(size):
        y[k] -= added[k]
