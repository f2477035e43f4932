"""Dahl and LuGre within the plane: Coulomb's closed forms, time integration, symmetries, and the work of friction."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from pytest import approx
from scipy.integrate import solve_ivp
from scipy.special import ellipk
from tests.models.friction.laws.test_dahl_under_vibration import AT_REST, CONTACT, FREQUENCY, LOAD, MU, OMEGA
from tests.models.friction.laws.test_lugre_under_vibration import LAW, load_ratio, sine

from sonolube.models.contact import ContactMotion, cube_tangential_stiffness, normal_force
from sonolube.models.friction import (
    Coulomb,
    LuGreFriction,
    dahl_under_vibration,
    lugre_under_vibration,
    oblique_vibration_ratio,
    parallel_vibration_ratio,
)
from sonolube.models.friction.laws.steady_period_kernel import steady_period_mean_force

EVEN = replace(LAW, static_friction_force=LAW.coulomb_friction_force, viscous_coefficient=0.0, bristle_damping=0.0)
"""LuGre bristles without Stribeck effect and viscous friction, which are Dahl's."""


def dahl(**arguments: float) -> float:
    """Friction ratio by Dahl's law, of the static one."""
    given: dict[str, Any] = {"separation": AT_REST, "friction_coefficient": MU, "frequency": FREQUENCY} | arguments
    return float(dahl_under_vibration(CONTACT, **given)) / (MU * LOAD)


def planar(along: complex = 0.0, across: complex = 0.0, *, normal: float = 0.0) -> ContactMotion:
    """Motion with complex amplitudes within the plane, in m, and an amplitude along the normal."""
    still = sine(normal)
    phases = np.exp(2j * np.pi * np.arange(still.displacement.size) / still.displacement.size)
    return replace(still, along=(along * phases).real, across=(across * phases).real)


@pytest.mark.parametrize("velocity_ratio", [0.02, 0.2, 0.9, 3.0])
def test_a_stiff_contact_across_has_the_complete_elliptic_integral(velocity_ratio: float) -> None:
    stroke = 1e-4  # against a deformation of 2 nm
    m = 1 / (1 + velocity_ratio**2)
    expected = 2 / np.pi * np.sqrt(1 - m) * ellipk(m)
    speed = velocity_ratio * OMEGA * stroke
    assert dahl(sliding_speed=speed, transverse_amplitude=stroke) == approx(expected, abs=3e-4)
    stiff = replace(EVEN, bristle_stiffness=1e4 / stroke)
    found = lugre_under_vibration(stiff, planar(across=stroke), sliding_speed=speed)
    assert found == approx(expected, abs=3e-4)


@pytest.mark.parametrize("angle", [0.3, 1.0, 2.0])
@pytest.mark.parametrize("velocity_ratio", [0.1, 0.6, 1.5])
def test_a_stiff_contact_at_an_angle_has_the_closed_form_of_coulomb(angle: float, velocity_ratio: float) -> None:
    stroke = 1e-4
    speed = velocity_ratio * OMEGA * stroke
    expected = oblique_vibration_ratio(
        sliding_speed=speed, vibration_velocity=OMEGA * stroke, vibration_direction=angle
    )
    amplitudes = {"in_plane_amplitude": stroke * np.cos(angle), "transverse_amplitude": stroke * np.sin(angle)}
    if np.cos(angle) < 0:  # half a turn of the other component
        amplitudes["in_plane_amplitude"] *= -1
    in_step = -np.pi / 2 + (np.pi if np.cos(angle) < 0 else 0)
    found = dahl(sliding_speed=speed, **amplitudes, phase=np.pi / 2, transverse_phase=in_step)
    assert found == approx(float(expected), abs=3e-4)


def test_an_ellipse_on_a_stiff_contact_has_the_ratio_of_the_coulomb_model() -> None:
    stroke = 1e-4
    for speed in (1.0, 8.0, 20.0):
        for lag in (0.4, np.pi / 2, 2.5):
            moved = planar(along=stroke, across=0.6 * stroke * np.exp(-1j * lag))
            rigid = float(Coulomb().ratio(CONTACT, moved, sliding_speed=speed))
            stiff = replace(EVEN, bristle_stiffness=1e5 / stroke)
            assert lugre_under_vibration(stiff, moved, sliding_speed=speed) == approx(rigid, abs=1e-3)
            by_dahl = dahl(
                sliding_speed=speed,
                in_plane_amplitude=stroke,
                transverse_amplitude=0.6 * stroke,
                transverse_phase=lag - np.pi / 2,
            )
            assert by_dahl == approx(rigid, abs=1e-3)


