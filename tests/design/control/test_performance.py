"""Step-response metrics against the closed form of a first-order lag, and short runs counted by hand."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.design.control import (
    ClosedLoopRun,
    FrictionCharacteristic,
    FrictionLoop,
    Process,
    VibrationMode,
    control_energy,
    simulate_closed_loop,
    step_response_metrics,
    tuned_controller,
)
from sonolube.design.control.control_design import final_state, lost_resonance
from sonolube.errors import InvalidInput
from sonolube.rig import read_rig

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


def run_of(setpoint: list[float], force: list[float], **changes: Any) -> ClosedLoopRun:
    """Run in steps of 10 ms."""
    count = len(setpoint)
    known = ClosedLoopRun(
        time=0.01 * np.arange(float(count)),
        setpoint=np.array(setpoint),
        friction_force=np.array(force),
        measured_force=np.array(force),
        level=np.linspace(0.0, 10.0, count),
        frequency=np.full(count, 20e3),
        resonance_frequency=np.full(count, 20e3),
        envelope=np.zeros(count, dtype=complex),
        phase=np.zeros(count),
        electrical_energy=0.5 * np.arange(float(count)),
    )
    return replace(known, **changes)


#            0    1    2    3    4    5    6    7    8    9   10   11
SETPOINT = [2.0, 2.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0]
FORCE = [2.0, 2.0, 2.0, 1.8, 1.2, 0.9, 0.8, 1.0, 1.02, 1.04, 1.0, 0.98]


def test_rise_settling_overshoot_and_error_of_a_step_are_counted_by_hand() -> None:
    found = step_response_metrics(run_of(SETPOINT, FORCE), start_time=0.02)
    # shares of the step of -1 N: 0, 0.2, 0.8, 1.1, 1.2, 1, 0.98, 0.96, 1, 1.02 from 0.02 s on
    # 10 % halfway to the second, 5 ms; 90 % a third of the way from 0.8 to 1.1, 23.33 ms
    assert found.rise_time == approx(0.02 + 0.01 / 3 - 0.005)
    assert found.settling_time == approx(0.05)  # 1.2 is the last beyond 5 %
    assert found.overshoot == approx(0.2)
    assert found.tracking_error == approx(np.sqrt((0.0**2 + 0.02**2) / 2))  # of the last two of ten
    wide = step_response_metrics(run_of(SETPOINT, FORCE), start_time=0.02, band=0.15)
    assert wide.settling_time == approx(0.05)
    wider = step_response_metrics(run_of(SETPOINT, FORCE), start_time=0.02, band=0.25)
    assert wider.settling_time == approx(0.02)  # 0.8 is inside


def test_a_step_up_is_judged_alike_and_ends_at_the_next_step() -> None:
    setpoint = [1.0, 2.0, 2.0, 2.0, 5.0, 5.0]
    found = step_response_metrics(run_of(setpoint, [1.0, 1.0, 1.5, 2.5, 9.0, 9.0]), start_time=0.01)
    assert found.rise_time == approx(0.01 + 0.01 * 0.4 - 0.01 * 0.2)  # 1.1 N and 1.9 N
    assert found.settling_time is None
    assert found.overshoot == approx(0.5)
    assert found.tracking_error == approx(0.5)  # of the last one of three


def test_a_response_that_does_not_arrive_has_no_rise_and_no_overshoot() -> None:
    found = step_response_metrics(run_of([2.0, 1.0, 1.0], [2.0, 2.0, 1.5]), start_time=0.01)
    assert (found.rise_time, found.settling_time, found.overshoot) == (None, None, 0.0)
    at_once = step_response_metrics(run_of([2.0, 1.0, 1.0], [2.0, 1.0, 1.0]), start_time=0.01)
    assert (at_once.rise_time, at_once.settling_time) == (0.0, 0.0)


@pytest.mark.parametrize("time", [0.0, 0.01, 0.03, 1.0])
def test_a_time_without_a_step_is_refused(time: float) -> None:
    with raises(InvalidInput, match="the set-point has no step there; give the time of one"):
        step_response_metrics(run_of(SETPOINT, FORCE), start_time=time)


def test_energies_are_sums_over_the_intervals() -> None:
    rig = read_rig("examples/rigs/tribometer.toml")  # 0.341, 3 N, 20.3 mm/s, 360 nF, offset half of the voltage
    run = run_of([1.0] * 3, [1.0, 0.9, 0.4], level=np.array([0.0, 10.0, 20.0]))
    found = control_energy(rig, run)
    # D 1.9: C U_max U_pp f, U_max = U_pp
    assert found.amplifier_energy == approx(360e-9 * (100 + 400) * 20e3 * 0.01)
    assert found.electrical_energy == approx(1.0)
    assert found.saved_work == approx((3 * 1.023 - 2.3) * 0.01 * 0.0203)
    amplitude = replace(run, electrical_energy=None)
    assert control_energy(rig, amplitude).electrical_energy is None
    assert control_energy(rig, amplitude).amplifier_energy is None
    assert control_energy(replace(rig, capacitance=None), run).amplifier_energy is None
    one = run_of([1.0], [0.5], level=np.array([20.0]))
    assert control_energy(rig, one).saved_work == 0.0


def test_the_final_state_is_that_of_the_last_fifth() -> None:
    run = run_of([1.0] * 11, [9.0] * 9 + [1.3, 0.6], level=np.array([7.0] * 9 + [2.0, 4.0]))
    found = final_state(run)
    assert found.level == approx(3.0)
    assert found.tracking_error == approx(np.sqrt((0.09 + 0.16) / 2))
    short = final_state(run_of([1.0] * 3, [9.0, 9.0, 1.5], level=np.array([7.0, 7.0, 2.0])))
    assert (short.level, short.tracking_error) == approx((2.0, 0.5))


@pytest.mark.parametrize(("last", "lost"), [(19e3, True), (19.5e3, False), (21e3, True), (20.9e3, False)])
def test_a_resonance_is_lost_at_either_end_of_the_band(last: float, lost: bool) -> None:
    run = run_of([1.0] * 2, [1.0] * 2, frequency=np.array([20e3, last]))
    tracker = SimpleNamespace(lowest_frequency=19e3, highest_frequency=21e3)
    study: Any = SimpleNamespace(run=run, tracker=tracker)
    assert lost_resonance(study) is lost
    fixed: Any = SimpleNamespace(run=run, tracker=None)
    assert lost_resonance(fixed) is False
