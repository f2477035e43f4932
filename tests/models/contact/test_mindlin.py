"""Mindlin's tangential stiffness against the slope of the load."""

import numpy as np
from pytest import approx

from sonolube.models.contact import (
    ASPERITY_LAWS,
    ContactPair,
    ElasticBody,
    RoughContact,
    contact_pair,
    mindlin_tangential_stiffness,
    separation,
)
from sonolube.models.contact.elastic_bodies import identical_materials_mindlin_ratio
from sonolube.models.surfaces import Roughness

# D, Table 3.2
PUBLISHED = RoughContact(
    roughness=Roughness(rms_height=6e-6, summit_radius=1.5e-6, summit_density=4.7e10),
    pair=ContactPair(effective_modulus=59.6e9, poisson_ratio=0.33, yield_strength=410e6, mindlin_ratio=0.8),
    nominal_area=2.25e-6,
    asperity=ASPERITY_LAWS["dong_2015"],
)


def test_mindlin_stiffness_is_the_mindlin_ratio_times_the_slope_of_the_load() -> None:
    # under exponential heights that slope is lambda F/Rq
    d = separation(PUBLISHED, normal_load=np.array([3.0, 40.0]))
    assert mindlin_tangential_stiffness(PUBLISHED, separation=d) == approx(0.8 * 3 * np.array([3.0, 40.0]) / 6e-6)


def test_the_mindlin_ratio_of_unlike_bodies_is_that_of_johnson() -> None:
    # Johnson (1985), 7.43 and 4.23: k_t/k_n = 4 G*/E* of steel, 200 GPa and 0.3, on aluminium, 70 GPa and 0.33
    steel, aluminium = (ElasticBody(youngs_modulus=E, poisson_ratio=nu) for E, nu in ((200e9, 0.3), (70e9, 0.33)))
    pair = contact_pair(softer=aluminium, harder=steel, yield_strength=1e8)
    shear = 1 / (1.67 * 2 * 1.33 / 70e9 + 1.70 * 2 * 1.30 / 200e9)
    modulus = 1 / (0.8911 / 70e9 + 0.91 / 200e9)
    assert pair.mindlin_ratio == approx(4 * shear / modulus)


def test_the_mindlin_ratio_of_like_bodies_is_its_closed_form() -> None:
    body = ElasticBody(youngs_modulus=200e9, poisson_ratio=0.29)
    pair = contact_pair(softer=body, harder=body, yield_strength=1e8)
    assert pair.mindlin_ratio == approx(identical_materials_mindlin_ratio(poisson_ratio=0.29))
