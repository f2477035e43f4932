"""What a periodic motion does at the contact: its turning points, its forces and how long the contact is lost."""

from typing import NamedTuple

import numba
import numpy as np

from sonolube.checks import Complexes, Floats
from sonolube.dynamics.contact_lanes import EXPONENTIAL, HERTZ, LOST, TABULATED, Law, loss_displacement, rest
from sonolube.dynamics.force_table import log_force_at
from sonolube.dynamics.gap_law import LARGEST_EXPONENT
from sonolube.dynamics.harmonic_kernel import Integers
from sonolube.dynamics.lanes import INSIDE, KERNEL

_PLAIN = 0.7  # share of the higher harmonics' accelerations up to which a motion surely turns only twice
_CLEAR = 0.95  # level over amplitude up to which it is passed well away from the turns
_SLOW = 0.05  # share of the peak velocity below which a minimum of the speed is nearly a turn
_SCAN = 16  # samples per harmonic to find the turns of any other motion


class Measures(NamedTuple):
    """Measures of the motion, one entry of each array to a point."""

    amplitude: Floats  # (p,) m, half of peak to peak
    turns: Floats  # (p, 2): phases of the upper and the lower turn; NaN where there are more
    lowest_displacement: Floats  # (p,) m
    force: Floats  # (p, 2) N: highest and lowest
    lost: Floats  # (p,) share of the period


@numba.njit(**KERNEL)
def measure(
    law: Law,
    omega: Floats,
    load: Floats,
    mean: Floats,
    harmonics: Complexes,
    count: Integers,
    measures: Measures,
) -> None:
    """Measure every motion.

    Parameters
    ----------
    law : Law
    omega, load, mean : ndarray, shape (p,)
        Angular frequency, in rad/s, dead load, in N, and mean displacement, in m.
    harmonics : ndarray of complex, shape (p, room)
    count : ndarray of int, shape (p,)
        Harmonics of each motion.
    measures : Measures
        Written.
    """
    for point in range(omega.size):
        own = harmonics[point, : count[point]]
        beyond = loss_displacement(law, load[point])
        size = np.sqrt(own[0].real * own[0].real + own[0].imag * own[0].imag)
        if _surely_turns_twice(own, size):
            above = own[0].conjugate() / size  # where the first harmonic turns
            below = -above
        else:
            above, below = _two_turns(own)
        if not np.isnan(above.real):
            upper, high = _turn(own, above)
            lower, low = _turn(own, below)
            high, low = mean[point] + high, mean[point] + low
            measures.turns[point, 0], measures.turns[point, 1] = upper, lower
            resting = rest(law, load[point])
            measures.force[point, 0] = contact_force(law, load[point], resting, low, 0.0)
            measures.force[point, 1] = contact_force(law, load[point], resting, high, 0.0)
            measures.lost[point] = 1.0 if low >= beyond else 0.0
            if low < beyond < high:
                measures.lost[point] = _share_above(own, beyond - mean[point], size, upper, lower)
        else:
            measures.turns[point, :] = np.nan
            high, low = _scan(law, omega[point], load[point], mean[point], own, measures, point)
        if law.damping > 0.0:
            _scan(law, omega[point], load[point], mean[point], own, measures, point)
        measures.amplitude[point] = 0.5 * (high - low)
        measures.lowest_displacement[point] = low


@numba.njit(**INSIDE)
def contact_force(law: Law, load: float, resting: float, x: float, v: float) -> float:
    """Return the contact force, in N, of a contact that rests where `rest` says."""
    if law.kind == EXPONENTIAL:
        force = load * np.exp(min(-x / law.parameter, LARGEST_EXPONENT))
    elif law.kind == HERTZ:
        force = law.parameter * max(resting - x, 0.0) ** 1.5
    elif law.kind == TABULATED:
        log_force = log_force_at(law.cells, resting + law.parameter * x)[0]
        force = np.exp(min(max(log_force, -LARGEST_EXPONENT), LARGEST_EXPONENT))
    else:
        force = max(load - law.parameter * x, 0.0)
    return float(force * max(1 - law.damping * v, 0.0))


@numba.njit(**INSIDE)
def _surely_turns_twice(own: Complexes, size: float) -> bool:
    higher = 0.0
    for k in range(2, own.size + 1):
        higher += k * k * (abs(own[k - 1].real) + abs(own[k - 1].imag))
    return bool(higher < _PLAIN * size)


