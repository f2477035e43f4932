"""The steady state with a single harmonic: where the search for the full one starts, and how finely it must look."""

from typing import NamedTuple

import numba
import numpy as np

from sonolube.checks import Floats
from sonolube.dynamics.contact_lanes import EXPONENTIAL, HERTZ, TABULATED, Law, parallel, reach, rest
from sonolube.dynamics.contact_port import ContactPort, receptances
from sonolube.dynamics.force_table import log_force_at
from sonolube.dynamics.gap_law import LARGEST_EXPONENT
from sonolube.dynamics.harmonic_kernel import Points, Resolution
from sonolube.dynamics.lanes import INSIDE, KERNEL, LANES
from sonolube.dynamics.one_harmonic_lanes import (
    LARGE_0,
    LARGE_1,
    SMALL_0,
    SMALL_1,
    WEAK,
    Block,
    choose_orders,
    substitute,
)

_ABSCISSAE = np.cos(np.pi * (np.arange(64) + 0.5) / 64)  # of the mean over a period of what depends on cos theta
_FEWER_ABSCISSAE = np.cos(np.pi * (np.arange(24) + 0.5) / 24)  # for a force without corners
_GRID = 32


class Guesses(NamedTuple):
    """Amplitudes of the fundamental that balance with one harmonic, one entry of each array to a point."""

    lowest: Floats
    highest: Floats


@numba.njit(**KERNEL)
def first_guesses(
    port: ContactPort,
    law: Law,
    tolerance: float,
    highest: bool,
    points: Points,
    resolution: Resolution,
    guesses: Guesses,
) -> None:
    """Write each point's solutions with one harmonic, take one of them as first guess, and choose the resolution.

    Parameters
    ----------
    port : ContactPort
    law : Law
    tolerance : float
        Harmonics to leave out, relative to the amplitude.
    highest : bool
        Whether to take the highest solution rather than the lowest.
    points : Points
        Whose mean and first harmonic are written.
    resolution : Resolution
        Written.
    guesses : Guesses
        Written.
    """
    rows, answer = np.empty((5, LANES)), np.empty((4, LANES))
    block = Block(rows[0], rows[1], rows[2], rows[3], rows[4])
    work, orders = np.empty((7, LANES)), np.empty((3, LANES))
    easy = parallel(law) and port.static_stiffness == 0.0
    exponential = (law.kind == EXPONENTIAL or law.kind == TABULATED) and points.voltage.shape[1] == 1
    for start in range(0, points.omega.size, LANES):
        end = min(start + LANES, points.omega.size)
        _gather(port, law, points, start, end, block, answer)
        if easy:
            substitute(block, answer, work)
        for point in range(start, end):
            if easy and block.strength[point - start] < WEAK:
                amplitude, force = block.amplitude[point - start], work[0, point - start]
                guesses.lowest[point] = guesses.highest[point] = amplitude
                mean = law.parameter * _bessel_logarithm(amplitude / law.parameter)
            else:
                _balance_amplitude(law, port.static_stiffness, points, point, answer[:, point - start], guesses)
                block.amplitude[point - start] = guesses.highest[point]
                amplitude = guesses.highest[point] if highest else guesses.lowest[point]
                load, free_mean = points.load[point], points.free_mean[point]
                mean, force = _one_harmonic(law, load, port.static_stiffness, free_mean, amplitude)
            _place(points, point, answer[:, point - start], amplitude, mean, force)
        if exponential:
            choose_orders(port, tolerance, block, work, orders)
            _resolve(parallel(law), start, end, orders, resolution)
        else:
            _resolve_plainly(points.voltage.shape[1], start, end, resolution)


@numba.njit(**INSIDE)
def _gather(port: ContactPort, law: Law, points: Points, start: int, end: int, block: Block, answer: Floats) -> None:
    """Write a block of points, and the real and imaginary parts of its receptances and free motions."""
    for lane in range(LANES):
        point = min(start + lane, end - 1)
        block.omega[lane], block.load[lane] = points.omega[point], points.load[point]
        block.length[lane] = reach(law, points.load[point])
    receptances(port, port.constant[0], port.slope[0], block.omega, 1.0, answer[0], answer[1])
    receptances(port, port.constant[1], port.slope[1], block.omega, 1.0, answer[2], answer[3])
    for lane in range(LANES):
        v = points.voltage[min(start + lane, end - 1), 0]
        re, im = answer[2, lane], answer[3, lane]
        answer[2, lane], answer[3, lane] = re * v.real - im * v.imag, re * v.imag + im * v.real


