"""GPU kernel of steady states, fused from initial guess to friction averages: one thread per point.

A thread computes the initial guess with a single harmonic, solves harmonic balance with adaptive truncation, measures
the motion, computes its stability and averages friction at the sliding speeds, all in registers and local memory. Only
results are written. Points that it cannot solve are left to the CPU.
"""

import math
from typing import Any

import numpy as np
from numba import float64
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.models.dynamics.gap_laws.protocol import CONTACT_LOSS_THRESHOLD
from sonolube.models.dynamics.gpu.device import cuda, on_device
from sonolube.models.dynamics.gpu.extrema import extremum, extremum_estimates, fraction_above
from sonolube.models.dynamics.gpu.floquet_exponent import DRIFT, SQUARES, floquet_exponent
from sonolube.models.dynamics.gpu.friction_average import SPEEDS, write_averages
from sonolube.models.dynamics.gpu.harmonic_balance import (
    CAPACITY,
    MATRIX,
    MOST_HARMONICS,
    ORDERS,
    assess,
    newton_solve,
    write_linear_response,
)
from sonolube.models.dynamics.gpu.initial_guess import amplitude_roots, balanced_mean, sinusoidal_truncation
from sonolube.models.dynamics.gpu.receptance import DETERMINANT, charge_per_volt, contact_per_volt
from sonolube.models.dynamics.harmonic_balance.harmonic_kernel import (
    CONVERGED,
    DIVERGED,
    NEEDS_HARMONICS,
    NEEDS_SAMPLES,
    TAIL,
)

SOLVED, UNRESOLVED, SEVERAL_GUESSES, MANY_EXTREMA = 0, 1, 2, 3
"""Outcomes of a point: solved; or left since it was not resolved, has several guesses, or may have many extrema. []"""

MEAN, MEAN_FORCE, AMPLITUDE, MAXIMUM_PHASE, MINIMUM_PHASE = range(5)
LOWEST_DISPLACEMENT, HIGHEST_FORCE, LOWEST_FORCE, CONTACT_LOSS, EXPONENT = range(5, 10)
MEASURES = 10
"""Rows of the measures of a motion, and their number. []"""

_MOST_SAMPLES, _MOST_COUPLED, _ATTEMPTS, _ITERATIONS = 2048, 32, 9, 12
_KICKS_PER_RADIAN = 8  # of the structure's fastest mode
_MOST_KICKS = 2**22  # per period; where more are required, the CPU reports it
_DISTINCT = 1e-4  # relative difference of amplitude above which two guesses are distinct
_WORK = max(MATRIX, SQUARES)


