"""Section 2.2, the flextensional actuator between two plates: rows of pull, power, velocity, saturation and speed.

Of its vibration only the quasi-static stroke is printed, so that the gain at resonance is free. One gain must agree
with both statements on friction: the reduction at 3.5 mm/s, and the speed at which the reduction vanishes.
"""

from collections.abc import Iterator
from dataclasses import replace
from math import pi
from typing import Final

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from sonolube.checks import Floats
from sonolube.facts.metrics import peak_vibration_velocity
from sonolube.facts.published import si_value
from sonolube.models.actuator import linear_amplifier_power
from sonolube.models.contact import decay_length, separation
from sonolube.models.friction import EMPIRICAL_MEMORY_LENGTH, sine_stick_slip_ratio
from sonolube.reproduction.row import Row, RowKind, default_model_row, published_formula_row, undetermined_row
from sonolube.validation.published_tests import FLEXTENSIONAL_GAINS, FrictionTest, friction_tests

_EQUAL_SPEEDS: Final = (
    "Equal speeds of sliding and vibration; of the vibration only the stroke far from resonance is printed, not the "
    "gain at resonance."
)


def flextensional_rows() -> Iterator[Row]:
    """Yield the rows of section 2.2."""
    yield _pulling_force()
    yield from _powers()
    yield from _velocities()
    yield from _saturation()
    yield from _vanishing_reduction()


def gain_of_slow_test() -> float:
    """Gain at resonance at which asperity stick-slip has the friction measured at 3.5 mm/s. []"""
    test = slow_test()
    return float(brentq(lambda gain: _ratio(test, gain) - test.friction_ratio, 1e-3, FLEXTENSIONAL_GAINS[1]))


def slow_test() -> FrictionTest:
    """Test H-1, 2.6 N and 3.5 mm/s."""
    return friction_tests("H")[0]


def stick_slip_ratio(test: FrictionTest, *, gain: ArrayLike = 1.0, sliding_speed: ArrayLike | None = None) -> Floats:
    """Friction ratio of a test by asperity stick-slip at a gain of its amplitude, at its own or at other speeds. []"""
    return sine_stick_slip_ratio(
        decay_length=_decay_length(test),
        vibration_amplitude=np.asarray(gain, dtype=np.float64) * test.vibration_amplitude,
        frequency=test.frequency,
        sliding_speed=test.sliding_speed if sliding_speed is None else sliding_speed,
    )


def _ratio(test: FrictionTest, gain: float = 1.0) -> float:
    """Friction ratio of a test by asperity stick-slip at a gain of the stroke. []"""
    return float(stick_slip_ratio(test, gain=gain))


def _decay_length(test: FrictionTest) -> float:
    """Decay length of the contact of a test. [m]"""
    return float(decay_length(test.contact, separation=separation(test.contact, normal_load=test.normal_load)))


def _pulling_force() -> Row:
    """Pulling force over the friction of one plate from the balance of forces."""
    test = slow_test()
    friction = test.friction_coefficient * test.normal_load
    note = (
        "Balance of forces: either plate presses with the same load and rubs with the same coefficient; the actuator's "
        "own weight is left out."
    )
    return published_formula_row("2.2.2-pulling-force-factor", (friction + friction) / friction, note)


def _powers() -> Iterator[Row]:
    """Yield the powers of the three levels by D 1.9."""
    for level in (1, 2, 3):
        power = linear_amplifier_power(
            capacitance=si_value("2.2.2-capacitance"),
            voltage_maximum=si_value(f"2.2.3-voltage-maximum-{level}"),
            voltage_peak_to_peak=si_value("2.2.5-voltage-peak-to-peak"),
            frequency=si_value("2.2.2-resonance"),
        )
        note = "D 1.9: capacitance times both voltages times frequency."
        yield published_formula_row(f"2.2.5-power-{level}", float(power), note)


def _velocities() -> Iterator[Row]:
    """Yield the peak vibration velocity, and the speed of no reduction that equals it."""
    test = slow_test()
    of_amplitude, of_stroke = (
        float(peak_vibration_velocity(frequency=test.frequency, vibration_amplitude=amplitude))
        for amplitude in (test.vibration_amplitude, 2 * test.vibration_amplitude)
    )
    note = f"2 pi f a, a half the stroke at this voltage; the whole stroke gives {1e3 * of_stroke:.0f} mm/s."
    yield published_formula_row("2.2.5-vibration-velocity", of_amplitude, note)
    note = f"{_EQUAL_SPEEDS} Possible: gains up to {FLEXTENSIONAL_GAINS[1]:g}."
    yield published_formula_row(
        "2.2.5-speed-of-no-reduction",
        of_amplitude,
        note,
        possible=(of_amplitude, FLEXTENSIONAL_GAINS[1] * of_amplitude),
    )


def _saturation() -> Iterator[Row]:
    """Yield the reduction at the three levels, which differ in their highest voltage alone."""
    yield undetermined_row(
        "2.2.4-reduction", "the friction forces, which are only plotted, and the roughness.", kind=RowKind.DEFAULT_MODEL
    )
    test, gain = slow_test(), gain_of_slow_test()
    note = (
        f"Asperity stick-slip at {1e3 * test.sliding_speed:g} mm/s, without gain at resonance. All three levels have 4 "
        f"V peak to peak and so one stroke: saturation is the only difference. A gain of {gain:.2g} would give the "
        "measured reduction."
    )
    at_largest = 1 - _ratio(test, FLEXTENSIONAL_GAINS[1])
    yield default_model_row("2.2.6-reduction", 1 - _ratio(test), note, possible=(1 - _ratio(test), at_largest))


def _vanishing_reduction() -> Iterator[Row]:
    """Yield the speed from which asperity stick-slip has no reduction, absolute and over the vibration velocity."""
    test, gain = slow_test(), gain_of_slow_test()
    fast = replace(test, sliding_speed=si_value("2.2.5-speed-of-no-reduction"))
    reduction = 1 - _ratio(fast, gain)
    velocity_ratio = EMPIRICAL_MEMORY_LENGTH / _decay_length(test)  # the friction ratio is 1 from omega a D_c/l on
    velocity = 2 * pi * test.frequency * test.vibration_amplitude
    yield default_model_row(
        "2.2.5-speed-of-no-reduction",
        gain * velocity_ratio * velocity,
        f"Asperity stick-slip, speed from which it has no reduction, with the gain at resonance of {gain:.2g} of its "
        f"reduction at {1e3 * test.sliding_speed:g} mm/s, with which it still has {100 * reduction:.0f} % at "
        f"{1e3 * fast.sliding_speed:g} mm/s; without gain {1e3 * velocity_ratio * velocity:.0f} mm/s.",
        suffix="asperity-stick-slip",
    )
    note = "Asperity stick-slip: memory length over decay length, at any amplitude and frequency."
    yield default_model_row("2.2.5-littmann-ratio", velocity_ratio, note, suffix="asperity-stick-slip")
