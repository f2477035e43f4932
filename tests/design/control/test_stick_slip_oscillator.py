"""Stick-slip of a mass on a belt against closed forms, and its suppression by vibration."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.design.control import (
    MassOnBelt,
    StickSlipMotion,
    kinetic_friction,
    mass_on_belt,
    steady_sliding_damping,
    stick_slip_motion,
)
from sonolube.errors import InvalidInput
from sonolube.rig import operating_points, read_rig

RIG = read_rig(Path(__file__).parents[3] / "examples" / "rigs" / "tribometer.toml")
COULOMB = MassOnBelt(
    holder_mass=0.05,
    holder_stiffness=2e4,
    holder_damping=0.0,
    sliding_speed=0.02,
    coulomb_friction_force=1.0,
    static_friction_force=1.5,
    stribeck_velocity=1e-9,
    relative_velocity=np.array([0.0, 1.0]),
    friction_ratio=np.ones(2),
)


def test_undamped_stick_slip_has_the_amplitude_and_period_of_its_closed_form() -> None:
    # Slip is a half sine about F_k/k from (F_s/k, v_b); stick carries the spring back at v_b.
    k, drop, v = 2e4, 0.5, 0.02
    omega = np.sqrt(k / 0.05)
    motion = stick_slip_motion(COULOMB, duration=0.5, steps_per_period=8000)
    assert motion.stick_slip_amplitude == approx(2 * np.hypot(drop, k * v / omega), rel=2e-3)
    period = 2 * drop / (k * v) + 2 / omega * (np.pi - np.arctan(drop * omega / (k * v)))
    loose = motion.time[1:][motion.sticking[:-1] & ~motion.sticking[1:]]
    assert np.diff(loose[5:]).mean() == approx(period, rel=2e-3)


def test_the_slope_of_rising_friction_is_a_viscous_damping() -> None:
    # F = F_c (a + b v) is a damper of F_c b: free decay at rate F_c b/(2 m).
    rising = replace(
        COULOMB, static_friction_force=1.0, relative_velocity=np.array([0.0, 1.0]), friction_ratio=np.array([0.2, 4.2])
    )
    assert steady_sliding_damping(rising) == approx(4.0)
    motion = stick_slip_motion(rising, duration=30 * rising.period)
    first, later = (
        np.ptp(motion.friction_force[(motion.time > start * rising.period) & (motion.time < end * rising.period)])
        for start, end in ((5, 6), (15, 16))
    )
    assert later / first == approx(np.exp(-4.0 / (2 * 0.05) * 10 * rising.period), rel=0.02)


def test_stribeck_friction_falls_from_static_to_coulomb_friction() -> None:
    falling = replace(COULOMB, stribeck_velocity=0.01)
    assert kinetic_friction(falling, relative_velocity=np.array([0.0, 0.01, 1.0])) == approx([1.5, 1 + 0.5 / np.e, 1.0])
    assert steady_sliding_damping(falling) < 0


@pytest.mark.parametrize(("volts", "steady"), [(0.0, False), (20.0, True)])
def test_vibration_suppresses_the_limit_cycle(volts: float, steady: bool) -> None:
    oscillator = mass_on_belt(
        RIG,
        holder_mass=0.05,
        holder_stiffness=2e4,
        holder_damping=0.6,
        static_friction_force=1.33,
        stribeck_velocity=0.02,
        level=volts,
    )
    motion = stick_slip_motion(oscillator, duration=1.0)
    assert (steady_sliding_damping(oscillator) > 0) == steady
    assert (motion.stick_slip_amplitude < 1e-6) == steady
    assert (motion.stick_fraction == 0) == steady


def test_static_friction_below_that_of_sliding_is_refused() -> None:
    with raises(InvalidInput, match="static_friction_force must not be below"):
        replace(COULOMB, static_friction_force=0.5)


def test_slip_begins_against_the_belt_and_follows_the_swing_about_sliding_friction() -> None:
    # from x_0 at v_b: x = F_c/k + (x_0 - F_c/k) cos(w t) + v_b/w sin(w t)
    motion = stick_slip_motion(COULOMB, duration=0.012, steps_per_period=100)
    loose = int(np.argmin(motion.sticking))
    omega, middle = np.sqrt(2e4 / 0.05), 1.0 / 2e4
    since, start = motion.time[loose : loose + 60] - motion.time[loose], motion.displacement[loose]
    swing = middle + (start - middle) * np.cos(omega * since) + 0.02 / omega * np.sin(omega * since)
    assert start == approx(1.5 / 2e4, rel=0.03)
    assert motion.displacement[loose : loose + 60] == approx(swing, abs=1e-6)
    assert not motion.sticking[loose : loose + 60].any()
    assert motion.time[1] == approx(2 * np.pi / omega / 100)
    # until then the belt carries it at its speed
    assert motion.displacement[:loose] == approx(0.02 * motion.time[:loose])


def test_damping_adds_to_the_force_of_the_holder_from_the_start_and_lets_slip_begin_earlier() -> None:
    damped = replace(COULOMB, holder_damping=20.0)
    motion = stick_slip_motion(damped, duration=0.01, steps_per_period=4000)
    assert motion.friction_force[0] == approx(20.0 * 0.02)
    loose = int(np.argmin(motion.sticking))
    assert 2e4 * motion.displacement[loose] + 20.0 * 0.02 == approx(1.5, rel=2e-3)


def test_a_holder_whose_damping_alone_exceeds_static_friction_never_sticks() -> None:
    # c v_b = 2 N of 1.5 N: the mass falls behind at once, and slides with k x + c v = F_c in the end
    motion = stick_slip_motion(replace(COULOMB, holder_damping=100.0), duration=0.1, steps_per_period=4000)
    assert not motion.sticking[1:].any()
    assert motion.stick_fraction == approx(0.0)
    assert motion.friction_force[-1] == approx(1.0, rel=1e-6)


def test_amplitude_and_stick_fraction_are_those_of_the_last_quarter() -> None:
    force = np.array([9.0, 9.0, 9.0, 9.0, 9.0, 9.0, 1.0, 4.0])
    sticking = np.array([True, True, True, True, True, True, True, False])
    motion = StickSlipMotion(time=np.arange(8.0), displacement=np.zeros(8), friction_force=force, sticking=sticking)
    assert motion.stick_slip_amplitude == approx(3.0)
    assert motion.stick_fraction == approx(0.5)


@pytest.mark.parametrize(
    ("velocity", "ratio"),
    [([0.0, 1.0, 1.0], [1.0, 1.0, 1.0]), ([0.0, 2.0, 1.0], [1.0, 1.0, 1.0]), ([0.1, 1.0], [1.0, 1.0]),
     ([0.0, 1.0], [1.0, 1.0, 1.0]), ([[0.0, 1.0]], [[1.0, 1.0]])],
)  # fmt: skip
def test_velocities_that_do_not_rise_from_zero_with_a_ratio_each_are_refused(
    velocity: list[float], ratio: list[float]
) -> None:
    with raises(InvalidInput, match="relative_velocity must increase from zero"):
        replace(COULOMB, relative_velocity=np.array(velocity), friction_ratio=np.array(ratio))


def test_steps_and_duration_have_their_limits() -> None:
    for steps in (20, 1_000_000):
        assert stick_slip_motion(COULOMB, duration=1e-6, steps_per_period=steps).time.size > 1
    for steps in (19, 1_000_001):
        with raises(InvalidInput, match="steps_per_period"):
            stick_slip_motion(COULOMB, duration=1e-6, steps_per_period=steps)
    with raises(InvalidInput, match=r"takes .* steps, of 5000000 at most"):
        stick_slip_motion(COULOMB, duration=5e6 * COULOMB.period / 2000)


def test_the_slider_of_a_rig_has_its_friction_and_speeds_up_to_the_fastest_slip() -> None:
    known: dict[str, float] = {
        "holder_mass": 0.05,
        "holder_stiffness": 2e4,
        "holder_damping": 0.6,
        "static_friction_force": 1.33,
        "stribeck_velocity": 0.02,
    }
    still = mass_on_belt(RIG, level=0.0, **known)
    assert still.coulomb_friction_force == approx(RIG.friction_coefficient * RIG.normal_load)
    assert still.sliding_speed == approx(RIG.sliding_speed)
    assert still.friction_ratio == approx(np.ones(33))
    assert still.relative_velocity[0] == 0.0
    assert still.relative_velocity[-1] == approx(2 * RIG.sliding_speed + 1.33 / np.sqrt(2e4 * 0.05))
    vibrated = mass_on_belt(RIG, level=20.0, **known)
    speed = vibrated.relative_velocity[-1]
    assert RIG.drive is not None
    offset = RIG.drive.voltage_offset / (RIG.drive.voltage_peak_to_peak or np.nan) * 20.0
    at_fastest = operating_points(RIG, voltage_peak_to_peak=20.0, voltage_offset=offset, sliding_speed=speed)
    assert vibrated.friction_ratio[-1] == approx(float(at_fastest.friction_ratio), rel=1e-9)
