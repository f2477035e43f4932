"""Onset of the steady state of signals with known running-in."""

import numpy as np
import xarray as xr
from pytest import approx

from sonolube.measurement.friction.windows import steady_state_onset
from sonolube.measurement.friction_analysis import analyse_running_in

RNG = np.random.default_rng(7)
RATE = 400.0  # Hz, D 2.3.2


def seconds(duration: float, rate: float = RATE) -> np.ndarray:
    return np.arange(round(duration * rate)) / rate


def recording(time: np.ndarray, **channels: np.ndarray) -> xr.Dataset:
    return xr.Dataset({name: ("time", values) for name, values in channels.items()}, coords={"time": time})


def test_running_in_ends_where_the_exponential_enters_the_band() -> None:
    t = np.arange(1, 2000, 2.0)  # windows of 2 s
    force = 1.024 * (1 - np.exp(-(t - 1) * 0.0203 / 1.5))  # over distance, characteristic 1.5 m
    found = steady_state_onset(time=t, friction_force=force, sliding_speed=0.0203)
    assert found.steady
    assert found.sliding_distance == approx(1.5 * np.log(100), abs=2 * 0.0203)  # within 1 % from there, one window
    assert found.friction_force == approx(1.024, rel=0.002)


def test_running_in_with_noise_ends_within_three_standard_deviations() -> None:
    t = np.arange(1, 4000, 2.0)
    force = 1.0 - 0.7 * np.exp(-t / 100) + RNG.normal(0, 0.02, t.size)
    found = steady_state_onset(time=t, friction_force=force, sliding_speed=1.0)
    assert found.steady
    expected = 100 * np.log(0.7 / 0.06)  # 246 s: the mean enters the band of 0.06 N
    assert 0.6 * expected < found.sliding_distance < 1.2 * expected
    assert found.friction_force_deviation == approx(0.02, rel=0.1)


def test_a_test_that_still_drifts_is_not_steady() -> None:
    t = np.arange(1, 400, 2.0)
    found = steady_state_onset(time=t, friction_force=0.5 + 0.002 * t, sliding_speed=0.02)
    assert not found.steady
    assert "still rises" in found.reason


def test_the_fluctuation_may_settle_later_than_the_friction() -> None:
    t = seconds(400)
    amplitude = 0.1 + 0.4 * np.exp(-t / 40)
    force = 1.0 - np.exp(-t / 5) + amplitude * np.sin(2 * np.pi * 25 * t)
    found = analyse_running_in(recording(t, friction_force=force), sliding_speed=0.0203)
    assert found.friction.start_time == approx(5 * np.log(100), abs=3)
    assert found.fluctuation.start_time == approx(40 * np.log(4 / 0.01), abs=4)
    assert found.fluctuation.friction_force == approx(0.1 / np.sqrt(2), rel=0.01)
