"""Onset of the steady state of signals with known running-in."""

import numpy as np
import xarray as xr
from pytest import approx, raises

from sonolube.errors import InvalidInput
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


def test_the_onset_is_the_first_of_five_windows_within_the_band_about_the_last_third() -> None:
    t = 5.0 + 2.0 * np.arange(30)
    force = np.full(30, 1.0)
    force[[10, 14]] = 1.2  # four windows between are not enough
    force[20:] += np.tile([0.004, -0.004], 5)  # scatter: 1.4826 times 0.004, of which three are 0.0178
    force[15] = 1.017
    found = steady_state_onset(time=t, friction_force=force, sliding_speed=0.05)
    assert found.steady
    assert found.reason == ""
    assert found.start_time == approx(2.0 * 0)  # windows 0 to 4
    force[:10] = 1.5
    found = steady_state_onset(time=t, friction_force=force, sliding_speed=0.05)
    assert found.start_time == approx(30.0)  # window 15
    assert found.sliding_distance == approx(1.5)
    kept = force[15:]
    assert found.friction_force == approx(kept.mean())
    assert found.friction_force_deviation == approx(kept.std(ddof=1))
    force[15] = 1.019
    assert steady_state_onset(time=t, friction_force=force, sliding_speed=0.05).start_time == approx(32.0)
    assert steady_state_onset(time=t, friction_force=force, sliding_speed=0.05, band=4.0).start_time == approx(30.0)
    wide = steady_state_onset(time=t, friction_force=force, sliding_speed=0.05, least_band=0.021)
    assert wide.start_time == approx(30.0)


def test_twelve_windows_with_a_value_are_needed_and_five_are_the_shortest_end() -> None:
    t = 2.0 * np.arange(13)
    force = np.append(np.ones(12), np.nan)
    assert steady_state_onset(time=t, friction_force=force, sliding_speed=1.0).steady
    force[3] = np.nan
    with raises(InvalidInput, match="at least 12 windows, got 11"):
        steady_state_onset(time=t, friction_force=force, sliding_speed=1.0)
    force[3], force[:7] = 1.0, 2.0  # the last five of twelve are level
    assert steady_state_onset(time=t, friction_force=force, sliding_speed=1.0).friction_force == approx(1.0)


def test_a_scattered_test_that_stays_in_no_band_is_not_steady() -> None:
    t = 2.0 * np.arange(30)
    force = 1 + 0.1 * np.tile([1, -1, 0.02, 0.01, -0.01, -0.02], 5)  # median deviation small, every third far out
    found = steady_state_onset(time=t, friction_force=force, sliding_speed=1.0)
    assert not found.steady
    assert "no 5 consecutive windows stay within" in found.reason
    assert found.start_time == approx(40.0)  # the last third


def test_a_trend_of_the_last_third_counts_above_scatter_smallest_band_and_three_standard_errors() -> None:
    t = 2.0 * np.arange(30)
    x = (np.arange(10) - 4.5) / 9  # from -1/2 to 1/2
    zigzag = np.tile([1.0, -1.0, -1.0, 1.0, 0.0], 2)

    def reason(rise: float, scatter: float, sign: float = 1.0) -> str:
        force = np.full(30, 1.0)
        force[20:] += sign * rise * x + scatter * zigzag
        return steady_state_onset(time=t, friction_force=force, sliding_speed=1.0, band=30.0).reason

    assert "still rises by 0.011 N; run longer" in reason(0.011, 0.0)  # above a hundredth of the level
    assert "still falls by 0.011 N" in reason(0.011, 0.0, -1.0)
    assert reason(0.009, 0.0) == ""
    # scatter of 0.01: 0.0148 N by its median, three standard errors of 3 sqrt(12 * 8e-4)/10 or more: 0.0294 N
    assert reason(0.025, 0.01) == ""
    assert "still rises" in reason(0.2, 0.01)
