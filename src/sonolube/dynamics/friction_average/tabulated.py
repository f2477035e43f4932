"""Means of the friction of motions that turn more than twice, cell by cell."""

import numba
import numpy as np

from sonolube.checks import Complexes, Floats, Integers
from sonolube.dynamics.friction_average.kernel import LOAD, MEAN, OMEGA, RESTING
from sonolube.dynamics.gap_law import LARGEST_EXPONENT
from sonolube.dynamics.harmonic_balance.contact_kernel import EXPONENTIAL, HERTZ, TABULATED, Choice, Law
from sonolube.dynamics.kernels.force_table import log_force_at
from sonolube.dynamics.kernels.simd import ALLOCATING, INSIDE

_CELLS, _FEWEST_CELLS = 256, 4096  # per harmonic, and at least


@numba.njit(**ALLOCATING)
def sliding_means_by_cells(
    kind: Choice,
    damped: Choice,
    law: Law,
    given: Floats,
    harmonics: Complexes,
    count: Integers,
    chosen: Integers,
    speeds: Floats,
    means: Floats,
) -> None:
    """Write what `sliding_means` writes, for any number of turns: exact for a linear velocity between samples.

    Parameters
    ----------
    kind, damped, law, given, count, chosen, speeds, means
        As in `sliding_means`.
    harmonics : ndarray of complex, shape (p, room)
    """
    rapidity = np.empty(speeds.size)
    for point in chosen:
        own = harmonics[point, : count[point]]
        means[:, point] = 0.0
        omega, load, mean, resting = given[point, OMEGA], given[point, LOAD], given[point, MEAN], given[point, RESTING]
        _by_cells(
            kind, damped, law, omega, load, resting, mean, own, speeds, rapidity, means[0, point], means[1, point]
        )


@numba.njit(**INSIDE)
def _by_cells(
    kind: Choice,
    damped: Choice,
    law: Law,
    omega: float,
    load: float,
    resting: float,
    mean: float,
    own: Complexes,
    speeds: Floats,
    last_rapidity: Floats,
    kinematic: Floats,
    loaded: Floats,
) -> None:
    """Integrate over cells in which the velocity is linear, exactly."""
    cells = max(_CELLS * own.size, _FEWEST_CELLS)
    last_velocity, last_force = 0.0, 0.0
    for j in range(cells + 1):
        x, rate, _ = swing(own, 2 * np.pi * j / cells)
        here = omega * rate
        force = contact_force(kind, damped, law, load, resting, mean + x, here) / load
        if j == 0:
            for s in range(speeds.size):
                last_rapidity[s] = np.arcsinh(here / speeds[s])
        else:
            for s in range(speeds.size):
                v, rise, rapidity = speeds[s], here - last_velocity, np.arcsinh(here / speeds[s])
                if abs(rise) > 1e-6 * v:
                    ratio = v * (rapidity - last_rapidity[s]) / rise
                else:
                    ratio = v / np.sqrt(v * v + here * here)
                last_rapidity[s] = rapidity
                kinematic[s] += ratio / cells
                loaded[s] += 0.5 * (force + last_force) * ratio / cells
        last_velocity, last_force = here, force


@numba.njit(**INSIDE)
def contact_force(kind: Choice, damped: Choice, law: Law, load: float, resting: float, x: float, v: float) -> float:
    """Return the contact force, in N, of a contact that rests where `equilibrium_displacement` says."""
    if len(kind) == EXPONENTIAL:
        force = load * np.exp(min(-x / law.parameter, LARGEST_EXPONENT))
    elif len(kind) == HERTZ:
        force = law.parameter * max(resting - x, 0.0) ** 1.5
    elif len(kind) == TABULATED:
        log_force = log_force_at(law.cells, resting + law.parameter * x)[0]
        force = np.exp(min(max(log_force, -LARGEST_EXPONENT), LARGEST_EXPONENT))
    else:
        force = max(load - law.parameter * x, 0.0)
    if len(damped) == 1:
        force *= max(1 - law.damping * v, 0.0)
    return float(force)


@numba.njit(**INSIDE)
def swing(own: Complexes, phase: float) -> tuple[float, float, float]:
    """Return displacement about the mean and its first two derivatives by phase."""
    x, rate, bend = _swing_at(own, np.cos(phase), np.sin(phase))
    return x, rate, bend


@numba.njit(**INSIDE)
def _swing_at(own: Complexes, cosine: float, sine: float) -> tuple[float, float, float]:
    c, s, x, rate, bend = 1.0, 0.0, 0.0, 0.0, 0.0
    for k in range(1, own.size + 1):
        c, s = c * cosine - s * sine, c * sine + s * cosine
        real, imaginary = own[k - 1].real * c - own[k - 1].imag * s, own[k - 1].real * s + own[k - 1].imag * c
        x += real
        rate -= k * imaginary
        bend -= k * k * real
    return x, rate, bend
