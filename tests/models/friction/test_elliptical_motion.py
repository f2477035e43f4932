"""Traction of an elliptically vibrating surface against the mean of its instantaneous friction."""

import numpy as np
from hypothesis import given, settings, strategies as st
from pytest import approx, raises
from scipy.optimize import brentq

from sonolube.errors import InvalidInput
from sonolube.models.friction import contact_time_fraction, elliptical_traction_ratio, parallel_vibration_ratio

FREQUENCY, STIFFNESS, AMPLITUDE = 20e3, 1e6, 1e-6  # of 1 N the force swings by 1 N
OMEGA = 2 * np.pi * FREQUENCY
THETA = (np.arange(40000) + 0.5) * 2 * np.pi / 40000


def ratio(load: float, *, in_plane: float = 1e-6, velocity: float = 0.0, lag: float = np.pi / 2) -> float:
    return float(
        elliptical_traction_ratio(
            normal_load=load,
            normal_stiffness=STIFFNESS,
            normal_amplitude=AMPLITUDE,
            in_plane_amplitude=in_plane,
            frequency=FREQUENCY,
            relative_velocity=velocity,
            phase=lag,
        )
    )


def normal_force_over_period(load: float, lag: float) -> np.ndarray:
    """Return the normal force over a period, the slider lifted until its mean is the load."""
    surface = AMPLITUDE * np.cos(THETA - lag)

    def surplus_force(height: float) -> float:
        return float(np.mean(STIFFNESS * np.maximum(surface - height, 0)) - load)

    height = float(brentq(surplus_force, -5e-6, AMPLITUDE, xtol=1e-18))
    return np.asarray(STIFFNESS * np.maximum(surface - height, 0))


@settings(deadline=None)  # the first call compiles
@given(load=st.floats(0.02, 3), in_plane=st.floats(-2, 2), velocity=st.floats(-1.5, 1.5), lag=st.floats(-7, 7))
def test_the_traction_is_the_mean_of_the_instantaneous_friction(
    load: float, in_plane: float, velocity: float, lag: float
) -> None:
    forces = normal_force_over_period(load, lag)
    relative_velocity = -in_plane * np.sin(THETA) - velocity
    mean = float(np.mean(forces * np.sign(relative_velocity))) / load
    computed = ratio(load, in_plane=in_plane * 1e-6, velocity=velocity * OMEGA * 1e-6, lag=lag)
    if abs(abs(in_plane) - abs(velocity)) > 1e-6:
        assert computed == approx(mean, abs=1e-3)
    assert np.mean(forces > 0) == approx(
        float(contact_time_fraction(normal_load=load, normal_stiffness=STIFFNESS, normal_amplitude=AMPLITUDE)), abs=1e-4
    )


def test_the_motor_force_is_linear_in_the_load_while_contact_is_short() -> None:
    # up to k a/pi contact is no longer than the half period in which the surface goes one way
    loads = np.array([0.01, 0.1, 0.2, 0.99 / np.pi])
    assert [ratio(load) for load in loads] == approx([-1] * 4)
    assert -1 < ratio(1.2 / np.pi) < -0.9


def test_the_motor_force_reverses_across_the_node_and_points_towards_it() -> None:
    # u = A cos(wt) sin(pi x/L), v = B sin(wt) cos(pi x/L) (D 3.24, 3.25), the node of u at x = 0: D 2.1.4
    right, left = ratio(0.5, in_plane=1e-6), ratio(0.5, in_plane=-1e-6)
    assert right == approx(-left)
    assert right < 0


def test_the_reduction_exceeds_100_percent_for_a_slider_driven_forward() -> None:
    reduction = 1 + ratio(0.05, in_plane=-1e-6, velocity=0.05)
    assert reduction == approx(2)


def test_in_phase_both_directions_cancel() -> None:
    assert ratio(0.4, lag=0.0) == approx(0, abs=1e-12)


def test_without_contact_loss_the_motor_force_is_that_of_the_force_amplitude() -> None:
    # mean of sgn(cos) (1 + k a/F_N cos) = 2/pi k a/F_N
    assert ratio(4.0) == approx(-2 / np.pi / 4)


def test_without_normal_motion_the_ratio_is_the_arcsine() -> None:
    without = elliptical_traction_ratio(
        normal_load=1.0,
        normal_stiffness=STIFFNESS,
        normal_amplitude=0.0,
        in_plane_amplitude=1e-6,
        frequency=FREQUENCY,
        relative_velocity=0.05,
    )
    rigid = parallel_vibration_ratio(sliding_speed=0.05, vibration_velocity=OMEGA * 1e-6)
    assert float(without) == approx(-float(rigid))


def test_a_slider_faster_than_the_surface_has_full_friction() -> None:
    assert ratio(0.5, velocity=0.2) == -1
    assert ratio(0.5, velocity=-0.2) == 1


def test_a_load_of_zero_is_refused_by_name() -> None:
    with raises(InvalidInput, match=r"normal_load must be positive, got 0\.0 N"):
        ratio(0.0)
