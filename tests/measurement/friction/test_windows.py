"""Window statistics against numpy, and of streamed files against the whole."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, strategies as st
from nptdms import ChannelObject, TdmsWriter
from pytest import approx, raises
from tests.tiers import examples

from sonolube.errors import InvalidInput
from sonolube.measurement.friction.windows import streamed_window_statistics, window_statistics

RNG = np.random.default_rng(7)
RATE = 400.0  # Hz, D 2.3.2


def seconds(duration: float, rate: float = RATE) -> np.ndarray:
    return np.arange(round(duration * rate)) / rate


def test_a_sine_fluctuates_by_its_amplitude_over_root_two_in_every_window() -> None:
    t = seconds(60)
    windows = window_statistics(1.0 + 0.3 * np.sin(2 * np.pi * 100 * t + 0.4), time=t)
    assert windows.time == approx(np.arange(30) * 2 + 1)
    assert windows.samples.tolist() == [800] * 30
    assert windows.mean == approx(1.0)
    assert windows.fluctuation == approx(0.3 / np.sqrt(2))
    assert windows.deviation == approx(0.3 / np.sqrt(2) * np.sqrt(800 / 799))


@given(st.lists(st.floats(-1e3, 1e3) | st.just(np.nan), min_size=2, max_size=200), st.floats(0.1, 30))
@examples(100)
def test_window_statistics_agree_with_numpy(values: list[float], window: float) -> None:
    x = np.array(values)
    if np.isnan(x).all():
        return
    t = np.arange(x.size) * 0.5
    windows = window_statistics(x, time=t, window_duration=window)
    number = np.floor(t / window + 1e-9)
    for i, which in enumerate(np.unique(number)):
        own = x[number == which]
        own = own[np.isfinite(own)]
        assert windows.samples[i] == own.size
        if own.size:
            assert windows.mean[i] == approx(own.mean(), abs=1e-9)
            assert windows.fluctuation[i] == approx(own.std(), abs=1e-9)


def test_dropped_samples_do_not_shift_the_windows() -> None:
    t = seconds(20)
    kept = (t < 5) | (t > 9.1)
    windows = window_statistics(np.floor(t / 2)[kept], time=t[kept])
    assert windows.time.tolist() == [1, 3, 5, 9, 11, 13, 15, 17, 19]
    assert windows.mean.tolist() == [0, 1, 2, 4, 5, 6, 7, 8, 9]


@pytest.mark.parametrize("block", [37, 800, 4096, 100_000])
def test_streamed_window_statistics_equal_those_of_the_whole_recording(block: int, tmp_path: Path) -> None:
    path = tmp_path / "long.tdms"
    t = seconds(31.3)
    force = RNG.normal(1.0, 0.1, t.size)
    force[100:105] = np.nan
    with TdmsWriter(path) as writer:
        for part in np.array_split(force, 7):
            writer.write_segment([ChannelObject("g", "friction_force", part, {"wf_increment": 1 / RATE})])
    streamed = streamed_window_statistics(path, block_samples=block)["friction_force"]
    whole = window_statistics(force, time=t)
    assert streamed.unit == "N"
    assert streamed.time == approx(whole.time)
    assert streamed.samples.tolist() == whole.samples.tolist()
    assert streamed.mean == approx(whole.mean, rel=1e-13)
    assert streamed.deviation == approx(whole.deviation, rel=1e-10)


@pytest.mark.parametrize("block", [200, 800, 10_000])
def test_missing_values_empty_only_the_windows_they_fill(block: int, tmp_path: Path) -> None:
    path = tmp_path / "failing.tdms"
    force, nothing = np.ones(4000), np.full(4000, np.nan)
    force[800:2400] = np.nan
    waves = {"wf_increment": 1 / RATE}
    with TdmsWriter(path) as writer:
        writer.write_segment(
            [ChannelObject("g", "friction_force", force, waves), ChannelObject("g", "temperature", nothing, waves)]
        )
    windows = streamed_window_statistics(path, channels=["friction_force"], block_samples=block)["friction_force"]
    assert windows.samples.tolist() == [800, 0, 0, 800, 800]
    assert windows.mean == approx([1, np.nan, np.nan, 1, 1], nan_ok=True)
    with raises(InvalidInput, match="channel 'temperature' holds no value"):
        streamed_window_statistics(path, block_samples=block)


def test_windows_carry_their_middle_duration_channel_and_unit() -> None:
    t = 10 + np.array([0.0, 1.0, 2.0, 3.0, 9.0, 10.0])
    windows = window_statistics(
        np.array([1.0, 4.0, 7.0, np.nan, 5.0, 8.0]), time=t, window_duration=3.0, channel="friction_force", unit="N"
    )
    assert windows.time == approx([11.5, 14.5, 20.5])
    assert windows.mean == approx([4.0, np.nan, 6.5], nan_ok=True)
    assert windows.samples.tolist() == [3, 0, 2]
    assert windows.deviation == approx([3.0, np.nan, 1.5 * np.sqrt(2)], nan_ok=True)
    assert windows.fluctuation == approx([np.sqrt(6), np.nan, 1.5], nan_ok=True)
    assert (windows.window_duration, windows.channel, windows.unit) == (3.0, "friction_force", "N")
    single = window_statistics(np.array([3.0, 5.0, 9.0]), time=np.array([0.0, 1.0, 2.0]))
    assert single.window_duration == 2.0
    assert single.deviation == approx([np.sqrt(2), np.nan], nan_ok=True)  # of a single sample there is none
    with raises(InvalidInput, match="window_duration must be positive"):
        window_statistics(np.ones(3), time=np.arange(3.0), window_duration=0.0)
    with raises(InvalidInput, match="friction_force must hold 3 numbers"):
        window_statistics(np.ones(2), time=np.arange(3.0), channel="friction_force")


def test_a_window_whose_beginning_is_rounded_belongs_to_itself() -> None:
    t = 0.1 * np.arange(10)  # 0.3 and 0.6 are rounded
    assert window_statistics(np.arange(10.0), time=t, window_duration=0.3).samples.tolist() == [3, 3, 3, 1]


def test_a_missing_channel_of_a_stream_is_named_with_those_that_are_there(tmp_path: Path) -> None:
    path = tmp_path / "short.tdms"
    with TdmsWriter(path) as writer:
        writer.write_segment([ChannelObject("g", "friction_force", np.ones(9), {"wf_increment": 0.5})])
    with raises(InvalidInput, match="has no channel 'torque'; it has friction_force"):
        streamed_window_statistics(path, channels=["torque"])
    with raises(InvalidInput, match="window_duration must be positive"):
        streamed_window_statistics(path, window_duration=-1.0)
    (found,) = streamed_window_statistics(path, window_duration=3.0, block_samples=4).values()
    assert found.samples.tolist() == [6, 3]
    assert found.channel == "friction_force"
