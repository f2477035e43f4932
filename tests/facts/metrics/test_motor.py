"""A DC motor at constant voltage: power balance, identification, and friction from its current."""

import numpy as np
from hypothesis import given, strategies as st
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.facts.metrics import (
    DCMotor,
    friction_from_current,
    motor_current_under_friction,
    motor_from_two_operating_points,
    motor_speed,
)

MOTOR = DCMotor(motor_voltage=8.0, torque_constant=0.6, resistance=4.0)


def test_at_half_the_stall_current_the_motor_runs_at_half_its_no_load_speed() -> None:
    free = float(motor_speed(MOTOR, motor_current=0.0))
    assert free == approx(8.0 / 0.6 / (2 * np.pi))
    assert float(motor_speed(MOTOR, motor_current=1.0)) == approx(free / 2)
    assert float(motor_speed(MOTOR, motor_current=2.0)) == approx(0.0)


@given(current=st.floats(0, 2))
def test_electrical_power_is_ohmic_loss_plus_mechanical_power(current: float) -> None:
    turned = 0.6 * current * 2 * np.pi * float(motor_speed(MOTOR, motor_current=current))
    assert 8.0 * current == approx(4.0 * current**2 + turned, abs=1e-12)


def test_two_operating_points_determine_the_motor() -> None:
    currents = np.array([1.4, 0.9])
    found = motor_from_two_operating_points(
        motor_voltage=8.0, motor_current=currents, rotation_speed=motor_speed(MOTOR, motor_current=currents)
    )
    assert (found.torque_constant, found.resistance) == approx((0.6, 4.0))


def test_one_ampere_at_a_torque_constant_of_0_6_is_20_newtons_at_30_millimetres() -> None:
    assert float(
        friction_from_current(
            torque_constant=MOTOR.torque_constant, motor_current=1.2, idle_current=0.2, groove_diameter=0.06
        )
    ) == approx(20.0)


@given(force=st.floats(-3, 20), idle=st.floats(0.5, 1))
def test_motor_current_and_friction_are_inverse_functions(force: float, idle: float) -> None:
    current = motor_current_under_friction(MOTOR, friction_force=force, idle_current=idle, groove_diameter=0.06)
    back = friction_from_current(
        torque_constant=MOTOR.torque_constant, motor_current=current, idle_current=idle, groove_diameter=0.06
    )
    assert float(back) == approx(force, abs=1e-12)


def test_impossible_motors_are_refused_by_name() -> None:
    with raises(InvalidInput, match="motor_current must fall where the speed rises"):
        motor_from_two_operating_points(motor_voltage=8.0, motor_current=[1.0, 1.2], rotation_speed=[0.8, 0.9])
    with raises(InvalidInput, match=r"stall current, 2 A"):
        motor_speed(MOTOR, motor_current=2.1)
    with raises(InvalidInput, match=r"torque_constant must be positive, got 0\.0"):
        DCMotor(motor_voltage=8.0, torque_constant=0.0, resistance=1.0)
