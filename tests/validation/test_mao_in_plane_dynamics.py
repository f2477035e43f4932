"""X. Mao, V. L. Popov, J. Starcevic and M. Popov, Friction 5, 194 (2017): normal oscillation, the slider on a guide."""

from typing import Any

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput, ModelRangeWarning
from sonolube.friction import (
    Holder,
    SpringContact,
    approximate_guided_ratio,
    approximate_oscillation_ratio,
    guided_critical_speed,
    guided_oscillation_ratio,
)

FLAT = SpringContact(friction_coefficient=0.4, mindlin_ratio=0.8)
CONTACT: dict[str, float] = {"normal_stiffness": 1e6, "normal_amplitude": 0.5e-6, "frequency": 20e3}
SPEEDS = np.array([0.05, 0.2, 0.4, 0.6, 0.8, 1.1])


def holder(stiffness: float, mass: float) -> Holder:
    damping = 0.05 * np.sqrt(stiffness * mass)
    return Holder(holder_stiffness=stiffness, holder_mass=mass, holder_damping=float(damping))


def ratios(guide: Holder) -> tuple[np.ndarray, np.ndarray]:
    """Return approximate and exact ratios up to the critical speed."""
    speed = SPEEDS * guided_critical_speed(FLAT, guide, **CONTACT)
    told: dict[str, Any] = {**CONTACT, "approach": 1e-6, "sliding_speed": speed}
    return approximate_guided_ratio(FLAT, guide, **told), guided_oscillation_ratio(FLAT, guide, **told)


@pytest.mark.parametrize(("stiffness", "mass"), [(1e5, 1e-2), (1e5, 1e-3), (1e4, 3e-4)])
def test_a_slider_too_heavy_to_follow_has_the_form_of_a_rigid_guide(stiffness: float, mass: float) -> None:
    found, exact = ratios(holder(stiffness, mass))
    assert found == approx(exact, abs=0.02)


def test_a_guide_without_mass_has_it_too() -> None:
    found, exact = ratios(Holder(holder_stiffness=5e5))
    assert found == approx(exact, abs=0.0145 / 2)


def test_a_rigid_guide_is_that_of_the_first_part() -> None:
    rigid = Holder()
    speed = 0.3 * guided_critical_speed(FLAT, rigid, **CONTACT)
    found = approximate_guided_ratio(FLAT, rigid, approach=1e-6, sliding_speed=speed, **CONTACT)
    first = approximate_oscillation_ratio(FLAT, approach=1e-6, normal_amplitude=0.5e-6, velocity_ratio=0.3)
    assert found == approx(first)


@pytest.mark.parametrize(("stiffness", "mass", "least"), [(1e6, 1e-4, 0.1), (1e6, 1e-5, 0.05)])
def test_where_the_slider_follows_the_form_fails_and_warns(stiffness: float, mass: float, least: float) -> None:
    with pytest.warns(ModelRangeWarning, match="can follow the oscillation"):
        found, exact = ratios(holder(stiffness, mass))
    assert np.abs(found - exact).max() > least


def test_springs_that_slip_apart_are_refused() -> None:
    sphere = SpringContact(friction_coefficient=0.4, mindlin_ratio=0.8, profile="parabolic")
    with raises(InvalidInput, match="profile must be 'flat'"):
        approximate_guided_ratio(sphere, Holder(), approach=1e-6, sliding_speed=0.01, **CONTACT)
