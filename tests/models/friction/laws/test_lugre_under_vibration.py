"""The LuGre law under vibration against a long time integration, and its limits."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx, raises
from scipy.integrate import solve_ivp
from scipy.special import i0

from sonolube.errors import InvalidInput
from sonolube.models.contact import ContactMotion
from sonolube.models.friction import LuGreFriction, lugre_under_vibration, parallel_vibration_ratio

LOAD, FREQUENCY, LENGTH = 3.0, 22e3, 2e-6
OMEGA = 2 * np.pi * FREQUENCY
LAW = LuGreFriction(
    coulomb_friction_force=1.2,
    static_friction_force=1.8,
    stribeck_velocity=0.1,
    bristle_stiffness=1e6,
    bristle_damping=2.0,
    viscous_coefficient=0.5,
)


def load_ratio(amplitude: float, phases: np.ndarray) -> np.ndarray:
    """Return the normal force of exponential heights over the load, about the load-balanced mean gap."""
    return np.asarray(np.exp(-amplitude / LENGTH * np.cos(phases)) / i0(amplitude / LENGTH))


def sine(amplitude: float) -> ContactMotion:
    phases = 2 * np.pi * np.arange(256) / 256
    force = LOAD * load_ratio(amplitude, phases)
    return ContactMotion(
        displacement=amplitude * np.cos(phases), normal_force=force, frequency=FREQUENCY, normal_load=LOAD
    )


@pytest.mark.parametrize(("fraction", "phase", "speed"), [(0.0, 0.0, 0.03), (0.5, -1.0, 0.2)])
def test_the_mean_of_the_steady_period_is_that_of_a_long_time_integration(
    fraction: float, phase: float, speed: float
) -> None:
    a = 1.5e-6

    def rates(time: float, state: np.ndarray) -> list[float]:
        theta = OMEGA * time
        v = speed - fraction * a * OMEGA * np.sin(theta - phase)
        curve = LAW.coulomb_friction_force + 0.6 * np.exp(-((v / 0.1) ** 2))
        g = curve * float(load_ratio(a, np.array(theta))) / LAW.bristle_stiffness
        rate = v - abs(v) * state[0] / g
        return [rate, LAW.bristle_stiffness * state[0] + LAW.bristle_damping * rate + LAW.viscous_coefficient * v]

    periods = 60
    ends = np.array([periods - 1, periods]) / FREQUENCY
    integrated = solve_ivp(
        rates, (0, ends[1]), [0.0, 0.0], t_eval=ends, rtol=1e-9, atol=1e-15, max_step=0.005 / FREQUENCY
    ).y
    mean = np.diff(integrated[1])[0] * FREQUENCY
    steady = 1.2 + 0.6 * np.exp(-((speed / 0.1) ** 2)) + 0.5 * speed
    ratio = lugre_under_vibration(LAW, sine(a), sliding_speed=speed, in_plane_fraction=fraction, in_plane_phase=phase)
    assert ratio == approx(mean / steady, abs=5e-4)


@pytest.mark.parametrize(
    ("amplitude", "fraction", "phase", "speed"), [(1.5e-6, 0.5, np.pi / 2, 0.2), (3e-6, 0.3, -np.pi / 2, 0.3)]
)
def test_in_plane_motion_out_of_step_with_the_load_is_averaged_to_second_order_in_the_phase_step(
    amplitude: float, fraction: float, phase: float, speed: float
) -> None:
    # a load taken one phase early or late is wrong by 1e-4 here, less than coarser comparisons show
    def rates(time: float, state: np.ndarray) -> list[float]:
        theta = OMEGA * time
        v = speed - fraction * amplitude * OMEGA * np.sin(theta - phase)
        curve = LAW.coulomb_friction_force + 0.6 * np.exp(-((v / 0.1) ** 2))
        rate = v - abs(v) * state[0] * LAW.bristle_stiffness / (curve * float(load_ratio(amplitude, np.array(theta))))
        return [rate, LAW.bristle_stiffness * state[0] + LAW.viscous_coefficient * v]

    ends = np.array([7, 8]) / FREQUENCY  # sliding by nine micrometres a period, bristles of one forget the start
    integrated = solve_ivp(
        rates, (0, ends[1]), [0.0, 0.0], method="LSODA", t_eval=ends, rtol=1e-10, atol=1e-17, max_step=0.002 / FREQUENCY
    ).y
    mean = np.diff(integrated[1])[0] * FREQUENCY
    steady = 1.2 + 0.6 * np.exp(-((speed / 0.1) ** 2)) + 0.5 * speed
    ratio = lugre_under_vibration(
        LAW, sine(amplitude), sliding_speed=speed, in_plane_fraction=fraction, in_plane_phase=phase
    )
    assert ratio == approx(mean / steady, abs=2e-6)


@pytest.mark.parametrize("amplitude", [0.5e-6, 2e-6, 4e-6])
def test_slow_sliding_has_the_harmonic_mean_of_the_load(amplitude: float) -> None:
    # compliant bristles average 1/F_n, I0(a/l)/F_N times I0(a/l)
    slow = replace(LAW, viscous_coefficient=0.0, bristle_stiffness=1e4)
    ratio = lugre_under_vibration(slow, sine(amplitude), sliding_speed=1e-4)
    assert ratio == approx(i0(amplitude / LENGTH) ** -2, abs=1e-3)


@pytest.mark.parametrize("speed", [0.01, 0.05, 0.15])
def test_stiff_bristles_without_stribeck_effect_at_constant_load_have_the_ratio_of_coulomb_friction(
    speed: float,
) -> None:
    stiff = replace(LAW, static_friction_force=1.2, viscous_coefficient=0.0, bristle_stiffness=1e9)
    even = replace(sine(1e-6), normal_force=np.full(256, LOAD))
    ratio = lugre_under_vibration(stiff, even, sliding_speed=speed, in_plane_fraction=1.0)
    assert ratio == approx(parallel_vibration_ratio(sliding_speed=speed, vibration_velocity=OMEGA * 1e-6), abs=2e-3)


def test_without_vibration_nothing_changes() -> None:
    assert lugre_under_vibration(LAW, sine(0.0), sliding_speed=[0.01, 0.3]) == approx([1.0, 1.0])


def test_a_motion_along_of_its_own_is_rigid_friction_for_stiff_bristles() -> None:
    even = replace(LAW, static_friction_force=LAW.coulomb_friction_force, viscous_coefficient=0.0)
    stiff = replace(even, bristle_stiffness=1e12)
    still = sine(0.0)
    phases = 2 * np.pi * np.arange(still.displacement.size) / still.displacement.size
    along = replace(still, along=1e-6 * np.cos(phases))
    peak = 2 * np.pi * along.frequency * 1e-6
    speeds = np.array([0.2, 0.7, 1.5]) * peak
    expected = parallel_vibration_ratio(sliding_speed=speeds, vibration_velocity=peak)
    assert lugre_under_vibration(stiff, along, sliding_speed=speeds) == approx(
        expected, abs=5e-3
    )  # of a jump within a step


def test_fast_in_plane_vibration_reduces_friction_further_on_a_falling_stribeck_curve() -> None:
    flat = replace(LAW, static_friction_force=1.2)
    for fraction in (0.2, 0.5):
        falling, constant = (
            lugre_under_vibration(law, sine(1e-6), sliding_speed=0.02, in_plane_fraction=fraction)
            for law in (LAW, flat)
        )
        assert falling < constant


def test_a_negative_fraction_is_refused_by_name() -> None:
    with raises(InvalidInput, match=r"in_plane_fraction must not be negative, got -0\.1"):
        lugre_under_vibration(LAW, sine(1e-6), sliding_speed=0.1, in_plane_fraction=-0.1)