@numba.njit(**INSIDE)
def _two_turns(own: Complexes) -> tuple[complex, complex]:
    """Return exp(i phase) about where a motion turns down and up, NaN if it turns, or nearly does, more than twice."""
    count = _SCAN * own.size
    rates, fastest = np.empty(count), 0.0
    for j in range(count):
        rates[j] = swing(own, 2 * np.pi * j / count)[1]
        fastest = max(fastest, abs(rates[j]))
    slow = _SLOW * fastest
    upper = lower = np.nan
    for j in range(count):
        before, here, after = rates[j - 1], rates[j], rates[(j + 1) % count]
        if before > 0 >= here:
            if not np.isnan(upper):
                return complex(np.nan), complex(np.nan)
            upper = 2 * np.pi * (j - 1 + before / (before - here)) / count
        elif before <= 0 < here:
            if not np.isnan(lower):
                return complex(np.nan), complex(np.nan)
            lower = 2 * np.pi * (j - 1 + before / (before - here)) / count
        elif abs(here) < slow and abs(here) <= abs(before) and abs(here) <= abs(after) and here * after > 0:
            return complex(np.nan), complex(np.nan)
    return np.exp(1j * upper), np.exp(1j * lower)


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


@numba.njit(**INSIDE)
def _turn(own: Complexes, near: complex) -> tuple[float, float]:
    """Return the phase nearby at which the velocity vanishes, and the displacement there about the mean."""
    cosine, sine = near.real, near.imag
    for _ in range(20):
        x, rate, bend = _swing_at(own, cosine, sine)
        step = rate / bend
        # back by 2 arctan(step/2), which keeps the pair on the circle and needs no sine
        share = 1 / (1 + 0.25 * step * step)
        along, across = (1 - 0.25 * step * step) * share, step * share
        cosine, sine = cosine * along + sine * across, sine * along - cosine * across
        if abs(step) < 1e-5:  # Newton's next step would be of the order of its square
            break
    return np.arctan2(sine, cosine), x - 0.5 * rate * step


@numba.njit(**INSIDE)
def _share_above(own: Complexes, level: float, size: float, upper: float, lower: float) -> float:
    """Return the share of the period in which a motion of two turns lies above a level between them."""
    cosine = level / size
    if abs(cosine) < _CLEAR and _surely_turns_twice(own, size):
        turn, aside = own[0].conjugate() / size, 1j * np.sqrt(1 - cosine * cosine)
        after, sure = _passage(own, level, turn * (cosine + aside))
        before, also = _passage(own, level, turn * (cosine - aside))
        if sure and also:
            angle = after * before.conjugate()
            return float(np.arctan2(angle.imag, angle.real) / (2 * np.pi) % 1.0)
    end = _crossing(own, level, upper, lower if lower > upper else lower + 2 * np.pi)
    start = _crossing(own, level, upper, lower if lower < upper else lower - 2 * np.pi)
    return float((end - start) / (2 * np.pi))


@numba.njit(**INSIDE)
def _passage(own: Complexes, level: float, near: complex) -> tuple[complex, bool]:
    """Return exp(i phase) nearby at which a displacement is passed, and whether three steps sufficed."""
    step = np.inf
    for _ in range(3):
        x, rate, _ = _swing_at(own, near.real, near.imag)
        step = (x - level) / rate
        near *= complex(1.0, -0.5 * step) / complex(1.0, 0.5 * step)
        if abs(step) < 1e-4:
            break
    return near, abs(step) < 1e-4


@numba.njit(**INSIDE)
def _crossing(own: Complexes, level: float, upper: float, lower: float) -> float:
    """Return the phase between two turns at which a displacement is passed."""
    inside, outside = upper, lower
    phase = upper + (lower - upper) / np.pi * np.arccos(min(max(level / abs(own[0]), -0.99), 0.99))
    for _ in range(60):
        x, rate, _ = swing(own, phase)
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
    return float(phase)


@numba.njit(**INSIDE)
def _scan(
    law: Law, omega: float, load: float, mean: float, own: Complexes, measures: Measures, point: int
) -> tuple[float, float]:
    """Measure a motion of many turns, or one whose force lags, by samples with parabolas through the extremes."""
    count = max(_SCAN * own.size, 256)
    x, force = np.empty(count), np.empty(count)
    lost, threshold, resting = 0.0, LOST * load, rest(law, load)
    for j in range(count):
        displacement, rate, _ = swing(own, 2 * np.pi * j / count)
        x[j] = mean + displacement
        force[j] = contact_force(law, load, resting, x[j], omega * rate)
    for j in range(count):
        here, after = force[j] - threshold, force[(j + 1) % count] - threshold
        if here < 0 and after < 0:
            lost += 1
        elif here * after < 0:
            lost += max(-here, -after) / abs(here - after)
    measures.force[point, 0] = _extreme(force, 1.0)
    measures.force[point, 1] = max(_extreme(force, -1.0), 0.0)
    measures.lost[point] = lost / count
    return _extreme(x, 1.0), _extreme(x, -1.0)


@numba.njit(**INSIDE)
def _extreme(samples: Floats, sign: float) -> float:
    """Return the highest of samples of a period, or with a negative sign the lowest."""
    top = 0
    for j in range(samples.size):
        if sign * samples[j] > sign * samples[top]:
            top = j
    before, here, after = samples[top - 1], samples[top], samples[(top + 1) % samples.size]
    bend = 2 * here - before - after
    return float(here if sign * bend <= 0 else here + (after - before) ** 2 / (8 * bend))
