"""Stiffness of the cube of Dong (2015): that of a beam."""

from collections.abc import Callable

from hypothesis import given, strategies as st
from pytest import approx, mark, raises

from sonolube.errors import InvalidInput
from sonolube.models.contact import (
    ASPERITY_LAWS,
    ContactPair,
    RoughContact,
    cube_tangential_stiffness,
    mindlin_tangential_stiffness,
    normal_force,
    real_contact_area,
    separation,
)
from sonolube.models.surfaces import Roughness

# D, Table 3.2
PUBLISHED = RoughContact(
    roughness=Roughness(rms_height=6e-6, summit_radius=1.5e-6, summit_density=4.7e10),
    pair=ContactPair(effective_modulus=59.6e9, poisson_ratio=0.33, yield_strength=410e6, mindlin_ratio=0.8),
    nominal_area=2.25e-6,
    asperity=ASPERITY_LAWS["dong_2015"],
)


@given(d=st.floats(5e-6, 40e-6))
def test_the_tangential_stiffness_of_the_cube_is_that_of_a_beam_with_fixed_ends(d: float) -> None:
    # 12 E I/d^3 with the second moment of a square section of area A, I = A^2/12
    area = float(real_contact_area(PUBLISHED, separation=d))
    beam = 12 * 59.6e9 * (area**2 / 12) / d**3
    assert cube_tangential_stiffness(PUBLISHED, separation=d) == approx(beam)


def test_the_bending_stiffness_of_the_published_cube_far_exceeds_its_shear_stiffness() -> None:
    d = separation(PUBLISHED, normal_load=3.0)
    shear = 73e9 / (2 * 1.33) * 4981e-12 / 15.453e-6  # G A_r/d of aluminium, area and height as published
    assert cube_tangential_stiffness(PUBLISHED, separation=d) == approx(4e8, rel=0.01)
    assert cube_tangential_stiffness(PUBLISHED, separation=d) > 40 * shear


def test_a_displacement_of_3_8_um_leaves_a_hundredth_of_the_stiffness_and_a_seventh_of_the_load() -> None:
    d = separation(PUBLISHED, normal_load=3.0)
    displaced = d + 3.8e-6
    ratio = cube_tangential_stiffness(PUBLISHED, separation=displaced) / cube_tangential_stiffness(
        PUBLISHED, separation=d
    )
    assert ratio == approx(0.012, abs=5e-4)
    assert normal_force(PUBLISHED, separation=displaced) / 3 == approx(0.15, abs=5e-3)


@mark.parametrize("stiffness", [cube_tangential_stiffness, mindlin_tangential_stiffness])
def test_a_cube_without_height_is_refused(stiffness: Callable[..., object]) -> None:
    with raises(InvalidInput, match=r"separation must be positive, got 0\.0 m"):
        stiffness(PUBLISHED, separation=[1e-6, 0.0])
