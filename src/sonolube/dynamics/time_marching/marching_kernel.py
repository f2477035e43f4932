"""Marching of many points side by side: the compiled part.

Every point is a lane. What belongs to the lanes stands in one flat array of rows, a row holding one number of each
lane, so that a step is one loop over lanes that the compiler turns into vector instructions. Numbers that must be known
at compile time for that, such as how many pairs of states there are, travel as the lengths of tuples.
"""

from typing import Any, NamedTuple

import numba
import numpy as np

from sonolube.checks import Floats
from sonolube.dynamics.kernels.force_table import log_force_at

LANES = 32
STATISTICS = 8  # of the contact: highest, lowest, sum, cosine and sine sum of x; sum, highest and lowest of F_n
_MATHS = {"nsz"}  # as lanes.KERNEL, and for its reason
_LARGEST_EXPONENT = 32.0
INSTANT = 1e-200  # steps: a ramp without duration has ended when it starts
SWEEPS = 8  # by which a start without a past converges; each gains the feedback of the force over four steps


class Rows(NamedTuple):
    """Where each group of rows starts in the flat array."""

    propagator: int
    oldest: int
    x_seen: int
    v_seen: int
    y: int
    state: int
    recent: int
    x_foreseen: int
    v_foreseen: int
    forces: int
    law: int
    statistics: int
    x_free: int
    v_free: int
    forces_ahead: int
    x_ahead: int
    v_ahead: int
    mark: int
    end: int


@numba.njit(cache=True)
def rows(pairs: tuple[int, ...]) -> Rows:
    """Return where each group of rows starts, in the order in which the groups stand."""
    pair, fixed = 2 * len(pairs) * LANES, 12 * 2 * len(pairs) * LANES
    return Rows(
        0,  # propagator of y, row by row of each pair
        2 * pair,  # what the oldest force adds to y
        3 * pair,  # displacement of the contact per state
        4 * pair,  # its velocity per state
        5 * pair,  # y, the state less what recent forces add
        6 * pair,  # the state
        7 * pair,  # what each recent force adds to the state
        fixed,  # displacement ahead per recent force
        fixed + 5 * LANES,  # velocity ahead per recent force
        fixed + 10 * LANES,  # recent forces less the load, newest first
        fixed + 15 * LANES,  # contact law: load, three constants, damping
        fixed + 20 * LANES,  # statistics
        fixed + 28 * LANES,  # displacements now and ahead without contact
        fixed + 33 * LANES,  # velocities likewise
        fixed + 38 * LANES,  # forces less the load, now and ahead
        fixed + 43 * LANES,  # displacements ahead per force
        fixed + 63 * LANES,  # velocities ahead per force
        fixed + 83 * LANES,  # one where a lane starts anew
        fixed + 84 * LANES,
    )


@numba.njit(cache=True, fastmath=_MATHS, error_model="numpy")
def exponential(argument: float) -> float:
    """Return exp(argument) to 1e-13, the argument held between -32 and 32."""
    u = min(max(argument, -_LARGEST_EXPONENT), _LARGEST_EXPONENT) / 256
    uu = u * u
    power = (1 / 720 + u * (1 / 5040)) + uu * (1 / 40320 + u * (1 / 362880))
    power = (1.0 + u) + uu * ((1 / 2 + u * (1 / 6)) + uu * ((1 / 24 + u * (1 / 120)) + uu * power))
    power *= power
    power *= power
    power *= power
    power *= power
    power *= power
    power *= power
    power *= power
    power *= power
    return power


@numba.njit(cache=True, fastmath=_MATHS, error_model="numpy")
def _contact_force(
    kind: tuple[int, ...], damped: tuple[int, ...], cells: Floats, x: float, v: float, lanes: Floats, law: int
) -> Any:
    """Return F_n of one lane."""
    load, first, second = lanes[law], lanes[law + LANES], lanes[law + 2 * LANES]
    if len(kind) == 0:
        force = load * exponential(-x * first)
    elif len(kind) == 1:
        approach = max(second - x, 0.0)
        force = first * approach * np.sqrt(approach)
    elif len(kind) == 2:
        force = max(load - first * x, 0.0)
    else:
        force = load * exponential(log_force_at(cells, second + first * x)[0] - lanes[law + 3 * LANES])
    if len(damped):
        force *= max(1.0 - lanes[law + 4 * LANES] * v, 0.0)
    return force


