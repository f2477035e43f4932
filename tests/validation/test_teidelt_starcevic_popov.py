"""R. Teidelt, J. Starcevic and V. L. Popov, Tribol. Lett. 48, 51 (2012): static friction while the load oscillates."""

import numpy as np
import pytest
from pytest import approx

from sonolube.models.friction import SpringContact, normal_oscillation_ratio, normal_static_ratio

FLAT = SpringContact(friction_coefficient=0.4, mindlin_ratio=0.8)
SPHERE = SpringContact(friction_coefficient=0.4, mindlin_ratio=0.8, profile="parabolic")
DEPTH = 1e-6


@pytest.mark.parametrize("share", [0.0, 0.2, 0.5, 0.9, 1.0])
def test_static_friction_is_that_of_the_least_load(share: float) -> None:
    # constant stiffness: mu (F_N - k_z a)
    assert normal_static_ratio(FLAT, approach=DEPTH, normal_amplitude=share * DEPTH) == approx(1 - share, abs=1e-12)


@pytest.mark.parametrize("share", [0.2, 0.5, 0.9])
def test_under_a_sphere_it_is_that_of_hertzs_least_load(share: float) -> None:
    phases = 2 * np.pi * (np.arange(100_000) + 0.5) / 100_000
    mean = np.mean((1 - share * np.cos(phases)) ** 1.5)
    held = normal_static_ratio(SPHERE, approach=DEPTH, normal_amplitude=share * DEPTH)
    assert held == approx((1 - share) ** 1.5 / mean, rel=1e-6)


@pytest.mark.parametrize("contact", [FLAT, SPHERE])
@pytest.mark.parametrize("share", [0.2, 0.7])
def test_slow_sliding_comes_down_to_it(contact: SpringContact, share: float) -> None:
    slow = normal_oscillation_ratio(
        contact, approach=DEPTH, normal_amplitude=share * DEPTH, frequency=20e3, sliding_speed=1e-8
    )
    assert slow == approx(normal_static_ratio(contact, approach=DEPTH, normal_amplitude=share * DEPTH), abs=1e-4)
