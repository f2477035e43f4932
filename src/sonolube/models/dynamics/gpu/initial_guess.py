"""Initial guess with a single harmonic, and a-priori truncation, for an exponential contact, by GPU threads.

The method is that of `sonolube.models.dynamics.harmonic_balance.initial_guess` and `truncation`.
"""

import math

from sonolube.checks import Floats
from sonolube.models.dynamics.gpu.device import on_device
from sonolube.models.dynamics.gpu.receptance import receptance_bound
from sonolube.models.dynamics.harmonic_balance.bessel import BEND, LARGE_0, LARGE_1, SMALL_0, SMALL_1
from sonolube.models.dynamics.harmonic_balance.initial_guess import WEAK

_GRID = 32  # amplitudes to scan for roots
_MOST_ORDERS = 64
_LARGEST_EXPONENT = 600.0


@on_device
def bessel_ratio(beta: float) -> float:
    """Return I_1/I_0 to within 2e-6."""
    i0, i1 = 0.0, 0.0
    if beta < BEND:
        t = (beta / BEND) ** 2
        for power in range(6, -1, -1):
            i0, i1 = SMALL_0[power] + t * i0, SMALL_1[power] + t * i1
        return beta * i1 / i0
    t = BEND / beta
    for power in range(8, -1, -1):
        i0, i1 = LARGE_0[power] + t * i0, LARGE_1[power] + t * i1
    return i1 / i0


@on_device
def log_bessel_i0(beta: float) -> float:
    """Return ln I_0 to within 2e-6."""
    i0 = 0.0
    if beta < BEND:
        for power in range(6, -1, -1):
            i0 = SMALL_0[power] + (beta / BEND) ** 2 * i0
        return math.log(i0)
    for power in range(8, -1, -1):
        i0 = LARGE_0[power] + BEND / beta * i0
    return beta + math.log(i0 / math.sqrt(beta))


@on_device
def balanced_mean(
    length: float, load: float, static_stiffness: float, static_displacement: float, amplitude: float
) -> tuple[float, float]:
    """Return the mean that balances a sinusoidal motion statically, and the amplitude of the opposing force."""
    beta = amplitude / length
    rise, opposing = log_bessel_i0(beta), 2 * bessel_ratio(beta)
    if static_stiffness == 0.0:
        return length * rise, load * opposing
    lower, upper = min(static_displacement, 0.0), max(static_displacement, amplitude)
    mean, small = lower, 1e-6 * (amplitude + 1e-3 * length)
    force = load * math.exp(min(rise - mean / length, _LARGEST_EXPONENT))
    for _ in range(60):
        excess = static_stiffness * (mean - static_displacement) - (force - load)
        if excess < 0:
            lower = mean
        else:
            upper = mean
        step = excess / (static_stiffness + force / length)
        mean -= step
        if mean < lower or mean > upper:
            mean = 0.5 * (lower + upper)
        force = load * math.exp(min(rise - mean / length, _LARGEST_EXPONENT))
        if abs(step) < small:
            break
    return mean, force * opposing


@on_device
def required_drive(
    length: float,
    load: float,
    static_stiffness: float,
    static_displacement: float,
    g_re: float,
    g_im: float,
    amplitude: float,
) -> tuple[float, float]:
    """Return the free amplitude that an amplitude requires, |a + G force(a)|, and the amplitude of the force."""
    force = balanced_mean(length, load, static_stiffness, static_displacement, amplitude)[1]
    re, im = amplitude + g_re * force, g_im * force
    return math.sqrt(re * re + im * im), force


@on_device
def amplitude_roots(
    length: float,
    load: float,
    static_stiffness: float,
    static_displacement: float,
    g_re: float,
    g_im: float,
    free: float,
) -> tuple[float, float]:
    """Return the smallest and the largest root of the amplitude equation of a single harmonic."""
    if free == 0.0:
        return free, free
    size = math.sqrt(g_re * g_re + g_im * g_im)
    small = 1e-3 * length
    at_rest = balanced_mean(length, load, static_stiffness, static_displacement, small)[1] / small
    force = balanced_mean(length, load, static_stiffness, static_displacement, free)[1]
    if size * max(at_rest, force / free) < WEAK:
        amplitude = free
        for _ in range(3):
            re, im = 1 + g_re * force / amplitude, g_im * force / amplitude
            amplitude = free / math.sqrt(re * re + im * im)
            force = balanced_mean(length, load, static_stiffness, static_displacement, amplitude)[1]
        return amplitude, amplitude
    largest = 1.1 * free + small
    for _ in range(60):
        needed, force = required_drive(length, load, static_stiffness, static_displacement, g_re, g_im, largest)
        if needed > free and largest > size * force:
            break
        largest *= 1.5
    return bracketed_amplitudes(length, load, static_stiffness, static_displacement, g_re, g_im, free, largest)


@on_device
def bracketed_amplitudes(
    length: float,
    load: float,
    static_stiffness: float,
    static_displacement: float,
    g_re: float,
    g_im: float,
    free: float,
    bound: float,
) -> tuple[float, float]:
    """Return the smallest and the largest root up to a bound, bracketed on a grid and refined by false position."""
    smallest, largest, found = free, free, False
    lower, short = 0.0, -free
    extent = math.asinh(bound / length)
    for i in range(1, _GRID + 1):
        upper = length * math.sinh(extent * i / _GRID)
        excess = required_drive(length, load, static_stiffness, static_displacement, g_re, g_im, upper)[0] - free
        if short < 0 and excess >= 0:
            largest = regula_falsi(
                length, load, static_stiffness, static_displacement, g_re, g_im, free, lower, short, upper, excess
            )
            if not found:
                smallest, found = largest, True
        lower, short = upper, excess
    return smallest, largest


@on_device
def regula_falsi(
    length: float,
    load: float,
    static_stiffness: float,
    static_displacement: float,
    g_re: float,
    g_im: float,
    free: float,
    lower: float,
    short: float,
    upper: float,
    excess: float,
) -> float:
    """Return the bracketed root of the amplitude equation by false position (Illinois variant)."""
    middle, above = upper, False
    for _ in range(12):
        middle = (lower * excess - upper * short) / (excess - short)
        value = required_drive(length, load, static_stiffness, static_displacement, g_re, g_im, middle)[0] - free
        if value > 0:
            upper, excess = middle, value
            short *= 0.5 if above else 1.0
        else:
            lower, short = middle, value
            excess *= 1.0 if above else 0.5
        above = value > 0
        if abs(value) < 1e-4 * free:
            break
    return middle


@on_device
def sinusoidal_truncation(
    pairs: Floats, tolerance: float, omega: float, load: float, length: float, amplitude: float
) -> tuple[int, int, int]:
    """Return harmonics, coupled harmonics and the first order of the force that is truncated."""
    beta, force_ratio, harmonics, coupled, truncated, order = amplitude / length, 1.0, 2, 1, 1, 1
    while force_ratio >= tolerance and order < _MOST_ORDERS:
        # upper bound of I_k/I_(k-1) by D. E. Amos
        force_ratio *= beta / (order - 0.5 + math.sqrt((order + 0.5) ** 2 + beta * beta))
        response = 2 * load * force_ratio * receptance_bound(pairs, order * omega)
        if force_ratio >= tolerance:
            if response > 0.5 * tolerance * amplitude:
                harmonics = order
            if response > WEAK / 10 * length:
                coupled = order
            truncated = order + 1
        order += 1
    return max(harmonics, coupled, 2), coupled, truncated
