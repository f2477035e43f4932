"""Coefficient of friction: hand-computed values, and refused arguments."""

import numpy as np
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.models.friction import friction_coefficient


def test_the_coefficient_is_force_over_load_and_keeps_the_sign_of_the_force() -> None:
    found = friction_coefficient(friction_force=[54.0, 0.0, -54.0], normal_load=100.0)
    assert found == approx(np.array([0.54, 0.0, -0.54]))


def test_forces_and_loads_broadcast() -> None:
    assert friction_coefficient(friction_force=np.linspace(-1, 1, 5), normal_load=np.ones((3, 1))).shape == (3, 5)


def test_a_load_that_is_not_positive_is_refused_by_name() -> None:
    with raises(InvalidInput, match=r"normal_load must be positive, got 0\.0 N"):
        friction_coefficient(friction_force=1.0, normal_load=0.0)