@on_device
def first_truncation(
    pairs: Floats, tolerance: float, omega: float, load: float, length: float, amplitude: float, drives: int, least: int
) -> tuple[int, int, int]:
    """Return the numbers of harmonics, of coupled harmonics and of samples to start with.

    The drive has `drives` harmonics, and the motion at least `least`.
    """
    if drives == 1:
        h, n, truncated = sinusoidal_truncation(pairs, TAIL * tolerance, omega, load, length, amplitude)
        count = max(4 * h, 2 * ((truncated + h + 5) // 2))
    else:
        h, n, count = max(8, drives), 8, max(64, 4 * drives)
    h, n = max(h, least), max(n, min(least, _MOST_COUPLED))
    return h, min(n, h), max(count, 4 * h)


@on_device
def refined_truncation(outcome: int, h: int, n: int, count: int) -> tuple[int, int, int]:
    """Return the truncation with more of what a point lacks."""
    fully_coupled = outcome == DIVERGED and n >= min(h, _MOST_COUPLED)
    if outcome == DIVERGED:
        n = min(4 * n, _MOST_COUPLED)
    if outcome == NEEDS_HARMONICS or fully_coupled:
        h *= 2
    if outcome == NEEDS_SAMPLES or fully_coupled:
        count *= 2
    return h, min(n, h), max(count, 4 * h)


@on_device
def write_guess(
    length: float,
    load: float,
    static_stiffness: float,
    static_displacement: float,
    amplitude: float,
    receptances: Floats,
    free: Floats,
    unknown: Floats,
) -> None:
    """Write mean and first harmonic of the motion with a single harmonic of a given amplitude."""
    mean, force = balanced_mean(length, load, static_stiffness, static_displacement, amplitude)
    for k in range(CAPACITY):
        unknown[0, k], unknown[1, k] = 0.0, 0.0
    unknown[0, 0] = mean
    if amplitude > 0:
        stiffness = force / amplitude
        re, im = 1 + receptances[0, 1] * stiffness, receptances[1, 1] * stiffness
        below = re * re + im * im
        unknown[0, 1] = (free[0, 1] * re + free[1, 1] * im) / below
        unknown[1, 1] = (free[1, 1] * re - free[0, 1] * im) / below


@on_device
def write_motion(
    pairs: Floats,
    clamped_capacitance: float,
    omega: float,
    voltage: Floats,
    unknown: Floats,
    spectrum: Floats,
    h: int,
    point: int,
    harmonics: Floats,
    charge: Floats,
) -> None:
    """Write the harmonics of displacement and charge."""
    for k in range(1, MOST_HARMONICS + 1):
        harmonics[2 * k - 2, point] = unknown[0, k] if k <= h else 0.0
        harmonics[2 * k - 1, point] = unknown[1, k] if k <= h else 0.0
    for k in range(1, min(voltage.shape[0] // 2, h) + 1):
        own_re, own_im = charge_per_volt(pairs, k * omega)
        own_re += clamped_capacitance
        re, im = contact_per_volt(pairs, k * omega)
        v_re, v_im = voltage[2 * k - 2, point], voltage[2 * k - 1, point]
        f_re, f_im = 2 * spectrum[0, k], 2 * spectrum[1, k]
        charge[2 * k - 2, point] = own_re * v_re - own_im * v_im + re * f_re - im * f_im
        charge[2 * k - 1, point] = own_re * v_im + own_im * v_re + re * f_im + im * f_re


@on_device
def write_measures(
    load: float, length: float, unknown: Floats, h: int, upper: float, lower: float, point: int, measures: Floats
) -> None:
    """Write the measures of a motion, from estimates of the phases of its maximum and minimum."""
    upper, high = extremum(unknown, h, upper)
    lower, low = extremum(unknown, h, lower)
    high, low = unknown[0, 0] + high, unknown[0, 0] + low
    measures[AMPLITUDE, point], measures[LOWEST_DISPLACEMENT, point] = 0.5 * (high - low), low
    measures[MAXIMUM_PHASE, point], measures[MINIMUM_PHASE, point] = upper, lower
    measures[HIGHEST_FORCE, point] = load * math.exp(min(-low / length, 700.0))
    measures[LOWEST_FORCE, point] = load * math.exp(min(-high / length, 700.0))
    loss = -length * math.log(CONTACT_LOSS_THRESHOLD)
    measures[CONTACT_LOSS, point] = fraction_above(unknown, h, loss, upper, high, lower, low)


@on_device
def kicks_per_period(pairs: Floats, omega: float, count: int) -> int:
    """Return the number of kicks per period that stability requires."""
    fastest = 0.0
    for pair in range(pairs.shape[1]):
        fastest = max(fastest, abs(pairs[DETERMINANT, pair]))
    kicks = min(_KICKS_PER_RADIAN * math.sqrt(fastest) / omega, _MOST_KICKS)
    return max(count, int(math.ceil(kicks)))  # noqa: RUF046 - a GPU rounds to a float


def steady_points(
    pairs: Floats,
    constants: Floats,
    minimum_harmonics: int,
    upper_branch: bool,
    stability: bool,
    friction: bool,
    settings: Floats,
    voltage: Floats,
    speeds: Floats,
    nodes: Floats,
    count: NDArray[np.int64],
    measures: Floats,
    harmonics: Floats,
    charge: Floats,
    averages: Floats,
    integers: NDArray[np.int64],
) -> None:
    """Solve the steady states of a batch, one point per thread; points are the last axis of every array.

    Parameters
    ----------
    pairs : ndarray, shape (16, m)
        From `model_rows`.
    constants : ndarray, shape (5,)
        Static stiffness of the structure at its contact, in N/m, clamped capacitance, in F, decay length of the
        contact, in m, largest relative error, and smallest sliding speed, in m/s.
    minimum_harmonics : int
        Least number of harmonics, fully coupled.
    upper_branch, stability, friction : bool
        Whether to return the larger of coexisting vibrations, to compute stability, and to average friction.
    settings : ndarray, shape (3, p)
        Angular frequency, in rad/s, dead load, in N, and mean displacement without contact force, in m.
    voltage : ndarray, shape (2 K, p)
        Real and imaginary parts of the drive's harmonics in turn, in V.
    speeds : ndarray, shape (s,)
        Positive sliding speeds, in m/s.
    nodes, count : ndarray
        `NodeTables`.
    measures : ndarray, shape (10, p)
        Written, in the order of the constants of this module.
    harmonics : ndarray, shape (24, p)
        Written: real and imaginary parts of the displacement's harmonics in turn, in m.
    charge : ndarray, shape (2 K, p)
        Written likewise, in C.
    averages : ndarray, shape (2, s, p)
        Written: friction averages, plain and force-weighted.
    integers : ndarray of int, shape (5, p)
        Written: outcome of the point, then its harmonics, samples, coupled harmonics and Newton steps; the outcome
        alone where there are several guesses.
    """
    point = cuda.grid(1)
    if point >= settings.shape[1]:
        return
    unknown, step = cuda.local.array((2, CAPACITY), float64), cuda.local.array((2, CAPACITY), float64)
    receptances, free = cuda.local.array((2, CAPACITY), float64), cuda.local.array((2, CAPACITY), float64)
    spectrum, work = cuda.local.array((2, ORDERS), float64), cuda.local.array(_WORK, float64)
    drift, sums = cuda.local.array(DRIFT, float64), cuda.local.array((2, SPEEDS), float64)
    static_stiffness, capacitance, length, tolerance = constants[0], constants[1], constants[2], constants[3]
    omega, load, static_displacement = settings[0, point], settings[1, point], settings[2, point]
    drives = voltage.shape[0] // 2

    write_linear_response(pairs, voltage, point, omega, 0, 1, receptances, free)
    free_amplitude = math.sqrt(free[0, 1] ** 2 + free[1, 1] ** 2)
    smallest, largest = amplitude_roots(
        length, load, static_stiffness, static_displacement, receptances[0, 1], receptances[1, 1], free_amplitude
    )
    integers[0, point] = SEVERAL_GUESSES
    if largest > smallest * (1 + _DISTINCT):
        return
    amplitude = largest if upper_branch else smallest
    h, n, samples = first_truncation(pairs, tolerance, omega, load, length, amplitude, drives, minimum_harmonics)
    outcome, known, steps = DIVERGED, 1, 0
    for attempt in range(_ATTEMPTS):
        if h > MOST_HARMONICS or samples > _MOST_SAMPLES:
            break
        write_linear_response(pairs, voltage, point, omega, known, h, receptances, free)
        known = max(known, h)
        if outcome == DIVERGED:
            write_guess(length, load, static_stiffness, static_displacement, amplitude, receptances, free, unknown)
        iterations = _ITERATIONS + 4 * attempt
        size, scale, taken = newton_solve(
            load,
            length,
            static_stiffness,
            static_displacement,
            receptances,
            free,
            h,
            n,
            samples,
            iterations,
            tolerance,
            unknown,
            step,
            spectrum,
            work,
        )
        steps += taken
        outcome = assess(pairs, omega, load, h, samples, tolerance, size, scale, spectrum)
        if outcome == CONVERGED:
            break
        h, n, samples = refined_truncation(outcome, h, n, samples)
    integers[0, point], integers[1, point], integers[2, point] = UNRESOLVED, h, samples
    integers[3, point], integers[4, point] = n, steps
    if outcome != CONVERGED:
        return
    # the CPU averages friction of motions with strong higher harmonics
    has_two_extrema, upper, lower = extremum_estimates(unknown, h, not friction)
    integers[0, point] = MANY_EXTREMA
    if not has_two_extrema:
        return
    integers[0, point] = SOLVED
    measures[MEAN, point] = unknown[0, 0]
    measures[MEAN_FORCE, point] = load + static_stiffness * (unknown[0, 0] - static_displacement)
    write_motion(pairs, capacitance, omega, voltage, unknown, spectrum, h, point, harmonics, charge)
    write_measures(load, length, unknown, h, upper, lower, point, measures)
    if stability:
        kicks = kicks_per_period(pairs, omega, samples)
        measures[EXPONENT, point] = floquet_exponent(pairs, omega, load, length, unknown, h, kicks, drift, work)
    if friction:
        upper, lower, steepness = (
            measures[MAXIMUM_PHASE, point],
            measures[MINIMUM_PHASE, point],
            measures[AMPLITUDE, point] / length,
        )
        write_averages(
            omega,
            length,
            unknown,
            h,
            upper,
            lower,
            steepness,
            constants[4],
            speeds,
            nodes,
            count,
            sums,
            point,
            averages,
        )


KERNEL: Any = cuda.jit(cache=True)(steady_points)
