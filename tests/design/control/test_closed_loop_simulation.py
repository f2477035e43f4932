"""Closed loop in time against its difference equation: feed-forward, integral action, saturation and stability."""

import numpy as np
import pytest
from numpy.typing import NDArray
from pytest import approx
from scipy.signal import lfilter
from tests.same import same

from sonolube.design.control import (
    Disturbance,
    FrictionCharacteristic,
    FrictionLoop,
    Process,
    VibrationMode,
    simulate_closed_loop,
    stability_margins,
    tuned_controller,
)

INTERVAL = 2e-4
LINE = FrictionCharacteristic(level=np.array([0.0, 50.0]), friction_force=np.array([2.0, 0.5]))
MODE = VibrationMode(
    natural_frequency=22e3, damping_ratio=0.02, motional_conductance=0.4, parallel_capacitance=2e-7, frequency=22e3
)
PROCESS = Process(time_constant=MODE.time_constant, dead_time=1e-3, sample_interval=INTERVAL)


def loop(*, feed_forward: bool, closed_loop_time: float | None = None) -> FrictionLoop:
    controller = tuned_controller(
        LINE, PROCESS, level_maximum=50.0, feed_forward=feed_forward, closed_loop_time=closed_loop_time
    )
    return FrictionLoop(plant=LINE, mode=MODE, controller=controller, tracker=None, level_maximum=50.0)


def test_the_simulated_loop_obeys_its_difference_equation() -> None:
    # Without feed-forward, by a linear characteristic at resonance, friction is C G/(1 + C G z^-d) of the set-point.
    control_loop = loop(feed_forward=False, closed_loop_time=3e-3)
    gains, p, d = control_loop.controller.gains, PROCESS.pole, PROCESS.dead_time_samples
    kc, ki = gains.proportional_gain, gains.proportional_gain * INTERVAL / gains.integral_time
    above = (1 - p) * np.array([kc, ki - kc])
    below = np.polyadd(np.polymul(np.polymul([1, -1], [1, -p]), [1] + [0] * d), above)
    numerator = np.concatenate([np.zeros(below.size - above.size - d), above, np.zeros(d)])
    setpoint = np.where(np.arange(300) < 10, 2.0, 1.2)
    expected: NDArray[np.float64] = 2.0 + lfilter(numerator, below, setpoint - 2.0)
    assert simulate_closed_loop(control_loop, setpoint=setpoint).friction_force == approx(expected, abs=1e-12)


def test_under_perfect_feed_forward_friction_follows_the_lag_alone() -> None:
    setpoint = np.where(np.arange(100) < 10, 2.0, 1.0)
    run = simulate_closed_loop(loop(feed_forward=True), setpoint=setpoint)
    n = np.maximum(np.arange(100) - 10, 0)
    assert run.friction_force == approx(1 + PROCESS.pole**n, abs=1e-12)


@pytest.mark.parametrize("feed_forward", [True, False])
def test_integral_action_removes_the_steady_error_of_a_wrong_characteristic(feed_forward: bool) -> None:
    setpoint = np.full(800, 1.2)
    run = simulate_closed_loop(
        loop(feed_forward=feed_forward), setpoint=setpoint, disturbance=Disturbance(friction_factor=1.25)
    )
    assert run.friction_force[-1] == approx(1.2, rel=1e-6)


def test_anti_windup_makes_the_recovery_independent_of_how_long_the_voltage_was_saturated() -> None:
    def recovery(saturated: int) -> NDArray[np.float64]:
        setpoint = np.append(np.full(saturated, 0.1), np.full(200, 1.0))  # 0.1 N is below the lowest attainable force
        return simulate_closed_loop(loop(feed_forward=False), setpoint=setpoint).friction_force[saturated:]

    assert recovery(2000) == approx(recovery(400), abs=1e-6)
    assert recovery(2000)[60:] == approx(1.0, abs=0.01)


def test_the_sensor_noise_is_reproducible_by_its_seed() -> None:
    noisy = Disturbance(friction_force_deviation=0.01, seed=3)
    runs = [
        simulate_closed_loop(loop(feed_forward=True), setpoint=np.full(200, 1.0), disturbance=noisy) for _ in range(2)
    ]
    same(runs[0].measured_force, runs[1].measured_force)
    assert np.std(runs[0].measured_force[50:]) == approx(0.01, rel=0.3)


@pytest.mark.parametrize(("fraction", "stable"), [(0.93, True), (1.07, False)])
def test_the_simulated_loop_becomes_unstable_at_its_gain_margin(fraction: float, stable: bool) -> None:
    control_loop = loop(feed_forward=False)
    factor = fraction * stability_margins(PROCESS, control_loop.controller.gains).gain_margin
    setpoint = np.full(3000, 1.25 * factor)
    run = simulate_closed_loop(control_loop, setpoint=setpoint, disturbance=Disturbance(friction_factor=factor))
    assert (np.ptp(run.friction_force[-200:]) < 1e-3) == stable
