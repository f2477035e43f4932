"""Validation of sampled signals."""

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.measurement.friction.loops import friction_work
from sonolube.measurement.friction.windows import window_statistics
from sonolube.measurement.time_series import (
    constant_stretches,
    even_stretches,
    evenly_sampled,
    require_equal_length,
    require_time_series,
    uniform_sample_interval,
)


@pytest.mark.parametrize(
    ("force", "match"),
    [
        (np.full(10, np.nan), "holds no value among 10"),
        (np.full(10, np.inf), "infinite"),
        (np.ones(9), "must hold 10 numbers"),
    ],
)
def test_signals_of_wrong_length_infinite_or_without_values_are_refused(force: np.ndarray, match: str) -> None:
    with raises(InvalidInput, match=match):
        friction_work(time=np.arange(10.0), friction_force=force, relative_velocity=np.ones(10))


def test_decreasing_time_is_refused() -> None:
    with raises(InvalidInput, match="time must increase, got 1 s"):
        window_statistics(np.ones(3), time=np.array([0.0, 2.0, 1.0]))


def test_time_comes_first_and_signals_follow_in_their_order() -> None:
    t, one, other = require_time_series(time=[0, 1], b=[3, np.nan], a=np.array([1, 2]))
    assert t.tolist() == [0.0, 1.0]
    assert one[0] == 3.0
    assert np.isnan(one[1])
    assert other.tolist() == [1.0, 2.0]
    with raises(InvalidInput, match=r"at least two samples, got shape \(1,\)"):
        require_time_series(time=[1.0])
    with raises(InvalidInput, match=r"time must increase, got 1 s after as much or more"):
        require_time_series(time=[0.0, 1.0, 1.0, 2.0])
    with raises(InvalidInput, match=r"a must hold 2 numbers, got shape \(2,\) of <U1"):
        require_time_series(time=[0.0, 1.0], a=np.array(["x", "y"]))


def test_vectors_of_one_length_are_accepted() -> None:
    require_equal_length(a=np.ones(1), b=np.ones(1))
    for pair in ((np.ones(2), np.ones(3)), (np.ones(0), np.ones(0)), (np.ones((2, 2)), np.ones((2, 2)))):
        with raises(InvalidInput, match="a and b must be one-dimensional and equal in length, got shapes"):
            require_equal_length(a=pair[0], b=pair[1])


def test_a_stretch_ends_where_any_column_changes_and_missing_values_are_alike() -> None:
    one = np.array([1.0, 1, 2, 2, np.nan, np.nan, 2])
    other = np.array([False, False, False, True, True, True, True])
    assert constant_stretches(one, other) == [(0, 2), (2, 3), (3, 4), (4, 6), (6, 7)]
    assert constant_stretches(np.empty(0)) == []
    assert constant_stretches(np.ones(1)) == [(0, 1)]


def test_an_even_time_may_deviate_by_a_twentieth_of_its_interval() -> None:
    time = np.arange(11.0) * 2 + 1
    assert uniform_sample_interval(time=time) == approx(2.0)
    time[4] += 0.09
    assert uniform_sample_interval(time=time) == approx(2.0)
    time[4] += 0.02
    with raises(InvalidInput, match="after 7 s samples were dropped or the rate changes"):
        uniform_sample_interval(time=time)


def test_a_recording_is_cut_at_gaps_and_where_its_rate_changes() -> None:
    dt = 0.01
    steps = np.concatenate([np.full(299, dt), [2.6 * dt], np.full(499, dt), [2.4 * dt], np.full(99, dt)])
    time = np.concatenate([[0.0], np.cumsum(steps)])
    interval, found = even_stretches(time=time, fewest=64)
    assert [(part.start, part.stop) for part in found] == [(0, 300), (300, 900)]  # 2.4 medians are no gap
    assert interval == approx((599 * dt + 1.4 * dt) / 599)
    two = np.concatenate([np.full(400, dt), np.full(200, 2 * dt)])
    interval, found = even_stretches(time=np.concatenate([[0.0], np.cumsum(two)]), fewest=64)
    assert interval == approx(dt, rel=0.02)
    (part,) = found  # that of the other rate is left out
    assert part.start == 0
    assert abs(part.stop - 400) < 62
    short = 0.5 * np.arange(63.0)
    assert even_stretches(time=short, fewest=64) == (0.5, [])
    assert even_stretches(time=short, fewest=63)[1] == [slice(0, 63)]
    broken = np.cumsum(np.where(np.arange(200) % 40 == 39, 5.0, 0.5))
    assert even_stretches(time=broken, fewest=64) == (0.5, [])


def test_a_rounded_clock_is_made_even_and_another_one_interpolated() -> None:
    time = np.array([0.0, 1.4, 1.7, 3.0, 4.0])
    signal = np.array([0.0, 2.0, 4.0, 6.0, 8.0])
    even, same = evenly_sampled(time=time, signal=signal, sample_interval=1.0)
    assert even.tolist() == [0, 1, 2, 3, 4]
    assert same.tolist() == signal.tolist()
    late = np.array([0.0, 2.5, 3.0, 3.5, 4.0])
    even, between = evenly_sampled(time=late, signal=signal, sample_interval=1.0)
    assert even.tolist() == [0, 1, 2, 3, 4]
    assert between == approx([0.0, 0.8, 1.6, 4.0, 8.0])
