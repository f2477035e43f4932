"""A spring contact on a guide with spring and mass, against its limits and its critical speed."""

import numpy as np
from pytest import approx, mark, raises

from sonolube.errors import InvalidInput
from sonolube.models.friction import (
    Holder,
    SpringContact,
    critical_speed,
    guided_critical_speed,
    guided_oscillation_ratio,
    normal_oscillation_ratio,
)

FLAT = SpringContact(friction_coefficient=0.4, mindlin_ratio=0.8)
SPHERE = SpringContact(friction_coefficient=0.4, mindlin_ratio=0.8, profile="parabolic")
FREQUENCY, DEPTH, SLIP = 20e3, 1e-6, 0.5e-6  # slip length mu k_z/k_x times the depth
OMEGA = 2 * np.pi * FREQUENCY


MASS, K_Z = 5e-3, 1e6


def guided(speed: float, *, stiffness: float, mass: float, damping: float = 0.0) -> float:
    return float(
        guided_oscillation_ratio(
            FLAT,
            Holder(holder_stiffness=stiffness, holder_mass=mass, holder_damping=damping),
            normal_stiffness=K_Z,
            approach=DEPTH,
            normal_amplitude=0.5 * DEPTH,
            frequency=FREQUENCY,
            sliding_speed=speed,
        )
    )


def test_a_heavy_slider_is_rigidly_guided() -> None:
    speed = 0.3 * float(critical_speed(FLAT, frequency=FREQUENCY, normal_amplitude=0.5 * DEPTH))
    rigid = normal_oscillation_ratio(
        FLAT, approach=DEPTH, normal_amplitude=0.5 * DEPTH, frequency=FREQUENCY, sliding_speed=speed
    )
    assert guided(speed, stiffness=1e4, mass=0.05, damping=10.0) == approx(float(rigid), abs=2e-3)


def test_a_guide_without_mass_is_a_spring_in_series() -> None:
    holder = Holder(holder_stiffness=0.8 * K_Z)  # as stiff as the contact, so that the critical speed doubles
    critical = guided_critical_speed(
        FLAT, holder, normal_stiffness=K_Z, normal_amplitude=0.5 * DEPTH, frequency=FREQUENCY
    )
    assert float(critical) == approx(2 * OMEGA * SLIP * 0.5)
    assert guided(0.999 * float(critical), stiffness=0.8 * K_Z, mass=0.0) < 1
    assert guided(1.001 * float(critical), stiffness=0.8 * K_Z, mass=0.0) == 1


@mark.parametrize("tuning", [0.5, 0.9, 1.3])
def test_the_guided_critical_speed_is_where_the_integrated_ratio_reaches_one(tuning: float) -> None:
    stiffness = tuning * MASS * OMEGA**2
    holder = Holder(holder_stiffness=stiffness, holder_mass=MASS, holder_damping=0.02 * MASS * OMEGA)
    critical = float(
        guided_critical_speed(FLAT, holder, normal_stiffness=K_Z, normal_amplitude=0.5 * DEPTH, frequency=FREQUENCY)
    )
    damping = holder.holder_damping
    assert guided(1.02 * critical, stiffness=stiffness, mass=MASS, damping=damping) == approx(1, abs=1e-6)
    assert guided(0.7 * critical, stiffness=stiffness, mass=MASS, damping=damping) < 0.999


def test_at_the_resonance_of_the_guide_the_critical_speed_is_unbounded() -> None:
    resonant = Holder(holder_stiffness=MASS * OMEGA**2, holder_mass=MASS)
    critical = guided_critical_speed(
        FLAT, resonant, normal_stiffness=K_Z, normal_amplitude=0.5 * DEPTH, frequency=FREQUENCY
    )
    assert critical > 1e6


def test_a_parabolic_contact_on_a_compliant_guide_is_refused() -> None:
    with raises(InvalidInput, match="profile must be 'flat'"):
        guided_oscillation_ratio(
            SPHERE,
            Holder(),
            normal_stiffness=K_Z,
            approach=DEPTH,
            normal_amplitude=DEPTH,
            frequency=FREQUENCY,
            sliding_speed=0.1,
        )
