"""Generated friction recordings with voltage steps as of D 4.1.2, whose truth is known; it uses nothing of sonolube."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

Samples = NDArray[np.float64]
D_LEVELS = (0.89, 0.85, 0.67, 0.32, 0.12, 0.04)  # N, D Table 4.2
D_VOLTAGES = (0.0, 5.1, 10.3, 15.5, 20.7, 25.9)  # V
D_STARTS = (0.0, 12.5, 16.5, 20.5, 24.5, 28.5)  # s
D_END = 32.5
MOTOR_ON = 0.5  # s


@dataclass(frozen=True, kw_only=True)
class Layout:
    """Voltages, levels of the friction and beginnings of the steps of a recording."""

    starts: tuple[float, ...]
    end: float
    voltages: tuple[float, ...]
    levels: tuple[float, ...]


@dataclass(frozen=True, kw_only=True)
class Sawtooth:
    """Stick-slip in one burst: where, how often and how much the force falls."""

    start: float
    slips: int
    frequency: float
    fall: float
    fall_scatter: float = 0.05
    period_scatter: float = 0.1
    ringing_frequency: float = 0.0
    ringing_damping: float = 0.02


def layout(rng: Generator, *, published: bool) -> Layout:
    """That of D figure 4.3, or a drawn one of three to seven voltages."""
    if published:
        return Layout(starts=D_STARTS, end=D_END, voltages=D_VOLTAGES, levels=D_LEVELS)
    count = int(rng.integers(3, 8))
    durations = np.concatenate([[rng.uniform(8, 14)], rng.uniform(3, 6, count)])
    edges = np.concatenate([[0.0], np.cumsum(durations)])
    voltages = np.concatenate([[0.0], np.sort(rng.uniform(4, 40, count)) + 4 * np.arange(count)])
    levels = rng.uniform(0.6, 3.0) * np.concatenate([[1.0], np.sort(rng.uniform(0.1, 0.95, count))[::-1]])
    return Layout(starts=tuple(edges[:-1]), end=float(edges[-1]), voltages=tuple(voltages), levels=tuple(levels))


def times(plan: Layout, rate: float) -> Samples:
    """Sample times of a recording."""
    return np.arange(int(plan.end * rate)) / rate


def held(plan: Layout, t: Samples, values: Sequence[float]) -> Samples:
    """Value of each step over time."""
    return np.asarray(values)[np.searchsorted(plan.starts, t, side="right") - 1]


def red_noise(rng: Generator, t: Samples, *, deviation: float, time_constant: float) -> Samples:
    """First-order autoregression in its stationary state."""
    from scipy.signal import lfilter

    phi = np.exp(-(t[1] - t[0]) / time_constant)
    start = phi * deviation * rng.standard_normal()
    drive = deviation * np.sqrt(1 - phi**2) * rng.standard_normal(t.size)
    return np.asarray(lfilter([1.0], [1.0, -phi], drive, zi=[start])[0])


def wobble(rng: Generator, t: Samples, *, speed: float, amplitudes: Sequence[float]) -> Samples:
    """Harmonics of the rotation with drawn phases."""
    phases = rng.uniform(0, 2 * np.pi, len(amplitudes))
    orders = enumerate(zip(amplitudes, phases, strict=True), start=1)
    return np.asarray(sum(a * np.cos(2 * np.pi * k * speed * t + phase) for k, (a, phase) in orders))


def stick_slip(rng: Generator, t: Samples, burst: Sawtooth) -> Samples:
    """Sawtooth about zero that begins and ends at its middle, each slip followed by the ringing of the sensor."""
    periods = np.maximum(1 + burst.period_scatter * rng.standard_normal(burst.slips + 1), 0.5) / burst.frequency
    slips = burst.start + periods[0] / 2 + np.concatenate([[0.0], np.cumsum(periods[1:-1])])
    falls = burst.fall * (1 + burst.fall_scatter * rng.standard_normal(burst.slips))
    knots = [slips[0] - periods[0] / 2, *slips, slips[-1] + periods[-1] / 2]
    force = np.zeros(t.size)
    level = 0.0
    for number, (first, last) in enumerate(pairwise(knots)):
        inside = (t >= first) & (t < last)
        top = falls[number] / 2 if number < burst.slips else 0.0
        force[inside] = level + (top - level) * (t[inside] - first) / (last - first)
        level = -top
    if burst.ringing_frequency:
        pulse = 2 * np.pi * burst.ringing_frequency
        for slip, fall in zip(slips, falls, strict=True):
            since = t - slip
            after = (since >= 0) & (since < 8 / (burst.ringing_damping * pulse))
            decay = np.exp(-burst.ringing_damping * pulse * since[after])
            force[after] += fall * decay * np.cos(pulse * since[after])
    return force


def burst_duration(slips: int, frequency: float) -> float:
    """Longest time that a burst is likely to take."""
    return float((slips + 0.5 * np.sqrt(slips) + 0.5) / frequency)
