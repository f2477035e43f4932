"""Laws of contact on lanes: force, stiffness and damping of every point in a row at once."""

from typing import NamedTuple

import numba
import numpy as np

from sonolube.checks import Floats
from sonolube.dynamics.gap_law import ExponentialGap, GapLaw, HertzGap, LinearGap
from sonolube.dynamics.lanes import INSIDE, KERNEL, LANES, exponentials
from sonolube.errors import InvalidInput

EXPONENTIAL, HERTZ, LINEAR = ExponentialGap.kind, HertzGap.kind, LinearGap.kind
LOST = 0.01  # share of the dead load below which contact counts as lost


class Law(NamedTuple):
    """A gap law as the kernels see it: which one, its one parameter and its damping."""

    kind: int
    parameter: float
    damping: float


def law_of(gap_law: GapLaw) -> Law:
    """Return the gap law as the kernels see it."""
    if isinstance(gap_law, ExponentialGap):
        return Law(EXPONENTIAL, gap_law.decay_length, gap_law.force_damping)
    if isinstance(gap_law, HertzGap):
        return Law(HERTZ, gap_law.coefficient, gap_law.force_damping)
    if isinstance(gap_law, LinearGap):
        return Law(LINEAR, gap_law.normal_stiffness, gap_law.force_damping)
    raise InvalidInput(f"gap_law must be one of the laws of sonolube.dynamics.gap_law, got {gap_law!r}")


@numba.njit(**KERNEL)
def reach(law: Law, load: float) -> float:
    """Return the length over which the contact changes under a dead load, in m."""
    if law.kind == EXPONENTIAL:
        return law.parameter
    if law.kind == HERTZ:
        return float((load / law.parameter) ** (2 / 3))
    return load / law.parameter


@numba.njit(**INSIDE)
def loss_displacement(law: Law, load: float) -> float:
    """Return the displacement beyond which contact counts as lost, in m."""
    if law.kind == EXPONENTIAL:
        return float(-law.parameter * np.log(LOST))
    if law.kind == HERTZ:
        return float((load / law.parameter) ** (2 / 3) * (1 - LOST ** (2 / 3)))
    return (1 - LOST) * load / law.parameter


@numba.njit(**INSIDE)
def contact_rows(
    law: Law,
    load: Floats,
    length: Floats,
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
    load, length : ndarray, shape (lanes,)
        Dead load, in N, and `reach`, in m.
    x, v : ndarray, shape (lanes,)
        Displacement, in m, and velocity, in m/s; the latter is not read without damping.
    work : ndarray, shape (lanes,)
        Scratch.
    force, slope, drag : ndarray, shape (lanes,)
        Results in N, N/m and N s/m; the last is not written without damping.
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
            approach = max(length[lane] - x[lane], 0.0)
            slope[lane] = 1.5 * law.parameter * np.sqrt(approach)
            force[lane] = slope[lane] * approach / 1.5
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
