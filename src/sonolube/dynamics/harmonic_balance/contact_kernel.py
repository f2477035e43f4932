"""Laws of contact on lanes: force, stiffness and damping of every point in a row at once."""

from typing import NamedTuple

import numba
import numpy as np

from sonolube.checks import Floats
from sonolube.dynamics.gap_law import ExponentialGap, GapLaw, HertzGap, LinearGap, TabulatedGap
from sonolube.dynamics.kernels.force_table import log_force_at
from sonolube.dynamics.kernels.simd import INSIDE, LANES, exponentials
from sonolube.errors import InvalidInput

EXPONENTIAL, HERTZ, LINEAR, TABULATED = ExponentialGap.kind, HertzGap.kind, LinearGap.kind, TabulatedGap.kind
_NO_CELLS = np.empty((0, 4))

Choice = tuple[int, ...]
"""A number that a kernel is compiled for: the length of a tuple."""


class Law(NamedTuple):
    """A gap law as the kernels see it: its one parameter, its damping and its table, if it has one."""

    parameter: float
    damping: float
    cells: Floats


class Compiled(NamedTuple):
    """What kernels are compiled for, so that nobody waits for the compiling of laws that are not used."""

    kind: Choice  # EXPONENTIAL to TABULATED
    damped: Choice  # whether there is damping


def law_of(gap_law: GapLaw) -> tuple[Compiled, Law]:
    """Return the gap law as the kernels see it."""
    cells = _NO_CELLS
    if isinstance(gap_law, ExponentialGap):
        parameter = gap_law.decay_length
    elif isinstance(gap_law, HertzGap):
        parameter = gap_law.coefficient
    elif isinstance(gap_law, LinearGap):
        parameter = gap_law.normal_stiffness
    elif isinstance(gap_law, TabulatedGap):
        parameter, cells = gap_law.cells_per_length, gap_law.cells
    else:
        raise InvalidInput(f"gap_law must be one of the laws of sonolube.dynamics.gap_law, got {gap_law!r}")
    chosen = Compiled((0,) * gap_law.kind, (0,) * (gap_law.force_damping > 0))
    return chosen, Law(parameter, gap_law.force_damping, cells)


def equilibrium_displacement(gap_law: GapLaw, load: Floats) -> Floats:
    """Return where the contact rests under a dead load: a sphere's approach, in m, or cells from a table's start."""
    if isinstance(gap_law, HertzGap):
        return np.asarray((load / gap_law.coefficient) ** (2 / 3))
    if isinstance(gap_law, TabulatedGap):
        return gap_law.rest_position(load)
    return np.zeros_like(load)


@numba.njit(**INSIDE)
def parallel(kind: Choice, damped: Choice) -> bool:
    """Return whether the stiffness goes with the force, which is then as smooth as the motion."""
    return len(kind) == EXPONENTIAL and len(damped) == 0


@numba.njit(**INSIDE)
def differentiate(damped: Choice, motion: Floats, h: int, velocity: Floats) -> None:
    """Write the velocity over omega of a motion of h harmonics, rows as of the motion, where damping wants it."""
    if len(damped) == 1:
        for k in range(1, h + 1):
            for lane in range(LANES):
                velocity[2 * k - 1, lane] = -k * motion[2 * k, lane]
                velocity[2 * k, lane] = k * motion[2 * k - 1, lane]


@numba.njit(**INSIDE)
def contact_rows(
    kind: Choice, damped: Choice, law: Law, load: Floats, resting: Floats, x: Floats, v: Floats, results: Floats
) -> None:
    """Write the force, its fall per displacement and its fall per velocity.

    Parameters
    ----------
    kind, damped : tuple
        As of `Compiled`.
    law : Law
    load, resting : ndarray, shape (lanes,)
        Dead load, in N, and `equilibrium_displacement`.
    x, v : ndarray, shape (lanes,)
        Displacement, in m, and velocity, in m/s; the latter is not read without damping.
    results : ndarray, shape (3, lanes)
        In N, N/m and N s/m; the last is scratch without damping.
    """
    force, slope, drag = results[0], results[1], results[2]
    if len(kind) == EXPONENTIAL:
        for lane in range(LANES):
            slope[lane] = -x[lane] / law.parameter
        exponentials(slope, force)
        for lane in range(LANES):
            force[lane] *= load[lane]
            slope[lane] = force[lane] / law.parameter
    elif len(kind) == HERTZ:
        for lane in range(LANES):
            approach = max(resting[lane] - x[lane], 0.0)
            slope[lane] = 1.5 * law.parameter * np.sqrt(approach)
            force[lane] = slope[lane] * approach / 1.5
    elif len(kind) == TABULATED:
        _tabulated_rows(law, resting, x, force, slope, drag)
    else:
        for lane in range(LANES):
            touching = load[lane] - law.parameter * x[lane]
            force[lane] = max(touching, 0.0)
            slope[lane] = law.parameter if touching > 0 else 0.0
    if len(damped) == 1:
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
