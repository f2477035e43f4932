"""Time-marching kernel: the exponential integrator on SIMD lanes, one trajectory per lane.

All numbers of the lanes are in one flat array of rows, a row holding one number of every lane, so that a step is a
single loop over lanes that compiles to vector instructions. Integers that must be known at compile time, such as the
number of pairs of states, are passed as the lengths of tuples.
"""

from typing import Any, NamedTuple

import numpy as np

from sonolube.checks import Floats
from sonolube.execution.compilation import kernel
from sonolube.models.dynamics.kernels.contact_kernel import EXPONENTIAL, HERTZ, LINEAR, KernelLaw, log_force_at

LANES = 32
"""Trajectories marched side by side. []"""
STATISTICS = 8
"""Statistics of the contact: highest, lowest, sum, cosine and sine sum of x; sum, highest and lowest of F_n. []"""


class RowLayout(NamedTuple):
    """Index at which each group of rows starts in the flat array."""

    propagator: int
    oldest: int
    x_output: int
    v_output: int
    y: int
    state: int
    recent: int
    x_predictor: int
    v_predictor: int
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


@kernel(cache=True)
def row_layout(pairs: tuple[int, ...]) -> RowLayout:
    """Index at which each group of rows starts, in the order of the groups."""
    pair, fixed = 2 * len(pairs) * LANES, 12 * 2 * len(pairs) * LANES
    return RowLayout(
        0,  # propagator: state transition matrices, row by row of each pair
        2 * pair,  # oldest: contribution of the oldest force to the auxiliary state y
        3 * pair,  # x_output: displacement of the contact per state
        4 * pair,  # v_output: velocity of the contact per state
        5 * pair,  # y: auxiliary state, without the contributions of the recent forces
        6 * pair,  # state
        7 * pair,  # recent: contribution of each recent force to the state
        fixed,  # x_predictor: displacement one step ahead per recent force
        fixed + 5 * LANES,  # v_predictor: velocity one step ahead per recent force
        fixed + 10 * LANES,  # forces: recent forces less the load, newest first
        fixed + 15 * LANES,  # law: dead load, three numbers of the contact law, damping
        fixed + 20 * LANES,  # statistics
        fixed + 28 * LANES,  # x_free: displacements now and ahead without contact force
        fixed + 33 * LANES,  # v_free: velocities likewise
        fixed + 38 * LANES,  # forces_ahead: forces less the load, now and ahead
        fixed + 43 * LANES,  # x_ahead: displacements ahead per force
        fixed + 63 * LANES,  # v_ahead: velocities ahead per force
        fixed + 83 * LANES,  # mark: one where a lane restarts
        fixed + 84 * LANES,
    )


_FASTMATH = {"nsz"}  # no fused multiply-add, for the reason given in `sonolube.models.dynamics.kernels.simd`
_LARGEST_EXPONENT = 32.0
RAMP_EPSILON = 1e-200
"""Steps added to time and duration of a ramp, so that a ramp of no duration is complete at its start. []"""
SWEEPS = 8
"""Fixed-point iterations of a start without history; each reduces the error by the force's own feedback. []"""


@kernel(fastmath=_FASTMATH, error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)
def exponential(argument: float) -> float:
    """exp(argument) with a relative error of 1e-13, the argument clipped to -32 ... 32."""
    u = min(max(argument, -_LARGEST_EXPONENT), _LARGEST_EXPONENT) / 256
    uu = u * u
    power = (1 / 720 + u * (1 / 5040)) + uu * (1 / 40320 + u * (1 / 362880))
    power = (1.0 + u) + uu * ((1 / 2 + u * (1 / 6)) + uu * ((1 / 24 + u * (1 / 120)) + uu * power))
    for _ in range(8):
        power *= power
    return power


