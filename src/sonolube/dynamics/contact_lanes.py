"""Laws of contact on lanes: force, stiffness and damping of every point in a row at once."""

from typing import NamedTuple

import numba
import numpy as np

from sonolube.checks import Floats
from sonolube.dynamics.force_table import log_force_at, position_of
from sonolube.dynamics.gap_law import ExponentialGap, GapLaw, HertzGap, LinearGap, TabulatedGap
from sonolube.dynamics.lanes import INSIDE, KERNEL, LANES, exponentials
from sonolube.errors import InvalidInput

EXPONENTIAL, HERTZ, LINEAR, TABULATED = ExponentialGap.kind, HertzGap.kind, LinearGap.kind, TabulatedGap.kind
_NO_CELLS = np.empty((0, 4))
LOST = 0.01  # share of the dead load below which contact counts as lost


class Law(NamedTuple):
    """A gap law as the kernels see it: which one, its one parameter, its damping and its table, if it has one."""

    kind: int
    parameter: float
    damping: float
    cells: Floats


def law_of(gap_law: GapLaw) -> Law:
    """Return the gap law as the kernels see it."""
    if isinstance(gap_law, ExponentialGap):
        return Law(EXPONENTIAL, gap_law.decay_length, gap_law.force_damping, _NO_CELLS)
    if isinstance(gap_law, HertzGap):
        return Law(HERTZ, gap_law.coefficient, gap_law.force_damping, _NO_CELLS)
    if isinstance(gap_law, LinearGap):
        return Law(LINEAR, gap_law.normal_stiffness, gap_law.force_damping, _NO_CELLS)
    if isinstance(gap_law, TabulatedGap):
        return Law(TABULATED, gap_law.cells_per_length, gap_law.force_damping, gap_law.cells)
    raise InvalidInput(f"gap_law must be one of the laws of sonolube.dynamics.gap_law, got {gap_law!r}")


@numba.njit(**INSIDE)
def parallel(law: Law) -> bool:
    """Return whether the stiffness goes with the force, which is then as smooth as the motion."""
    return bool(law.kind == EXPONENTIAL and law.damping == 0.0)


@numba.njit(**INSIDE)
def rest(law: Law, load: float) -> float:
    """Return where the contact rests under a dead load: a sphere's approach, in m, or cells from a table's start."""
    if law.kind == HERTZ:
        return float((load / law.parameter) ** (2 / 3))
    if law.kind == TABULATED:
        return float(position_of(law.cells, np.log(load)))
    return 0.0


@numba.njit(**KERNEL)
def reach(law: Law, load: float) -> float:
    """Return the length over which the contact changes under a dead load, in m."""
    if law.kind == EXPONENTIAL:
        return law.parameter
    if law.kind == HERTZ:
        return float(rest(law, load))
    if law.kind == TABULATED:
        return float(-1 / (law.parameter * log_force_at(law.cells, rest(law, load))[1]))
    return load / law.parameter


@numba.njit(**INSIDE)
def loss_displacement(law: Law, load: float) -> float:
    """Return the displacement beyond which contact counts as lost, in m."""
    if law.kind == EXPONENTIAL:
        return float(-law.parameter * np.log(LOST))
    if law.kind == HERTZ:
        return float(rest(law, load) * (1 - LOST ** (2 / 3)))
    if law.kind == TABULATED:
        return float((position_of(law.cells, np.log(LOST * load)) - rest(law, load)) / law.parameter)
    return (1 - LOST) * load / law.parameter


@numba.njit(**INSIDE)
def contact_rows(
    law: Law,
    load: Floats,
    resting: Floats,
    x: Floats,
    v: Floats,
    work: Floats,
    force: Floats,
    slope: Floats,
    drag: Floats,
) -> None:
    """Write the force, its fall per displacement and its fall per velocity.

    Parameters
    ----------
    law : Law
    load, resting : ndarray, shape (lanes,)
        Dead load, in N, and `rest`.
    x, v : ndarray, shape (lanes,)
        Displacement, in m, and velocity, in m/s; the latter is not read without damping.
    work : ndarray, shape (lanes,)
        Scratch.
    force, slope, drag : ndarray, shape (lanes,)
        Results in N, N/m and N s/m; the last is scratch without damping.
    """
    if law.kind == EXPONENTIAL:
        rate = 1 / law.parameter
        for lane in range(LANES):
            slope[lane] = -x[lane] * rate
        exponentials(slope, force, work)
        for lane in range(LANES):
            force[lane] *= load[lane]
            slope[lane] = force[lane] * rate
    elif law.kind == HERTZ:
        for lane in range(LANES):
            approach = max(resting[lane] - x[lane], 0.0)
            slope[lane] = 1.5 * law.parameter * np.sqrt(approach)
            force[lane] = slope[lane] * approach / 1.5
    elif law.kind == TABULATED:
        _tabulated_rows(law, resting, x, work, force, slope, drag)
    else:
        for lane in range(LANES):
            touching = load[lane] - law.parameter * x[lane]
            force[lane] = max(touching, 0.0)
            slope[lane] = law.parameter if touching > 0 else 0.0
    if law.damping > 0:
        for lane in range(LANES):
            share = 1 - law.damping * v[lane]
            drag[lane] = law.damping * force[lane] if share > 0 else 0.0
            share = max(share, 0.0)
            force[lane] *= share
            slope[lane] *= share


@numba.njit(**INSIDE)
def _tabulated_rows(
    law: Law, resting: Floats, x: Floats, work: Floats, force: Floats, slope: Floats, change: Floats
) -> None:
    for lane in range(LANES):
        slope[lane], change[lane] = log_force_at(law.cells, resting[lane] + law.parameter * x[lane])
    exponentials(slope, force, work)
    for lane in range(LANES):
        slope[lane] = -law.parameter * change[lane] * force[lane]
