"""Generated runs with switched vibration whose decay length, zero and amplitude are known; it uses nothing of sonolube.

Friction comes from elements that stick and slip, marched through periods in small steps; contact stiffnesses from the
contact force integrated over a period; the current from a resonator beside the capacitance of its stack. Courses over
the distance are sigmoids and straight lines. The friction ratio has an error in level and slope, every reading has
noise and a slow wander, and the force has the wobble of the disc.
"""

from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

Samples = NDArray[np.float64]

NORMAL_LOAD = 5.0  # N
SLIDING_SPEED = 65e-3  # m/s
FREQUENCY = 22e3  # Hz
AMPLITUDE = 2.3e-6  # m
STAGE = 5.0  # m between two switches
END = 300.0  # m
FREE_FREQUENCY = 40.0  # Hz, of the slow mode
MODAL_MASS = 8.0  # kg
VOLTAGE = 26.0  # V, peak to peak
KINDS = ("long_sliding", "zero_error", "detuning", "none", "several", "weak", "friction_alone")


@dataclass(frozen=True, kw_only=True, eq=False)
class Truth:
    """What a run was made of, each at its switches."""

    kind: str
    changed: tuple[str, ...]
    distance: Samples
    decay_length: Samples
    amplitude: Samples
    force_zero: Samples
    dry_friction: Samples
    ratio: Samples
    current: Samples
    small_shift: Samples
    large_shift: Samples


def stick_slip_ratio(decay_length: Samples, amplitude: Samples, memory_length: float, *, steps: int = 1200) -> Samples:
    """Friction ratio of elements at many gaps, each with its spring, marched through two periods."""
    beta = (amplitude / decay_length)[:, None]
    reach = SLIDING_SPEED * decay_length / (2 * np.pi * FREQUENCY * amplitude * memory_length)
    edges = np.linspace(-1.0, 14.0 / beta[:, 0], 241).T
    c = (edges[:, 1:] + edges[:, :-1]) / 2
    spring, mean, weight = np.maximum(c - 1, 0.0), np.zeros_like(c), np.exp(-beta * c) * np.diff(edges, axis=1)
    turn = 2 * np.pi / steps
    for step in range(2 * steps):
        limit = np.maximum(c - np.cos(turn * (step + 0.5)), 0.0)
        spring = np.minimum(spring + turn * reach[:, None], limit)
        if step >= steps:
            mean += spring / steps
    normal = np.exp(beta[:, 0] * np.cos(turn * np.arange(steps))[:, None]).mean(axis=0)  # I0
    return np.asarray(np.minimum(beta[:, 0] ** 2 / normal * (weight * mean).sum(axis=1), 1.0))


def contact_stiffness(decay_length: Samples, amplitude: Samples) -> Samples:
    """First harmonic of the contact force over a harmonic motion about its balanced mean, over the amplitude."""
    phase = 2 * np.pi * (np.arange(256) + 0.5) / 256
    force = np.exp(-(amplitude / decay_length)[:, None] * np.cos(phase))
    force *= NORMAL_LOAD / force.mean(axis=1, keepdims=True)
    return np.asarray(-2 * (force * np.cos(phase)).mean(axis=1) / amplitude)


