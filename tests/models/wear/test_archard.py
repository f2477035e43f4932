"""Archard's law against hand computation and its proportionality."""

from hypothesis import given, strategies as st
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.models.wear import ArchardWear, archard_wear_rate

STEEL_ON_BRASS = ArchardWear(wear_coefficient=1e-4, hardness=1e9)

loads = st.floats(0.01, 1e3)


@given(load=loads, factor=st.floats(0.01, 100))
def test_wear_is_proportional_to_load(load: float, factor: float) -> None:
    one = archard_wear_rate(STEEL_ON_BRASS, normal_load=load)
    assert archard_wear_rate(STEEL_ON_BRASS, normal_load=factor * load) == approx(factor * one, rel=1e-9, abs=0)


def test_a_kilometre_under_ten_newton_takes_the_hand_computed_volume() -> None:
    # K = 1e-4, H = 1 GPa, 10 N: 1e-12 m2; over 1000 m, 1 mm3.
    assert 1000 * archard_wear_rate(STEEL_ON_BRASS, normal_load=10.0) == approx(1e-9)


def test_a_negative_load_is_refused_by_name() -> None:
    with raises(InvalidInput, match=r"normal_load must not be negative, got -3\.0 N"):
        archard_wear_rate(STEEL_ON_BRASS, normal_load=-3.0)
