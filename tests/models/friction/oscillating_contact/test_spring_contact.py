"""Spring contact: critical speed by hand, and the load-balanced approach by averaging."""

import numpy as np
from pytest import approx, mark, raises

from sonolube.errors import InvalidInput
from sonolube.models.friction import SpringContact, critical_speed, load_balanced_approach

FLAT = SpringContact(friction_coefficient=0.4, mindlin_ratio=0.8)
SPHERE = SpringContact(friction_coefficient=0.4, mindlin_ratio=0.8, profile="parabolic")
FREQUENCY, DEPTH = 20e3, 1e-6
BOTH = mark.parametrize("contact", [FLAT, SPHERE])


def test_the_critical_speed_is_hand_computed() -> None:
    # 0.4 * 2 pi 20 kHz * 1 um / 0.8
    assert float(critical_speed(FLAT, frequency=20e3, normal_amplitude=1e-6)) == approx(0.0628319, rel=1e-5)


@BOTH
@mark.parametrize("amplitude", [0.0, 0.4, 1.0, 3.0])
def test_the_load_balanced_approach_has_the_mean_force_at_rest(contact: SpringContact, amplitude: float) -> None:
    mean = float(load_balanced_approach(contact, approach=DEPTH, normal_amplitude=amplitude * DEPTH)) / DEPTH
    theta = (np.arange(40000) + 0.5) * 2 * np.pi / 40000
    power = 1.0 if contact is FLAT else 1.5
    assert np.mean(np.maximum(mean - amplitude * np.cos(theta), 0) ** power) == approx(1, abs=1e-6)


def test_an_unknown_profile_is_refused() -> None:
    with raises(InvalidInput, match="profile must be 'flat' or 'parabolic'"):
        SpringContact(friction_coefficient=0.4, mindlin_ratio=0.8, profile="cone")  # type: ignore[arg-type]