def truth(rng: Generator, kind: str) -> Truth:
    """Draw a run under one hypothesis, under several, with a weak change, or with friction that changes alone."""
    s = np.arange(STAGE, END, STAGE)
    length, fall = np.full(s.size, 1e-6 * np.exp(rng.uniform(np.log(0.65), np.log(2.2)))), np.zeros(s.size)
    zero, dry = np.zeros(s.size), rng.uniform(0.17, 0.32) * NORMAL_LOAD
    alone = np.zeros(s.size)
    changes = {
        "several": tuple(rng.permutation(["long_sliding", "zero_error", "detuning"])[:2].tolist()),
        "weak": ("weak",),
        "friction_alone": ("friction_alone",),
        "none": (),
    }.get(kind, (kind,))
    if "long_sliding" in changes:
        length = 0.7e-6 * np.exp(rng.normal(0, 0.12) + np.log(_factor(rng)) * _sigmoid(rng, s))
    if "detuning" in changes:
        fall = np.log(_factor(rng)) * _course(rng, s)
    if "zero_error" in changes:
        zero = -dry * rng.uniform(0.34, 0.65) * (np.ones(s.size) if rng.random() < 0.5 else _sigmoid(rng, s))
        length = np.full(s.size, 1e-6 * rng.uniform(1.3, 2.1)) if kind == "zero_error" else length
    if kind == "weak":
        which, course = rng.integers(3), _course(rng, s)
        length = length * np.exp((which == 0) * rng.uniform(0.15, 0.3) * course)
        fall = fall + (which == 1) * rng.uniform(0.15, 0.3) * course
        zero = zero - (which == 2) * rng.uniform(0.10, 0.18) * dry * course
        changes = (("long_sliding", "detuning", "zero_error")[which],)
    if kind == "friction_alone":
        alone = rng.uniform(0.2, 0.3) * _sigmoid(rng, s)
    return _with_readings(rng, (kind, changes), s, length, fall, zero, dry, alone)


def _with_readings(
    rng: Generator,
    what: tuple[str, tuple[str, ...]],
    s: Samples,
    length: Samples,
    fall: Samples,
    zero: Samples,
    dry: float,
    alone: Samples,
) -> Truth:
    """Readings without noise of the courses of a run, each with its own slow wander."""
    length = length * np.exp(_wander(rng, s, 0.03))
    amplitude = AMPLITUDE * np.exp(rng.normal(0, 0.1) - fall + _wander(rng, s, 0.015))
    ratio = stick_slip_ratio(length, amplitude, 1.5e-6 * np.exp(rng.normal(0, 0.25)))
    beta = np.log(amplitude / length)
    ratio = ratio + rng.normal(0, 0.07) + rng.normal(0, 0.05) * (beta - beta[0]) + alone + _wander(rng, s, 0.01)
    friction = dry * (1 - rng.uniform(0.1, 0.4) * np.exp(-s / rng.uniform(5, 40))) * np.exp(_wander(rng, s, 0.03))
    follows = rng.random() < 0.5
    driven = rng.uniform(1.5e-6, 3e-6) * (amplitude / amplitude[0] if follows else np.ones(s.size))
    shifts = [
        np.sqrt(FREE_FREQUENCY**2 + k / (4 * np.pi**2 * MODAL_MASS)) - FREE_FREQUENCY
        for k in (NORMAL_LOAD / length, contact_stiffness(length, driven))
    ]
    wander = _wander(rng, s, 0.01)
    return Truth(
        kind=what[0],
        changed=what[1],
        distance=s,
        decay_length=length,
        amplitude=amplitude,
        force_zero=zero + dry * _wander(rng, s, 0.01),
        dry_friction=friction,
        ratio=np.clip(ratio, 0.02, 1.1),
        current=_current(rng, amplitude / amplitude[0]) * np.exp(_wander(rng, s, 0.01)),
        small_shift=shifts[0] * (1 + wander),
        large_shift=shifts[1] * (1 + wander),
    )


def _factor(rng: Generator) -> float:
    """Factor of a change that is large enough for the published sets: about 2.9."""
    return float(np.exp(np.log(2 / 0.7) + rng.normal(0, 0.15)))


def _sigmoid(rng: Generator, s: Samples) -> Samples:
    """Course from 0 to nearly 1, steepest in the logarithm of the distance, complete at the end."""
    power, half = rng.uniform(1.2, 2.5), rng.uniform(20, 90)
    course = s**power / (s**power + half**power)
    return np.asarray(course / course[-1])


def _course(rng: Generator, s: Samples) -> Samples:
    """Sigmoid, or a straight line."""
    return s / s[-1] if rng.random() < 0.5 else _sigmoid(rng, s)


