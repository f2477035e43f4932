"""M. Popov, V. L. Popov and N. V. Popov, Friction 5, 45 (2017): normal oscillation, its fit against springs."""

import numpy as np
import pytest
from pytest import approx

from sonolube.friction import SpringContact, approximate_oscillation_ratio, critical_speed, normal_oscillation_ratio

FLAT = SpringContact(friction_coefficient=0.4, mindlin_ratio=0.8)
DEPTH = 1e-6


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
    fit = approximate_oscillation_ratio(FLAT, approach=DEPTH, normal_amplitude=share * DEPTH, velocity_ratio=speed)
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
    whole = approximate_oscillation_ratio(FLAT, approach=DEPTH, normal_amplitude=0.5e-6, velocity_ratio=[1, 3])
    assert whole == approx([1, 1])
