"""The sampled loop: tuning, margins, and the controller in closed loop with a straight map."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from pytest import approx, raises
from scipy.signal import lfilter

from sonolube.design.control import (
    Amplifier,
    Disturbance,
    FrictionCharacteristic,
    FrictionLoop,
    PIGains,
    Process,
    VibrationMode,
    active_limit,
    friction_at_voltage,
    simc_gains,
    simulate_closed_loop,
    stability_margins,
    step_response_metrics,
    swing_limit,
    tuned_controller,
    voltage_for_friction,
)
from sonolube.errors import InvalidInput, OutsideRange

INTERVAL = 2e-4
LINE = FrictionCharacteristic(voltage_peak_to_peak=np.array([0.0, 50.0]), friction_force=np.array([2.0, 0.5]))
MODE = VibrationMode(
    natural_frequency=22e3, damping_ratio=0.02, motional_conductance=0.4, parallel_capacitance=2e-7, frequency=22e3
)
PROCESS = Process(time_constant=MODE.time_constant, dead_time=1e-3, sample_interval=INTERVAL)


def loop(*, feed_forward: bool, closed_loop_time: float | None = None) -> FrictionLoop:
    controller = tuned_controller(
        LINE, PROCESS, voltage_maximum=50.0, feed_forward=feed_forward, closed_loop_time=closed_loop_time
    )
    return FrictionLoop(plant=LINE, mode=MODE, controller=controller, tracker=None, voltage_maximum=50.0)


def spectral_radius(process: Process, gains: PIGains, factor: float) -> float:
    """Return the largest root of (z - 1)(z - p) z^d + loop numerator, the loop's characteristic polynomial."""
    p, kc, d = process.pole, factor * gains.proportional_gain, process.dead_time_samples
    ki = kc * process.sample_interval / gains.integral_time
    den = np.polymul(np.polymul([1, -1], [1, -p]), [1] + [0] * d)
    return float(np.abs(np.roots(np.polyadd(den, (1 - p) * np.array([kc, ki - kc])))).max())


def test_skogestads_margins_are_found_where_sampling_is_fast() -> None:
    # Skogestad 2003, table 1, tau_c = theta: gain 3.14, phase 61.4 deg, Ms 1.59, delay 2.14 theta.
    process = Process(time_constant=1e-3, dead_time=1e-3, sample_interval=1e-6)
    margins = stability_margins(process, simc_gains(process))
    assert margins.gain_margin == approx(np.pi, rel=1e-3)
    assert np.degrees(margins.phase_margin) == approx(61.4, abs=0.1)
    assert margins.sensitivity_peak == approx(1.59, abs=0.005)
    assert margins.delay_margin == approx(2.14e-3, rel=2e-3)


@pytest.mark.parametrize("delayed", [0, 1, 2, 5, 9])
def test_the_gain_margin_of_a_delayed_sum_has_its_closed_form(delayed: int) -> None:
    # K z^-d/(z - 1) is stable up to K = 2 sin(pi/(2 (2 d + 1))); the rule makes K = T/(2 theta), theta = (d + 1/2) T.
    process = Process(time_constant=3e-4, dead_time=delayed * INTERVAL, sample_interval=INTERVAL)
    expected = 2 * np.sin(np.pi / (2 * (2 * delayed + 1))) * 2 * (delayed + 0.5)
    assert stability_margins(process, simc_gains(process)).gain_margin == approx(expected, rel=1e-5)


@settings(max_examples=25, deadline=None)
@given(
    time_constant=st.floats(5e-5, 0.1),
    dead_time=st.floats(0, 3e-3),
    gain=st.floats(0.05, 0.8),
    integral_time=st.floats(5e-4, 0.05),
)
def test_at_its_gain_margin_a_loop_is_on_the_brink(
    time_constant: float, dead_time: float, gain: float, integral_time: float
) -> None:
    process = Process(time_constant=time_constant, dead_time=dead_time, sample_interval=INTERVAL)
    gains = PIGains(proportional_gain=gain, integral_time=integral_time)
    if spectral_radius(process, gains, 1.0) < 1:
        margin = stability_margins(process, gains).gain_margin
        assert spectral_radius(process, gains, 0.999 * margin) < 1
        assert spectral_radius(process, gains, 1.001 * margin) > 1


def test_a_slow_process_gets_the_shorter_integral_time_of_the_rule() -> None:
    process = Process(time_constant=1.0, dead_time=1e-3, sample_interval=INTERVAL)
    assert simc_gains(process).integral_time == approx(8 * process.effective_dead_time)


def test_a_measurement_is_late_by_whole_intervals() -> None:
    assert Process(time_constant=1e-3, dead_time=1e-3, sample_interval=2e-4).dead_time_samples == 5
    assert Process(time_constant=1e-3, dead_time=1.01e-3, sample_interval=2e-4).dead_time_samples == 6


def test_the_loop_in_time_is_its_difference_equation() -> None:
    # Without feed-forward, through a straight map at resonance, friction is C G/(1 + C G z^-d) of the reference.
    running = loop(feed_forward=False, closed_loop_time=3e-3)
    gains, p, d = running.controller.gains, PROCESS.pole, PROCESS.dead_time_samples
    kc, ki = gains.proportional_gain, gains.proportional_gain * INTERVAL / gains.integral_time
    above = (1 - p) * np.array([kc, ki - kc])
    below = np.polyadd(np.polymul(np.polymul([1, -1], [1, -p]), [1] + [0] * d), above)
    numerator = np.concatenate([np.zeros(below.size - above.size - d), above, np.zeros(d)])
    reference = np.where(np.arange(300) < 10, 2.0, 1.2)
    expected: NDArray[np.float64] = 2.0 + lfilter(numerator, below, reference - 2.0)
    assert simulate_closed_loop(running, setpoint=reference).friction_force == approx(expected, abs=1e-12)


