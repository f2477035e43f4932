"""Cube model on the contacts of the Poisson-effect tests, with its assumptions."""

from dataclasses import replace
from typing import Final, Literal

from sonolube.checks import Floats
from sonolube.facts.published import si_value
from sonolube.models.actuator import BarWaveguide, normal_amplitude
from sonolube.models.contact import ASPERITY_LAWS, RoughContact
from sonolube.models.friction import dong_2015_half_period_ratio
from sonolube.validation.contacts import STEEL_YIELD_STRENGTH, STEEL_YIELD_STRENGTHS, Bodies, poisson_contact

Horn = Literal["aluminium", "steel"]
"""Material of the waveguide of the Poisson-effect tests."""

HORNS: Final[tuple[Horn, ...]] = ("aluminium", "steel")

STEEL_ON_STEEL_NOTE: Final = (
    f"yield strength of steel on steel not printed, {STEEL_YIELD_STRENGTH / 1e6:g} MPa implied by D 3.1.4,"
    f" {STEEL_YIELD_STRENGTHS[0] / 1e6:g} to {STEEL_YIELD_STRENGTHS[1] / 1e6:g} MPa possible"
)


def poisson_friction_ratio(
    *,
    bodies: Bodies,
    horn: Horn,
    normal_load: Floats,
    axial_amplitude: float,
    yield_strength: float = STEEL_YIELD_STRENGTH,
) -> Floats:
    """Friction ratio at the centre of the waveguide by the cube over the separating half period, D 3.15. []"""
    waveguide = poisson_waveguide(horn, axial_amplitude=axial_amplitude, frequency=si_value("3.1.4-frequency"))
    contact = poisson_contact(bodies=bodies, yield_strength=yield_strength)
    return dong_2015_half_period_ratio(
        contact, normal_load=normal_load, vibration_amplitude=normal_amplitude(waveguide)
    )


def poisson_waveguide(horn: Horn, *, axial_amplitude: float, frequency: float) -> BarWaveguide:
    """Waveguide of the Poisson-effect tests, a uniform bar."""
    return BarWaveguide(
        length=si_value("2.1.2-waveguide-length"),
        thickness=si_value("2.1.2-waveguide-thickness"),
        poisson_ratio=si_value(f"table-3.1-poisson_ratio_{horn}-1"),
        axial_amplitude=axial_amplitude,
        frequency=frequency,
    )


def without_yielding(contact: RoughContact) -> RoughContact:
    """Contact with purely elastic asperities."""
    return replace(contact, asperity=ASPERITY_LAWS["elastic"])
