"""Closed-form approximations against the exact ratios."""

import numpy as np
from pytest import approx, mark, warns

from sonolube.errors import ModelRangeWarning
from sonolube.models.friction import SpringContact, approximate_normal_ratio, critical_speed, normal_oscillation_ratio

FLAT = SpringContact(friction_coefficient=0.4, mindlin_ratio=0.8)
SPHERE = SpringContact(friction_coefficient=0.4, mindlin_ratio=0.8, profile="parabolic")
FREQUENCY, DEPTH = 20e3, 1e-6


@mark.parametrize(("contact", "below", "above"), [(FLAT, 0.0144, 1e-9), (SPHERE, 0.0061, 0.0223)])
def test_the_published_approximation_has_the_stated_error(contact: SpringContact, below: float, above: float) -> None:
    amplitude, v = np.linspace(0.05, 1, 12) * DEPTH, np.linspace(0.002, 1, 200)[:, np.newaxis]
    exact = normal_oscillation_ratio(
        contact,
        approach=DEPTH,
        normal_amplitude=amplitude,
        frequency=FREQUENCY,
        sliding_speed=v * critical_speed(contact, frequency=FREQUENCY, normal_amplitude=amplitude),
    )
    error = approximate_normal_ratio(contact, approach=DEPTH, normal_amplitude=amplitude, velocity_ratio=v) - exact
    assert error.min() == approx(-below, abs=2e-4)
    assert error.max() == approx(above, abs=2e-4)


def test_the_approximation_warns_where_contact_is_lost() -> None:
    with warns(ModelRangeWarning, match="contact is lost"):
        approximate_normal_ratio(FLAT, approach=1e-6, normal_amplitude=2e-6, velocity_ratio=0.5)