@numba.njit(cache=True, fastmath=_MATHS, error_model="numpy")
def _step(
    pairs: tuple[int, ...],
    kind: tuple[int, ...],
    damped: tuple[int, ...],
    cells: Floats,
    lanes: Floats,
    drive: Floats,
    cosine: float,
    sine: float,
) -> None:
    at = rows(pairs)
    for lane in range(LANES):
        forces, law, statistics = at.forces + lane, at.law + lane, at.statistics + lane
        newest, second = lanes[forces], lanes[forces + LANES]
        third, fourth, oldest = lanes[forces + 2 * LANES], lanes[forces + 3 * LANES], lanes[forces + 4 * LANES]
        x, v = 0.0, 0.0
        for i in range(len(pairs)):
            one, two, e = 2 * i * LANES + lane, (2 * i + 1) * LANES + lane, at.propagator + 4 * i * LANES + lane
            a, b = lanes[at.y + one], lanes[at.y + two]
            new_a = lanes[e] * a + lanes[e + LANES] * b + lanes[at.oldest + one] * oldest + drive[one]
            new_b = lanes[e + 2 * LANES] * a + lanes[e + 3 * LANES] * b
            new_b += lanes[at.oldest + two] * oldest + drive[two]
            lanes[at.y + one], lanes[at.y + two] = new_a, new_b
            x += lanes[at.x_seen + one] * new_a + lanes[at.x_seen + two] * new_b
            if len(damped):
                v += lanes[at.v_seen + one] * new_a + lanes[at.v_seen + two] * new_b
        p = at.x_foreseen + lane
        held = lanes[p] * newest + lanes[p + LANES] * second + lanes[p + 2 * LANES] * third
        x += held + lanes[p + 3 * LANES] * fourth + lanes[p + 4 * LANES] * oldest
        if len(damped):
            p = at.v_foreseen + lane
            held = lanes[p] * newest + lanes[p + LANES] * second + lanes[p + 2 * LANES] * third
            v += held + lanes[p + 3 * LANES] * fourth + lanes[p + 4 * LANES] * oldest
        force = _contact_force(kind, damped, cells, x, v, lanes, law)
        lanes[forces + 4 * LANES], lanes[forces + 3 * LANES], lanes[forces + 2 * LANES] = fourth, third, second
        lanes[forces + LANES], lanes[forces] = newest, force - lanes[law]
        lanes[statistics] = max(lanes[statistics], x)
        lanes[statistics + LANES] = min(lanes[statistics + LANES], x)
        lanes[statistics + 2 * LANES] += x
        lanes[statistics + 3 * LANES] += cosine * x
        lanes[statistics + 4 * LANES] += sine * x
        lanes[statistics + 5 * LANES] += force
        if len(damped):  # otherwise the extremes of the force are those of the displacement
            lanes[statistics + 6 * LANES] = max(lanes[statistics + 6 * LANES], force)
            lanes[statistics + 7 * LANES] = min(lanes[statistics + 7 * LANES], force)


@numba.njit(cache=True, fastmath=_MATHS, error_model="numpy")
def _complete_state(pairs: tuple[int, ...], lanes: Floats) -> None:
    """Make the state of y and the recent forces."""
    at = rows(pairs)
    for k in range(2 * len(pairs)):
        for lane in range(LANES):
            total = lanes[at.y + k * LANES + lane]
            for j in range(5):
                added = at.recent + (2 * len(pairs) * j + k) * LANES + lane
                total += lanes[added] * lanes[at.forces + j * LANES + lane]
            lanes[at.state + k * LANES + lane] = total


@numba.njit(cache=True, fastmath=_MATHS, error_model="numpy")
def _move_freely(pairs: tuple[int, ...], lanes: Floats, table: Floats, step: int) -> None:
    """Write the contact's motion now and at the next four steps without a contact force; uses up the state."""
    at, row = rows(pairs), 2 * len(pairs) * LANES
    for ahead in range(5):
        drive = table[(step + ahead) * row : (step + ahead + 1) * row]
        for lane in range(LANES):
            x, v = 0.0, 0.0
            for i in range(len(pairs)):
                one, two, e = 2 * i * LANES + lane, (2 * i + 1) * LANES + lane, at.propagator + 4 * i * LANES + lane
                a, b = lanes[at.state + one], lanes[at.state + two]
                x += lanes[at.x_seen + one] * a + lanes[at.x_seen + two] * b
                v += lanes[at.v_seen + one] * a + lanes[at.v_seen + two] * b
                if ahead < 4:
                    lanes[at.state + one] = lanes[e] * a + lanes[e + LANES] * b + drive[one]
                    lanes[at.state + two] = lanes[e + 2 * LANES] * a + lanes[e + 3 * LANES] * b + drive[two]
            lanes[at.x_free + ahead * LANES + lane], lanes[at.v_free + ahead * LANES + lane] = x, v


