"""The LuGre law against its Stribeck curve, an integrator and the limit of Dahl."""

import numpy as np
import pytest
from hypothesis import given, strategies as st
from pytest import approx, raises
from scipy.integrate import solve_ivp

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.models.friction import LuGreFriction, lugre_friction_history, lugre_steady_friction

# the values of Canudas de Wit et al. (1995), table I
S_0, S_1, S_2, F_C, F_S, V_S = 1e5, np.sqrt(1e5), 0.4, 1.0, 1.5, 0.001
LAW = LuGreFriction(
    coulomb_friction_force=F_C,
    static_friction_force=F_S,
    stribeck_velocity=V_S,
    bristle_stiffness=S_0,
    bristle_damping=S_1,
    viscous_coefficient=S_2,
)


@pytest.mark.parametrize(
    ("velocity", "force"),
    [
        (1e-9, 1.5),  # static
        (0.001, 1.0 + 0.5 / np.e + 0.4e-3),  # at the Stribeck velocity
        (0.1, 1.0 + 0.04),  # Coulomb and viscous
        (-0.001, -1.0 - 0.5 / np.e - 0.4e-3),
        (-0.1, -1.04),
        (0.0, 0.0),
    ],
)
def test_steady_friction_is_that_of_the_stribeck_curve(velocity: float, force: float) -> None:
    assert lugre_steady_friction(LAW, relative_velocity=velocity) == approx(force, rel=1e-6)


@pytest.mark.parametrize("velocity", [2e-4, 0.001, 0.05, -2e-4, -0.05])
def test_any_start_converges_to_steady_friction_in_both_directions(velocity: float) -> None:
    t = np.linspace(0, 1e-3 / abs(velocity), 2000)
    history = lugre_friction_history(
        LAW, time=t, relative_velocity=np.full((3, 2000), velocity), bristle_deflection=[-1e-5, 0, 1.5e-5]
    )
    expected = float(lugre_steady_friction(LAW, relative_velocity=velocity))
    assert history.friction_force[:, -1] == approx(np.full(3, expected), rel=1e-9)


def test_a_sinusoidal_motion_follows_the_integrated_differential_equation() -> None:
    def g(v: Floats) -> Floats:
        limit: Floats = (F_C + (F_S - F_C) * np.exp(-((v / V_S) ** 2))) / S_0
        return limit

    def velocity(t: Floats) -> Floats:
        v: Floats = 3e-3 * np.sin(2 * np.pi * t) + 5e-4
        return v

    def rate(t: Floats, z: Floats) -> Floats:
        v = velocity(t)
        return v - np.abs(v) / g(v) * z

    t = np.linspace(0, 1.5, 30001)
    v = velocity(t)
    z = solve_ivp(rate, (0, 1.5), [0.0], method="LSODA", t_eval=t, rtol=1e-10, atol=1e-16, max_step=1e-3).y[0]
    history = lugre_friction_history(LAW, time=t, relative_velocity=v)
    assert history.bristle_deflection == approx(z, abs=1e-6 * F_S / S_0)
    assert history.friction_force == approx(S_0 * z + S_1 * rate(t, z) + S_2 * v, abs=1e-5)


def test_halving_the_step_quarters_the_error() -> None:
    def end(steps: int) -> float:
        t = np.linspace(0, 0.3, steps + 1)
        v = 3e-3 * np.sin(2 * np.pi * t)
        return float(lugre_friction_history(LAW, time=t, relative_velocity=v).bristle_deflection[-1])

    exact = end(200_000)
    assert (end(1000) - exact) / (end(2000) - exact) == approx(4, rel=0.02)


@given(velocities=st.lists(st.floats(-1, 1), min_size=2, max_size=40), start=st.floats(-1, 1), step=st.floats(1e-7, 10))
def test_deflections_stay_within_the_static_force_over_the_stiffness(
    velocities: list[float], start: float, step: float
) -> None:
    t = np.arange(len(velocities)) * step
    history = lugre_friction_history(LAW, time=t, relative_velocity=velocities, bristle_deflection=start * F_S / S_0)
    assert np.all(np.abs(history.bristle_deflection) <= F_S / S_0 * (1 + 1e-12))


def test_without_stribeck_effect_damping_and_viscous_friction_the_law_is_dahls() -> None:
    law = LuGreFriction(
        coulomb_friction_force=F_C,
        static_friction_force=F_C,
        stribeck_velocity=V_S,
        bristle_stiffness=S_0,
        bristle_damping=0.0,
        viscous_coefficient=0.0,
    )
    t = np.linspace(0, 1e-2, 100)
    history = lugre_friction_history(law, time=t, relative_velocity=np.full(100, 4e-3))
    assert history.friction_force == approx(F_C * (1 - np.exp(-S_0 * 4e-3 * t / F_C)), rel=1e-9)


def test_a_static_force_below_the_coulomb_force_is_refused() -> None:
    with raises(
        InvalidInput, match=r"static_friction_force must be at least coulomb_friction_force, 1\.0 N, got 0\.5 N"
    ):
        LuGreFriction(
            coulomb_friction_force=1.0,
            static_friction_force=0.5,
            stribeck_velocity=V_S,
            bristle_stiffness=S_0,
            bristle_damping=S_1,
            viscous_coefficient=S_2,
        )
