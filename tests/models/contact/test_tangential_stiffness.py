"""Models of the tangential stiffness by name, against closed forms of Mindlin and of a beam."""

import pytest
from pytest import approx

from sonolube.errors import UnknownName
from sonolube.models.contact import (
    ASPERITY_LAWS,
    DEFAULT_TANGENTIAL_STIFFNESS,
    TANGENTIAL_STIFFNESSES,
    ElasticBody,
    RoughContact,
    contact_pair,
    separation,
)
from sonolube.models.surfaces import Roughness

STEEL = ElasticBody(youngs_modulus=200e9, poisson_ratio=0.29)
CONTACT = RoughContact(
    roughness=Roughness(rms_height=6e-6, summit_radius=1.5e-6, summit_density=4.7e10),
    pair=contact_pair(softer=STEEL, harder=STEEL, yield_strength=250e6),
    nominal_area=2.25e-6,
    asperity=ASPERITY_LAWS["dong_2015"],
)


@pytest.mark.parametrize("load", [0.3, 3.0, 30.0])
def test_by_default_it_is_that_of_like_bodies_that_stick(load: float) -> None:
    # 2 (1 - nu)/(2 - nu) of the normal stiffness, which under exponential heights is load over Rq/3
    stiffness = TANGENTIAL_STIFFNESSES[DEFAULT_TANGENTIAL_STIFFNESS]
    expected = 2 * 0.71 / 1.71 * load / 2e-6
    assert stiffness(CONTACT, separation=separation(CONTACT, normal_load=load)) == approx(expected)


def test_the_cubes_exceeds_the_normal_stiffness_more_than_a_hundredfold() -> None:
    # as the area of the block in bending counts twice and its shear not at all
    bending = TANGENTIAL_STIFFNESSES.named("dong_2015")(CONTACT, separation=separation(CONTACT, normal_load=3.0))
    assert bending > 100 * 3.0 / 2e-6


def test_an_unknown_model_is_refused_with_the_nearest_name() -> None:
    with pytest.raises(UnknownName, match="model of the tangential stiffness"):
        TANGENTIAL_STIFFNESSES.named("mindlyn")
