"""Friction force from the motor current, by hand and against Monte Carlo."""

import numpy as np
import xarray as xr
from pytest import approx

from sonolube.measurement.friction.rotation import MotorCalibration, friction_from_motor_current
from sonolube.measurement.friction_analysis import analyse_motor_current

RNG = np.random.default_rng(7)
RATE = 400.0  # Hz, D 2.3.2


def seconds(duration: float, rate: float = RATE) -> np.ndarray:
    return np.arange(round(duration * rate)) / rate


def recording(time: np.ndarray, **channels: np.ndarray) -> xr.Dataset:
    return xr.Dataset({name: ("time", values) for name, values in channels.items()}, coords={"time": time})


MOTOR = MotorCalibration(
    torque_constant=0.4,
    idle_current=0.55,
    groove_diameter=60e-3,
    torque_constant_uncertainty=0.02,
    idle_current_uncertainty=0.01,
)


def test_the_motor_torque_balances_the_friction_torque() -> None:
    # 12 N at 30 mm are 0.36 N m, which at 0.4 N m/A take 0.9 A beyond the no-load current
    force, _ = friction_from_motor_current(MOTOR, motor_current=[1.45, 0.55])
    assert force[0] == approx(12.0)
    assert force[1] == 0.0


def test_the_uncertainty_from_the_motor_current_agrees_with_monte_carlo() -> None:
    n = 200_000
    torque_constant, no_load = RNG.normal(0.4, 0.02, n), RNG.normal(0.55, 0.01, n)
    force = torque_constant * (RNG.normal(1.45, 0.03, n) - no_load) / 30e-3
    _, uncertainty = friction_from_motor_current(MOTOR, motor_current=1.45, motor_current_uncertainty=0.03)
    assert uncertainty == approx(np.std(force), rel=0.01)


def test_a_recorded_motor_current_gives_friction_in_windows() -> None:
    t = seconds(10)
    trace = analyse_motor_current(recording(t, motor_current=np.where(t < 4, 1.45, 1.0)), motor=MOTOR)
    assert trace.friction_force == approx([12, 12, 6, 6, 6])
    assert trace.friction_force_uncertainty[0] == approx(np.hypot(0.4 * 0.01, 0.02 * 0.9) / 30e-3)