@numba.njit(**INSIDE)
def _place(points: Points, point: int, answer: Floats, amplitude: float, mean: float, force: float) -> None:
    """Write mean and first harmonic of the motion with this amplitude."""
    points.mean[point] = mean
    points.harmonics[point, :] = 0.0
    if amplitude > 0:
        free, receptance = complex(answer[2], answer[3]), complex(answer[0], answer[1])
        points.harmonics[point, 0] = free * amplitude / (amplitude + receptance * force)


@numba.njit(**INSIDE)
def _resolve(falls_fast: bool, start: int, end: int, orders: Floats, resolution: Resolution) -> None:
    for point in range(start, end):
        harmonics, order = int(orders[0, point - start]), int(orders[2, point - start])
        needed = order + harmonics + 5 if falls_fast else 2 * (order + 2)
        resolution.harmonics[point], resolution.coupled[point] = harmonics, int(orders[1, point - start])
        resolution.samples[point] = max(4 * harmonics, 2 * (needed // 2))


@numba.njit(**INSIDE)
def _resolve_plainly(given: int, start: int, end: int, resolution: Resolution) -> None:
    harmonics = max(8, given)
    for point in range(start, end):
        resolution.harmonics[point], resolution.coupled[point] = harmonics, min(harmonics, 8)
        resolution.samples[point] = max(64, 4 * harmonics)


@numba.njit(**INSIDE)
def _balance_amplitude(
    law: Law, static_stiffness: float, points: Points, point: int, answer: Floats, guesses: Guesses
) -> None:
    """Solve |a + G force(a)| = free amplitude for its lowest and highest solution."""
    load, free_mean = points.load[point], points.free_mean[point]
    receptance, free = complex(answer[0], answer[1]), abs(complex(answer[2], answer[3]))
    guesses.lowest[point] = guesses.highest[point] = free
    if free == 0.0:
        return
    length = reach(law, load)
    at_rest = _opposing(law, static_stiffness, load, free_mean, 1e-3 * length) / (1e-3 * length)
    force = _opposing(law, static_stiffness, load, free_mean, free)
    strength = abs(receptance) * max(at_rest, force / free)
    if strength < WEAK:
        amplitude = free
        for _ in range(3):
            amplitude = free / abs(1 + receptance * force / amplitude)
            force = _opposing(law, static_stiffness, load, free_mean, amplitude)
        guesses.lowest[point] = guesses.highest[point] = amplitude
        return
    largest = 1.1 * free + 1e-3 * length
    for _ in range(60):
        force = _opposing(law, static_stiffness, load, free_mean, largest)
        if abs(largest + receptance * force) > free and largest > abs(receptance) * force:
            break
        largest *= 1.5
    lower, short, found = 0.0, -free, False
    spread = np.arcsinh(largest / length)
    for i in range(1, _GRID + 1):
        upper = length * np.sinh(spread * i / _GRID)
        excess = abs(upper + receptance * _opposing(law, static_stiffness, load, free_mean, upper)) - free
        if short < 0 <= excess:
            root = _root(law, static_stiffness, load, free_mean, receptance, free, lower, short, upper, excess)
            guesses.highest[point] = root
            if not found:
                guesses.lowest[point], found = root, True
        lower, short = upper, excess


@numba.njit(**INSIDE)
def _root(
    law: Law,
    static_stiffness: float,
    load: float,
    free_mean: float,
    receptance: complex,
    free: float,
    lower: float,
    short: float,
    upper: float,
    excess: float,
) -> float:
    """Return the amplitude between two at which what balances passes the free amplitude (false position, Illinois)."""
    middle, above = upper, False
    for _ in range(12):
        middle = (lower * excess - upper * short) / (excess - short)
        value = abs(middle + receptance * _opposing(law, static_stiffness, load, free_mean, middle)) - free
        if value > 0:
            upper, excess, short = middle, value, (0.5 if above else 1.0) * short
        else:
            lower, short, excess = middle, value, (1.0 if above else 0.5) * excess
        above = value > 0
        if abs(value) < 1e-4 * free:
            break
    return middle


@numba.njit(**INSIDE)
def _opposing(law: Law, static_stiffness: float, load: float, free_mean: float, amplitude: float) -> float:
    """Return the amplitude of the contact force that opposes a sinusoidal motion about the mean that balances."""
    if law.kind == EXPONENTIAL and static_stiffness == 0.0:
        return float(2 * load * _bessel_ratio(amplitude / law.parameter))
    return float(_one_harmonic(law, load, static_stiffness, free_mean, amplitude)[1])


@numba.njit(**INSIDE)
def _one_harmonic(
    law: Law, load: float, static_stiffness: float, free_mean: float, amplitude: float
) -> tuple[float, float]:
    """Return the mean that balances a sinusoidal motion, and the amplitude of the contact force opposing it."""
    if law.kind == EXPONENTIAL and static_stiffness == 0.0:
        beta = amplitude / law.parameter
        return law.parameter * _bessel_logarithm(beta), 2 * load * _bessel_ratio(beta)
    lower, upper = min(free_mean, 0.0), max(free_mean, amplitude)
    if static_stiffness == 0.0:
        lower, upper = 0.0, amplitude
    mean, small = lower, 1e-6 * (amplitude + 1e-3 * reach(law, load))
    force, opposing, slope = _force_moments(law, load, mean, amplitude)
    for _ in range(60):
        excess = static_stiffness * (mean - free_mean) - (force - load)
        if excess < 0:
            lower = mean
        else:
            upper = mean
        step = excess / (static_stiffness + slope)
        if law.kind == TABULATED and static_stiffness == 0.0:
            step = np.log(load / force) * force / slope  # in the logarithm the force is nearly straight
        mean -= step
        if not lower <= mean <= upper:
            mean = 0.5 * (lower + upper)
        force, opposing, slope = _force_moments(law, load, mean, amplitude)
        if abs(step) < small:
            break
    return mean, opposing


@numba.njit(**INSIDE)
def _force_moments(law: Law, load: float, mean: float, amplitude: float) -> tuple[float, float, float]:
    """Return the mean force, its harmonic against a motion amplitude * cos theta, and the mean stiffness."""
    if law.kind == EXPONENTIAL:
        beta = amplitude / law.parameter
        force = load * np.exp(min(_bessel_logarithm(beta) - mean / law.parameter, 600.0))
        return force, 2 * force * _bessel_ratio(beta), force / law.parameter
    force, opposing, slope, resting = 0.0, 0.0, 0.0, rest(law, load)
    if law.kind == TABULATED:
        force, opposing, slope = _tabulated_moments(law, resting, mean, amplitude)
        return force, opposing, slope
    for cosine in _ABSCISSAE:
        x = mean + amplitude * cosine
        if law.kind == HERTZ:
            approach = max(resting - x, 0.0)
            rate = 1.5 * law.parameter * np.sqrt(approach)
            now = rate * approach / 1.5
        else:
            now = max(load - law.parameter * x, 0.0)
            rate = law.parameter if now > 0 else 0.0
        force += now / _ABSCISSAE.size
        slope += rate / _ABSCISSAE.size
        opposing -= 2 * now * cosine / _ABSCISSAE.size
    return force, opposing, slope


@numba.njit(**INSIDE)
def _tabulated_moments(law: Law, resting: float, mean: float, amplitude: float) -> tuple[float, float, float]:
    force, opposing, slope = 0.0, 0.0, 0.0
    for cosine in _FEWER_ABSCISSAE:
        log_force, change = log_force_at(law.cells, resting + law.parameter * (mean + amplitude * cosine))
        now = np.exp(min(max(log_force, -LARGEST_EXPONENT), LARGEST_EXPONENT)) / _FEWER_ABSCISSAE.size
        force += now
        slope -= law.parameter * change * now
        opposing -= 2 * now * cosine
    return force, opposing, slope


@numba.njit(**INSIDE)
def _bessel_ratio(beta: float) -> float:
    """Return I_1/I_0 to within 1e-6."""
    i0, i1 = 0.0, 0.0
    if beta < 3.75:
        t = (beta / 3.75) ** 2
        for power in range(6, -1, -1):
            i0, i1 = SMALL_0[power] + t * i0, SMALL_1[power] + t * i1
        return beta * i1 / i0
    t = 3.75 / beta
    for power in range(8, -1, -1):
        i0, i1 = LARGE_0[power] + t * i0, LARGE_1[power] + t * i1
    return i1 / i0


@numba.njit(**INSIDE)
def _bessel_logarithm(beta: float) -> float:
    """Return ln I_0 to within 1e-6."""
    i0 = 0.0
    if beta < 3.75:
        for power in range(6, -1, -1):
            i0 = SMALL_0[power] + (beta / 3.75) ** 2 * i0
        return float(np.log(i0))
    for power in range(8, -1, -1):
        i0 = LARGE_0[power] + 3.75 / beta * i0
    return float(beta + np.log(i0 / np.sqrt(beta)))
