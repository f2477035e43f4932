"""N. Milahin and J. Starcevic, Phys. Mesomech. 18, 197 (2015): static friction of a ball oscillating along it.

What they state: it is one function of the oscillation's amplitude over coefficient and indentation depth.
"""

import numpy as np
import pytest
from pytest import approx

from sonolube.models.friction import SpringContact, longitudinal_oscillation_ratio, longitudinal_static_ratio

STROKES = np.array([0.0, 0.05, 0.2, 0.5, 0.8, 0.99])


def static(stroke: np.ndarray, *, coefficient: float, depth: float) -> np.ndarray:
    ball = SpringContact(friction_coefficient=coefficient, mindlin_ratio=0.8, profile="parabolic")
    return longitudinal_static_ratio(ball, approach=depth, in_plane_amplitude=stroke * coefficient / 0.8 * depth)


@pytest.mark.parametrize(("coefficient", "depth"), [(0.1, 1e-6), (0.4, 0.2e-6), (0.8, 5e-6)])
def test_amplitude_over_coefficient_and_depth_decides(coefficient: float, depth: float) -> None:
    one_curve = static(STROKES, coefficient=0.2, depth=1e-6)
    assert static(STROKES, coefficient=coefficient, depth=depth) == approx(one_curve)


def test_the_curve_is_the_sum_over_springs_of_what_each_holds() -> None:
    # limits 1 - q^2 with distance; each holds its limit less the stroke, or nothing
    q = (np.arange(200_000) + 0.5) / 200_000
    held = [1.5 * np.maximum(1 - q**2 - stroke, 0.0).mean() for stroke in STROKES]
    assert static(STROKES, coefficient=0.4, depth=1e-6) == approx(held, abs=1e-6)


def test_the_force_at_one_end_is_that_of_mindlins_unloading() -> None:
    # Cattaneo and Mindlin: a ball drawn to full slip and let back by 2 a holds 1 - 2 [1 - (1 - s)^(3/2)] there; with
    # the whole friction at the other end their mean is the static force, spring by spring
    back = 1 - 2 * (1 - (1 - STROKES) ** 1.5)
    assert static(STROKES, coefficient=0.4, depth=1e-6) == approx((1 + back) / 2)


@pytest.mark.parametrize("stroke", [0.1, 0.5, 0.9])
def test_it_is_the_limit_of_slow_sliding(stroke: float) -> None:
    ball = SpringContact(friction_coefficient=0.4, mindlin_ratio=0.8, profile="parabolic")
    slow = longitudinal_oscillation_ratio(
        ball, approach=1e-6, in_plane_amplitude=stroke * 0.5e-6, frequency=20e3, sliding_speed=1e-8
    )
    assert static(np.array(stroke), coefficient=0.4, depth=1e-6) == approx(float(slow), abs=1e-4)
