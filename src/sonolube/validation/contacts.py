"""The contacts of the dissertation's models, from its own parameter tables."""

from dataclasses import replace
from typing import Literal

from sonolube.actuator import BarWaveguide, normal_amplitude
from sonolube.checks import Floats
from sonolube.contact import (
    ASPERITY_LAWS,
    ContactPair,
    ElasticBody,
    RoughContact,
    contact_pair,
    identical_materials_mindlin_ratio,
)
from sonolube.friction import dong_2015_half_period_ratio
from sonolube.published import statement, table
from sonolube.surfaces import Roughness

STEEL_YIELD_STRENGTH = 250e6
"""Yield strength of steel on steel. [Pa] Not printed; what the separations stated in D 3.1.4 imply."""

STEEL_ON_STEEL_NOTE = (
    f"yield strength of steel on steel not printed, {STEEL_YIELD_STRENGTH / 1e6:g} MPa implied by D 3.1.4"
)

Bodies = Literal["aluminium_steel", "steel_steel"]


def poisson_contact(*, bodies: Bodies) -> RoughContact:
    """Return the contact of the Poisson-effect tests, Table 3.1."""
    steel = ElasticBody(
        youngs_modulus=_value("3.1", "youngs_modulus_steel"), poisson_ratio=_value("3.1", "poisson_ratio_steel")
    )
    aluminium = ElasticBody(
        youngs_modulus=_value("3.1", "youngs_modulus_aluminium"), poisson_ratio=_value("3.1", "poisson_ratio_aluminium")
    )
    softer, strength = (
        (steel, STEEL_YIELD_STRENGTH) if bodies == "steel_steel" else (aluminium, _value("3.1", "yield_strength"))
    )
    return RoughContact(
        roughness=_roughness("3.1"),
        asperity=ASPERITY_LAWS["dong_2015"],
        pair=contact_pair(softer=softer, harder=steel, yield_strength=strength),
        nominal_area=_value("3.1", "nominal_area"),
    )


def wear_contact() -> RoughContact:
    """Return the contact of the wear model on the tribometer, Table 3.2."""
    poisson_ratio = _value("3.1", "poisson_ratio_aluminium")
    return RoughContact(
        roughness=_roughness("3.2"),
        asperity=ASPERITY_LAWS["dong_2015"],
        pair=ContactPair(
            effective_modulus=_value("3.2", "effective_modulus"),
            poisson_ratio=poisson_ratio,
            yield_strength=_value("3.2", "yield_strength"),
            mindlin_ratio=identical_materials_mindlin_ratio(poisson_ratio=poisson_ratio),
        ),
        nominal_area=_value("3.2", "nominal_area"),
    )


def steel_on_steel_contact(*, nominal_area: float) -> RoughContact:
    """Return the contact of two steel bodies with the roughness of Table 3.2.

    Parameters
    ----------
    nominal_area : float
        Nominal contact area. [m2]

    Returns
    -------
    RoughContact
    """
    return replace(poisson_contact(bodies="steel_steel"), roughness=_roughness("3.2"), nominal_area=nominal_area)


def poisson_friction_ratio(
    *, bodies: Bodies, horn: Literal["aluminium", "steel"], normal_load: Floats, axial_amplitude: float
) -> Floats:
    """Return the cube's friction ratio at the centre of the waveguide of the Poisson-effect tests. []

    Parameters
    ----------
    bodies : str
        The pair in contact.
    horn : str
        Material of the waveguide.
    normal_load : ndarray
        Force pressing the bodies together. [N]
    axial_amplitude : float
        Axial amplitude at the ends of the waveguide. [m]

    Returns
    -------
    ndarray, shape of `normal_load`
    """
    waveguide = BarWaveguide(
        length=statement("2.1.2-waveguide-length").number.value,
        thickness=statement("2.1.2-waveguide-thickness").number.value,
        poisson_ratio=_value("3.1", f"poisson_ratio_{horn}"),
        axial_amplitude=axial_amplitude,
        frequency=statement("3.1.4-frequency").number.value,
    )
    return dong_2015_half_period_ratio(
        poisson_contact(bodies=bodies), normal_load=normal_load, vibration_amplitude=normal_amplitude(waveguide)
    )


def elastic(contact: RoughContact) -> RoughContact:
    """Return the same contact with asperities that never yield."""
    return replace(contact, asperity=ASPERITY_LAWS["elastic"])


def _roughness(table_id: str) -> Roughness:
    return Roughness(
        rms_height=_value(table_id, "rms_height"),
        summit_radius=_value(table_id, "summit_radius"),
        summit_density=_value(table_id, "summit_density"),
    )


def _value(table_id: str, column: str) -> float:
    return float(table(table_id).columns[column].values[0])
