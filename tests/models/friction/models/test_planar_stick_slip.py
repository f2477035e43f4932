"""Asperity stick-slip within the plane: springs of every height, limits into one direction, symmetry."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx
from tests.models.friction.models.test_coulomb import FREQUENCY, motion
from tests.models.friction.models.test_models import CONTACT

from sonolube.models.friction import (
    AsperityStickSlip,
    Coulomb,
    SpringContact,
    combined_oscillation_ratio,
    longitudinal_oscillation_ratio,
)

MEMORY = 0.3e-6
MODEL = AsperityStickSlip(memory_length=MEMORY)
SPEEDS = np.array([0.02, 0.1, 0.3])
SPRINGS = SpringContact(friction_coefficient=1.0, mindlin_ratio=1.0)
NODES, WEIGHTS = np.polynomial.legendre.leggauss(200)
HEIGHTS, SHARES = 15 * (1 + NODES), 15 * WEIGHTS  # in decay lengths, up to 30


def test_along_it_is_the_mean_of_springs_of_every_height() -> None:
    expected = sum(
        share
        * height
        * np.exp(-height)
        * longitudinal_oscillation_ratio(
            SPRINGS, approach=height * MEMORY, in_plane_amplitude=1e-6, frequency=FREQUENCY, sliding_speed=SPEEDS
        )
        for height, share in zip(HEIGHTS, SHARES, strict=True)
    )
    found = MODEL.ratio(CONTACT, motion(along=1), sliding_speed=SPEEDS)
    assert found == approx(expected, abs=5e-4)


def test_across_it_is_the_mean_of_springs_of_every_height() -> None:
    nodes, weights = np.polynomial.legendre.leggauss(40)
    heights, shares = 12 * (1 + nodes), 12 * weights
    expected = sum(
        share
        * height
        * np.exp(-height)
        * combined_oscillation_ratio(
            SPRINGS, approach=height * MEMORY, transverse_amplitude=1e-6, frequency=FREQUENCY, sliding_speed=SPEEDS
        )
        for height, share in zip(heights, shares, strict=True)
    )
    assert MODEL.ratio(CONTACT, motion(across=1), sliding_speed=SPEEDS) == approx(expected, abs=5e-4)


@pytest.mark.parametrize(("normal", "along"), [(0.0, 1), (1.0, np.exp(-1j)), (2.5, 0.4j), (1.0, 0.0)])
def test_no_motion_across_is_the_limit_of_little(normal: float, along: complex) -> None:
    without = motion(normal=normal, along=along)
    little = motion(normal=normal, along=along, across=1e-7)
    for speed in SPEEDS:
        found, expected = (MODEL.ratio(CONTACT, each, sliding_speed=speed) for each in (little, without))
        assert found == approx(expected, abs=5e-4)


def test_mirror_images_have_one_friction() -> None:
    one, other = (motion(normal=1.0, along=0.5j, across=sign * np.exp(0.4j)) for sign in (1, -1))
    found, mirrored = (MODEL.ratio(CONTACT, each, sliding_speed=SPEEDS) for each in (one, other))
    assert found == approx(mirrored, rel=1e-9)


def test_along_reduces_more_than_across_and_both_less_than_rigid_contacts() -> None:
    along, across = motion(along=1), motion(across=1)
    for moving in (along, across):
        soft = MODEL.ratio(CONTACT, moving, sliding_speed=SPEEDS)
        assert np.all(soft >= Coulomb().ratio(CONTACT, moving, sliding_speed=SPEEDS) - 1e-4)
    slow = SPEEDS[:1]
    assert MODEL.ratio(CONTACT, along, sliding_speed=slow) < MODEL.ratio(CONTACT, across, sliding_speed=slow)


def test_friction_is_its_own_where_the_motion_is_too_small_to_slip() -> None:
    tiny = motion(along=1e-5, across=1e-5j)
    assert MODEL.ratio(CONTACT, tiny, sliding_speed=SPEEDS) == approx(np.ones(3), abs=1e-3)
    assert MODEL.ratio(CONTACT, replace(tiny, across=None), sliding_speed=SPEEDS) == approx(np.ones(3), abs=1e-3)
