import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pytest import approx, raises
from scipy.integrate import quad
from scipy.special import i0, i1, modstruve

from sonolube.contact import ASPERITY_LAWS, ContactPair, RoughContact, real_contact_area, separation
from sonolube.errors import InvalidInput
from sonolube.surfaces import Roughness
from sonolube.wear import (
    ArchardWear,
    archard_wear_rate,
    cube_wear_rate,
    mass_loss,
    specific_wear_rate,
    vibrating_cube_wear_rate,
    vibration_contact_count,
)

STEEL_ON_BRASS = ArchardWear(wear_coefficient=1e-4, hardness=1e9)
ACORN_NUT_ON_DISC = RoughContact(  # D Table 3.2
    roughness=Roughness(rms_height=6e-6, summit_radius=1.5e-6, summit_density=4.7e10),
    pair=ContactPair(effective_modulus=59.6e9, poisson_ratio=0.33, yield_strength=410e6, mindlin_ratio=0.8),
    nominal_area=2.25e-6,
    asperity=ASPERITY_LAWS["dong_2015"],
)
HUNDREDTHS_OF_CUBIC_MILLIMETRES_PER_METRE = 1e-11  # in m2
DECAY_LENGTH = 6e-6 / 3  # Rq/lambda

loads = st.floats(0.01, 1e3)


@given(load=loads, factor=st.floats(0.01, 100))
def test_wear_is_proportional_to_load(load: float, factor: float) -> None:
    one = archard_wear_rate(STEEL_ON_BRASS, normal_load=load)
    assert archard_wear_rate(STEEL_ON_BRASS, normal_load=factor * load) == approx(factor * one)


def test_a_kilometre_under_ten_newton_takes_the_hand_computed_volume() -> None:
    # K = 1e-4, H = 1 GPa, 10 N: 1e-12 m2; over 1000 m, 1 mm3.
    assert 1000 * archard_wear_rate(STEEL_ON_BRASS, normal_load=10.0) == approx(1e-9)


def test_a_negative_load_is_refused_by_name() -> None:
    with raises(InvalidInput, match=r"normal_load must not be negative, got -3\.0 N"):
        archard_wear_rate(STEEL_ON_BRASS, normal_load=-3.0)


@given(load=loads)
def test_the_specific_rate_of_archards_law_does_not_depend_on_the_load(load: float) -> None:
    rate = archard_wear_rate(STEEL_ON_BRASS, normal_load=load)
    assert specific_wear_rate(wear_rate=rate, normal_load=load) == approx(1e-13)


def test_a_cubic_millimetre_of_aluminium_weighs_two_point_seven_milligrams() -> None:
    assert mass_loss(wear_volume=1e-9, density=2700.0) == approx(2.7e-6)


def test_an_hour_at_twenty_two_kilohertz_makes_eighty_million_contacts() -> None:
    assert vibration_contact_count(frequency=22e3, duration=3600.0) == approx(79.2e6)


def test_the_cube_model_gives_the_printed_wear_without_vibration() -> None:
    rate = cube_wear_rate(ACORN_NUT_ON_DISC, normal_load=3.0) / HUNDREDTHS_OF_CUBIC_MILLIMETRES_PER_METRE
    assert round(float(rate), 3) == 2.566  # D Table 3.4


def test_the_cube_model_gives_the_printed_wear_with_vibration() -> None:
    rate = vibrating_cube_wear_rate(ACORN_NUT_ON_DISC, normal_load=3.0, vibration_amplitude=2.5e-6)
    # D Table 3.4: 1.355, where the integral is 1.3545; a sum of some 2400 samples, both ends counted, gives the printed
    assert rate / HUNDREDTHS_OF_CUBIC_MILLIMETRES_PER_METRE == approx(1.355, rel=5e-4)


def test_the_printed_sliding_distance_misses_the_printed_wear() -> None:
    rate = cube_wear_rate(ACORN_NUT_ON_DISC, normal_load=3.0) / HUNDREDTHS_OF_CUBIC_MILLIMETRES_PER_METRE
    assert rate * np.pi / 4 == approx(2.015, abs=5e-4)  # over 4 sqrt(A_n)/pi, D 3.27


def test_the_printed_full_period_would_have_vibration_raise_the_wear() -> None:
    d = float(separation(ACORN_NUT_ON_DISC, normal_load=3.0))

    def volume(theta: float) -> float:
        gap = d + 2.5e-6 * np.sin(theta)
        return float(real_contact_area(ACORN_NUT_ON_DISC, separation=gap) * gap)

    assert quad(volume, 0, 2 * np.pi)[0] / (2 * np.pi) / volume(0.0) == approx(1.31, abs=0.005)  # D 3.28


@pytest.mark.parametrize("load", [0.1, 3.0, 30.0])
@pytest.mark.parametrize("amplitude", [1e-8, 0.5e-6, 2.5e-6, 8e-6])
def test_vibrating_wear_is_the_closed_form_of_exponential_heights(load: float, amplitude: float) -> None:
    # area goes with exp(-x/l): the half-period means of exp(-z s) and s exp(-z s), s = sin(theta), are
    # I0(z) - L0(z) and, minus its derivative, L1(z) + 2/pi - I1(z)
    d, z = float(separation(ACORN_NUT_ON_DISC, normal_load=load)), amplitude / DECAY_LENGTH
    ratio = (i0(z) - modstruve(0, z)) + amplitude / d * (modstruve(1, z) + 2 / np.pi - i1(z))
    still = cube_wear_rate(ACORN_NUT_ON_DISC, normal_load=load)
    vibrating = vibrating_cube_wear_rate(ACORN_NUT_ON_DISC, normal_load=load, vibration_amplitude=amplitude)
    assert vibrating / still == approx(ratio, rel=1e-11)


@given(load=st.floats(0.1, 100))
def test_a_vanishing_vibration_leaves_the_wear_as_it_is(load: float) -> None:
    still = cube_wear_rate(ACORN_NUT_ON_DISC, normal_load=load)
    assert vibrating_cube_wear_rate(ACORN_NUT_ON_DISC, normal_load=load, vibration_amplitude=0.0) == approx(still)


def test_a_load_that_leaves_no_cube_is_refused() -> None:
    with raises(InvalidInput, match=r"separation must be positive"):
        cube_wear_rate(ACORN_NUT_ON_DISC, normal_load=1e5)
