"""One kernel from the settings of a point to its steady state: a thread to a point, nothing but answers written.

A thread guesses with one harmonic, balances the harmonics, finer where needed, measures the motion, judges whether it
is stable and averages friction at the sliding speeds, all in registers and memory of its own. What it cannot finish it
leaves to the processor.
"""

import math
from typing import Any

import numpy as np
from numba import float64
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.dynamics.gap_law import LOST
from sonolube.dynamics.gpu.balance import MATRIX, MOST_HARMONICS, ORDERS, ROOM, balance, verdict, write_linear_part
from sonolube.dynamics.gpu.device import cuda, on_device
from sonolube.dynamics.gpu.extrema import loss_fraction, turn, two_turns
from sonolube.dynamics.gpu.floquet_exponent import FREE, SQUARES, growth_rate
from sonolube.dynamics.gpu.friction_average import SPEEDS, write_means
from sonolube.dynamics.gpu.initial_guess import sine_amplitudes, sine_balance, sine_orders
from sonolube.dynamics.gpu.structure_rows import DETERMINANT, charged, driven
from sonolube.dynamics.harmonic_balance.harmonic_kernel import CONVERGED, DIVERGED, NEEDS_HARMONICS, NEEDS_SAMPLES, TAIL

DONE, UNRESOLVED, AMBIGUOUS, TURNING = 0, 1, 2, 3
"""What became of a point: finished, or left since it was not resolved, has two guesses, or may turn more than twice."""

MEAN, MEAN_FORCE, AMPLITUDE, UPPER, LOWER, LOWEST, HIGHEST_FORCE, LOWEST_FORCE, SHARE_LOST, GROWTH_RATE = range(10)
MEASURES = 10
"""Rows of what is measured. []"""

_MOST_SAMPLES, _MOST_COUPLED, _ATTEMPTS, _ITERATIONS = 2048, 32, 9, 12
_KICKS = 8  # a radian of the structure's fastest mode
_MOST_KICKS = 2**22  # a period; where more are needed the processor says so
_DISTINCT = 1e-4  # relative difference of amplitude that makes two guesses
_WORK = max(MATRIX, SQUARES)


