"""X. Mao, V. L. Popov, J. Starcevic and M. Popov, Friction 5, 194 (2017): normal oscillation, the slider on a guide.

Their abstract: amplitude, velocity and the relation of three frequencies decide, those of the oscillation, the contact
and the guide; very soft and very stiff guides give what was known; at resonance there is no critical speed.
"""

from typing import Any

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput, ModelRangeWarning
from sonolube.models.friction import (
    Holder,
    SpringContact,
    approximate_guided_ratio,
    approximate_normal_ratio,
    guided_critical_speed,
    guided_oscillation_ratio,
    normal_oscillation_ratio,
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
    conditions: dict[str, Any] = {**CONTACT, "approach": 1e-6, "sliding_speed": speed}
    return approximate_guided_ratio(FLAT, guide, **conditions), guided_oscillation_ratio(FLAT, guide, **conditions)


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
    first = approximate_normal_ratio(FLAT, approach=1e-6, normal_amplitude=0.5e-6, velocity_ratio=0.3)
    assert found == approx(first)


@pytest.mark.parametrize(("stiffness", "mass", "least"), [(1e6, 1e-4, 0.1), (1e6, 1e-5, 0.05)])
def test_where_the_slider_follows_the_form_fails_and_warns(stiffness: float, mass: float, least: float) -> None:
    with pytest.warns(ModelRangeWarning, match="the slider follows the oscillation"):
        found, exact = ratios(holder(stiffness, mass))
    assert np.abs(found - exact).max() > least


def test_springs_that_slip_apart_are_refused() -> None:
    sphere = SpringContact(friction_coefficient=0.4, mindlin_ratio=0.8, profile="parabolic")
    with raises(InvalidInput, match="profile must be 'flat'"):
        approximate_guided_ratio(sphere, Holder(), approach=1e-6, sliding_speed=0.01, **CONTACT)


OMEGA = 2 * np.pi * 20e3
LIGHT, RIGID_CRITICAL = 5e-5, OMEGA * 0.5e-6 * 0.5  # of the contact on a rigid guide: mu k_z/k_x is 0.5


def tuned(stiffness: float, *, mass: float = LIGHT) -> Holder:
    return Holder(holder_stiffness=stiffness, holder_mass=mass, holder_damping=0.02 * mass * OMEGA)


def exact(guide: Holder, velocity_ratio: np.ndarray) -> np.ndarray:
    return guided_oscillation_ratio(
        FLAT, guide, approach=1e-6, sliding_speed=velocity_ratio * RIGID_CRITICAL, **CONTACT
    )


def test_amplitude_velocity_and_three_frequencies_decide() -> None:
    # with damping a fourth number; all else is scaled
    one = exact(tuned(0.5 * LIGHT * OMEGA**2), SPEEDS)
    stiffer, faster, deeper, smoother = 7.0, 1.3, 3.0, 0.5
    contact = SpringContact(friction_coefficient=smoother * 0.4, mindlin_ratio=0.8)
    guide = Holder(
        holder_stiffness=stiffer * 0.5 * LIGHT * OMEGA**2,
        holder_mass=stiffer * LIGHT / faster**2,
        holder_damping=stiffer * 0.02 * LIGHT * OMEGA / faster,
    )
    scaled = guided_oscillation_ratio(
        contact,
        guide,
        normal_stiffness=stiffer * 1e6,
        approach=deeper * 1e-6,
        normal_amplitude=deeper * 0.5e-6,
        frequency=faster * 20e3,
        sliding_speed=SPEEDS * smoother * deeper * faster * RIGID_CRITICAL,
    )
    assert scaled == approx(one, abs=1e-6)


@pytest.mark.parametrize(("stiffness", "mass"), [(1e11, 5e-3), (1e13, 5e-3), (1e3, 0.05)])
def test_a_guide_very_stiff_or_a_heavy_slider_on_a_very_soft_one_are_those_of_the_first_part(
    stiffness: float, mass: float
) -> None:
    first = normal_oscillation_ratio(
        FLAT, approach=1e-6, normal_amplitude=0.5e-6, frequency=20e3, sliding_speed=SPEEDS * RIGID_CRITICAL
    )
    assert exact(tuned(stiffness, mass=mass), SPEEDS) == approx(first, abs=1e-3)


def test_a_soft_guide_without_mass_needs_a_speed_that_grows_as_it_softens() -> None:
    soft = Holder(holder_stiffness=1e3)  # mu k_z a omega/K, and the contact's own
    critical = float(guided_critical_speed(FLAT, soft, **CONTACT))
    assert critical == approx(0.4 * 1e6 * 0.5e-6 * OMEGA / 1e3, rel=2e-3)
    assert exact(soft, np.array([0.99, 1.01]) * critical / RIGID_CRITICAL) == approx([0.99994, 1], abs=1e-4)


def test_the_resonant_guide_has_no_critical_speed_but_what_damping_sets() -> None:
    resonance, fast = LIGHT * OMEGA**2, np.array([3.0, 6.0])
    damped = Holder(holder_stiffness=resonance, holder_mass=LIGHT, holder_damping=0.1 * LIGHT * OMEGA)
    assert np.all(exact(damped, fast) < 0.95)
    assert exact(tuned(3 * resonance), fast) == approx([1, 1])
    assert guided_critical_speed(FLAT, Holder(holder_stiffness=resonance, holder_mass=LIGHT), **CONTACT) > 1e6
