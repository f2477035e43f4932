"""Chapter 2, the flextensional actuator between two plates: section 2.2.

Of its vibration only the stroke far from resonance is printed, so that the gain at resonance is free. One gain must
give both statements on friction: what is left of it at 3.5 mm/s, and the speed at which nothing is gained any more.
"""

from collections.abc import Iterator
from dataclasses import replace
from itertools import chain
from math import pi

from scipy.optimize import brentq

from sonolube.actuator import linear_amplifier_power
from sonolube.contact import decay_length, separation
from sonolube.friction import EMPIRICAL_MEMORY_LENGTH, sine_stick_slip_ratio
from sonolube.metrics import peak_vibration_velocity
from sonolube.published.values import stated
from sonolube.reproduce.row import Row, compare, undetermined
from sonolube.validation.friction_tests import FrictionTest, friction_tests
from sonolube.validation.inputs import named, said

_LARGEST_GAIN = 20.0  # beyond any stroke that the ceramic would bear at this voltage


def rows() -> Iterator[Row]:
    """Yield the rows of section 2.2."""
    return chain(_pull(), _power(), _velocity(), _saturation(), _loss_with_speed())


def gain_for_the_slow_test() -> float:
    """Return the gain at resonance with which the stick-slip closure gives the friction measured at 3.5 mm/s. []"""
    test = _slow_test()
    return float(brentq(lambda gain: _ratio(test, gain) - test.friction_ratio, 1e-3, _LARGEST_GAIN))


def _slow_test() -> FrictionTest:
    return next(test for test in friction_tests() if test.set_name == "H")


def _ratio(test: FrictionTest, gain: float = 1.0) -> float:
    return float(
        sine_stick_slip_ratio(
            decay_length=_decay_length(test),
            vibration_amplitude=gain * test.vibration_amplitude,
            frequency=test.frequency,
            sliding_speed=test.sliding_speed,
        )
    )


def _decay_length(test: FrictionTest) -> float:
    return float(decay_length(test.contact, separation=separation(test.contact, normal_load=test.normal_load)))


def _pull() -> Iterator[Row]:
    test = _slow_test()
    friction = test.friction_coefficient * test.normal_load
    yield compare(
        stated("2.2.2-pulling-force-factor"),
        (friction + friction) / friction,
        "Balance of forces: either plate presses with the same load and rubs with the same coefficient; the actuator's "
        "own weight is left out.",
    )


def _power() -> Iterator[Row]:
    for level in (1, 2, 3):
        power = linear_amplifier_power(
            capacitance=said("2.2.2-capacitance").value,
            voltage_maximum=said(f"2.2.3-voltage-maximum-{level}").value,
            voltage_peak_to_peak=said("2.2.5-voltage-peak-to-peak").value,
            frequency=said("2.2.2-resonance").value,
        )
        yield compare(
            stated(f"2.2.5-power-{level}"), float(power), "D 1.9: capacitance times both voltages times frequency."
        )


def _velocity() -> Iterator[Row]:
    test = _slow_test()
    at_amplitude, at_stroke = (
        float(peak_vibration_velocity(frequency=test.frequency, vibration_amplitude=amplitude))
        for amplitude in (test.vibration_amplitude, 2 * test.vibration_amplitude)
    )
    yield compare(
        stated("2.2.5-vibration-velocity"),
        at_amplitude,
        f"2 pi f a, a half the stroke at this voltage; the whole stroke gives {1e3 * at_stroke:.0f} mm/s.",
    )
    yield compare(
        stated("2.2.5-speed-of-no-reduction"),
        at_amplitude,
        "Where sliding and vibration are equally fast; of the vibration only the stroke far from resonance is printed.",
    )


def _saturation() -> Iterator[Row]:
    """Yield the reduction at each of three levels, which differ in their highest voltage alone."""
    yield undetermined(stated("2.2.4-reduction"), "the friction forces, which are only plotted, and the roughness.")
    test, gain = _slow_test(), gain_for_the_slow_test()
    for level in (1, 2, 3):
        yield compare(
            named(stated("2.2.6-reduction"), f"level-{level}"),
            1 - _ratio(test),
            f"Stick-slip closure at {1e3 * test.sliding_speed:g} mm/s, without gain at resonance. Level {level} has "
            f"the stroke of the others, for all have 4 V peak to peak: saturation is all that is left. A gain of "
            f"{gain:.2g} would give what was measured.",
        )


def _loss_with_speed() -> Iterator[Row]:
    test, gain = _slow_test(), gain_for_the_slow_test()
    fast = replace(test, sliding_speed=said("2.2.5-speed-of-no-reduction").value)
    left = 1 - _ratio(fast, gain)
    # the closure's ratio is exactly 1 from v_r = omega a D_c/l on
    share = EMPIRICAL_MEMORY_LENGTH / _decay_length(test)
    velocity = 2 * pi * test.frequency * test.vibration_amplitude
    yield compare(
        named(stated("2.2.5-speed-of-no-reduction"), "stick-slip"),
        gain * share * velocity,
        f"Stick-slip closure, from where on it gives no reduction, with the gain of {gain:.2g} at resonance that its "
        f"reduction at {1e3 * test.sliding_speed:g} mm/s asks for, where {100 * left:.0f} % are still gained at "
        f"{1e3 * fast.sliding_speed:g} mm/s; without gain {1e3 * share * velocity:.0f} mm/s.",
    )
    yield compare(
        named(stated("2.2.5-littmann-ratio"), "stick-slip"),
        share,
        "Stick-slip closure: memory length over decay length, whatever amplitude and frequency.",
    )
