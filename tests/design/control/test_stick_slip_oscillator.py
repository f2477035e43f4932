"""Stick-slip of a mass on a belt against closed forms, and its suppression by vibration."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.design.control import (
    MassOnBelt,
    kinetic_friction,
    mass_on_belt,
    steady_sliding_damping,
    stick_slip_motion,
)
from sonolube.errors import InvalidInput
from sonolube.rig import read_rig

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
