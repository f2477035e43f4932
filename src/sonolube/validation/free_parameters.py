"""Free parameters of model variants with their physical bounds, each common to all rigs or specific to one rig.

Contact and vibration are as the experiments state them. Only what was not measured on a rig may vary: nominal area and
yield strength, which only shift the gap at rest so that one factor stands for both; the coefficient of friction within
its scatter; the compliance of the holder; and in-plane motion along the sliding direction. Memory length and amplitude
fraction belong to the friction model and are the same for all rigs, as is the decay length Rq/lambda. Defaults, initial
values and bounds with their reasons are in free_parameters.toml.
"""

import tomllib
from dataclasses import dataclass, replace
from pathlib import Path
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


def _parameters() -> dict[str, FreeParameter]:
    """Parameters of the file beside this one, by name."""
    content = tomllib.loads(Path(__file__).with_name("free_parameters.toml").read_text(encoding="utf-8"))
    return {
        name: FreeParameter(name=name, **entry | {"initial_values": tuple(entry["initial_values"])})
        for name, entry in content.items()
    }


_PARAMETERS: Final = _parameters()
NOMINAL_AREA_FACTOR: Final = _PARAMETERS["nominal_area_factor"]
FRICTION_COEFFICIENT_FACTOR: Final = _PARAMETERS["friction_coefficient_factor"]
AMPLITUDE_FRACTION: Final = _PARAMETERS["amplitude_fraction"]
MEMORY_LENGTH: Final = _PARAMETERS["memory_length"]
DECAY_CONSTANT: Final = _PARAMETERS["decay_constant"]
SLIP_LENGTH: Final = _PARAMETERS["slip_length"]
APPROACH_RATIO: Final = _PARAMETERS["approach_ratio"]
HOLDER_COMPLIANCE: Final = _PARAMETERS["holder_compliance"]
IN_PLANE_MOTION: Final = (_PARAMETERS["in_plane_fraction"], _PARAMETERS["in_plane_phase"])
VIBRATION_DIRECTION: Final = _PARAMETERS["vibration_direction"]
APPROACH: Final = _PARAMETERS["approach"]
MINDLIN_RATIO: Final = _PARAMETERS["mindlin_ratio"]
STRIBECK_CURVE: Final = (_PARAMETERS["static_friction_ratio"], _PARAMETERS["stribeck_velocity"])
