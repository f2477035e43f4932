"""Rough contacts of the dissertation's tests, from its tables of model parameters."""

from dataclasses import replace
from math import pi, sqrt
from typing import Final, Literal

from sonolube.facts.published import si_value
from sonolube.models.contact import (
    ASPERITY_LAWS,
    ContactPair,
    ElasticBody,
    RoughContact,
    contact_pair,
    identical_materials_mindlin_ratio,
)
from sonolube.models.surfaces import Roughness

STEEL_YIELD_STRENGTH: Final = 250e6
"""Yield strength of steel on steel. [Pa] Not printed; inferred from the separations stated in D 3.1.4."""

STEEL_YIELD_STRENGTHS: Final = (205e6, 960e6)
"""Lowest and highest yield strength that the steel of D can have. [Pa]

Annealed 304 and 316 (ASTM A240), and the steel of the hardness of D 4.1.3 by Tabor's relation."""

RMS_OVER_ARITHMETIC_MEAN: Final = sqrt(pi / 2)
"""R_q over R_a of Gaussian heights. []"""

Bodies = Literal["aluminium_steel", "steel_steel"]


def poisson_contact(*, bodies: Bodies, yield_strength: float = STEEL_YIELD_STRENGTH) -> RoughContact:
    """Contact of the Poisson-effect tests, Table 3.1."""
    steel, aluminium = (
        ElasticBody(
            youngs_modulus=si_value(f"table-3.1-youngs_modulus_{metal}-1"),
            poisson_ratio=si_value(f"table-3.1-poisson_ratio_{metal}-1"),
        )
        for metal in ("steel", "aluminium")
    )
    softer, strength = (
        (steel, yield_strength) if bodies == "steel_steel" else (aluminium, si_value("table-3.1-yield_strength-1"))
    )
    return RoughContact(
        roughness=_roughness("3.1"),
        asperity=ASPERITY_LAWS["dong_2015"],
        pair=contact_pair(softer=softer, harder=steel, yield_strength=strength),
        nominal_area=si_value("table-3.1-nominal_area-1"),
    )


def wear_contact() -> RoughContact:
    """Contact of the wear model on the modified tribometer, Table 3.2."""
    poisson_ratio = si_value("table-3.1-poisson_ratio_aluminium-1")
    return RoughContact(
        roughness=_roughness("3.2"),
        asperity=ASPERITY_LAWS["dong_2015"],
        pair=ContactPair(
            effective_modulus=si_value("table-3.2-effective_modulus-1"),
            poisson_ratio=poisson_ratio,
            yield_strength=si_value("table-3.2-yield_strength-1"),
            mindlin_ratio=identical_materials_mindlin_ratio(poisson_ratio=poisson_ratio),
        ),
        nominal_area=si_value("table-3.2-nominal_area-1"),
    )


def steel_on_steel_contact(*, nominal_area: float, yield_strength: float = STEEL_YIELD_STRENGTH) -> RoughContact:
    """Contact of two steel bodies with the roughness of Table 3.2."""
    pressed = poisson_contact(bodies="steel_steel", yield_strength=yield_strength)
    return replace(pressed, roughness=_roughness("3.2"), nominal_area=nominal_area)


def uncoated_plate_contact(*, yield_strength: float = STEEL_YIELD_STRENGTH) -> RoughContact:
    r"""Contact of the steel pin on the uncoated steel plates of section 4.1.

    .. math:: R_q = \sqrt{\pi/2}\, R_a = 2.12\ \mathrm{\mu m}

    with the 1.69 um of D 4.1.3 as R_a, which D prints wherever it names the kind of a single roughness; as R_q it
    would be 1.69 um. The plates did not wear measurably, so that it holds during the tests. The roughness of the pin
    is not printed. Summit radius and density are those of Table 3.2.
    """
    area = si_value("table-4.1-nominal_area-1")
    rough = steel_on_steel_contact(nominal_area=area, yield_strength=yield_strength)
    height = RMS_OVER_ARITHMETIC_MEAN * si_value("4.1.3-roughness-uncoated")
    return replace(rough, roughness=replace(rough.roughness, rms_height=height))


def _roughness(table_id: str) -> Roughness:
    """Combined roughness of Table 3.1 or 3.2."""
    return Roughness(
        rms_height=si_value(f"table-{table_id}-rms_height-1"),
        summit_radius=si_value(f"table-{table_id}-summit_radius-1"),
        summit_density=si_value(f"table-{table_id}-summit_density-1"),
    )
