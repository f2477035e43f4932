"""Mindlin's tangential stiffness against the slope of the load."""

import numpy as np
from pytest import approx

from sonolube.contact import ASPERITY_LAWS, ContactPair, RoughContact, mindlin_tangential_stiffness, separation
from sonolube.surfaces import Roughness

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
