"""Published facts on the unprinted masses, springs and dampers of the tribometer, ranked, and the identified structure.

The file tribometer.toml beside this one states them. Rank 1: measurements and construction of the rig. Rank 2: numbers
that the dissertation computed. Rank 3: statements in words and conclusions drawn here.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Final

from sonolube.facts.published import si_value
from sonolube.identification import (
    ForwardModel,
    Identification,
    IdentificationProblem,
    identify,
    parametric_structure,
    reference_parameters,
    structure_model,
)
from sonolube.models.actuator.stack import PiezoStack
from sonolube.models.dynamics import Structure, chain_structure, pin_on_disc_chain
from sonolube.rig.facts_file import read_facts

IDENTIFIED: Final = {
    "tip_mass": 0.1093,
    "reaction_mass": 2.41,
    "arm_mass": 0.602,
    "arm_stiffness": 4.56e5,
    "arm_damping": 90.0,
    "tip_damping": 702.0,
}
"""Rounded result of `tribometer_identification`, in SI; the search takes half a minute."""


def tribometer_identification(*, seed: int = 0) -> Identification:
    """Identification of m1, m2, m3, k2, c1 and c2 of D 3.31 from the published facts."""
    known = tribometer_problem()
    return identify(tribometer_model(), facts=known.facts, bounds=known.bounds, seed=seed)


def tribometer_model() -> ForwardModel:
    """Forward model of the published facts: the chain of tip, printed stack, reaction mass and arm."""
    known, stack = tribometer_problem(), tribometer_stack()

    def build(parameters: Mapping[str, float]) -> Structure:
        return chain_structure(pin_on_disc_chain(stack, **parameters))

    reference = reference_parameters(build, bounds=known.bounds)
    return structure_model(parametric_structure(build, reference=reference), known.observations)


def tribometer_stack() -> PiezoStack:
    """Piezoelectric stack of the tribometer, D Table 3.5, its coupling factor derived from the other constants.

    Returns
    -------
    PiezoStack
    """

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
