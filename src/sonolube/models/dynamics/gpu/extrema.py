"""Extrema of a periodic motion and its time without contact, by GPU threads.

The method is that of `sonolube.models.dynamics.harmonic_balance.extrema`.
"""

import math

from sonolube.checks import Floats
from sonolube.models.dynamics.gpu.device import on_device

_WEAK_HARMONICS = 0.7  # sum of k^2 |X_k|, k > 1, over |X_1| up to which a motion certainly has two extrema
_CLEAR = 0.99  # level over amplitude, at most, from which the search for its crossing starts
_SLOW = 0.05  # velocity over its peak below which a minimum of the speed is nearly an extremum
_SAMPLES_PER_HARMONIC = 16  # to find the extrema of any other motion


@on_device
def phase_derivatives(unknown: Floats, h: int, cosine: float, sine: float) -> tuple[float, float, float]:
    """Return displacement about the mean and its first two derivatives by phase."""
    c, s, x, slope, bend = 1.0, 0.0, 0.0, 0.0, 0.0
    for k in range(1, h + 1):
        c, s = c * cosine - s * sine, c * sine + s * cosine
        real, imaginary = unknown[0, k] * c - unknown[1, k] * s, unknown[0, k] * s + unknown[1, k] * c
        x += real
        slope -= k * imaginary
        bend -= k * k * real
    return x, slope, bend


@on_device
def sampled_slope(unknown: Floats, h: int, j: int, count: int) -> float:
    """Return the derivative of the displacement by phase at the j-th of equally spaced samples."""
    phase = 2 * math.pi * j / count
    return phase_derivatives(unknown, h, math.cos(phase), math.sin(phase))[1]


@on_device
def extremum_estimates(unknown: Floats, h: int, sampled: bool) -> tuple[bool, float, float]:
    """Return whether a motion has two extrema, and estimates of the phases of maximum and minimum.

    Motions with strong higher harmonics are sampled on request, and otherwise reported to have more extrema.
    """
    re, im = unknown[0, 1], unknown[1, 1]
    size, higher = math.sqrt(re * re + im * im), 0.0
    for k in range(2, h + 1):
        higher += k * k * (abs(unknown[0, k]) + abs(unknown[1, k]))
    if higher < _WEAK_HARMONICS * size:
        return True, math.atan2(-im, re), math.atan2(im, -re)
    if not sampled:
        return False, 0.0, 0.0
    return sampled_extremum_estimates(unknown, h)


@on_device
def sampled_extremum_estimates(unknown: Floats, h: int) -> tuple[bool, float, float]:
    """Return what `extremum_estimates` does, by samples of the slope."""
    count, fastest = _SAMPLES_PER_HARMONIC * h, 0.0
    for j in range(count):
        fastest = max(fastest, abs(sampled_slope(unknown, h, j, count)))
    ups, downs, slow, upper, lower = 0, 0, 0, 0.0, 0.0
    before, here = sampled_slope(unknown, h, -1, count), sampled_slope(unknown, h, 0, count)
    for j in range(count):
        after = sampled_slope(unknown, h, j + 1, count)
        if before > 0 and here <= 0:
            ups += 1
            upper = 2 * math.pi * (j - 1 + before / (before - here)) / count
        elif before <= 0 and here > 0:
            downs += 1
            lower = 2 * math.pi * (j - 1 + before / (before - here)) / count
        elif abs(here) < _SLOW * fastest and abs(here) <= min(abs(before), abs(after)) and here * after > 0:
            slow += 1
        before, here = here, after
    return ups == 1 and downs == 1 and slow == 0, upper, lower


@on_device
def extremum(unknown: Floats, h: int, near: float) -> tuple[float, float]:
    """Return the phase of the extremum near a phase, and the displacement there about the mean."""
    phase, displacement = near, 0.0
    for _ in range(20):
        x, slope, bend = phase_derivatives(unknown, h, math.cos(phase), math.sin(phase))
        step = slope / bend
        phase -= 2 * math.atan(0.5 * step)
        displacement = x - 0.5 * slope * step
        if abs(step) < 1e-5:
            break
    return math.atan2(math.sin(phase), math.cos(phase)), displacement


@on_device
def level_crossing(unknown: Floats, h: int, level: float, upper: float, lower: float) -> float:
    """Return the phase between maximum and minimum at which a level is crossed, by Newton's method with bisection."""
    inside, outside = upper, lower
    size = math.sqrt(unknown[0, 1] ** 2 + unknown[1, 1] ** 2)
    phase = upper + (lower - upper) / math.pi * math.acos(min(max(level / size, -_CLEAR), _CLEAR))
    for _ in range(60):
        x, slope, _ = phase_derivatives(unknown, h, math.cos(phase), math.sin(phase))
        if x > level:
            inside = phase
        else:
            outside = phase
        step = (x - level) / slope
        phase -= step
        if (phase - inside) * (phase - outside) >= 0:
            phase = 0.5 * (inside + outside)
        elif abs(step) < 1e-4:
            break
    return phase


@on_device
def fraction_above(unknown: Floats, h: int, loss: float, upper: float, high: float, lower: float, low: float) -> float:
    """Return the fraction of the period beyond a displacement, given phases and displacements of the extrema."""
    if low >= loss:
        return 1.0
    if high <= loss:
        return 0.0
    level = loss - unknown[0, 0]
    after = level_crossing(unknown, h, level, upper, lower if lower > upper else lower + 2 * math.pi)
    before = level_crossing(unknown, h, level, upper, lower if lower < upper else lower - 2 * math.pi)
    return (after - before) / (2 * math.pi)
