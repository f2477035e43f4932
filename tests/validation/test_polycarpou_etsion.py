"""The contact numbers of the dissertation, which follow from the closed forms of Polycarpou and Etsion (1999).

Tables 3.1 and 3.2, the separations it quotes for 40 N, and a mixed regime evaluated by hand from the closed forms.
"""

from dataclasses import replace

from pytest import approx, mark

from sonolube.models.contact import (
    ASPERITY_LAWS,
    ElasticBody,
    RoughContact,
    contact_pair,
    real_contact_area,
    separation,
)
from sonolube.models.surfaces import Roughness

ALUMINIUM = ElasticBody(youngs_modulus=73e9, poisson_ratio=0.33)
STEEL = ElasticBody(youngs_modulus=200e9, poisson_ratio=0.29)
ALUMINIUM_ON_STEEL = contact_pair(softer=ALUMINIUM, harder=STEEL, yield_strength=410e6)
# D prints no strength for this pair; 250 MPa is what its statements imply.
STEEL_ON_STEEL = contact_pair(softer=STEEL, harder=STEEL, yield_strength=250e6)

TABLE_3_1 = RoughContact(
    roughness=Roughness(rms_height=6e-6, summit_radius=1.7e-6, summit_density=47e9),
    pair=ALUMINIUM_ON_STEEL,
    nominal_area=1e-4,
    asperity=ASPERITY_LAWS["dong_2015"],
)
TABLE_3_2 = RoughContact(
    roughness=Roughness(rms_height=6e-6, summit_radius=1.5e-6, summit_density=4.7e10),
    pair=replace(ALUMINIUM_ON_STEEL, effective_modulus=59.6e9),
    nominal_area=2.25e-6,
    asperity=ASPERITY_LAWS["dong_2015"],
)
MIXED = RoughContact(
    roughness=Roughness(rms_height=0.1e-6, summit_radius=100e-6, summit_density=4.76e9),
    pair=ALUMINIUM_ON_STEEL,
    nominal_area=1e-4,
    asperity=ASPERITY_LAWS["dong_2015"],
)


@mark.parametrize(
    ("pair", "law", "expected"),
    [
        (ALUMINIUM_ON_STEEL, "dong_2015", 18.11e-6),
        (ALUMINIUM_ON_STEEL, "elastic", 24.93e-6),
        (STEEL_ON_STEEL, "dong_2015", 17.11e-6),
        (STEEL_ON_STEEL, "elastic", 26.14e-6),
    ],
)
def test_separations_at_40_newton_are_those_of_figure_3_2(pair: object, law: str, expected: float) -> None:
    contact = replace(TABLE_3_1, pair=pair, asperity=ASPERITY_LAWS[law])  # type: ignore[arg-type]
    assert separation(contact, normal_load=40.0) == approx(expected, abs=0.005e-6)


def test_over_the_published_loads_the_area_grows_sixfold() -> None:
    light, heavy = (
        real_contact_area(TABLE_3_1, separation=separation(TABLE_3_1, normal_load=load)) for load in (40.0, 240.0)
    )
    assert heavy / light == approx(6)
    assert (light, heavy) == approx((6.5e-8, 3.9e-7), rel=0.03, abs=0)


def test_the_wear_contact_stands_and_touches_as_its_published_wear_rates_need() -> None:
    d = separation(TABLE_3_2, normal_load=3.0)
    assert d == approx(15.453e-6, abs=0.0005e-6)
    assert real_contact_area(TABLE_3_2, separation=d) == approx(4981e-12, abs=0.5e-12)
    # A_r d/2 per sqrt(An) slid is the wear rate without vibration, 2.566e-2 mm3/m in Table 3.3
    assert real_contact_area(TABLE_3_2, separation=d) * d / 2 / 1.5e-3 == approx(2.566e-11, rel=2e-4, abs=0)


def test_a_mixed_regime_has_the_separation_and_area_evaluated_by_hand() -> None:
    d = separation(MIXED, normal_load=40.0)
    assert d == approx(212.585e-9, abs=0.0005e-9)
    assert real_contact_area(MIXED, separation=d) == approx((8433.14 + 62089.13) * 1e-12, abs=0.01e-12)
