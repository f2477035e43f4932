"""Coulomb's law: sign, proportionality to the load, and refused arguments."""

import numpy as np
from hypothesis import given, strategies as st
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.models.friction import CoulombFriction, coulomb_friction, friction_coefficient

STEEL_ON_ALUMINIUM = CoulombFriction(friction_coefficient=0.54)


def test_friction_opposes_sliding_in_both_directions_and_vanishes_at_rest() -> None:
    force = coulomb_friction(STEEL_ON_ALUMINIUM, normal_load=100.0, relative_velocity=[0.01, 0.0, -3.0])
    assert force == approx(np.array([54.0, 0.0, -54.0]))


@given(load=st.floats(0, 1e6), velocity=st.floats(-10, 10))
def test_the_sliding_speed_has_no_effect(load: float, velocity: float) -> None:
    slow, fast = (
        coulomb_friction(STEEL_ON_ALUMINIUM, normal_load=load, relative_velocity=v)
        for v in (velocity, 2 * velocity + np.sign(velocity))
    )
    assert slow == approx(fast)


@given(load=st.floats(1e-3, 1e6), mu=st.floats(0, 2))
def test_the_coefficient_is_recovered_from_the_force(load: float, mu: float) -> None:
    force = coulomb_friction(CoulombFriction(friction_coefficient=mu), normal_load=load, relative_velocity=1.0)
    assert friction_coefficient(friction_force=force, normal_load=load) == approx(mu)


def test_loads_and_velocities_broadcast() -> None:
    force = coulomb_friction(STEEL_ON_ALUMINIUM, normal_load=np.ones((3, 1)), relative_velocity=np.linspace(-1, 1, 5))
    assert force.shape == (3, 5)


def test_loads_and_coefficients_out_of_range_are_refused_by_name() -> None:
    with raises(InvalidInput, match=r"normal_load must not be negative, got -3\.0 N"):
        coulomb_friction(STEEL_ON_ALUMINIUM, normal_load=-3.0, relative_velocity=1.0)
    with raises(InvalidInput, match=r"normal_load must be positive, got 0\.0 N"):
        friction_coefficient(friction_force=1.0, normal_load=0.0)
    with raises(InvalidInput, match=r"friction_coefficient must not be negative"):
        CoulombFriction(friction_coefficient=-0.1)
