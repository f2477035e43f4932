"""Dahl's law against closed forms, an integrator, and the work of closed loops."""

import numpy as np
from hypothesis import given, strategies as st
from pytest import approx, raises
from scipy.integrate import solve_ivp

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.models.friction import DahlFriction, dahl_friction_history

K, F_C = 2e6, 1.5
LAW = DahlFriction(contact_stiffness=K, coulomb_friction_force=F_C)
DEFORMATION = F_C / K


def test_a_history_at_one_speed_follows_the_closed_form_at_any_step() -> None:
    for samples in (2, 17, 1000):
        t = np.linspace(0, 1e-3, samples)
        history = dahl_friction_history(LAW, time=t, relative_velocity=np.full(samples, 2e-3))
        assert history == approx(F_C * (1 - np.exp(-K * 2e-3 * t / F_C)), rel=1e-9)


def test_a_step_with_a_reversal_is_exact() -> None:
    # from 1 mm/s to -3 mm/s in 4 ms: 0.5 um forward in the first 1 ms, 4.5 um back in the other three
    history = dahl_friction_history(LAW, time=[0, 4e-3], relative_velocity=[1e-3, -3e-3])
    forward = F_C * (1 - np.exp(-K * 0.5e-6 / F_C))
    assert history[-1] == approx(-F_C + (F_C + forward) * np.exp(-K * 4.5e-6 / F_C), rel=1e-12)


@given(velocities=st.lists(st.floats(-1, 1), min_size=2, max_size=40), start=st.floats(-1, 1))
def test_mirrored_motion_gives_mirrored_friction(velocities: list[float], start: float) -> None:
    t, v = np.arange(len(velocities)) * 1e-5, np.array(velocities)
    one = dahl_friction_history(LAW, time=t, relative_velocity=v, deformation=start * DEFORMATION)
    other = dahl_friction_history(LAW, time=t, relative_velocity=-v, deformation=-start * DEFORMATION)
    assert one == approx(-other)


def test_after_a_long_slide_friction_is_coulombs_for_any_start() -> None:
    starts = np.array([-DEFORMATION, 0, DEFORMATION])
    force = dahl_friction_history(LAW, time=[0, 1], relative_velocity=[1.0, 1.0], deformation=starts)
    assert force[:, -1] == approx(np.full(3, F_C))


def test_a_vibrating_contact_follows_the_integrated_differential_equation() -> None:
    omega, v_r, v_1 = 2 * np.pi * 22e3, 0.02, 0.1

    def rate(t: float, force: Floats) -> Floats:
        v = v_r + v_1 * np.cos(omega * t)
        slope: Floats = K * v * (1 - force / F_C * np.sign(v))
        return slope

    t = np.linspace(0, 3 / 22e3, 6001)
    expected = solve_ivp(rate, (0, t[-1]), [0.0], t_eval=t, rtol=1e-9, atol=1e-12, max_step=2e-8).y[0]
    history = dahl_friction_history(LAW, time=t, relative_velocity=v_r + v_1 * np.cos(omega * t))
    assert history == approx(expected, abs=2e-6 * F_C)


@given(amplitude=st.floats(1e-9, 1e-4), cycles=st.integers(1, 4))
def test_a_closed_cycle_dissipates_work(amplitude: float, cycles: int) -> None:
    t = np.linspace(0, cycles, 400 * cycles + 1)
    v = 2 * np.pi * amplitude * np.cos(2 * np.pi * t)
    force = dahl_friction_history(LAW, time=t, relative_velocity=v)
    steady = slice(-401, None)
    work = np.trapezoid(force[steady] * v[steady], t[steady])
    # a long loop approaches Coulomb's rectangle, 4 F_c a; no loop exceeds it
    assert -1e-12 <= work <= 4 * F_C * amplitude * (1 + 1e-4)


def test_a_loop_far_longer_than_the_deformation_dissipates_coulombs_work() -> None:
    a = 1000 * DEFORMATION
    t = np.linspace(0, 2, 40001)
    v = 2 * np.pi * a * np.cos(2 * np.pi * t)
    force = dahl_friction_history(LAW, time=t, relative_velocity=v)
    assert np.trapezoid((force * v)[20000:], t[20000:]) == approx(4 * F_C * a, rel=2e-3)


@given(velocities=st.lists(st.floats(-1, 1), min_size=2, max_size=40), start=st.floats(-1, 1))
def test_friction_never_exceeds_the_coulomb_force(velocities: list[float], start: float) -> None:
    t = np.arange(len(velocities)) * 1e-5
    history = dahl_friction_history(LAW, time=t, relative_velocity=velocities, deformation=start * DEFORMATION)
    assert np.all(np.abs(history) <= F_C * (1 + 1e-12))


def test_many_motions_are_integrated_at_once() -> None:
    t = np.linspace(0, 1e-3, 50)
    speeds = np.array([1e-3, 2e-3, 5e-3])
    together = dahl_friction_history(LAW, time=t, relative_velocity=speeds[:, np.newaxis] * np.ones(50))
    assert together.shape == (3, 50)
    assert together == approx(F_C * (1 - np.exp(-K * speeds[:, np.newaxis] * t / F_C)), rel=1e-9)


def test_times_that_do_not_increase_are_refused() -> None:
    with raises(InvalidInput, match=r"time must increase, got 1\.0 s after 1\.0 s"):
        dahl_friction_history(LAW, time=[0, 1, 1], relative_velocity=[1, 1, 1])
    with raises(InvalidInput, match=r"at least two samples"):
        dahl_friction_history(LAW, time=[0], relative_velocity=[1])


def test_a_motion_and_times_of_different_length_are_refused() -> None:
    with raises(InvalidInput, match=r"one value for each of 3 times along its last axis, got shape \(2,\)"):
        dahl_friction_history(LAW, time=[0, 1, 2], relative_velocity=[1, 1])
    with raises(InvalidInput, match=r"\(2,\) starting values do not match \(3,\) motions"):
        dahl_friction_history(LAW, time=[0, 1], relative_velocity=np.ones((3, 2)), deformation=[0, 0])


def test_a_stiffness_that_is_not_positive_is_refused_by_name() -> None:
    with raises(InvalidInput, match=r"contact_stiffness must be positive, got 0\.0 N/m"):
        DahlFriction(contact_stiffness=0.0, coulomb_friction_force=1.0)
