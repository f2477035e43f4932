"""Rough contacts of the dissertation's tests, how far their roughness is known, and its efficiency line.

Two surfaces touch and D prints the roughness of one at most; its Table 3.2 has 6 um, which section 3.1.4 takes from
comparison standards. What is printed of the surfaces of a test:

=====  ===================================================================================  ===============
set    printed                                                                              in the records
=====  ===================================================================================  ===============
A      R_q = 0.58 um unworn; 19 to 23 um across grooves, their shape included (Table 2.4)   6 um
B      1.69 um unworn, no kind named; no volume lost (4.1.3)                                2.12 um
C      0.45 um unworn, 1.8 um worn under vibration, no kind named (2.5.2)                   6 um
D      nothing                                                                              6 um
E, F   "a mirror-like surface finish" (2.5.4)                                               6 um
G      R_q = 0.857 um unworn, worn 2.54 um at the round and 0.87 um at the flat tip (2.10)  6 um
H      nothing                                                                              6 um
=====  ===================================================================================  ===============

Where no kind is named the number is read as R_a: the 0.45 um of section 2.5.2 is R_a in Table 2.4. Only the plates of
set B are known to have kept the printed roughness during the test. Records of C and G keep the input of Table 3.2: the
groove of C grew rougher during the test, by an unknown course; with 0.87 um the vibration of G, 11.5 um, would
close the gap, where models of rough contact have no meaning. Their spread is the distance to the printed value,
and `published_tests.with_printed_roughness` puts that in its place: it fits worse.
"""

from dataclasses import replace
from functools import cache
from math import hypot, log, pi, sqrt
from typing import Final, Literal

from sonolube.facts.metrics import EfficiencyLine
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
"""Metals of the bodies of the Poisson-effect tests."""


def poisson_contact(*, bodies: Bodies, yield_strength: float = STEEL_YIELD_STRENGTH) -> RoughContact:
    """Rough contact of the Poisson-effect tests, D Table 3.1.

    Parameters
    ----------
    bodies : {"aluminium_steel", "steel_steel"}
        Metals of both bodies; the softer one yields.
    yield_strength : float
        Of steel on steel; that of aluminium is printed. [Pa]

    Returns
    -------
    RoughContact
    """
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
    """Rough contact of the wear model on the modified tribometer, D Table 3.2.

    Returns
    -------
    RoughContact
    """
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
    """Contact of two steel bodies with the roughness of D Table 3.2.

    Parameters
    ----------
    nominal_area : float
        Nominal contact area. [m2]
    yield_strength : float
        Of the softer steel. [Pa]

    Returns
    -------
    RoughContact
    """
    pressed = poisson_contact(bodies="steel_steel", yield_strength=yield_strength)
    return replace(pressed, roughness=_roughness("3.2"), nominal_area=nominal_area)


def uncoated_plate_contact(*, yield_strength: float = STEEL_YIELD_STRENGTH) -> RoughContact:
    r"""Contact of the steel pin on the uncoated steel plates of section 4.1.

    .. math:: R_q = \sqrt{\pi/2}\, R_a = 2.12\ \mathrm{\mu m}

    with the 1.69 um of D 4.1.3 as R_a, which D prints wherever it names the kind of a single roughness; as R_q it
    would be 1.69 um. The plates did not wear measurably, so that it holds during the tests. The roughness of the pin
    is not printed. Summit radius and density are those of Table 3.2.

    Parameters
    ----------
    yield_strength : float
        Of the softer steel. [Pa]

    Returns
    -------
    RoughContact
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


_GUESSED: Final = log(2)  # to the next grade of a comparison standard, which doubles; D 3.1.4
_COUNTERFACE: Final = log(2) / 4  # half the way from one rough surface to two alike, a factor of sqrt(2) in R_q


def roughness_spread(label: str) -> float:
    r"""Standard deviation of ln R_q that the provenance of a test's roughness justifies. []

    0.21 for set B; 0.69, a factor of two, where R_q is that of comparison standards; where a roughness is printed that
    the record does not have, the distance to it: 0.98 for C, 0.86 and 1.93 for the tips of G.

    For set B the deviation adds in quadrature half of the step from R_q to R_a, ln(pi/2)/4 = 0.11, and half of the step
    from a smooth pin to one as rough as the plate, ln(2)/4 = 0.17:

    .. math:: \sigma_{\ln R_q} = \sqrt{0.11^2 + 0.17^2} = 0.21 .
    """
    printed = _printed_rms_heights().get(label)
    if printed is None:
        return _GUESSED
    if label[0] == "B":
        return hypot(log(RMS_OVER_ARITHMETIC_MEAN) / 2, _COUNTERFACE)
    return log(wear_contact().roughness.rms_height / printed)


def printed_rms_height(label: str) -> float | None:
    """R_q as printed for the worn surface of a test, of sets B, C and G; None where none is printed. [m]"""
    return _printed_rms_heights().get(label)


@cache
def _printed_rms_heights() -> dict[str, float]:
    """R_q as printed for the worn surface of a test, by label. [m]"""
    plates = dict.fromkeys([f"B-{level}" for level in range(1, 6)], uncoated_plate_contact().roughness.rms_height)
    return plates | {
        "C-1": RMS_OVER_ARITHMETIC_MEAN * si_value("2.5.2-roughness-on"),
        "G-1": si_value("table-2.10-rms_height-2"),
        "G-2": si_value("table-2.10-rms_height-3"),
    }


def efficiency_line() -> EfficiencyLine:
    r"""Efficiency coefficient as a linear function of the sliding speed, fitted in D to its tests.

    .. math:: \eta = -2.93\,v_r + 0.672

    with the sliding speed in m/s and the efficiency coefficient in mW mm2/(N W), D 4.2.

    Returns
    -------
    EfficiencyLine
    """
    return EfficiencyLine(slope=si_value("4.1.2-efficiency-slope"), intercept=si_value("4.1.2-efficiency-intercept"))
