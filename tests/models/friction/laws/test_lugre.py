"""The LuGre law refuses forces that contradict each other."""

from pytest import raises

from sonolube.errors import InvalidInput
from sonolube.models.friction import LuGreFriction


def test_a_static_force_below_the_coulomb_force_is_refused() -> None:
    with raises(
        InvalidInput, match=r"static_friction_force must be at least coulomb_friction_force, 1\.0 N, got 0\.5 N"
    ):
        LuGreFriction(
            coulomb_friction_force=1.0,
            static_friction_force=0.5,
            stribeck_velocity=1e-3,
            bristle_stiffness=1e5,
            bristle_damping=300.0,
            viscous_coefficient=0.4,
        )
