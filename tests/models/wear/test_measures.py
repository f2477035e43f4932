"""Specific wear rate, mass loss and number of contacts by hand."""

from hypothesis import given, strategies as st
from pytest import approx

from sonolube.models.wear import ArchardWear, archard_wear_rate, mass_loss, specific_wear_rate, vibration_contact_count

STEEL_ON_BRASS = ArchardWear(wear_coefficient=1e-4, hardness=1e9)

loads = st.floats(0.01, 1e3)


@given(load=loads)
def test_the_specific_rate_of_archards_law_does_not_depend_on_the_load(load: float) -> None:
    rate = archard_wear_rate(STEEL_ON_BRASS, normal_load=load)
    assert specific_wear_rate(wear_rate=rate, normal_load=load) == approx(1e-13, rel=1e-9, abs=0)


def test_a_cubic_millimetre_of_aluminium_weighs_two_point_seven_milligrams() -> None:
    assert mass_loss(wear_volume=1e-9, density=2700.0) == approx(2.7e-6)


def test_an_hour_at_twenty_two_kilohertz_makes_eighty_million_contacts() -> None:
    assert vibration_contact_count(frequency=22e3, duration=3600.0) == approx(79.2e6)
