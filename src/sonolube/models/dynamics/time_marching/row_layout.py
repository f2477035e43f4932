"""Layout of the flat array of rows in which the time-marching kernel keeps a set of SIMD lanes."""

from typing import NamedTuple

from sonolube.execution.compilation import kernel

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
