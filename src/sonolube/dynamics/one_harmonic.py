"""The steady state with a single harmonic: where the search for the full one starts, and how finely it must look."""

from typing import NamedTuple

import numba
import numpy as np

from sonolube.checks import Floats
from sonolube.dynamics.contact_lanes import EXPONENTIAL, HERTZ, TABULATED, Law, reach, rest
from sonolube.dynamics.contact_port import ContactPort, receptances
from sonolube.dynamics.force_table import log_force_at
from sonolube.dynamics.gap_law import LARGEST_EXPONENT
from sonolube.dynamics.harmonic_kernel import Points, Resolution
from sonolube.dynamics.lanes import INSIDE, KERNEL, LANES

_ABSCISSAE = np.cos(np.pi * (np.arange(64) + 0.5) / 64)  # of the mean over a period of what depends on cos theta
_FEWER_ABSCISSAE = np.cos(np.pi * (np.arange(24) + 0.5) / 24)  # for a force without corners
_WEAK = 0.2  # contact stiffness times receptance up to which substitution finds the only solution
_GRID = 32
# polynomials for the modified Bessel functions, lowest power first (Abramowitz and Stegun 9.8.1 to 9.8.4)
_SMALL_0 = (1.0, 3.5156229, 3.0899424, 1.2067492, 0.2659732, 0.0360768, 0.0045813)
_SMALL_1 = (0.5, 0.87890594, 0.51498869, 0.15084934, 0.02658733, 0.00301532, 0.00032411)
_LARGE_0 = (
    0.39894228,
    0.01328592,
    0.00225319,
    -0.00157565,
    0.00916281,
    -0.02057706,
    0.02635537,
    -0.01647633,
    0.00392377,
)
_LARGE_1 = (
    0.39894228,
    -0.03988024,
    -0.00362018,
    0.00163801,
    -0.01031555,
    0.02282967,
    -0.02895312,
    0.01787654,
    -0.00420059,
)


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
    static_stiffness = port.static_stiffness
    omega, answer = np.empty(LANES), np.empty((4, LANES))
    total = points.omega.size
    for start in range(0, total, LANES):
        for lane in range(LANES):
            omega[lane] = points.omega[min(start + lane, total - 1)]
        receptances(port, port.constant[0], port.slope[0], omega, 1.0, answer[0], answer[1])
        receptances(port, port.constant[1], port.slope[1], omega, 1.0, answer[2], answer[3])
        for lane in range(min(LANES, total - start)):
            point = start + lane
            receptance = complex(answer[0, lane], answer[1, lane])
            free = complex(answer[2, lane], answer[3, lane]) * points.voltage[point, 0]
            _balance_amplitude(law, static_stiffness, points, point, receptance, abs(free), guesses)
            amplitude = guesses.highest[point] if highest else guesses.lowest[point]
            _place(law, static_stiffness, points, point, receptance, free, amplitude)
            _choose_resolution(port, law, tolerance, points, point, guesses.highest[point], resolution)


@numba.njit(**INSIDE)
def _place(
    law: Law, static_stiffness: float, points: Points, point: int, receptance: complex, free: complex, amplitude: float
) -> None:
    """Write mean and first harmonic of the motion with this amplitude."""
    mean, force = _one_harmonic(law, points.load[point], static_stiffness, points.free_mean[point], amplitude)
    points.mean[point] = mean
    points.harmonics[point, :] = 0.0
    if amplitude > 0:
        points.harmonics[point, 0] = free * amplitude / (amplitude + receptance * force)


@numba.njit(**INSIDE)
def _balance_amplitude(
    law: Law, static_stiffness: float, points: Points, point: int, receptance: complex, free: float, guesses: Guesses
) -> None:
    """Solve |a + G force(a)| = free amplitude for its lowest and highest solution."""
    load, free_mean = points.load[point], points.free_mean[point]
    guesses.lowest[point] = guesses.highest[point] = free
    if free == 0.0:
        return
    length = reach(law, load)
    at_rest = _opposing(law, static_stiffness, load, free_mean, 1e-3 * length) / (1e-3 * length)
    force = _opposing(law, static_stiffness, load, free_mean, free)
    strength = abs(receptance) * max(at_rest, force / free)
    if strength < _WEAK:
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
            i0, i1 = _SMALL_0[power] + t * i0, _SMALL_1[power] + t * i1
        return beta * i1 / i0
    t = 3.75 / beta
    for power in range(8, -1, -1):
        i0, i1 = _LARGE_0[power] + t * i0, _LARGE_1[power] + t * i1
    return i1 / i0


@numba.njit(**INSIDE)
def _bessel_logarithm(beta: float) -> float:
    """Return ln I_0 to within 1e-6."""
    i0 = 0.0
    if beta < 3.75:
        for power in range(6, -1, -1):
            i0 = _SMALL_0[power] + (beta / 3.75) ** 2 * i0
        return float(np.log(i0))
    for power in range(8, -1, -1):
        i0 = _LARGE_0[power] + 3.75 / beta * i0
    return float(beta + np.log(i0 / np.sqrt(beta)))


@numba.njit(**INSIDE)
def _choose_resolution(
    port: ContactPort,
    law: Law,
    tolerance: float,
    points: Points,
    point: int,
    amplitude: float,
    resolution: Resolution,
) -> None:
    """Choose harmonics, coupled harmonics and samples from those of an exponential force of the decay at rest."""
    given = points.voltage.shape[1]
    if (law.kind != EXPONENTIAL and law.kind != TABULATED) or given > 1:
        harmonics = max(8, given)
        resolution.harmonics[point], resolution.coupled[point] = harmonics, min(harmonics, 8)
        resolution.samples[point] = max(64, 4 * harmonics)
        return
    load, omega = points.load[point], points.omega[point]
    length = reach(law, load)
    beta = amplitude / length
    harmonics, coupled, order, share = 2, 1, 1, 1.0
    while order < 64:
        share *= beta / (order - 0.5 + np.sqrt((order + 0.5) ** 2 + beta**2))  # I_k/I_(k-1), D. E. Amos
        if share < tolerance:
            break
        receptance, s = 0.0, order * omega
        for pair in range(port.trace.size):
            above = port.constant[0, pair] ** 2 + (port.slope[0, pair] * s) ** 2
            below = (port.determinant[pair] - s * s) ** 2 + (port.trace[pair] * s) ** 2
            receptance += np.sqrt(above / below)
        if 2 * load * share * receptance > 0.5 * tolerance * amplitude:
            harmonics = max(order, 2)
        if 2 * load / length * receptance * share > _WEAK / 10:
            coupled = order
        order += 1
    harmonics = max(harmonics, coupled)
    resolution.harmonics[point], resolution.coupled[point] = harmonics, coupled
    resolution.samples[point] = max(4 * harmonics, 2 * (order + 2))
