"""Wear of the cube model against the printed tables of D and closed forms."""

import numpy as np
import pytest
from hypothesis import given, strategies as st
from pytest import approx, raises
from scipy.integrate import quad
from scipy.special import i0, i1, modstruve

from sonolube.errors import InvalidInput
from sonolube.models.contact import ASPERITY_LAWS, ContactPair, RoughContact, real_contact_area, separation
from sonolube.models.surfaces import Roughness
from sonolube.models.wear import cube_wear_rate, vibrating_cube_wear_rate

ACORN_NUT_ON_DISC = RoughContact(  # D Table 3.2
    roughness=Roughness(rms_height=6e-6, summit_radius=1.5e-6, summit_density=4.7e10),
    pair=ContactPair(effective_modulus=59.6e9, poisson_ratio=0.33, yield_strength=410e6, mindlin_ratio=0.8),
    nominal_area=2.25e-6,
    asperity=ASPERITY_LAWS["dong_2015"],
)
HUNDREDTHS_OF_CUBIC_MILLIMETRES_PER_METRE = 1e-11  # in m2
DECAY_LENGTH = 6e-6 / 3  # Rq/lambda


def test_the_cube_model_gives_the_printed_wear_without_vibration() -> None:
    rate = cube_wear_rate(ACORN_NUT_ON_DISC, normal_load=3.0) / HUNDREDTHS_OF_CUBIC_MILLIMETRES_PER_METRE
    assert round(float(rate), 3) == 2.566  # D Table 3.4


def test_the_cube_model_gives_the_printed_wear_with_vibration() -> None:
    rate = vibrating_cube_wear_rate(ACORN_NUT_ON_DISC, normal_load=3.0, vibration_amplitude=2.5e-6)
    # D Table 3.4: 1.355, where the integral is 1.3545; a sum of some 2400 samples, both ends counted, gives the printed
    assert rate / HUNDREDTHS_OF_CUBIC_MILLIMETRES_PER_METRE == approx(1.355, rel=5e-4)


def test_the_printed_sliding_distance_does_not_give_the_printed_wear() -> None:
    rate = cube_wear_rate(ACORN_NUT_ON_DISC, normal_load=3.0) / HUNDREDTHS_OF_CUBIC_MILLIMETRES_PER_METRE
    assert rate * np.pi / 4 == approx(2.015, abs=5e-4)  # over 4 sqrt(A_n)/pi, D 3.27


def test_by_the_printed_full_period_vibration_raises_the_wear() -> None:
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
    at_rest = cube_wear_rate(ACORN_NUT_ON_DISC, normal_load=load)
    vibrating = vibrating_cube_wear_rate(ACORN_NUT_ON_DISC, normal_load=load, vibration_amplitude=amplitude)
    assert vibrating / at_rest == approx(ratio, rel=1e-11)


@given(load=st.floats(0.1, 100))
def test_a_vanishing_vibration_does_not_change_the_wear(load: float) -> None:
    at_rest = cube_wear_rate(ACORN_NUT_ON_DISC, normal_load=load)
    assert vibrating_cube_wear_rate(ACORN_NUT_ON_DISC, normal_load=load, vibration_amplitude=0.0) == approx(
        at_rest, rel=1e-6, abs=0
    )


def test_a_load_without_positive_separation_is_refused() -> None:
    with raises(InvalidInput, match=r"separation must be positive"):
        cube_wear_rate(ACORN_NUT_ON_DISC, normal_load=1e5)
