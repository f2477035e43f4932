"""Friction under vibration in earlier studies, as far as the dissertation prints what a model needs of them."""

from dataclasses import dataclass
from functools import cache
from typing import Final

from sonolube.validation.inputs import said

EARLIER_SETS: Final = {"L": "along the sliding, earlier studies (sections 1.3.1 and 2.2.5)"}
"""What each set of earlier tests is."""


@dataclass(frozen=True, kw_only=True, slots=True)
class InPlaneTest:
    """One measured friction ratio under vibration within the plane of contact.

    Parameters
    ----------
    label : str
        Its set and its number in the set, such as "L-1".
    study : str
        Who measured it.
    sliding_speed : float
        Sliding speed while the surfaces vibrate. [m/s]
    vibration_velocity : float
        Peak velocity of the vibration within the plane. [m/s]
    vibration_direction : float
        Angle between vibration and sliding. [rad]
    friction_ratio : float
        Friction with vibration over friction without. []
    """

    label: str
    study: str
    sliding_speed: float
    vibration_velocity: float
    vibration_direction: float
    friction_ratio: float

    @property
    def set_name(self) -> str:
        """Letter of its set."""
        return self.label[0]


@cache
def earlier_tests() -> tuple[InPlaneTest, ...]:
    """Return the tests of earlier studies.

    Notes
    -----
    Littmann's is the speed at which nothing is left of the reduction; the speed of his largest is not printed.
    """
    littmann = said("1.3.1-littmann-vibration-velocity").value
    return (
        InPlaneTest(
            label="L-1",
            study="Littmann et al.",
            sliding_speed=said("2.2.5-littmann-ratio").value * littmann,
            vibration_velocity=littmann,
            vibration_direction=0.0,
            friction_ratio=1.0,
        ),
        InPlaneTest(
            label="L-2",
            study="Gutowski and Leus",
            sliding_speed=said("1.3.1-gutowski-sliding-speed").value,
            vibration_velocity=said("1.3.1-gutowski-vibration-velocity").value,
            vibration_direction=0.0,
            friction_ratio=1 - said("1.3.1-gutowski-reduction").value,
        ),
    )