@kernel(fastmath=_FASTMATH, error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)
def _contact_force(law: KernelLaw, x: float, v: float, lanes: Floats, row: int) -> Any:
    """Contact force of one lane, in N; the rows of the law are those of `MarchingProblem.law_rows`."""
    load, first, second = lanes[row], lanes[row + LANES], lanes[row + 2 * LANES]
    if len(law.kind) == EXPONENTIAL:
        force = load * exponential(-x * first)
    elif len(law.kind) == HERTZ:
        approach = max(second - x, 0.0)
        force = first * approach * np.sqrt(approach)
    elif len(law.kind) == LINEAR:
        force = max(load - first * x, 0.0)
    else:
        force = load * exponential(log_force_at(law.cells, second + first * x)[0] - lanes[row + 3 * LANES])
    if len(law.damped):
        force *= max(1.0 - lanes[row + 4 * LANES] * v, 0.0)
    return force


@kernel(fastmath=_FASTMATH, error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)
def _step(pairs: tuple[int, ...], law: KernelLaw, lanes: Floats, drive: Floats, cosine: float, sine: float) -> None:
    """March all lanes by one step: predict the contact's motion, evaluate its force, update the statistics."""
    at = row_layout(pairs)
    for lane in range(LANES):
        forces, load, statistics = at.forces + lane, at.law + lane, at.statistics + lane
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
            x += lanes[at.x_output + one] * new_a + lanes[at.x_output + two] * new_b
            if len(law.damped):
                v += lanes[at.v_output + one] * new_a + lanes[at.v_output + two] * new_b
        p = at.x_predictor + lane
        from_forces = lanes[p] * newest + lanes[p + LANES] * second + lanes[p + 2 * LANES] * third
        x += from_forces + lanes[p + 3 * LANES] * fourth + lanes[p + 4 * LANES] * oldest
        if len(law.damped):
            p = at.v_predictor + lane
            from_forces = lanes[p] * newest + lanes[p + LANES] * second + lanes[p + 2 * LANES] * third
            v += from_forces + lanes[p + 3 * LANES] * fourth + lanes[p + 4 * LANES] * oldest
        force = _contact_force(law, x, v, lanes, load)
        lanes[forces + 4 * LANES], lanes[forces + 3 * LANES], lanes[forces + 2 * LANES] = fourth, third, second
        lanes[forces + LANES], lanes[forces] = newest, force - lanes[load]
        lanes[statistics] = max(lanes[statistics], x)
        lanes[statistics + LANES] = min(lanes[statistics + LANES], x)
        lanes[statistics + 2 * LANES] += x
        lanes[statistics + 3 * LANES] += cosine * x
        lanes[statistics + 4 * LANES] += sine * x
        lanes[statistics + 5 * LANES] += force
        if len(law.damped):  # otherwise the extremes of the force are those of the displacement
            lanes[statistics + 6 * LANES] = max(lanes[statistics + 6 * LANES], force)
            lanes[statistics + 7 * LANES] = min(lanes[statistics + 7 * LANES], force)


@kernel(fastmath=_FASTMATH, error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)
def _complete_state(pairs: tuple[int, ...], lanes: Floats) -> None:
    """Write the state from the auxiliary state y and the recent forces."""
    at = row_layout(pairs)
    for k in range(2 * len(pairs)):
        for lane in range(LANES):
            total = lanes[at.y + k * LANES + lane]
            for j in range(5):
                added = at.recent + (2 * len(pairs) * j + k) * LANES + lane
                total += lanes[added] * lanes[at.forces + j * LANES + lane]
            lanes[at.state + k * LANES + lane] = total