def test_a_perfect_feed_forward_leaves_nothing_to_the_feedback() -> None:
    reference = np.where(np.arange(100) < 10, 2.0, 1.0)
    run = simulate_closed_loop(loop(feed_forward=True), setpoint=reference)
    n = np.maximum(np.arange(100) - 10, 0)
    assert run.friction_force == approx(1 + PROCESS.pole**n, abs=1e-12)


@pytest.mark.parametrize("feed_forward", [True, False])
def test_friction_reaches_the_reference_whatever_the_real_friction(feed_forward: bool) -> None:
    reference = np.full(800, 1.2)
    run = simulate_closed_loop(
        loop(feed_forward=feed_forward), setpoint=reference, disturbance=Disturbance(friction_factor=1.25)
    )
    assert run.friction_force[-1] == approx(1.2, rel=1e-6)


def test_a_long_saturation_delays_the_return_no_more_than_a_short_one() -> None:
    def returned(saturated: int) -> NDArray[np.float64]:
        reference = np.append(np.full(saturated, 0.1), np.full(200, 1.0))  # 0.1 N is below the map's least
        return simulate_closed_loop(loop(feed_forward=False), setpoint=reference).friction_force[saturated:]

    assert returned(2000) == approx(returned(400), abs=1e-6)
    assert returned(2000)[60:] == approx(1.0, abs=0.01)


def test_a_step_of_a_lag_rises_and_settles_as_an_exponential() -> None:
    fine = Process(time_constant=MODE.time_constant, dead_time=0.0, sample_interval=MODE.time_constant / 400)
    running = replace(loop(feed_forward=True), controller=tuned_controller(LINE, fine, voltage_maximum=50.0))
    reference = np.where(np.arange(8000) < 100, 2.0, 1.0)
    found = step_response_metrics(
        simulate_closed_loop(running, setpoint=reference), start_time=100 * fine.sample_interval
    )
    assert found.rise_time == approx(MODE.time_constant * np.log(9), rel=2e-3)
    assert found.settling_time == approx(MODE.time_constant * np.log(20), rel=2e-3)
    assert found.overshoot < 1e-9


def test_noise_of_the_sensor_is_the_same_for_the_same_seed() -> None:
    noisy = Disturbance(friction_force_deviation=0.01, seed=3)
    runs = [
        simulate_closed_loop(loop(feed_forward=True), setpoint=np.full(200, 1.0), disturbance=noisy) for _ in range(2)
    ]
    assert np.array_equal(runs[0].measured_force, runs[1].measured_force)
    assert np.std(runs[0].measured_force[50:]) == approx(0.01, rel=0.3)


@given(force=st.floats(0.5, 2.0))
def test_map_and_inverse_undo_each_other(force: float) -> None:
    volts = voltage_for_friction(LINE, friction_force=force)
    assert friction_at_voltage(LINE, voltage_peak_to_peak=volts) == approx(force)


def test_friction_out_of_reach_is_refused_with_the_reach() -> None:
    with raises(OutsideRange, match=r"between 0\.5 N, at 50 V, and 2 N without vibration, got 0\.1 N"):
        voltage_for_friction(LINE, friction_force=0.1)


def test_a_map_that_rises_is_refused() -> None:
    with raises(InvalidInput, match="forces fall throughout"):
        FrictionCharacteristic(voltage_peak_to_peak=np.array([0.0, 1.0]), friction_force=np.array([1.0, 1.0]))


def test_a_sine_at_the_slew_limit_is_nowhere_steeper() -> None:
    swing = swing_limit(Amplifier(voltage_maximum=500.0, slew_rate_maximum=1e6), admittance=0.01j, frequency=22e3)
    t = np.linspace(0, 1 / 22e3, 20_001)
    slope = np.gradient(0.5 * swing * np.sin(2 * np.pi * 22e3 * t), t)
    assert np.abs(slope).max() == approx(1e6, rel=1e-4)


def test_the_current_limit_is_that_of_the_admittance() -> None:
    amplifier = Amplifier(voltage_maximum=100.0, current_maximum=0.5)
    swing = swing_limit(amplifier, admittance=0.03 + 0.04j, frequency=22e3)
    assert 0.05 * swing / 2 == approx(0.5)
    assert active_limit(amplifier, admittance=0.03 + 0.04j, frequency=22e3) == "current"


def test_a_loop_of_far_too_much_gain_has_no_margin_left() -> None:
    margins = stability_margins(PROCESS, PIGains(proportional_gain=100.0, integral_time=5e-4))
    assert margins.gain_margin < 1
    assert margins.phase_margin < 0
    assert margins.delay_margin < 0


@pytest.mark.parametrize(("share", "settles"), [(0.93, True), (1.07, False)])
def test_a_loop_in_time_rings_where_its_gain_margin_is_spent(share: float, settles: bool) -> None:
    running = loop(feed_forward=False)
    spent = share * stability_margins(PROCESS, running.controller.gains).gain_margin
    reference = np.full(3000, 1.25 * spent)
    run = simulate_closed_loop(running, setpoint=reference, disturbance=Disturbance(friction_factor=spent))
    assert (np.ptp(run.friction_force[-200:]) < 1e-3) == settles
