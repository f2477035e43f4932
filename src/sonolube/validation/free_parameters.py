"""Free parameters of model variants with their physical bounds, each common to all rigs or specific to one rig.

Contact and vibration are as the experiments state them. Only what was not measured on a rig may vary: nominal area and
yield strength, which only shift the gap at rest so that one factor stands for both; the coefficient of friction within
its scatter; the compliance of the holder; and in-plane motion along the sliding direction. Memory length and amplitude
fraction belong to the friction model and are the same for all rigs, as is the decay length Rq/lambda.
"""

from dataclasses import dataclass, replace
from math import pi
from typing import Final

RIGS: Final = {"tribometer": "ACDEF", "power map": "B", "welder": "G", "flextensional": "H"}
"""Letters of the sets measured on each rig."""

FITTED_RIGS: Final = ("tribometer", "power map", "welder")
"""Rigs whose sets are fitted; the amplitude of the flextensional actuator at resonance is not known."""


@dataclass(frozen=True, kw_only=True, slots=True)
class FreeParameter:
    """Parameter of a model variant that is fitted to tests.

    Parameters
    ----------
    name : str
        Name; that of the vocabulary for a quantity.
    unit : str
        Unit in reports.
    default : float
        Value where no fitted test determines it, in SI.
    initial_values : tuple of float
        Initial values of the fit, in SI.
    low, high : float
        Physical bounds, in SI.
    reason : str
        Reason for these bounds.
    applicable_sets : str
        Letters of the sets to which it applies; empty for all.
    """

    name: str
    unit: str = ""
    default: float
    initial_values: tuple[float, ...]
    low: float
    high: float
    reason: str
    applicable_sets: str = ""

    def applies_to(self, sets: str) -> bool:
        """Whether the parameter applies to any of the sets of the given letters."""
        return not self.applicable_sets or bool(set(self.applicable_sets) & set(sets))

    @property
    def is_angle(self) -> bool:
        """Whether the parameter is periodic, so that its bounds only limit the search."""
        return self.unit == "rad"


def per_rig(parameters: tuple[FreeParameter, ...], *rigs: str) -> tuple[FreeParameter, ...]:
    """Copy of each parameter for each of the named rigs, specific to that rig."""
    return tuple(replace(parameter, applicable_sets=RIGS[rig]) for rig in rigs for parameter in parameters)


NOMINAL_AREA_FACTOR: Final = FreeParameter(
    name="nominal_area_factor",
    default=1.0,
    initial_values=(0.5, 2.0),
    low=0.1,
    high=10.0,
    reason="The pin runs in: its worn area grows from the Hertzian one to the stated one. Yield strength at most "
    "doubles by work hardening. Together they stay within a factor of ten.",
)
FRICTION_COEFFICIENT_FACTOR: Final = FreeParameter(
    name="friction_coefficient_factor",
    default=1.0,
    initial_values=(0.9, 1.1),
    low=0.8,
    high=1.25,
    reason="Forces scatter by up to 10 % (Table 2.3) and the load is set to as much; two standard deviations.",
)
AMPLITUDE_FRACTION: Final = FreeParameter(
    name="amplitude_fraction",
    default=1.0,
    initial_values=(0.3,),
    low=0.05,
    high=1.0,
    reason="At most the whole motion contributes.",
)
MEMORY_LENGTH: Final = FreeParameter(
    name="memory_length",
    unit="m",
    default=1.5e-6,
    initial_values=(1.5e-6,),
    low=0.1e-6,
    high=10e-6,
    reason="From a tenth of the length of Mindlin at the lowest coefficient to the size of a contact spot.",
)
DECAY_CONSTANT: Final = FreeParameter(
    name="decay_constant",
    default=3.0,
    initial_values=(2.0, 3.0),
    low=1.0,
    high=6.0,
    reason="R_q over decay length: from exponential heights, whose deviation is their decay length, to Gaussian ones "
    "far out in their tail. D takes 3.",
)
SLIP_LENGTH: Final = FreeParameter(
    name="slip_length",
    unit="m",
    default=1.5e-6,
    initial_values=(1.5e-6, 4e-6),
    low=0.1e-6,
    high=10e-6,
    reason="As the memory length.",
)
APPROACH_RATIO: Final = FreeParameter(
    name="approach_ratio",
    default=1 / 3,
    initial_values=(0.3, 0.6),
    low=0.05,
    high=3.0,
    reason="Approach over R_q: from a smooth contact to one flattened through all of its roughness.",
)
HOLDER_COMPLIANCE: Final = FreeParameter(
    name="holder_compliance",
    unit="m/N",
    default=0.0,
    initial_values=(1e-8, 1e-7, 5e-7),
    low=1e-9,
    high=2e-6,
    reason="From a spot of a millimetre on solid steel to the tip of a bending steel pin, 5 mm thick and 5 cm long.",
)
IN_PLANE_MOTION: Final = (
    FreeParameter(
        name="in_plane_fraction",
        default=0.0,
        initial_values=(0.1, 0.3),
        low=0.0,
        high=0.5,
        reason="Misalignment by 5 degrees gives 0.09, an eccentric tip some tenths; beyond one half the pin would be "
        "the stator of an ultrasonic motor, whose in-plane and normal motions are alike.",
    ),
    FreeParameter(
        name="in_plane_phase",
        unit="rad",
        default=0.0,
        initial_values=(0.0, pi / 2, pi, 3 * pi / 2),
        low=-2 * pi,
        high=4 * pi,
        reason="Any: mode and drive determine it. The bounds limit the search.",
    ),
)
VIBRATION_DIRECTION: Final = FreeParameter(
    name="vibration_direction",
    unit="rad",
    default=0.0,
    initial_values=(0.3, 1.2),
    low=0.0,
    high=pi / 2,
    reason="Any, from along to across the sliding.",
)
APPROACH: Final = FreeParameter(
    name="approach",
    unit="m",
    default=2e-6,
    initial_values=(1e-6, 4e-6),
    low=0.1e-6,
    high=20e-6,
    reason="Load over normal stiffness: from a smooth Hertzian contact to ten times that of exponential heights.",
)
MINDLIN_RATIO: Final = FreeParameter(
    name="mindlin_ratio",
    default=0.82,
    initial_values=(0.1, 0.4, 0.82),
    low=0.02,
    high=1.0,
    reason="The ratio of Mindlin for like bodies is 0.67 to 1; a holder in series lowers the tangential stiffness, as "
    "does roughness in measured contacts.",
)
STRIBECK_CURVE: Final = (
    FreeParameter(
        name="static_friction_ratio",
        default=1.0,
        initial_values=(1.2, 2.0),
        low=1.0,
        high=3.0,
        reason="Static friction of metals is up to some three times their sliding friction; below one the curve "
        "would not be that of Stribeck.",
    ),
    FreeParameter(
        name="stribeck_velocity",
        unit="m/s",
        default=0.1,
        initial_values=(0.03, 0.3),
        low=1e-3,
        high=1.0,
        reason="From creep to the peak velocity of the strongest vibration.",
    ),
)
