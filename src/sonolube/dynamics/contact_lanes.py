"""Laws of contact on lanes: force, stiffness and damping of every point in a row at once."""

from typing import NamedTuple

import numba
import numpy as np

from sonolube.checks import Floats
from sonolube.dynamics.force_table import log_force_at
from sonolube.dynamics.gap_law import ExponentialGap, GapLaw, HertzGap, LinearGap, TabulatedGap
from sonolube.dynamics.lanes import INSIDE, LANES, exponentials
from sonolube.errors import InvalidInput

EXPONENTIAL, HERTZ, LINEAR, TABULATED = ExponentialGap.kind, HertzGap.kind, LinearGap.kind, TabulatedGap.kind
_NO_CELLS = np.empty((0, 4))


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


def resting_place(gap_law: GapLaw, load: Floats) -> Floats:
    """Return where the contact rests under a dead load: a sphere's approach, in m, or cells from a table's start."""
    if isinstance(gap_law, HertzGap):
        return np.asarray((load / gap_law.coefficient) ** (2 / 3))
    if isinstance(gap_law, TabulatedGap):
        return gap_law.rest_position(load)
    return np.zeros_like(load)


@numba.njit(**INSIDE)
def parallel(law: Law) -> bool:
    """Return whether the stiffness goes with the force, which is then as smooth as the motion."""
    return bool(law.kind == EXPONENTIAL and law.damping == 0.0)


@numba.njit(**INSIDE)
def contact_rows(
    law: Law,
    load: Floats,
    resting: Floats,
    x: Floats,
    v: Floats,
    force: Floats,
    slope: Floats,
    drag: Floats,
) -> None:
    """Write the force, its fall per displacement and its fall per velocity.

    Parameters
    ----------
    law : Law
    load, resting : ndarray, shape (lanes,)
        Dead load, in N, and `resting_place`.
    x, v : ndarray, shape (lanes,)
        Displacement, in m, and velocity, in m/s; the latter is not read without damping.
    force, slope, drag : ndarray, shape (lanes,)
        Results in N, N/m and N s/m; the last is scratch without damping.
    """
    if law.kind == EXPONENTIAL:
        rate = 1 / law.parameter
        for lane in range(LANES):
            slope[lane] = -x[lane] * rate
        exponentials(slope, force)
        for lane in range(LANES):
            force[lane] *= load[lane]
            slope[lane] = force[lane] * rate
    elif law.kind == HERTZ:
        for lane in range(LANES):
            approach = max(resting[lane] - x[lane], 0.0)
            slope[lane] = 1.5 * law.parameter * np.sqrt(approach)
            force[lane] = slope[lane] * approach / 1.5
    elif law.kind == TABULATED:
        _tabulated_rows(law, resting, x, force, slope, drag)
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
def _tabulated_rows(law: Law, resting: Floats, x: Floats, force: Floats, slope: Floats, change: Floats) -> None:
    for lane in range(LANES):
        slope[lane], change[lane] = log_force_at(law.cells, resting[lane] + law.parameter * x[lane])
    exponentials(slope, force)
    for lane in range(LANES):
        slope[lane] = -law.parameter * change[lane] * force[lane]