def test_along_alone_is_the_limit_of_little_across() -> None:
    for stroke in (1e-9, 1e-7):
        along = dahl(sliding_speed=0.01, in_plane_amplitude=stroke)
        assert dahl(sliding_speed=0.01, in_plane_amplitude=stroke, transverse_amplitude=1e-9 * stroke) == approx(
            along, abs=1e-4
        )
    only, both = planar(along=1e-6), planar(along=1e-6, across=1e-12)
    speeds = [0.02, 0.1]
    assert lugre_under_vibration(LAW, both, sliding_speed=speeds) == approx(
        lugre_under_vibration(LAW, only, sliding_speed=speeds), abs=2e-4
    )


def test_the_stiff_limit_along_is_the_arcsine() -> None:
    stiff = replace(EVEN, bristle_stiffness=1e10)
    for velocity_ratio in (0.1, 0.5, 1.2):
        peak = OMEGA * 1e-6
        speed = velocity_ratio * peak
        found = lugre_under_vibration(stiff, planar(along=1e-6, across=0.0), sliding_speed=speed)
        expected = parallel_vibration_ratio(sliding_speed=speed, vibration_velocity=peak)
        assert found == approx(expected, abs=1e-3)


def test_a_compliant_contact_keeps_the_friction_that_vibration_across_leaves_a_stiff_one_without() -> None:
    # a deformation far above the stroke stays what the mean path makes it: F/F_c = v_r/mean(|v|)
    speed, stroke = 0.01, 1e-13
    phases = np.linspace(0, 2 * np.pi, 200_001)
    mean_path = np.mean(np.hypot(speed, OMEGA * stroke * np.cos(phases))[:-1])
    assert dahl(sliding_speed=speed, transverse_amplitude=stroke) == approx(speed / mean_path, rel=1e-4)
    soft = replace(EVEN, bristle_stiffness=1e2)
    large = 1e-6
    mean_path = np.mean(np.hypot(speed, OMEGA * large * np.cos(phases))[:-1])
    found = lugre_under_vibration(soft, planar(across=large), sliding_speed=speed)
    assert found == approx(speed / mean_path, rel=1e-3)


@pytest.mark.parametrize(
    ("along", "across", "normal", "lag", "speed"),
    [(0.0, 20e-9, 0.0, 0.0, 1e-3), (15e-9, 20e-9, 0.0, 0.7, 1e-3), (5e-9, 10e-9, 1e-6, -1.0, 1e-3)],
)
def test_dahl_within_the_plane_follows_the_integrated_differential_equation(
    along: float, across: float, normal: float, lag: float, speed: float
) -> None:
    phase = 0.4

    def rate(turn: float, state: np.ndarray) -> list[float]:
        gap = AT_REST + normal * np.sin(turn - phase)
        k, limit = cube_tangential_stiffness(CONTACT, separation=gap), MU * normal_force(CONTACT, separation=gap)
        v = np.array([speed / OMEGA + along * np.cos(turn), across * np.cos(turn - phase - lag)])
        return [*(v - np.hypot(*v) * k / limit * state[:2]), float(k * state[0])]

    state = np.zeros(3)
    for _ in range(12):
        period = solve_ivp(rate, (0, 2 * np.pi), [*state[:2], 0.0], rtol=1e-8, atol=1e-16, max_step=0.05)
        state = period.y[:, -1]
    found = dahl(
        sliding_speed=speed,
        in_plane_amplitude=along,
        normal_amplitude=normal,
        phase=phase,
        transverse_amplitude=across,
        transverse_phase=lag,
    )
    assert found == approx(state[2] / (2 * np.pi) / (MU * LOAD), rel=1e-4)


