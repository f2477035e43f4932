"""Static friction under oscillation."""

from pytest import raises

from sonolube.errors import OutsideRange
from sonolube.models.friction import SpringContact, normal_static_ratio

FLAT = SpringContact(friction_coefficient=0.4, mindlin_ratio=0.8)


def test_loss_of_contact_throughout_the_period_is_refused() -> None:
    with raises(OutsideRange, match="contact is lost throughout"):
        normal_static_ratio(FLAT, approach=-2e-6, normal_amplitude=1e-6)
