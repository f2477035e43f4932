"""What a motion with two turns a period does at an exponential contact, by a thread."""

import math

from sonolube.checks import Floats
from sonolube.dynamics.gpu.device import on_device

_PLAIN = 0.7  # share of the higher harmonics' accelerations up to which a motion surely turns only twice
_SLOW = 0.05  # share of the peak velocity below which a minimum of the speed is nearly a turn
_SCAN = 16  # samples per harmonic to find the turns of any other motion


@on_device
def swing(unknown: Floats, h: int, cosine: float, sine: float) -> tuple[float, float, float]:
    """Return displacement about the mean and its first two derivatives by phase."""
    c, s, x, rate, bend = 1.0, 0.0, 0.0, 0.0, 0.0
    for k in range(1, h + 1):
        c, s = c * cosine - s * sine, c * sine + s * cosine
        real, imaginary = unknown[0, k] * c - unknown[1, k] * s, unknown[0, k] * s + unknown[1, k] * c
        x += real
        rate -= k * imaginary
        bend -= k * k * real
    return x, rate, bend


@on_device
def rate_at(unknown: Floats, h: int, j: int, count: int) -> float:
    """Return the velocity over omega at the j-th of some instants."""
    phase = 2 * math.pi * j / count
    return swing(unknown, h, math.cos(phase), math.sin(phase))[1]


@on_device
def two_turns(unknown: Floats, h: int, scanned: bool) -> tuple[bool, float, float]:
    """Return whether a motion turns only twice, and about the phases where it turns down and up.

    What the higher harmonics leave open takes samples, where these are wanted.
    """
    re, im = unknown[0, 1], unknown[1, 1]
    size, higher = math.sqrt(re * re + im * im), 0.0
    for k in range(2, h + 1):
        higher += k * k * (abs(unknown[0, k]) + abs(unknown[1, k]))
    if higher < _PLAIN * size:
        return True, math.atan2(-im, re), math.atan2(im, -re)
    if not scanned:
        return False, 0.0, 0.0
    return scanned_turns(unknown, h)


@on_device
def scanned_turns(unknown: Floats, h: int) -> tuple[bool, float, float]:
    """Return the same by samples."""
    count, fastest = _SCAN * h, 0.0
    for j in range(count):
        fastest = max(fastest, abs(rate_at(unknown, h, j, count)))
    ups, downs, slow, upper, lower = 0, 0, 0, 0.0, 0.0
    before, here = rate_at(unknown, h, -1, count), rate_at(unknown, h, 0, count)
    for j in range(count):
        after = rate_at(unknown, h, j + 1, count)
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
def turn(unknown: Floats, h: int, near: float) -> tuple[float, float]:
    """Return the phase nearby at which the velocity vanishes, and the displacement there about the mean."""
    phase, height = near, 0.0
    for _ in range(20):
        x, rate, bend = swing(unknown, h, math.cos(phase), math.sin(phase))
        step = rate / bend
        phase -= 2 * math.atan(0.5 * step)
        height = x - 0.5 * rate * step
        if abs(step) < 1e-5:
            break
    return math.atan2(math.sin(phase), math.cos(phase)), height


@on_device
def crossing(unknown: Floats, h: int, level: float, upper: float, lower: float) -> float:
    """Return the phase between two turns at which a displacement is passed."""
    inside, outside = upper, lower
    size = math.sqrt(unknown[0, 1] ** 2 + unknown[1, 1] ** 2)
    phase = upper + (lower - upper) / math.pi * math.acos(min(max(level / size, -0.99), 0.99))
    for _ in range(60):
        x, rate, _ = swing(unknown, h, math.cos(phase), math.sin(phase))
        if x > level:
            inside = phase
        else:
            outside = phase
        step = (x - level) / rate
        phase -= step
        if (phase - inside) * (phase - outside) >= 0:
            phase = 0.5 * (inside + outside)
        elif abs(step) < 1e-4:
            break
    return phase


@on_device
def loss_fraction(unknown: Floats, h: int, beyond: float, upper: float, high: float, lower: float, low: float) -> float:
    """Return the share of the period beyond a displacement, given the turns."""
    if low >= beyond:
        return 1.0
    if high <= beyond:
        return 0.0
    level = beyond - unknown[0, 0]
    after = crossing(unknown, h, level, upper, lower if lower > upper else lower + 2 * math.pi)
    before = crossing(unknown, h, level, upper, lower if lower < upper else lower - 2 * math.pi)
    return (after - before) / (2 * math.pi)
