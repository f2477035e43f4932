"""Published facts on the unprinted masses, springs and dampers of the tribometer, ranked, and the identified structure.

Rank 1: measurements and construction of the rig. Rank 2: numbers that the dissertation computed. Rank 3: statements in
words and conclusions drawn here.
"""

import math
from typing import Final

from sonolube.actuator.stack import PiezoStack
from sonolube.contact import decay_length
from sonolube.identification import Fact, Identification, PinOnDiscTest, identify, pin_on_disc_model
from sonolube.published import ComputedValue, PrintedNumber, propagate_rounding, published_number, si_value
from sonolube.validation.contacts import wear_contact

BOUNDS: Final = {
    "tip_mass": (0.01, 10.0),
    "reaction_mass": (0.01, 10.0),
    "arm_mass": (0.05, 5.0),
    "arm_stiffness": (1e3, 1e7),
    "arm_damping": (1.0, 1e3),
    "tip_damping": (0.1, 1e4),
}
"""Bounds of the identified parameters, in SI."""

IDENTIFIED: Final = {
    "tip_mass": 0.1093,
    "reaction_mass": 2.41,
    "arm_mass": 0.602,
    "arm_stiffness": 4.56e5,
    "arm_damping": 90.0,
    "tip_damping": 702.0,
}
"""Rounded result of `tribometer_identification`, in SI; the search takes half a minute."""

_GRAVITY = 9.80665  # m/s2
_HALF_POWER = 0.5**0.5
_ARM_HEAVIEST = 1.0  # kg


def tribometer_identification(*, seed: int = 0) -> Identification:
    """Return the identification of m1, m2, m3, k2, c1 and c2 of D 3.31 from the published facts.

    Parameters
    ----------
    seed : int
        Seed of the random searches.

    Returns
    -------
    Identification
    """
    return identify(pin_on_disc_model(tribometer_test()), facts=tribometer_facts(), bounds=BOUNDS, seed=seed)


def tribometer_test() -> PinOnDiscTest:
    """Return the stack of the tribometer as printed, with its drive and load."""
    contact, load = wear_contact(), si_value("table-3.2-normal_load-1")
    return PinOnDiscTest(
        stack=tribometer_stack(),
        frequency=si_value("4.1.1-frequency"),
        voltage_peak_to_peak=si_value("table-4.1-voltage_peak_to_peak-15"),
        normal_load=load,
        decay_length=float(decay_length(contact)),
        settling_time=si_value("3.3.4-settling-time"),
        added_mass=(_load_of_most_arm_vibration() - load) / _GRAVITY,
    )


def tribometer_stack() -> PiezoStack:
    """Return the stack of Table 3.5, its coupling factor derived from the other constants."""
    layers, constant, stiffness, capacitance, mass, damping = (
        si_value(f"table-3.5-{name}-1")
        for name in (
            "stack_layers",
            "charge_constant_33",
            "stack_stiffness",
            "capacitance",
            "stack_mass",
            "stack_damping",
        )
    )
    return PiezoStack(
        free_capacitance=capacitance,
        free_stroke_per_volt=layers * constant,
        stack_stiffness=stiffness,
        stack_mass=mass,
        stack_damping=damping,
    )


def tribometer_facts() -> tuple[Fact, ...]:
    """Return the published facts, in the order of their ranks."""
    return (*_measured(), *_simulated(), *_concluded())


def _measured() -> tuple[Fact, ...]:
    """Return the facts of rank 1: measurements and construction of the rig."""
    per_volt = propagate_rounding(
        lambda amplitude, voltage: amplitude / voltage,
        "table-4.1-vibration_amplitude-15",
        "table-4.1-voltage_peak_to_peak-15",
    )
    return (
        _printed(
            "electrical_resonance",
            published_number("4.1.1-frequency"),
            rank=1,
            unit="Hz",
            meaning="Resonance of the actuator, to the digits printed",
            source="D 2.3.1, 4.1.1, A.3.1.3",
        ),
        _printed(
            "amplitude_per_volt",
            per_volt,
            rank=1,
            unit="m/V",
            meaning="Amplitude per volt peak to peak: 2.31 um at 25.9 V",
            source="D Table 4.1; 2.5 um at 28.0 V of D 2.3.1 and A.3.1 is the same",
        ),
        Fact(
            name="resonance_amplitude_ratio",
            value=1.0,
            tolerance=1 - _HALF_POWER,
            rank=1,
            relation=">=",
            meaning="The drive is at resonance, at least within the half-power width",
            source="D 3.3.5, 4.1.1",
        ),
        Fact(
            name="mass_ratio",
            value=10.0,
            tolerance=5.0,
            rank=1,
            relation=">=",
            meaning="The reaction mass is much larger than the tip",
            source="D 3.3.1; 10 and 5 are what 'much' is taken for",
        ),
    )


