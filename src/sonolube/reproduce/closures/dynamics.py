"""Closures on motions that the dynamics gives: does it do better than a prescribed sine against Tables 2.3 and 4.2?

It does not, and must not. The contact's few newtons bend the motion of a tip that its inertia drives with thousands:
higher harmonics stay below 1e-4 of the first. A slow motion of the arm, however large, changes nothing: exponential
heights know no scale but the decay length, so that a shift of the gap multiplies normal force and friction of every
asperity by one and the same factor, and where the mean force is the load the factor's mean is 1. An error of the dead
load drops out of the ratio, unless it comes and goes with the vibration; Table 4.2 would need nine tenths of the load
to leave.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import Final

import numpy as np

from sonolube.checks import Floats
from sonolube.contact import GapMotion, decay_length, load_balanced_motion, sinusoidal_motion
from sonolube.dynamics import (
    ExponentialGap,
    Structure,
    chain_structure,
    contact_motion as motion_of,
    pin_on_disc_chain,
    steady_state,
    trajectory,
)
from sonolube.friction import FRICTION_MODELS
from sonolube.reproduce.row import Row, compare
from sonolube.validation.fit import measured_in
from sonolube.validation.friction_tests import FrictionTest
from sonolube.validation.inputs import in_table, said
from sonolube.validation.tribometer import IDENTIFIED, tribometer_stack

MOTIONS: Final = {
    "sine": "a prescribed sine of the stated amplitude, balanced",
    "harmonic-balance": "the steady motion of the identified tribometer, all harmonics",
    "slow-arm": "that motion on an arm that swings by a decay length at 100 Hz",
    "marched": "the tribometer marched from rest, its last arm period of 0.05 s",
}
"""The motions compared."""

TESTS: Final = "AB"
"""Sets whose voltages are known: Tables 2.3 and 4.2."""

MODELS: Final = ("asperity_stick_slip", "bristle_with_holder")
"""Friction models compared with their default parameters, the holder rigid."""

_SAMPLES: Final = 256  # of one period of the drive
_SLOW_SAMPLES: Final = 64  # of one period of the drive, where an arm period of them is followed
_STEPS: Final = 64


@dataclass(frozen=True, kw_only=True, slots=True)
class Prediction:
    """Friction ratios of one test by every model under every motion.

    Parameters
    ----------
    test : FrictionTest
    ratios : mapping of (str, str) to float
        Friction ratio by model and motion.
    """

    test: FrictionTest
    ratios: Mapping[tuple[str, str], float]


@cache
def predictions() -> tuple[Prediction, ...]:
    """Return the ratio of every friction model under every motion, for each test of both tables."""
    return tuple(
        Prediction(
            test=test,
            ratios={(model, name): _ratio(model, test, moving) for model in MODELS for name, moving in _motions(test)},
        )
        for test in measured_in(TESTS)
    )


def rows() -> Iterator[Row]:
    """Yield one row for each reduction of both tables, by stick-slip on the motion that the dynamics gives."""
    for prediction in predictions():
        test = prediction.test
        ratios = {name: prediction.ratios["asperity_stick_slip", name] for name in MOTIONS}
        assert test.published is not None
        by_motion = "; ".join(f"{MOTIONS[name]} {ratio:.4f}" for name, ratio in ratios.items())
        yield compare(
            replace(test.published, id=f"closure-stick-slip-on-dynamics-{test.label}"),
            1 - ratios["harmonic-balance"],
            "Friction model asperity_stick_slip with its default parameters. "
            f"Ratio measured {test.friction_ratio:.3f}; on {by_motion}.",
        )


@cache
def identified_structure() -> Structure:
    """Return the tribometer's structure with the parameters that the published facts identify."""
    return chain_structure(pin_on_disc_chain(tribometer_stack(), **IDENTIFIED))


def slow_arm_motion(test: FrictionTest, moving: GapMotion, *, swing: float, cycles: int) -> GapMotion:
    """Return a motion on an arm that swings once in some cycles of it, balanced over the whole.

    Parameters
    ----------
    test : FrictionTest
    moving : GapMotion
        One cycle.
    swing : float
        Amplitude of the arm at the contact, in m.
    cycles : int
        Cycles in one swing.

    Returns
    -------
    GapMotion
    """
    one = moving.resampled(_SLOW_SAMPLES).displacement
    slow = swing * np.cos(2 * np.pi * np.arange(cycles * one.size) / (cycles * one.size))
    return load_balanced_motion(
        test.contact, _motion(np.tile(one, cycles) + slow, np.ones(slow.size), test, cycles=cycles)
    )


def _motions(test: FrictionTest) -> Iterator[tuple[str, GapMotion]]:
    about_rest = sinusoidal_motion(
        test.contact,
        normal_load=test.normal_load,
        vibration_amplitude=test.vibration_amplitude,
        frequency=test.frequency,
    )
    steady = _steady_motion(test)
    yield "sine", load_balanced_motion(test.contact, about_rest)
    yield "harmonic-balance", steady
    yield "slow-arm", slow_arm_motion(test, steady, swing=_law(test).decay_length, cycles=_arm_cycles(test))
    yield "marched", _marched_motion(test)


def _ratio(model: str, test: FrictionTest, moving: GapMotion) -> float:
    speed, mu = test.sliding_speed, test.friction_coefficient
    return float(FRICTION_MODELS[model]().ratio(test.contact, moving, sliding_speed=speed, friction_coefficient=mu))


def _steady_motion(test: FrictionTest) -> GapMotion:
    states = steady_state(
        identified_structure(),
        _law(test),
        normal_load=test.normal_load,
        frequency=test.frequency,
        voltage_amplitude=_voltage(test) / 2,
    )
    period = motion_of(states, (), samples=_SAMPLES)
    return _motion(period.displacement, period.normal_force, test)


def _marched_motion(test: FrictionTest) -> GapMotion:
    cycles = _arm_cycles(test)
    periods = round(said("3.3.4-settling-time").value * test.frequency)
    contact = trajectory(
        identified_structure(),
        _law(test),
        normal_load=test.normal_load,
        frequency=test.frequency,
        voltage_peak_to_peak=_voltage(test),
        periods=periods,
        steps_per_period=_STEPS,
    ).contact
    last = slice(-cycles * _STEPS, None)
    return _motion(contact.displacement[last], contact.normal_force[last], test, cycles=cycles)


def _motion(displacement: Floats, force: Floats, test: FrictionTest, *, cycles: int = 1) -> GapMotion:
    return GapMotion(
        displacement=displacement,
        normal_force=force,
        frequency=test.frequency / cycles,
        normal_load=test.normal_load,
    )


def _law(test: FrictionTest) -> ExponentialGap:
    return ExponentialGap(decay_length=float(decay_length(test.contact)))


def _arm_cycles(test: FrictionTest) -> int:
    return round(test.frequency / said("3.3.4-residual-frequency").value)


def _voltage(test: FrictionTest) -> float:
    """Return the voltage from peak to peak; of Table 2.3 that of the same amplitude per volt."""
    per_volt = in_table("4.1", "vibration_amplitude", 14).value / in_table("4.1", "voltage_peak_to_peak", 14).value
    return test.vibration_amplitude / per_volt
