"""Plasticity index by hand, and of bodies without yielding."""

from dataclasses import replace

from pytest import approx

from sonolube.models.contact import (
    ASPERITY_LAWS,
    ContactPair,
    ExponentialHeights,
    GaussianHeights,
    HeightDistribution,
    RoughContact,
    plasticity_index,
)
from sonolube.models.surfaces import Roughness

STEEL = ContactPair(effective_modulus=110e9, poisson_ratio=0.3, yield_strength=2e9, mindlin_ratio=0.8)
FINE = Roughness(rms_height=0.2e-6, summit_radius=20e-6, summit_density=1.25e10)
CONTACT = RoughContact(roughness=FINE, pair=STEEL, nominal_area=1e-4, asperity=ASPERITY_LAWS["dong_2015"])

HEIGHTS: list[HeightDistribution] = [
    ExponentialHeights(),
    GaussianHeights(),
    GaussianHeights(summit_deviation_ratio=0.6),
]


def test_the_plasticity_index_is_the_hand_computed_one() -> None:
    # C_nu Y0 = 1.6108 * 2 GPa; w_c = (pi * 3.2216/220)^2 * 20 um = 42.326 nm; sqrt(200/42.326)
    assert plasticity_index(replace(CONTACT, asperity=ASPERITY_LAWS["chang_etsion_bogy"])) == approx(
        2.17378, rel=1e-4, abs=0
    )


def test_the_plasticity_index_of_bodies_that_never_yield_is_zero() -> None:
    assert plasticity_index(replace(CONTACT, asperity=ASPERITY_LAWS["elastic"])) == 0


def test_the_plasticity_index_follows_the_heights_of_the_contact_not_the_roughness_before_wear() -> None:
    # 3 l = 800 nm, four times the rms height of 200 nm: sqrt(800/42.326)
    contact = replace(CONTACT, asperity=ASPERITY_LAWS["chang_etsion_bogy"], decay_length=0.8e-6 / 3)
    assert plasticity_index(contact) == approx(2 * 2.17378, rel=1e-4, abs=0)
