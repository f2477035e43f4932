"""The steady state with one harmonic, and how finely to look for the full one, by a thread."""

import math

from sonolube.checks import Floats
from sonolube.dynamics.gpu.device import on_device
from sonolube.dynamics.gpu.structure_rows import receptance_bound
from sonolube.dynamics.harmonic_balance.bessel import LARGE_0, LARGE_1, SMALL_0, SMALL_1
from sonolube.dynamics.harmonic_balance.initial_guess import WEAK

_GRID = 32
_LARGEST = 600.0  # exponent


@on_device
def bessel_ratio(beta: float) -> float:
    """Return I_1/I_0 to within 2e-6."""
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


@on_device
def bessel_logarithm(beta: float) -> float:
    """Return ln I_0 to within 2e-6."""
    i0 = 0.0
    if beta < 3.75:
        for power in range(6, -1, -1):
            i0 = SMALL_0[power] + (beta / 3.75) ** 2 * i0
        return math.log(i0)
    for power in range(8, -1, -1):
        i0 = LARGE_0[power] + 3.75 / beta * i0
    return beta + math.log(i0 / math.sqrt(beta))


@on_device
def sine_balance(
    length: float, load: float, static_stiffness: float, static_displacement: float, amplitude: float
) -> tuple[float, float]:
    """Return the mean that balances a sinusoidal motion, and the amplitude of the contact force opposing it."""
    beta = amplitude / length
    rise, opposing = bessel_logarithm(beta), 2 * bessel_ratio(beta)
    if static_stiffness == 0.0:
        return length * rise, load * opposing
    lower, upper = min(static_displacement, 0.0), max(static_displacement, amplitude)
    mean, small = lower, 1e-6 * (amplitude + 1e-3 * length)
    force = load * math.exp(min(rise - mean / length, _LARGEST))
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
        force = load * math.exp(min(rise - mean / length, _LARGEST))
        if abs(step) < small:
            break
    return mean, force * opposing


@on_device
def required(
    length: float,
    load: float,
    static_stiffness: float,
    static_displacement: float,
    g_re: float,
    g_im: float,
    amplitude: float,
) -> tuple[float, float]:
    """Return the free amplitude that an amplitude needs, |a + G force(a)|, and the force."""
    force = sine_balance(length, load, static_stiffness, static_displacement, amplitude)[1]
    re, im = amplitude + g_re * force, g_im * force
    return math.sqrt(re * re + im * im), force


@on_device
def sine_amplitudes(
    length: float,
    load: float,
    static_stiffness: float,
    static_displacement: float,
    g_re: float,
    g_im: float,
    free: float,
) -> tuple[float, float]:
    """Return the lowest and highest amplitude that balances with one harmonic."""
    if free == 0.0:
        return free, free
    size = math.sqrt(g_re * g_re + g_im * g_im)
    small = 1e-3 * length
    at_rest = sine_balance(length, load, static_stiffness, static_displacement, small)[1] / small
    force = sine_balance(length, load, static_stiffness, static_displacement, free)[1]
    if size * max(at_rest, force / free) < WEAK:
        amplitude = free
        for _ in range(3):
            re, im = 1 + g_re * force / amplitude, g_im * force / amplitude
            amplitude = free / math.sqrt(re * re + im * im)
            force = sine_balance(length, load, static_stiffness, static_displacement, amplitude)[1]
        return amplitude, amplitude
    largest = 1.1 * free + small
    for _ in range(60):
        needed, force = required(length, load, static_stiffness, static_displacement, g_re, g_im, largest)
        if needed > free and largest > size * force:
            break
        largest *= 1.5
    return scanned_amplitudes(length, load, static_stiffness, static_displacement, g_re, g_im, free, largest)


@on_device
def scanned_amplitudes(
    length: float,
    load: float,
    static_stiffness: float,
    static_displacement: float,
    g_re: float,
    g_im: float,
    free: float,
    largest: float,
) -> tuple[float, float]:
    """Return the lowest and highest root up to the largest amplitude, each found by false position."""
    lowest, highest, found = free, free, False
    lower, short = 0.0, -free
    spread = math.asinh(largest / length)
    for i in range(1, _GRID + 1):
        upper = length * math.sinh(spread * i / _GRID)
        excess = required(length, load, static_stiffness, static_displacement, g_re, g_im, upper)[0] - free
        if short < 0 and excess >= 0:
            highest = sine_root(
                length, load, static_stiffness, static_displacement, g_re, g_im, free, lower, short, upper, excess
            )
            if not found:
                lowest, found = highest, True
        lower, short = upper, excess
    return lowest, highest


@on_device
def sine_root(
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
    """Return the amplitude between two at which what balances passes the free amplitude (false position, Illinois)."""
    middle, above = upper, False
    for _ in range(12):
        middle = (lower * excess - upper * short) / (excess - short)
        value = required(length, load, static_stiffness, static_displacement, g_re, g_im, middle)[0] - free
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
def sine_orders(
    pairs: Floats, tolerance: float, omega: float, load: float, length: float, amplitude: float
) -> tuple[int, int, int]:
    """Return harmonics, coupled harmonics and the order of the force that is left out."""
    beta, share, harmonics, coupled, left_out, order = amplitude / length, 1.0, 2, 1, 1, 1
    while share >= tolerance and order < 64:
        # about I_k/I_(k-1), a little too much (D. E. Amos)
        share *= beta / (order - 0.5 + math.sqrt((order + 0.5) ** 2 + beta * beta))
        answer = 2 * load * share * receptance_bound(pairs, order * omega)
        if share >= tolerance:
            if answer > 0.5 * tolerance * amplitude:
                harmonics = order
            if answer > WEAK / 10 * length:
                coupled = order
            left_out = order + 1
        order += 1
    return max(harmonics, coupled, 2), coupled, left_out
