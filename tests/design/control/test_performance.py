"""Step-response metrics against the closed form of a first-order lag."""

import numpy as np
from pytest import approx

from sonolube.design.control import (
    FrictionCharacteristic,
    FrictionLoop,
    Process,
    VibrationMode,
    simulate_closed_loop,
    step_response_metrics,
    tuned_controller,
)

LINE = FrictionCharacteristic(level=np.array([0.0, 50.0]), friction_force=np.array([2.0, 0.5]))
MODE = VibrationMode(
    natural_frequency=22e3, damping_ratio=0.02, motional_conductance=0.4, parallel_capacitance=2e-7, frequency=22e3
)


def test_a_lag_under_perfect_feed_forward_rises_and_settles_as_an_exponential() -> None:
    fine = Process(time_constant=MODE.time_constant, dead_time=0.0, sample_interval=MODE.time_constant / 400)
    controller = tuned_controller(LINE, fine, level_maximum=50.0)
    loop = FrictionLoop(plant=LINE, mode=MODE, controller=controller, tracker=None, level_maximum=50.0)
    setpoint = np.where(np.arange(8000) < 100, 2.0, 1.0)
    metrics = step_response_metrics(
        simulate_closed_loop(loop, setpoint=setpoint), start_time=100 * fine.sample_interval
    )
    assert metrics.rise_time == approx(MODE.time_constant * np.log(9), rel=2e-3)
    assert metrics.settling_time == approx(MODE.time_constant * np.log(20), rel=2e-3)
    assert metrics.overshoot < 1e-9
