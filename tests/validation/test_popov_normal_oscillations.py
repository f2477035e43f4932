"""M. Popov, V. L. Popov and N. V. Popov, Friction 5, 45 (2017): normal oscillation, its fit against springs.

Their abstract: friction is a function of two numbers, a velocity and an amplitude; the shape of the bodies decides
which; it holds on where contact is lost for part of the period. The form of the fit is the known one.
"""

from typing import Literal

import numpy as np
import pytest
from pytest import approx

from sonolube.models.friction import SpringContact, approximate_normal_ratio, critical_speed, normal_oscillation_ratio

FLAT = SpringContact(friction_coefficient=0.4, mindlin_ratio=0.8)
DEPTH = 1e-6
SPEEDS = np.array([0.01, 0.2, 0.6, 0.99, 1.0])
Profile = Literal["flat", "parabolic"]


def curve(
    profile: Profile,
    share: float,
    *,
    coefficient: float = 0.4,
    ratio: float = 0.8,
    depth: float = DEPTH,
    frequency: float = 20e3,
) -> np.ndarray:
    """Return the exact ratio over velocities in critical speeds."""
    contact = SpringContact(friction_coefficient=coefficient, mindlin_ratio=ratio, profile=profile)
    critical = critical_speed(contact, frequency=frequency, normal_amplitude=share * depth)
    return normal_oscillation_ratio(
        contact, approach=depth, normal_amplitude=share * depth, frequency=frequency, sliding_speed=SPEEDS * critical
    )


@pytest.mark.parametrize("profile", ["flat", "parabolic"])
@pytest.mark.parametrize("share", [0.4, 1.0, 1.5])
def test_velocity_over_the_critical_and_amplitude_over_the_approach_decide(profile: Profile, share: float) -> None:
    one = curve(profile, share)
    assert curve(profile, share, coefficient=0.1, ratio=0.6, depth=7e-6, frequency=43e3) == approx(one, abs=1e-9)


@pytest.mark.parametrize("profile", ["flat", "parabolic"])
def test_at_the_critical_speed_reduction_ends_whether_the_slider_jumps_or_not(profile: Profile) -> None:
    for share in (0.4, 1.0, 1.5):
        ratios = curve(profile, share)
        assert ratios[-2] < 1
        assert ratios[-1] == 1


@pytest.mark.parametrize("share", [0.4, 0.9])
def test_the_shape_of_the_bodies_decides_which_curve(share: float) -> None:
    assert np.all(curve("parabolic", share)[:3] < curve("flat", share)[:3] - 0.01)


@pytest.mark.parametrize("profile", ["flat", "parabolic"])
def test_a_slider_that_jumps_loses_its_static_friction(profile: Profile) -> None:
    assert curve(profile, 1.5)[0] < 0.15 < 0.3 < curve(profile, 0.4)[0]


def marched(share: float, speed: float) -> float:
    """Return the mean friction of a spring of unit mean limit; speed over the critical, steps by hand."""
    n = 20_000
    limit = np.maximum(1 - share * np.cos(2 * np.pi * np.arange(1, n + 1) / n), 0.0)
    drawn, force, mean = share * speed * 2 * np.pi / n, 1 - share, 0.0
    for _ in range(2):
        mean = 0.0
        for most in limit.tolist():
            force = min(force + drawn, most)
            mean += force / n
    return mean


@pytest.mark.parametrize(("share", "speed"), [(0.4, 0.1), (0.4, 0.6), (0.9, 0.02), (0.9, 0.3)])
def test_the_fit_is_within_its_stated_error_of_springs_marched(share: float, speed: float) -> None:
    fit = approximate_normal_ratio(FLAT, approach=DEPTH, normal_amplitude=share * DEPTH, velocity_ratio=speed)
    assert -0.0144 * share - 2e-4 < fit - marched(share, speed) < 2e-4


@pytest.mark.parametrize("share", [0.4, 0.9, 1.5])
def test_the_exact_ratio_is_that_of_springs_marched(share: float) -> None:
    critical = critical_speed(FLAT, frequency=20e3, normal_amplitude=share * DEPTH)
    ratio = normal_oscillation_ratio(
        FLAT, approach=DEPTH, normal_amplitude=share * DEPTH, frequency=20e3, sliding_speed=0.3 * critical
    )
    phases = 2 * np.pi * (np.arange(20_000) + 0.5) / 20_000
    carried = np.maximum(1 - share * np.cos(phases), 0.0).mean()
    assert ratio == approx(marched(share, 0.3) / carried, abs=5e-4)


def test_from_the_critical_speed_on_friction_is_whole() -> None:
    whole = approximate_normal_ratio(FLAT, approach=DEPTH, normal_amplitude=0.5e-6, velocity_ratio=[1, 3])
    assert whole == approx([1, 1])
