"""Rigs of the dissertation: the Poisson-effect tests under the cube model, and the modified tribometer."""

from dataclasses import replace
from functools import cache
from typing import Final, Literal, get_args

from sonolube.checks import Floats
from sonolube.facts.published import si_value
from sonolube.models.actuator import BarWaveguide, Drive, normal_amplitude
from sonolube.models.contact import ASPERITY_LAWS, RoughContact
from sonolube.models.dynamics import Structure, chain_structure, pin_on_disc_chain
from sonolube.models.friction import FRICTION_MODELS, dong_2015_half_period_ratio
from sonolube.rig import DrivenRig
from sonolube.validation.contacts import (
    STEEL_YIELD_STRENGTH,
    STEEL_YIELD_STRENGTHS,
    Bodies,
    poisson_contact,
    uncoated_plate_contact,
    wear_contact,
)
from sonolube.validation.tribometer import IDENTIFIED, tribometer_stack

Horn = Literal["aluminium", "steel"]
"""Material of the waveguide of the Poisson-effect tests."""

HORNS: Final[tuple[Horn, ...]] = get_args(Horn)

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


IDENTIFIED_NOTE: Final = (
    "Masses, springs and dampers of D 3.3.1 are not printed; they are identified from published facts"
)
"""Note of every result that depends on them."""


@cache
def identified_structure() -> Structure:
    """Structure of the tribometer with the parameters identified from published facts."""
    return chain_structure(pin_on_disc_chain(tribometer_stack(), **IDENTIFIED))


def tribometer_rig(*, friction_model: str = "asperity_stick_slip") -> DrivenRig:
    """Tribometer of section 2.3 for the multi-scale model of section 3.3, driven as in the tests."""
    stack, load = tribometer_stack(), si_value("table-2.2-normal_load-1")
    voltage = 2 * si_value("A.3.1.3-voltage-amplitude") * si_value("A.3.1.5-gain")
    return DrivenRig(
        title="Modified pin-on-disc tribometer",
        source="D Tables 2.2, 2.3, 3.2 and 3.5, appendix A",
        contact=wear_contact(),
        normal_load=load,
        friction_coefficient=si_value("table-2.3-friction_force-1") / load,
        sliding_speed=si_value("table-2.3-sliding_speed-1"),
        vibration_amplitude=si_value("2.3.1-amplitude"),
        amplitude_source="computed",
        drive=Drive(frequency=si_value("4.1.1-frequency"), voltage_peak_to_peak=voltage, voltage_offset=voltage / 2),
        capacitance=stack.free_capacitance,
        stack=stack,
        structure=identified_structure(),
        friction_model=FRICTION_MODELS[friction_model](),
        assumptions={"structure": IDENTIFIED_NOTE},
    )


def plate_rig() -> DrivenRig:
    """Tribometer with the uncoated steel plates of section 4.1, at the settings of its example test."""
    rig, highest = tribometer_rig(), si_value("table-4.1-voltage_peak_to_peak-15")
    load = si_value("4.1.2-normal-load")
    return replace(
        rig,
        title="Tribometer with uncoated steel plates",
        source="D 4.1.3, Tables 4.1 and 4.2",
        contact=uncoated_plate_contact(),
        friction_coefficient=si_value("4.1.2-friction-off") / load,
        normal_load=load,
        sliding_speed=si_value("4.1.2-sliding-speed"),
        drive=replace(rig.drive, voltage_peak_to_peak=highest, voltage_offset=highest / 2),
    )