@kernel(fastmath=_FASTMATH, error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)
def _free_motion(pairs: tuple[int, ...], lanes: Floats, table: Floats, step: int) -> None:
    """Write the contact's motion now and at the next four steps without contact force; overwrites the state."""
    at, row = row_layout(pairs), 2 * len(pairs) * LANES
    for ahead in range(5):
        drive = table[(step + ahead) * row : (step + ahead + 1) * row]
        for lane in range(LANES):
            x, v = 0.0, 0.0
            for i in range(len(pairs)):
                one, two, e = 2 * i * LANES + lane, (2 * i + 1) * LANES + lane, at.propagator + 4 * i * LANES + lane
                a, b = lanes[at.state + one], lanes[at.state + two]
                x += lanes[at.x_output + one] * a + lanes[at.x_output + two] * b
                v += lanes[at.v_output + one] * a + lanes[at.v_output + two] * b
                if ahead < 4:
                    lanes[at.state + one] = lanes[e] * a + lanes[e + LANES] * b + drive[one]
                    lanes[at.state + two] = lanes[e + 2 * LANES] * a + lanes[e + 3 * LANES] * b + drive[two]
            lanes[at.x_free + ahead * LANES + lane], lanes[at.v_free + ahead * LANES + lane] = x, v


@kernel(fastmath=_FASTMATH, error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)
def _collocate(pairs: tuple[int, ...], law: KernelLaw, lanes: Floats) -> None:
    """Write the forces now and at the next four steps, consistent with the motion under them, by fixed-point sweeps."""
    at = row_layout(pairs)
    for lane in range(LANES):
        load = at.law + lane
        force = _contact_force(law, lanes[at.x_free + lane], lanes[at.v_free + lane], lanes, load)
        for j in range(5):
            lanes[at.forces_ahead + j * LANES + lane] = force - lanes[load]
    for _ in range(SWEEPS):
        for lane in range(LANES):
            load = at.law + lane
            for i in range(4):
                ahead = (i + 1) * LANES + lane
                x, v = lanes[at.x_free + ahead], lanes[at.v_free + ahead]
                for j in range(5):
                    force = lanes[at.forces_ahead + j * LANES + lane]
                    x += lanes[at.x_ahead + (5 * i + j) * LANES + lane] * force
                    if len(law.damped):
                        v += lanes[at.v_ahead + (5 * i + j) * LANES + lane] * force
                force = _contact_force(law, x, v, lanes, load)
                lanes[at.forces_ahead + ahead] = force - lanes[load]


@kernel(fastmath=_FASTMATH, error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)
def _restart(pairs: tuple[int, ...], law: KernelLaw, lanes: Floats, table: Floats, step: int, backward: Floats) -> None:
    """Replace the force history of marked lanes by the smooth continuation of the next four steps into the past.

    After a jump of the voltage the past forces no longer predict those to come. The state is unchanged.
    """
    at = row_layout(pairs)
    _complete_state(pairs, lanes)
    _free_motion(pairs, lanes, table, step)
    _collocate(pairs, law, lanes)
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


@kernel(fastmath=_FASTMATH, error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)
def _ramp_factors(factor: Floats, time: float, ramp_steps: Floats, cosine_shaped: bool) -> None:
    """Write the ramp factor of every lane at a time in steps."""
    for lane in range(LANES):
        factor[lane] = min((time + RAMP_EPSILON) / (ramp_steps[lane] + RAMP_EPSILON), 1.0)
    if cosine_shaped:
        for lane in range(LANES):
            factor[lane] = 0.5 - 0.5 * np.cos(np.pi * factor[lane])


@kernel(fastmath=_FASTMATH, error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)
def _combine_ramp(
    table: Floats, constant: Floats, linear: Floats, quadratic: Floats, level: Floats, slope: Floats, bend: Floats
) -> None:
    """Write the drive under a ramp level + slope s + bend s^2 within a step."""
    for lane in range(LANES):
        table[lane] = level[lane] * constant[lane] + slope[lane] * linear[lane] + bend[lane] * quadratic[lane]


