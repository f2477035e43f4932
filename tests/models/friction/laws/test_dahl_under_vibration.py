"""Dahl's law under vibration against kinematic limits, closed forms and an integrator."""

import math

import numpy as np
import pytest
from pytest import approx, raises
from scipy.integrate import quad, solve_ivp
from scipy.special import i0

from sonolube.errors import InvalidInput, OutsideRange
from sonolube.models.contact import (
    ASPERITY_LAWS,
    ContactPair,
    RoughContact,
    cube_tangential_stiffness,
    normal_force,
    separation,
)
from sonolube.models.friction import dahl_under_vibration
from sonolube.models.surfaces import Roughness

# D Table 3.2
CONTACT = RoughContact(
    roughness=Roughness(rms_height=6e-6, summit_radius=1.5e-6, summit_density=4.7e10),
    pair=ContactPair(effective_modulus=59.6e9, poisson_ratio=0.33, yield_strength=410e6, mindlin_ratio=0.8),
    nominal_area=2.25e-6,
    asperity=ASPERITY_LAWS["dong_2015"],
)
LOAD, MU, FREQUENCY = 3.0, 0.3, 22e3
OMEGA = 2 * np.pi * FREQUENCY
AT_REST = float(separation(CONTACT, normal_load=LOAD))
DECAY_LENGTH = 6e-6 / 3  # Rq/lambda


def ratio(
    *,
    sliding_speed: float,
    in_plane_amplitude: float = 0.0,
    normal_amplitude: float = 0.0,
    phase: float = np.pi / 2,
    mean_separation: float = AT_REST,
    steps: int = 512,
) -> float:
    force = dahl_under_vibration(
        CONTACT,
        separation=mean_separation,
        friction_coefficient=MU,
        sliding_speed=sliding_speed,
        frequency=FREQUENCY,
        in_plane_amplitude=in_plane_amplitude,
        normal_amplitude=normal_amplitude,
        phase=phase,
        steps=steps,
    )
    return float(force) / (MU * LOAD)


@pytest.mark.parametrize("sliding_speed", [1e-6, 0.02, 5.0])
def test_without_vibration_friction_is_coulombs(sliding_speed: float) -> None:
    assert ratio(sliding_speed=sliding_speed) == approx(1, rel=1e-12)


def test_in_plane_vibration_slower_than_the_sliding_does_not_reduce_friction() -> None:
    assert ratio(sliding_speed=0.2, in_plane_amplitude=0.9 * 0.2 / OMEGA) == approx(1, rel=1e-12)


@pytest.mark.parametrize("velocity_ratio", [0.02, 0.2, 0.5, 0.9])
def test_a_long_in_plane_stroke_gives_the_kinematic_ratio(velocity_ratio: float) -> None:
    # with Coulomb friction the ratio is the fraction of time slid forward less that slid back
    stroke = 1e-4  # against a deformation of 2 nm
    kinematic = 2 / np.pi * np.arcsin(velocity_ratio)
    assert ratio(sliding_speed=velocity_ratio * OMEGA * stroke, in_plane_amplitude=stroke) == approx(
        kinematic, abs=3e-4
    )


@pytest.mark.parametrize("velocity_ratio", [0.02, 0.2, 0.5, 0.9])
def test_a_stroke_far_below_the_deformation_gives_sliding_speed_over_mean_relative_speed(velocity_ratio: float) -> None:
    # constant deformation: its growth v (1 - K delta/F_c sgn v) averages to zero at F/F_c = mean(v)/mean(|v|)
    stroke = 1e-14
    relative_speed = 2 / np.pi * (np.sqrt(1 - velocity_ratio**2) + velocity_ratio * np.arcsin(velocity_ratio))
    computed = ratio(sliding_speed=velocity_ratio * OMEGA * stroke, in_plane_amplitude=stroke)
    assert computed == approx(velocity_ratio / relative_speed, rel=1e-4)


@pytest.mark.parametrize("amplitude", [0.5e-6, 2.5e-6, 6e-6])
def test_fast_sliding_has_the_friction_of_the_mean_normal_force(amplitude: float) -> None:
    # the mean of exp(-a sin(theta)/l) is the modified Bessel function I0(a/l)
    assert ratio(sliding_speed=50.0, normal_amplitude=amplitude) == approx(i0(amplitude / DECAY_LENGTH), rel=1e-4)


def test_the_load_balanced_separation_restores_the_friction_of_fast_sliding() -> None:
    raised = AT_REST + DECAY_LENGTH * np.log(i0(2.5e-6 / DECAY_LENGTH))
    assert ratio(sliding_speed=50.0, normal_amplitude=2.5e-6, mean_separation=raised) == approx(1, rel=1e-4)