@on_device
def first_orders(
    pairs: Floats, tolerance: float, omega: float, load: float, length: float, amplitude: float, drives: int, least: int
) -> tuple[int, int, int]:
    """Return harmonics, those of them to couple, and samples to begin with."""
    if drives == 1:
        h, n, left_out = sine_orders(pairs, TAIL * tolerance, omega, load, length, amplitude)
        count = max(4 * h, 2 * ((left_out + h + 5) // 2))
    else:
        h, n, count = max(8, drives), 8, max(64, 4 * drives)
    h, n = max(h, least), max(n, min(least, _MOST_COUPLED))
    return h, min(n, h), max(count, 4 * h)


@on_device
def finer(outcome: int, h: int, n: int, count: int) -> tuple[int, int, int]:
    """Return more of what a point lacked."""
    alone = outcome == DIVERGED and n >= min(h, _MOST_COUPLED)
    if outcome == DIVERGED:
        n = min(4 * n, _MOST_COUPLED)
    if outcome == NEEDS_HARMONICS or alone:
        h *= 2
    if outcome == NEEDS_SAMPLES or alone:
        count *= 2
    return h, min(n, h), max(count, 4 * h)


@on_device
def place_guess(
    length: float,
    load: float,
    static_stiffness: float,
    static_displacement: float,
    amplitude: float,
    answer: Floats,
    linear: Floats,
    unknown: Floats,
) -> None:
    """Write mean and first harmonic of the motion with one harmonic and this amplitude."""
    mean, force = sine_balance(length, load, static_stiffness, static_displacement, amplitude)
    for k in range(ROOM):
        unknown[0, k], unknown[1, k] = 0.0, 0.0
    unknown[0, 0] = mean
    if amplitude > 0:
        share = force / amplitude
        re, im = 1 + answer[0, 1] * share, answer[1, 1] * share
        below = re * re + im * im
        unknown[0, 1] = (linear[0, 1] * re + linear[1, 1] * im) / below
        unknown[1, 1] = (linear[1, 1] * re - linear[0, 1] * im) / below


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
        own_re, own_im = charged(pairs, k * omega)
        own_re += clamped_capacitance
        re, im = driven(pairs, k * omega)
        v_re, v_im = voltage[2 * k - 2, point], voltage[2 * k - 1, point]
        f_re, f_im = 2 * spectrum[0, k], 2 * spectrum[1, k]
        charge[2 * k - 2, point] = own_re * v_re - own_im * v_im + re * f_re - im * f_im
        charge[2 * k - 1, point] = own_re * v_im + own_im * v_re + re * f_im + im * f_re


@on_device
def write_measures(
    load: float, length: float, unknown: Floats, h: int, upper: float, lower: float, point: int, measures: Floats
) -> None:
    """Write what a motion does at the contact, given about its turns."""
    upper, high = turn(unknown, h, upper)
    lower, low = turn(unknown, h, lower)
    high, low = unknown[0, 0] + high, unknown[0, 0] + low
    measures[AMPLITUDE, point], measures[LOWEST, point] = 0.5 * (high - low), low
    measures[UPPER, point], measures[LOWER, point] = upper, lower
    measures[HIGHEST_FORCE, point] = load * math.exp(min(-low / length, 700.0))
    measures[LOWEST_FORCE, point] = load * math.exp(min(-high / length, 700.0))
    beyond = -length * math.log(LOST)
    measures[SHARE_LOST, point] = loss_fraction(unknown, h, beyond, upper, high, lower, low)


@on_device
def kicks_of(pairs: Floats, omega: float, count: int) -> int:
    """Return how many kicks a period takes to judge growth."""
    fastest = 0.0
    for pair in range(pairs.shape[1]):
        fastest = max(fastest, abs(pairs[DETERMINANT, pair]))
    kicks = min(_KICKS * math.sqrt(fastest) / omega, _MOST_KICKS)
    return max(count, int(math.ceil(kicks)))  # noqa: RUF046 - a GPU rounds to a float


def steady_points(
    pairs: Floats,
    constants: Floats,
    least: int,
    falling: bool,
    stability: bool,
    sliding: bool,
    settings: Floats,
    voltage: Floats,
    speeds: Floats,
    phases: Floats,
    count: NDArray[np.int64],
    measures: Floats,
    harmonics: Floats,
    charge: Floats,
    means: Floats,
    whole: NDArray[np.int64],
) -> None:
    """Find the steady states of many points, each by one thread; points are the last axis of every array.

    Parameters
    ----------
    pairs : ndarray, shape (16, m)
        The structure as `structure_rows` gives it.
    constants : ndarray, shape (5,)
        Static stiffness of the structure at its contact, in N/m, clamped capacitance, in F, the contact's decay length,
        in m, the largest relative error, and the lowest sliding speed, in m/s.
    least : int
        Harmonics to take and couple at least.
    falling, stability, sliding : bool
        Whether to take the larger of several vibrations, to judge stability, and to average friction.
    settings : ndarray, shape (3, p)
        Angular frequency, in rad/s, dead load, in N, and mean displacement without contact, in m.
    voltage : ndarray, shape (2 K, p)
        Real and imaginary parts of the drive's harmonics in turn, in V.
    speeds : ndarray, shape (s,)
        Sliding speeds, in m/s, none of them zero.
    phases, count : ndarray
        As `crowded_levels` gives them.
    measures : ndarray, shape (10, p)
        Written, in the order of the constants of this module.
    harmonics : ndarray, shape (24, p)
        Written: real and imaginary parts of the displacement's harmonics in turn, in m.
    charge : ndarray, shape (2 K, p)
        Written likewise, in C.
    means : ndarray, shape (2, s, p)
        Written: mean friction factors, plain and weighted by the force.
    whole : ndarray of int, shape (5, p)
        Written: what became of the point, and its harmonics, samples, coupled harmonics and steps of Newton's method;
        of what became alone, where there are two guesses.
    """
    point = cuda.grid(1)
    if point >= settings.shape[1]:
        return
    unknown, step = cuda.local.array((2, ROOM), float64), cuda.local.array((2, ROOM), float64)
    answer, linear = cuda.local.array((2, ROOM), float64), cuda.local.array((2, ROOM), float64)
    spectrum, work = cuda.local.array((2, ORDERS), float64), cuda.local.array(_WORK, float64)
    free_motion, sums = cuda.local.array(FREE, float64), cuda.local.array((2, SPEEDS), float64)
    static_stiffness, capacitance, length, tolerance = constants[0], constants[1], constants[2], constants[3]
    omega, load, static_displacement = settings[0, point], settings[1, point], settings[2, point]
    drives = voltage.shape[0] // 2

    write_linear_part(pairs, voltage, point, omega, 0, 1, answer, linear)
    free = math.sqrt(linear[0, 1] ** 2 + linear[1, 1] ** 2)
    lowest, highest = sine_amplitudes(
        length, load, static_stiffness, static_displacement, answer[0, 1], answer[1, 1], free
    )
    whole[0, point] = AMBIGUOUS
    if highest > lowest * (1 + _DISTINCT):
        return
    amplitude = highest if falling else lowest
    h, n, samples = first_orders(pairs, tolerance, omega, load, length, amplitude, drives, least)
    outcome, known, steps = DIVERGED, 1, 0
    for attempt in range(_ATTEMPTS):
        if h > MOST_HARMONICS or samples > _MOST_SAMPLES:
            break
        write_linear_part(pairs, voltage, point, omega, known, h, answer, linear)
        known = max(known, h)
        if outcome == DIVERGED:
            place_guess(length, load, static_stiffness, static_displacement, amplitude, answer, linear, unknown)
        iterations = _ITERATIONS + 4 * attempt
        size, scale, taken = balance(
            load,
            length,
            static_stiffness,
            static_displacement,
            answer,
            linear,
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
        outcome = verdict(pairs, omega, load, h, samples, tolerance, size, scale, spectrum)
        if outcome == CONVERGED:
            break
        h, n, samples = finer(outcome, h, n, samples)
    whole[0, point], whole[1, point], whole[2, point] = UNRESOLVED, h, samples
    whole[3, point], whole[4, point] = n, steps
    if outcome != CONVERGED:
        return
    twice, upper, lower = two_turns(unknown, h, not sliding)  # friction of lopsided motions is the processor's
    whole[0, point] = TURNING
    if not twice:
        return
    whole[0, point] = DONE
    measures[MEAN, point] = unknown[0, 0]
    measures[MEAN_FORCE, point] = load + static_stiffness * (unknown[0, 0] - static_displacement)
    write_motion(pairs, capacitance, omega, voltage, unknown, spectrum, h, point, harmonics, charge)
    write_measures(load, length, unknown, h, upper, lower, point, measures)
    if stability:
        kicks = kicks_of(pairs, omega, samples)
        measures[GROWTH_RATE, point] = growth_rate(pairs, omega, load, length, unknown, h, kicks, free_motion, work)
    if sliding:
        upper, lower, steepness = measures[UPPER, point], measures[LOWER, point], measures[AMPLITUDE, point] / length
        write_means(
            omega, length, unknown, h, upper, lower, steepness, constants[4], speeds, phases, count, sums, point, means
        )


KERNEL: Any = cuda.jit(cache=True)(steady_points)
