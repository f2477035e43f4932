"""What a fit of a closure may choose: shared by all rigs or each rig's own, within which bounds, and why those.

Contact and vibration are as the experiments state them. Of a rig only what was not measured may vary: nominal area and
yield strength, which only move the gap at rest so that one factor stands for both; the coefficient of friction within
its scatter; the compliance of the holder; and parasitic motion along the sliding direction. Memory length and share of
the amplitude are the closure's own and the same for all rigs, and so is the decay length, Rq/lambda.
"""

from dataclasses import dataclass, replace
from math import pi
from typing import Final

RIGS: Final = {"tribometer": "ACDEF", "power map": "B", "welder": "G", "flextensional": "H"}
"""Rigs, and the letters of the sets measured on each."""

FITTED_RIGS: Final = ("tribometer", "power map", "welder")
"""Rigs whose sets are fitted; the flextensional actuator's amplitude at resonance is not known."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Parameter:
    """A parameter that a fit may choose.

    Parameters
    ----------
    name : str
        Its name, a word of the vocabulary where it is a quantity.
    unit : str
        Unit for the report.
    rest : float
        Its value where no test tells it, SI.
    start : tuple of float
        Values from which a fit sets out, SI.
    low, high : float
        The physical bounds, SI.
    reason : str
        Why these bounds.
    matters_in : str
        Letters of the sets that can tell it; empty for all.
    """

    name: str
    unit: str
    rest: float
    start: tuple[float, ...]
    low: float
    high: float
    reason: str
    matters_in: str = ""

    def matters_to(self, sets: str) -> bool:
        """Return whether any of some sets can tell it."""
        return not self.matters_in or bool(set(self.matters_in) & set(sets))

    @property
    def is_angle(self) -> bool:
        """Whether it repeats after a turn, so that its bounds only frame the search."""
        return self.unit == "rad"


def of_rigs(parameters: tuple[Parameter, ...], *rigs: str) -> tuple[Parameter, ...]:
    """Return each parameter once for each of some rigs, as its own."""
    return tuple(replace(parameter, matters_in=RIGS[rig]) for rig in rigs for parameter in parameters)


AREA: Final = Parameter(
    name="nominal_area_factor",
    unit="",
    rest=1.0,
    start=(0.5, 2.0),
    low=0.1,
    high=10.0,
    reason="The pin runs in: its worn spot grows from a Hertzian one to that stated. Yield strength at most doubles by "
    "work hardening. Together they stay within a factor of ten.",
)
COEFFICIENT: Final = Parameter(
    name="friction_coefficient_factor",
    unit="",
    rest=1.0,
    start=(0.9, 1.1),
    low=0.8,
    high=1.25,
    reason="Forces scatter by up to 10 % (Table 2.3) and the load is set to as much; two standard deviations.",
)
SHARE: Final = Parameter(
    name="amplitude_fraction",
    unit="",
    rest=1.0,
    start=(0.3,),
    low=0.05,
    high=1.0,
    reason="No more than the whole motion can act.",
)
MEMORY: Final = Parameter(
    name="memory_length",
    unit="m",
    rest=1.5e-6,
    start=(1.5e-6,),
    low=0.1e-6,
    high=10e-6,
    reason="From a tenth of Mindlin's length at the lowest coefficient to the size of a spot of contact.",
)
COMPLIANCE: Final = Parameter(
    name="holder_compliance",
    unit="m/N",
    rest=0.0,
    start=(1e-8, 1e-7, 5e-7),
    low=1e-9,
    high=2e-6,
    reason="From a spot of a millimetre on solid steel to the tip of a bending steel pin, 5 mm thick and 5 cm long.",
)
IN_PLANE: Final = (
    Parameter(
        name="in_plane_fraction",
        unit="",
        rest=0.0,
        start=(0.1, 0.3),
        low=0.0,
        high=0.5,
        reason="Misalignment by 5 degrees gives 0.09, an eccentric tip some tenths; beyond one half the pin would be "
        "the stator of an ultrasonic motor, which moves as far along as across.",
    ),
    Parameter(
        name="phase",
        unit="rad",
        rest=0.0,
        start=(0.0, pi / 2, pi, 3 * pi / 2),
        low=-2 * pi,
        high=4 * pi,
        reason="Any: mode and drive decide. The bounds frame the search.",
    ),
)