@kernel(fastmath=_FASTMATH, error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)
def _tabulate_drive(
    drive: Floats, table: Floats, steps: int, states: int, first: int, ramp_steps: Floats, cosine_shaped: bool
) -> None:
    """Write the drive of the steps of a period and of four more, the ramp interpolated by a parabola in each step."""
    level, middle, end = np.empty(LANES), np.empty(LANES), np.empty(LANES)
    slope, bend = np.empty(LANES), np.empty(LANES)
    power = steps * states * LANES
    for step in range(steps + 4):
        _ramp_factors(level, first + step, ramp_steps, cosine_shaped)
        _ramp_factors(middle, first + step + 0.5, ramp_steps, cosine_shaped)
        _ramp_factors(end, first + step + 1.0, ramp_steps, cosine_shaped)
        for lane in range(LANES):
            slope[lane] = 4 * middle[lane] - 3 * level[lane] - end[lane]
            bend[lane] = 2 * (level[lane] - 2 * middle[lane] + end[lane])
        for k in range(states):
            target, source = (step * states + k) * LANES, (step % steps * states + k) * LANES
            _combine_ramp(
                table[target : target + LANES],
                drive[source : source + LANES],
                drive[source + power : source + power + LANES],
                drive[source + 2 * power : source + 2 * power + LANES],
                level,
                slope,
                bend,
            )


@kernel(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)
def _mark_restarts(lanes: Floats, mark: int, now: int, step: int, ramp_steps: Floats, jumps: Any) -> bool:
    """Mark the lanes that restart before a step: all at time 0 and at a jump, one where its ramp has just ended."""
    all_lanes = now == 0
    for jump in jumps:
        all_lanes = all_lanes or jump == step
    any_lane = all_lanes
    for lane in range(LANES):
        ended = all_lanes or now >= ramp_steps[lane] > now - 1
        lanes[mark + lane] = 1.0 if ended else 0.0
        any_lane = any_lane or ended
    return any_lane


@kernel(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)
def _reset_statistics(lanes: Floats, statistics: int) -> None:
    """Reset the statistics at the start of a window."""
    lanes[statistics : statistics + STATISTICS * LANES] = 0.0
    for highest in (0, 6):
        row = statistics + highest * LANES
        lanes[row : row + LANES], lanes[row + LANES : row + 2 * LANES] = -np.inf, np.inf


@kernel(no_cpython_wrapper=True, no_cfunc_wrapper=True)
def _copy(lanes: Floats, first: int, target: Floats) -> None:
    """Copy consecutive rows of the lanes in use."""
    for k in range(target.shape[0]):
        for lane in range(target.shape[1]):
            target[k, lane] = lanes[first + k * LANES + lane]


@kernel(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
def march_lanes(
    pairs: tuple[int, ...],
    law: KernelLaw,
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
    """March all lanes; write the statistics of each window, and the states of the last steps and of the last periods.

    `cells` has shape (n, 4). `statistics` has shape (windows, 8, lanes in use). `recorded` has shape (steps to record,
    2 n + 1, lanes in use). `strobed` has shape (periods to record, 2 n, lanes in use).
    """
    at = row_layout(pairs)
    first_ramp_end, last_ramp_end = ramp_steps.min(), ramp_steps.max()
    unrecorded, unstrobed = periods * steps - recorded.shape[0], periods - strobed.shape[0]
    row = 2 * len(pairs) * LANES  # size of one step in the table
    phases = 2 * np.pi * np.arange(1, steps + 1) / steps
    cosines, sines = np.cos(phases), np.sin(phases)
    for period in range(periods):
        first = period * steps
        if first <= last_ramp_end + steps or period == 0:
            _tabulate_drive(drive, table, steps, 2 * len(pairs), first, ramp_steps, cosine_shaped)
        if period % window == 0:
            _reset_statistics(lanes, at.statistics)
        for step in range(steps):
            now = first + step
            may_restart = now == 0 or first_ramp_end - 1 <= now <= last_ramp_end + 1 or jumps.size > 0
            if may_restart and _mark_restarts(lanes, at.mark, now, step, ramp_steps, jumps):
                _restart(pairs, law, lanes, table, step, backward)
            _step(pairs, law, lanes, table[step * row : (step + 1) * row], cosines[step], sines[step])
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
