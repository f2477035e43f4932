"""Sampled loop of lag, dead time and PI: SIMC tuning and margins against closed forms and characteristic polynomial."""

import numpy as np
import pytest
from hypothesis import given, strategies as st
from pytest import approx
from tests.tiers import examples

from sonolube.design.control import PIGains, Process, simc_gains, stability_margins

INTERVAL = 2e-4


def spectral_radius(process: Process, gains: PIGains, factor: float) -> float:
    """Spectral radius of the closed loop: largest root of (z - 1)(z - p) z^d + numerator of the loop."""
    p, kc, d = process.pole, factor * gains.proportional_gain, process.dead_time_samples
    ki = kc * process.sample_interval / gains.integral_time
    den = np.polymul(np.polymul([1, -1], [1, -p]), [1] + [0] * d)
    return float(np.abs(np.roots(np.polyadd(den, (1 - p) * np.array([kc, ki - kc])))).max())


def test_with_fast_sampling_the_margins_are_those_of_skogestad_2003() -> None:
    # Skogestad 2003, table 1, tau_c = theta: gain 3.14, phase 61.4 deg, Ms 1.59, delay 2.14 theta.
    process = Process(time_constant=1e-3, dead_time=1e-3, sample_interval=1e-6)
    margins = stability_margins(process, simc_gains(process))
    assert margins.gain_margin == approx(np.pi, rel=1e-3)
    assert np.degrees(margins.phase_margin) == approx(61.4, abs=0.1)
    assert margins.sensitivity_peak == approx(1.59, abs=0.005)
    assert margins.delay_margin == approx(2.14e-3, rel=2e-3)


@pytest.mark.parametrize("delayed", [0, 1, 2, 5, 9])
def test_the_gain_margin_of_a_delayed_integrator_has_its_closed_form(delayed: int) -> None:
    # K z^-d/(z - 1) is stable up to K = 2 sin(pi/(2 (2 d + 1))); the rule makes K = T/(2 theta), theta = (d + 1/2) T.
    process = Process(time_constant=3e-4, dead_time=delayed * INTERVAL, sample_interval=INTERVAL)
    expected = 2 * np.sin(np.pi / (2 * (2 * delayed + 1))) * 2 * (delayed + 0.5)
    assert stability_margins(process, simc_gains(process)).gain_margin == approx(expected, rel=1e-5)


@examples(25)
@given(
    time_constant=st.floats(5e-5, 0.1),
    dead_time=st.floats(0, 3e-3),
    gain=st.floats(0.05, 0.8),
    integral_time=st.floats(5e-4, 0.05),
)
def test_at_its_gain_margin_a_loop_is_marginally_stable(
    time_constant: float, dead_time: float, gain: float, integral_time: float
) -> None:
    process = Process(time_constant=time_constant, dead_time=dead_time, sample_interval=INTERVAL)
    gains = PIGains(proportional_gain=gain, integral_time=integral_time)
    if spectral_radius(process, gains, 1.0) < 1:
        margin = stability_margins(process, gains).gain_margin
        assert spectral_radius(process, gains, 0.999 * margin) < 1
        assert spectral_radius(process, gains, 1.001 * margin) > 1


def test_for_a_slow_process_the_integral_time_is_limited_by_the_closed_loop_time() -> None:
    process = Process(time_constant=1.0, dead_time=1e-3, sample_interval=INTERVAL)
    assert simc_gains(process).integral_time == approx(8 * process.effective_dead_time)


def test_the_dead_time_is_rounded_up_to_whole_intervals() -> None:
    assert Process(time_constant=1e-3, dead_time=1e-3, sample_interval=2e-4).dead_time_samples == 5
    assert Process(time_constant=1e-3, dead_time=1.01e-3, sample_interval=2e-4).dead_time_samples == 6


def test_an_unstable_loop_has_a_gain_margin_below_one_and_negative_phase_and_delay_margins() -> None:
    process = Process(time_constant=3.6e-4, dead_time=1e-3, sample_interval=INTERVAL)
    margins = stability_margins(process, PIGains(proportional_gain=100.0, integral_time=5e-4))
    assert margins.gain_margin < 1
    assert margins.phase_margin < 0
    assert margins.delay_margin < 0