@numba.njit(cache=True, fastmath=_MATHS, error_model="numpy")
def _collocate(
    pairs: tuple[int, ...], kind: tuple[int, ...], damped: tuple[int, ...], cells: Floats, lanes: Floats
) -> None:
    """Write the forces now and at the next four steps, each by the motion that all of them bring about."""
    at = rows(pairs)
    for lane in range(LANES):
        law = at.law + lane
        force = _contact_force(kind, damped, cells, lanes[at.x_free + lane], lanes[at.v_free + lane], lanes, law)
        for j in range(5):
            lanes[at.forces_ahead + j * LANES + lane] = force - lanes[law]
    for _ in range(SWEEPS):
        for lane in range(LANES):
            law = at.law + lane
            for i in range(4):
                ahead = (i + 1) * LANES + lane
                x, v = lanes[at.x_free + ahead], lanes[at.v_free + ahead]
                for j in range(5):
                    force = lanes[at.forces_ahead + j * LANES + lane]
                    x += lanes[at.x_ahead + (5 * i + j) * LANES + lane] * force
                    if len(damped):
                        v += lanes[at.v_ahead + (5 * i + j) * LANES + lane] * force
                force = _contact_force(kind, damped, cells, x, v, lanes, law)
                lanes[at.forces_ahead + ahead] = force - lanes[law]


@numba.njit(cache=True, fastmath=_MATHS, error_model="numpy")
def _start(
    pairs: tuple[int, ...],
    kind: tuple[int, ...],
    damped: tuple[int, ...],
    cells: Floats,
    lanes: Floats,
    table: Floats,
    step: int,
    backward: Floats,
) -> None:
    """Replace the past of marked lanes by one that continues the forces of the next four steps.

    After a jump of the voltage the forces so far no longer foretell those to come; the state is not touched.
    """
    at = rows(pairs)
    _complete_state(pairs, lanes)
    _move_freely(pairs, lanes, table, step)
    _collocate(pairs, kind, damped, cells, lanes)
    for j in range(5):
        for lane in range(LANES):
            past = 0.0
            for i in range(5):
                past += backward[5 * j + i] * lanes[at.forces_ahead + i * LANES + lane]
            change = lanes[at.mark + lane] * (past - lanes[at.forces + j * LANES + lane])
            lanes[at.forces + j * LANES + lane] += change
            for k in range(2 * len(pairs)):
                added = at.recent + (2 * len(pairs) * j + k) * LANES + lane
                lanes[at.y + k * LANES + lane] -= lanes[added] * change


@numba.njit(cache=True, fastmath=_MATHS, error_model="numpy")
def _ramp(share: Floats, time: float, ramp_steps: Floats, cosine_shaped: bool) -> None:
    for lane in range(LANES):
        share[lane] = min((time + INSTANT) / (ramp_steps[lane] + INSTANT), 1.0)
    if cosine_shaped:
        for lane in range(LANES):
            share[lane] = 0.5 - 0.5 * np.cos(np.pi * share[lane])


@numba.njit(cache=True, fastmath=_MATHS, error_model="numpy")
def _combine(
    table: Floats, steady: Floats, sloping: Floats, bending: Floats, level: Floats, slope: Floats, bend: Floats
) -> None:
    for lane in range(LANES):
        table[lane] = level[lane] * steady[lane] + slope[lane] * sloping[lane] + bend[lane] * bending[lane]


@numba.njit(cache=True, fastmath=_MATHS, error_model="numpy")
def _tabulate(
    drive: Floats, table: Floats, steps: int, states: int, first: int, ramp_steps: Floats, cosine_shaped: bool
) -> None:
    """Write the drive of a period's steps and of four more, under the ramp, which is a parabola within each step."""
    level, middle, end = np.empty(LANES), np.empty(LANES), np.empty(LANES)
    slope, bend = np.empty(LANES), np.empty(LANES)
    power = steps * states * LANES
    for step in range(steps + 4):
        _ramp(level, first + step, ramp_steps, cosine_shaped)
        _ramp(middle, first + step + 0.5, ramp_steps, cosine_shaped)
        _ramp(end, first + step + 1.0, ramp_steps, cosine_shaped)
        for lane in range(LANES):
            slope[lane] = 4 * middle[lane] - 3 * level[lane] - end[lane]
            bend[lane] = 2 * (level[lane] - 2 * middle[lane] + end[lane])
        for k in range(states):
            target, source = (step * states + k) * LANES, (step % steps * states + k) * LANES
            _combine(
                table[target : target + LANES],
                drive[source : source + LANES],
                drive[source + power : source + power + LANES],
                drive[source + 2 * power : source + 2 * power + LANES],
                level,
                slope,
                bend,
            )