def _lugre_steady(
    law: LuGreFriction, along: float, across: float, lag: float, normal: float, speed: float
) -> tuple[float, float]:
    """Mean force along the sliding and mean power of friction, by a long time integration."""

    def rates(time: float, state: np.ndarray) -> list[float]:
        theta = OMEGA * time
        v = np.array([speed - along * OMEGA * np.sin(theta), -across * OMEGA * np.sin(theta - lag)])
        size = float(np.hypot(*v))
        rise = law.static_friction_force - law.coulomb_friction_force
        curve = law.coulomb_friction_force + rise * np.exp(-((size / law.stribeck_velocity) ** 2))
        rate = v - size * state[:2] * law.bristle_stiffness / (curve * float(load_ratio(normal, np.array(theta))))
        force = law.bristle_stiffness * state[:2] + law.bristle_damping * rate + law.viscous_coefficient * v
        return [*rate, force[0], force @ v]

    ends = np.array([29, 30]) / FREQUENCY
    found = solve_ivp(
        rates, (0, ends[1]), np.zeros(4), method="LSODA", t_eval=ends, rtol=1e-9, atol=1e-15, max_step=0.005 / FREQUENCY
    ).y
    mean, power = np.diff(found[2:], axis=1)[:, 0] * FREQUENCY
    return float(mean), float(power)


@pytest.mark.parametrize(
    ("along", "across", "lag", "normal", "speed"),
    [(0.0, 1e-6, 0.0, 0.0, 0.05), (0.6e-6, 1e-6, 1.0, 0.0, 0.1), (0.3e-6, 0.8e-6, -2.0, 1.5e-6, 0.05)],
)
def test_lugre_within_the_plane_is_that_of_a_long_time_integration_and_dissipates(
    along: float, across: float, lag: float, normal: float, speed: float
) -> None:
    mean, power = _lugre_steady(LAW, along, across, lag, normal, speed)
    steady = 1.2 + 0.6 * np.exp(-((speed / 0.1) ** 2)) + 0.5 * speed
    moved = planar(along=along, across=across * np.exp(-1j * lag), normal=normal)
    assert lugre_under_vibration(LAW, moved, sliding_speed=speed) == approx(mean / steady, abs=5e-4)
    assert power > mean * speed > 0  # what exceeds the work of the sliding, the drive of the vibration supplies


def test_without_bristle_damping_the_work_is_that_of_the_deformed_bristles_alone() -> None:
    # the work over a period is sigma_0 |v| z^2/g, which no motion makes negative
    law = replace(LAW, bristle_damping=0.0, viscous_coefficient=0.0)
    for along, across, lag in ((1e-6, 0.0, 0.0), (0.0, 1e-6, 0.0), (0.5e-6, 0.5e-6, np.pi / 2)):
        assert _lugre_steady(law, along, across, lag, 2e-6, 0.02)[1] > 0


@pytest.mark.parametrize("lag", [0.3, 1.2])
def test_friction_is_the_same_on_both_sides_of_the_sliding(lag: float) -> None:
    one, other = (planar(along=0.5e-6, across=sign * 1e-6 * np.exp(-1j * lag), normal=1e-6) for sign in (1, -1))
    assert lugre_under_vibration(LAW, one, sliding_speed=0.05) == approx(
        float(lugre_under_vibration(LAW, other, sliding_speed=0.05)), rel=1e-9
    )


def test_a_turned_plane_turns_the_force_of_dahl() -> None:
    # a path that is turned with the axes: the force turns with it, so that both components give its size
    turn = 0.7
    k, limit = 1e6, 1.0
    phases = np.linspace(0, 2 * np.pi, 4001)
    slides = np.diff([3e-7 * phases + 1e-6 * np.sin(phases), 0.5e-6 * np.cos(2 * phases)], axis=1)
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])

    def force(path: np.ndarray) -> np.ndarray:
        row = np.ones((1, path.shape[1]))
        paths = np.hypot(*path)[np.newaxis]
        means = [steady_period_mean_force(k * row, limit * row, each[np.newaxis], paths, row) for each in path]
        return np.array(means)[:, 0]

    assert force(rotation @ slides) == approx(rotation @ force(slides), rel=1e-9)


def test_without_vibration_nothing_changes() -> None:
    assert dahl(sliding_speed=0.02, transverse_amplitude=0.0) == approx(1.0, rel=1e-12)
    assert lugre_under_vibration(LAW, planar(), sliding_speed=[0.01, 0.3]) == approx([1.0, 1.0])