def _simulated() -> tuple[Fact, ...]:
    """Return the facts of rank 2: numbers that D computed."""
    quality = propagate_rounding(
        lambda stiffness, frequency, damping: stiffness / (2 * math.pi * frequency * damping),
        "table-3.5-stack_stiffness-1",
        "4.1.1-frequency",
        "table-3.5-stack_damping-1",
    )
    power = published_number("table-4.1-actuator_power-15")
    settling = si_value("3.3.4-settling-time")
    return (
        _printed(
            "resonance_quality_factor",
            quality,
            rank=2,
            meaning="k_p/(2 pi f c_p): the printed damping is all there is",
            source="D Table 3.5, fitted to an impedance curve",
        ),
        Fact(
            name="dissipated_power",
            value=power.value,
            tolerance=power.rounding_half_width,
            rank=2,
            relation="<=",
            unit="W",
            meaning="The actuator consumes no more than the power stated at 25.9 V",
            source="D Table 4.1, from the capacitance alone",
        ),
        Fact(
            name="resonance_settling_time",
            value=settling,
            tolerance=settling / 2,
            rank=2,
            unit="s",
            meaning="Time to the steady state, read as that of the stack's vibration",
            source="D 3.3.4",
        ),
        Fact(
            name="residual_settling_time",
            value=settling,
            tolerance=settling / 2,
            rank=2,
            unit="s",
            meaning="Time to the steady state, read as that of the arm's vibration",
            source="D 3.3.4",
        ),
        Fact(
            name="residual_frequency",
            value=si_value("3.3.4-residual-frequency"),
            tolerance=20.0,
            rank=2,
            unit="Hz",
            meaning="Frequency of the fluctuation beside the ultrasonic vibration",
            source="D 3.3.4",
        ),
    )


def _concluded() -> tuple[Fact, ...]:
    """Return the facts of rank 3: statements in words and conclusions drawn here."""
    hung = si_value("A.3.1.1-weight") / _GRAVITY
    return (
        Fact(
            name="residual_fraction",
            value=0.5,
            tolerance=0.25,
            rank=3,
            relation=">=",
            meaning="The fluctuation stays with the steady vibration: its share left after 0.05 s",
            source="D 3.3.4; one half is what 'stays' is taken for",
        ),
        Fact(
            name="residual_frequency_with_added_mass",
            value=si_value("4.1.2-arm-frequency"),
            tolerance=20.0,
            rank=3,
            unit="Hz",
            meaning="Frequency of the arm with the weights for 6 to 7 N, where it vibrates most",
            source="D 4.1.2",
        ),
        Fact(
            name="arm_mass",
            value=(hung + _ARM_HEAVIEST) / 2,
            tolerance=(_ARM_HEAVIEST - hung) / 2,
            rank=3,
            unit="kg",
            meaning="From the hung weight of 2 N alone to a whole kilogram with the arm",
            source="D A.3.1.1; the kilogram is assumed",
        ),
    )


def _printed(
    name: str, number: PrintedNumber | ComputedValue, *, rank: int, unit: str = "", meaning: str, source: str
) -> Fact:
    """Return a fact with half the rounding interval of its printed digits as the tolerance."""
    within = (number.high - number.low) / 2
    return Fact(name=name, value=number.value, tolerance=within, rank=rank, unit=unit, meaning=meaning, source=source)


def _load_of_most_arm_vibration() -> float:
    """Return the load at which D 4.1.2 states the largest vibration of the arm. [N]"""
    return (si_value("4.1.2-peak-load-1") + si_value("4.1.2-peak-load-2")) / 2