def _wander(rng: Generator, s: Samples, deviation: float) -> Samples:
    """First-order autoregression over the distance, about zero."""
    memory = np.exp(-STAGE / rng.uniform(10, 60))
    values = np.empty(s.size)
    values[0] = deviation * rng.standard_normal()
    for index, push in enumerate(rng.standard_normal(s.size - 1), start=1):
        values[index] = memory * values[index - 1] + deviation * np.sqrt(1 - memory**2) * push
    return values


def _current(rng: Generator, relative: Samples) -> Samples:
    """Current of a resonator that leaves its drive, or of one whose drive weakens, beside that of the capacitance."""
    capacitive = rng.uniform(0.0, 0.5)
    if rng.random() < 0.5:
        return np.asarray(0.4 * np.abs(1j * capacitive + relative))
    off = rng.choice([-1, 1]) * np.sqrt(np.maximum(1 / np.minimum(relative, 1.0) ** 2 - 1, 0.0))
    return np.asarray(0.4 * np.abs(1j * capacitive + 1 / (1 + 1j * off)))


def noisy_table(rng: Generator, made: Truth) -> dict[str, Samples]:
    """Readings at the switches with white noise, by the names of their columns, in SI."""
    count = made.distance.size

    def white(deviation: float) -> Samples:
        return np.asarray(deviation * rng.standard_normal(count))

    level = float(made.dry_friction.mean())
    return {
        "sliding_distance": made.distance,
        "friction_force": made.ratio * made.dry_friction + made.force_zero + white(0.008 * level),
        "intrinsic_friction_force": made.dry_friction + made.force_zero + white(0.008 * level),
        "force_zero": made.force_zero + white(0.006 * level),
        "stack_current": made.current * (1 + white(0.01)),
        "small_drive_shift": made.small_shift + white(0.02) * made.small_shift.mean(),
        "large_drive_shift": made.large_shift + white(0.02) * made.large_shift.mean(),
    }


def recording(rng: Generator, made: Truth, *, rate: float = 10.0, lift: float = 12.0) -> dict[str, Samples]:
    """Channels over time: slides of 5 m by turns without and with vibration, the pin lifted at each switch."""
    slide = round(STAGE / SLIDING_SPEED * rate)
    held = round(lift * rate)
    stages = made.distance.size + 1
    size = stages * slide + (stages - 1) * held
    t = np.arange(size) / rate
    place = np.arange(size) % (slide + held)
    stage = np.arange(size) // (slide + held)
    lifted = place >= slide
    distance = STAGE * (stage + np.minimum(place / slide, 1.0))
    on = (stage % 2 == 1) & ~lifted

    def at(values: Samples) -> Samples:
        return np.asarray(np.interp(distance, made.distance, values))

    dry = at(made.dry_friction)
    wobble = 0.05 * np.cos(2 * np.pi * rng.uniform(0.3, 0.8) * t + rng.uniform(0, 6))
    sliding = dry * np.where(on, at(made.ratio), 1.0) * (1 + wobble + 0.03 * rng.standard_normal(size))
    force = at(made.force_zero) + np.where(lifted, 0.0, sliding) + 0.01 * rng.standard_normal(size)
    readings = noisy_table(rng, made)
    switch = np.minimum(stage, made.distance.size - 1)
    shift = {
        name: np.where(lifted, readings[name][switch], np.nan) for name in ("small_drive_shift", "large_drive_shift")
    }
    return {
        "time": t,
        "friction_force": force,
        "voltage_peak_to_peak": np.where(on, VOLTAGE, 0.0),
        "normal_load": np.where(lifted, 0.0, NORMAL_LOAD) + 0.02 * rng.standard_normal(size),
        "stack_current": np.where(on, at(made.current), 0.0) + 0.002 + 0.001 * rng.standard_normal(size) ** 2,
        **shift,
    }
