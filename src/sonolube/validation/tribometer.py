"""Published facts on the unprinted masses, springs and dampers of the tribometer, ranked, and the identified structure.

The file tribometer.toml beside this one states them. Rank 1: measurements and construction of the rig. Rank 2: numbers
that the dissertation computed. Rank 3: statements in words and conclusions drawn here.
"""

from pathlib import Path
from typing import Final

from sonolube.facts.published import si_value
from sonolube.identification import Identification, IdentificationProblem, PinOnDiscTest, identify, pin_on_disc_model
from sonolube.models.actuator.stack import PiezoStack
from sonolube.models.contact import decay_length
from sonolube.rig.facts_file import read_facts
from sonolube.validation.contacts import wear_contact

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


def tribometer_identification(*, seed: int = 0) -> Identification:
    """Identification of m1, m2, m3, k2, c1 and c2 of D 3.31 from the published facts."""
    known = tribometer_problem()
    return identify(pin_on_disc_model(tribometer_test()), facts=known.facts, bounds=known.bounds, seed=seed)


def tribometer_test() -> PinOnDiscTest:
    """Stack of the tribometer as printed, with its drive and load."""
    load = si_value("table-3.2-normal_load-1")
    load_of_most_arm_vibration = (si_value("4.1.2-peak-load-1") + si_value("4.1.2-peak-load-2")) / 2
    return PinOnDiscTest(
        stack=tribometer_stack(),
        frequency=si_value("4.1.1-frequency"),
        voltage_peak_to_peak=si_value("table-4.1-voltage_peak_to_peak-15"),
        normal_load=load,
        decay_length=float(decay_length(wear_contact())),
        settling_time=si_value("3.3.4-settling-time"),
        added_mass=(load_of_most_arm_vibration - load) / _GRAVITY,
    )


def tribometer_stack() -> PiezoStack:
    """Stack of Table 3.5, its coupling factor derived from the other constants."""

    def constant(name: str) -> float:
        return si_value(f"table-3.5-{name}-1")

    return PiezoStack(
        free_capacitance=constant("capacitance"),
        free_stroke_per_volt=constant("stack_layers") * constant("charge_constant_33"),
        stack_stiffness=constant("stack_stiffness"),
        stack_mass=constant("stack_mass"),
        stack_damping=constant("stack_damping"),
    )


def tribometer_problem() -> IdentificationProblem:
    """Published facts, in the order of their ranks, and the bounds of the identified parameters."""
    return read_facts(Path(__file__).with_suffix(".toml"))
