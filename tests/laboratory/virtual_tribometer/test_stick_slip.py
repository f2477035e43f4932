"""Closed form of stick-slip against the integrated motion of a mass on a belt."""

import numpy as np
import pytest
from pytest import approx

from sonolube.design.control.stick_slip_oscillator import MassOnBelt, StickSlipMotion, stick_slip_motion
from sonolube.laboratory.virtual_tribometer.signals import StickSlip


def closed_form(speed: float, *, damping_ratio: float = 1e-3) -> StickSlip:
    return StickSlip(excess_force=0.3, stiffness=2e4, mass=0.05, damping_ratio=damping_ratio, sliding_speed=speed)


def integrated(speed: float, *, damping_ratio: float) -> StickSlipMotion:
    belt = MassOnBelt(
        holder_mass=0.05,
        holder_stiffness=2e4,
        holder_damping=2 * damping_ratio * np.sqrt(0.05 * 2e4),
        sliding_speed=speed,
        coulomb_friction_force=1.0,
        static_friction_force=1.3,
        stribeck_velocity=1e-5,  # friction falls at once
        relative_velocity=np.array([0.0, 1.0]),
        friction_ratio=np.ones(2),
    )
    return stick_slip_motion(belt, duration=2.0)


@pytest.mark.parametrize("speed", [2e-3, 1e-2, 3e-2])
def test_period_and_range_of_the_force_are_those_of_the_integrated_motion(speed: float) -> None:
    motion, formula = integrated(speed, damping_ratio=1e-3), closed_form(speed)
    late = motion.time > 1.0
    time, sticking = motion.time[late], motion.sticking[late]
    slips = time[1:][sticking[:-1] & ~sticking[1:]]
    assert np.mean(np.diff(slips)) == approx(formula.period, rel=0.02)
    drawn = formula.force(np.linspace(0, formula.period, 20_000))
    assert np.ptp(drawn) == approx(motion.stick_slip_amplitude, rel=0.02)
    assert np.mean(drawn) == approx(0.0, abs=1e-3)


def test_it_ends_at_the_speed_where_the_integrated_motion_no_longer_sticks() -> None:
    highest = closed_form(0.01, damping_ratio=0.02).highest_speed
    assert integrated(0.8 * highest, damping_ratio=0.02).stick_fraction > 0
    assert integrated(1.25 * highest, damping_ratio=0.02).stick_fraction == 0
    assert closed_form(0.99 * highest, damping_ratio=0.02).occurs
    assert not closed_form(1.01 * highest, damping_ratio=0.02).occurs


def test_the_force_rises_no_faster_than_the_spring_is_drawn_while_it_sticks() -> None:
    formula = closed_form(5e-3)
    time = np.linspace(formula.slip_time, formula.period, 1000, endpoint=False)
    assert np.diff(formula.force(time)) / np.diff(time) == approx(2e4 * 5e-3, rel=1e-6)