@numba.njit(cache=True, error_model="numpy")
def _mark(lanes: Floats, mark: int, now: int, step: int, ramp_steps: Floats, jumps: Any) -> bool:
    """Mark the lanes that start anew before a step: all at time 0 and at a jump, one where its ramp has ended."""
    everyone = now == 0
    for jump in jumps:
        everyone = everyone or jump == step
    someone = everyone
    for lane in range(LANES):
        ended = everyone or now >= ramp_steps[lane] > now - 1
        lanes[mark + lane] = 1.0 if ended else 0.0
        someone = someone or ended
    return someone


@numba.njit(cache=True, error_model="numpy")
def _forget(lanes: Floats, statistics: int) -> None:
    lanes[statistics : statistics + STATISTICS * LANES] = 0.0
    for highest in (0, 6):
        row = statistics + highest * LANES
        lanes[row : row + LANES], lanes[row + LANES : row + 2 * LANES] = -np.inf, np.inf


@numba.njit(cache=True)
def _copy(lanes: Floats, first: int, target: Floats) -> None:
    for k in range(target.shape[0]):
        for lane in range(target.shape[1]):
            target[k, lane] = lanes[first + k * LANES + lane]


@numba.njit(cache=True, nogil=True, error_model="numpy")
def march_lanes(
    pairs: tuple[int, ...],
    kind: tuple[int, ...],
    damped: tuple[int, ...],
    cells: Floats,
    lanes: Floats,
    drive: Floats,
    table: Floats,
    ramp_steps: Floats,
    cosine_shaped: bool,
    backward: Floats,
    jumps: Any,
    steps: int,
    periods: int,
    window: int,
    statistics: Floats,
    recorded: Floats,
    strobed: Floats,
) -> None:
    """March all lanes, and write the statistics of each window, the states of the last steps and of the last periods.

    Parameters
    ----------
    pairs, kind, damped : tuple of int
        Known by their lengths: number of pairs of states; contact law; whether it is damped.
    cells : ndarray, shape (n, 4)
        Table of a tabulated law, empty for any other.
    lanes : ndarray
        Rows of lanes, `rows` says which; on return the state stands among them.
    drive : ndarray
        Drive of each step for ramps of 1, s and s^2.
    table : ndarray
        Room for the drive of one period and four steps.
    ramp_steps : ndarray
        Duration of the ramp of each lane, in steps.
    cosine_shaped : bool
        Shape of the ramp.
    backward : ndarray
        Past that continues the forces now and at the next four steps.
    jumps : ndarray of int
        Steps of a period before which the voltage jumps.
    steps, periods, window : int
        Steps a period, periods to march, periods to a window of the statistics.
    statistics : ndarray, shape (windows, 8, lanes in use)
    recorded : ndarray, shape (steps to record, 2 n + 1, lanes in use)
        States, then the contact force less the load.
    strobed : ndarray, shape (periods to record, 2 n, lanes in use)
    """
    at = rows(pairs)
    first_end, last_end = ramp_steps.min(), ramp_steps.max()  # the first and the last end of a ramp
    unrecorded, unstrobed = periods * steps - recorded.shape[0], periods - strobed.shape[0]
    row = 2 * len(pairs) * LANES  # of the table: what it holds for one step
    phases = 2 * np.pi * np.arange(1, steps + 1) / steps
    cosines, sines = np.cos(phases), np.sin(phases)
    for period in range(periods):
        first = period * steps
        if first <= last_end + steps or period == 0:
            _tabulate(drive, table, steps, 2 * len(pairs), first, ramp_steps, cosine_shaped)
        if period % window == 0:
            _forget(lanes, at.statistics)
        for step in range(steps):
            now = first + step
            may_start = now == 0 or first_end - 1 <= now <= last_end + 1 or jumps.size > 0
            if may_start and _mark(lanes, at.mark, now, step, ramp_steps, jumps):
                _start(pairs, kind, damped, cells, lanes, table, step, backward)
            _step(pairs, kind, damped, cells, lanes, table[step * row : (step + 1) * row], cosines[step], sines[step])
            if now >= unrecorded:
                _complete_state(pairs, lanes)
                _copy(lanes, at.state, recorded[now - unrecorded, :-1])
                _copy(lanes, at.forces, recorded[now - unrecorded, -1:])
        if period >= unstrobed:
            _complete_state(pairs, lanes)
            _copy(lanes, at.state, strobed[period - unstrobed])
        if (period + 1) % window == 0 or period == periods - 1:
            _copy(lanes, at.statistics, statistics[period // window])
    _complete_state(pairs, lanes)