@pytest.mark.parametrize(
    ("sliding_speed", "in_plane_amplitude", "normal_amplitude", "phase"),
    [(2e-4, 0.0, 2.5e-6, 0.0), (2e-4, 5e-9, 2.5e-6, 1.0), (1e-3, 20e-9, 1e-6, np.pi / 2), (1e-3, 20e-9, 1e-6, -2.0)],
)
def test_a_steady_period_follows_the_integrated_differential_equation(
    sliding_speed: float, in_plane_amplitude: float, normal_amplitude: float, phase: float
) -> None:
    def gap(turn: float) -> float:
        return AT_REST + normal_amplitude * math.sin(turn - phase)

    def rate(turn: float, state: np.ndarray) -> list[float]:
        k = cube_tangential_stiffness(CONTACT, separation=gap(turn))
        limit = MU * normal_force(CONTACT, separation=gap(turn))
        v = sliding_speed / OMEGA + in_plane_amplitude * np.cos(turn)
        return [v * (1 - k * state[0] / limit * np.sign(v)), k * state[0]]

    settled = [0.0, 0.0]
    for _ in range(12):  # the start is forgotten by a factor of e in each F_c/K = 2.2 nm slid
        period = solve_ivp(rate, (0, 2 * np.pi), [settled[0], 0.0], rtol=1e-8, atol=1e-16, max_step=0.05)
        settled = period.y[:, -1].tolist()
    by_hand = settled[1] / (2 * np.pi) / (MU * LOAD)
    computed = ratio(
        sliding_speed=sliding_speed,
        in_plane_amplitude=in_plane_amplitude,
        normal_amplitude=normal_amplitude,
        phase=phase,
    )
    assert computed == approx(by_hand, rel=1e-4)


@pytest.mark.parametrize("sliding_speed", [1e-4, 0.02, 0.2])
@pytest.mark.parametrize("in_plane_amplitude", [0.0, 1e-8, 1e-6])
@pytest.mark.parametrize("normal_amplitude", [0.0, 2.5e-6, 1e-5])
def test_the_error_of_the_default_steps_is_below_1e_4(
    sliding_speed: float, in_plane_amplitude: float, normal_amplitude: float
) -> None:
    def refined(steps: int) -> float:
        return ratio(
            sliding_speed=sliding_speed,
            in_plane_amplitude=in_plane_amplitude,
            normal_amplitude=normal_amplitude,
            steps=steps,
        )

    assert refined(512) == approx(refined(4096), rel=1e-4)


def test_a_higher_load_on_the_forward_stroke_raises_friction_and_on_the_return_lowers_it() -> None:
    # a lag of a quarter turn brings the surfaces closest in the middle of the forward stroke
    forward, backward = (
        ratio(sliding_speed=0.02, in_plane_amplitude=1e-6, normal_amplitude=1e-6, phase=phase)
        for phase in (np.pi / 2, -np.pi / 2)
    )
    neutral = ratio(sliding_speed=0.02, in_plane_amplitude=1e-6, normal_amplitude=0.0)
    assert backward < neutral < forward


def test_with_long_strokes_friction_is_higher_in_phase_with_the_load() -> None:
    # Coulomb with the normal force of the moment: the mean of sgn(v) F_n over a period
    stroke, a, v_r = 1e-4, 2e-6, 3.0
    for phase in (0.0, np.pi / 2, -np.pi / 2):

        def friction(turn: float, phase: float = phase) -> float:
            return float(
                np.exp(-a * np.sin(turn - phase) / DECAY_LENGTH) * np.sign(v_r + OMEGA * stroke * np.cos(turn))
            )

        turn = np.arccos(-v_r / (OMEGA * stroke))
        by_hand = quad(friction, -np.pi, np.pi, points=[-turn, turn])[0] / (2 * np.pi)
        computed = ratio(sliding_speed=v_r, in_plane_amplitude=stroke, normal_amplitude=a, phase=phase)
        assert computed == approx(by_hand, abs=3e-3)


def test_points_broadcast_beyond_a_block() -> None:
    speeds = np.linspace(0.01, 0.3, 700)
    forces = dahl_under_vibration(
        CONTACT,
        separation=AT_REST,
        friction_coefficient=[[0.3], [0.6]],
        sliding_speed=speeds,
        frequency=FREQUENCY,
        in_plane_amplitude=1e-6,
        steps=32,
    )
    assert forces.shape == (2, 700)
    assert forces[0, 600] / (MU * LOAD) == approx(
        ratio(sliding_speed=float(speeds[600]), in_plane_amplitude=1e-6, steps=32), rel=1e-12
    )


def test_invalid_vibration_arguments_are_refused() -> None:
    with raises(OutsideRange, match=r"normal_amplitude must be smaller than the separation"):
        ratio(sliding_speed=0.02, normal_amplitude=20e-6)
    with raises(InvalidInput, match=r"sliding_speed must be positive, got 0\.0 m/s"):
        ratio(sliding_speed=0.0)
    with raises(InvalidInput, match=r"steps must be at least 1, got 0"):
        ratio(sliding_speed=0.02, steps=0)
