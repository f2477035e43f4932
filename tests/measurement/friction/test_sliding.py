"""Rest, sliding and steps of constant voltage and speed in small recordings, sample by sample."""

from typing import Any

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.measurement.friction.sliding import (
    _common,
    _constant_levels,
    _force_before_sliding,
    _settled_part,
    _stated_ranges,
    at_rest,
    rest_by_force,
    rest_by_speed,
    sliding_steps,
    stretches,
    voltage_threshold,
)


def test_stretches_are_from_their_first_sample_to_the_one_after_their_last() -> None:
    assert stretches(np.array([True, False, True, True, False, True])) == [(0, 1), (2, 4), (5, 6)]
    assert stretches(np.zeros(3, bool)) == []
    assert stretches(np.ones(3, bool)) == [(0, 3)]


def test_there_is_no_voltage_below_a_share_of_its_range_or_fifty_millivolts() -> None:
    volts = np.array([2.0, np.nan, 12.0])
    assert voltage_threshold(voltage_peak_to_peak=volts, tolerance=0.05) == approx(0.5)
    assert voltage_threshold(voltage_peak_to_peak=volts, tolerance=0.001) == 0.05


def test_the_surfaces_rest_below_a_twentieth_of_the_highest_speed_for_over_two_tenths_of_a_second() -> None:
    time = np.arange(100.0) * 0.05
    speed = np.full(100, -20.0)  # of either sign
    speed[10:12] = 0.9  # 0.1 s: a stroke turns back
    speed[20:24] = 0.9  # 0.2 s at the sample after it
    speed[30:36] = -0.99  # 0.3 s
    speed[40:46] = 1.01  # above a twentieth
    speed[:2] = 0.0  # at an end, rest may be longer than it is seen
    speed[-2:] = 0.0
    rest = rest_by_speed(time=time, speed=speed)
    assert stretches(rest)[0] == (0, 2)
    assert stretches(rest)[-1] == (98, 100)
    assert not rest[10:12].any()
    assert not rest[40:46].any()
    assert rest[30:36].all()
    assert rest_by_speed(time=time, speed=np.zeros(100)).all()
    assert not rest_by_speed(time=time, speed=np.full(100, np.nan)).any()


def test_without_voltage_the_surfaces_rest_below_half_of_the_level_there() -> None:
    time = np.arange(4000.0) * 1e-3
    force = np.ones(4000)
    force[1000:2000] = 0.45
    force[2000:2500] = 0.55
    force[3000:3100] = 0.0  # two sections of 50 ms, whose neighbours slide
    force[3500:] = 0.0  # with vibration
    without = time < 3.5
    rest = rest_by_force(time=time, friction_force=force, without_voltage=without)
    assert stretches(rest) == [(1000, 2000)]
    assert not rest_by_force(time=time, friction_force=-force, without_voltage=without).any()
    assert not rest_by_force(time=time, friction_force=force, without_voltage=np.zeros(4000, bool)).any()
    force[1500:1550] = np.nan
    assert rest_by_force(time=time, friction_force=force, without_voltage=without)[1700:2000].all()
    mostly = np.where(time < 0.5, 1.0, 0.1)  # an eighth slides: the ninetieth percentile is its level
    assert stretches(rest_by_force(time=time, friction_force=mostly, without_voltage=time >= 0)) == [(500, 4000)]


def test_rest_is_told_by_the_speed_where_it_is_known_and_by_the_force_elsewhere() -> None:
    time = np.arange(4000.0) * 1e-3
    force = np.where(time % 2 < 1, 1.0, 0.0)
    volts = np.where(time < 3.5, 0.0, 20.0)
    speed = np.where(time < 1, 0.0, 3.0)
    speed[2000:] = np.nan
    rest = at_rest(time=time, friction_force=force, voltage_peak_to_peak=volts, sliding_speed=speed)
    assert stretches(rest) == [(0, 1000), (3000, 3500)]
    assert stretches(at_rest(time=time, friction_force=force, sliding_speed=speed)) == [(0, 1000)]
    by_force = at_rest(time=time, friction_force=force, voltage_peak_to_peak=volts)
    assert stretches(by_force) == [(1000, 2000), (3000, 3500)]
    assert not at_rest(time=time, friction_force=force).any()
    assert not at_rest(time=time, friction_force=force, sliding_speed=np.full(4000, np.nan)).any()


def test_stated_ranges_leave_out_zero_and_common_ranges_overlap() -> None:
    assert _stated_ranges(np.array([0.0, 1, 1, 0, 2, 3, 3])) == [(1, 3), (4, 5), (5, 7)]
    assert _common([(0, 10), (20, 30)], [(5, 25), (30, 40)]) == [(5, 10), (20, 25)]


def test_levels_are_constant_over_sections_and_joined_over_short_disturbances() -> None:
    t = np.arange(600.0) * 0.01
    u = np.select([t < 2, t < 4], [0.0, 10.0], 10.3)
    u[250:258] = 30.0  # shorter than a section of 0.1 s
    u[100:110] = np.nan
    assert _constant_levels(t, u, 0.5, 1.0) == [(0, 200), (200, 600)]
    assert _constant_levels(t, u, 0.2, 1.0) == [(0, 200), (200, 400), (400, 600)]
    spike = np.zeros(600)
    spike[200:210] = 9.0  # one section
    assert _constant_levels(t, spike, 0.5, 1.0) == [(0, 600)]
    spike[200:220] = 9.0  # two are a level
    assert _constant_levels(t, spike, 0.5, 1.0) == [(0, 200), (200, 220), (220, 600)]


def test_a_step_settles_at_its_beginning_and_for_a_tenth_at_its_end() -> None:
    t = np.arange(100.0) * 0.1
    # from 2.0 s to 6.9 s; settling of 1 s: 3.0 s to 6.8 s inclusive
    part = _settled_part(t, 20, 70, 0.999)
    assert (part.start, part.stop) == (30, 69)


def test_the_force_before_sliding_begins_where_a_disc_has_coasted_down() -> None:
    t = np.arange(1000.0) * 0.01  # sections of five samples
    f = np.full(1000, 0.02)
    f[100:200] = 0.9  # an earlier turn of the disc
    f[200:232] = 0.9  # coasting at rest of the motor, into the seventh section
    f[400] = np.nan
    f[500:] = 1.0
    rest = np.zeros(1000, bool)
    rest[:100] = rest[200:500] = True
    found = _force_before_sliding(t, f, rest, (500, 1000))
    # last section above half of the level is 225 to 230, of which the median of 230 to 235 is low: from 235 on
    assert found.size == 500 - 235 - 1
    assert found == approx(0.02)
    assert _force_before_sliding(t, f, np.zeros(1000, bool), (500, 1000)).size == 0
    still = _force_before_sliding(t, np.where(t < 5, 0.02, 1.0), rest, (500, 1000))
    assert still.size == 300


def made() -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Rest for 1 s; 0, 20 and 0 V for 4, 3 and 2 s; the speed rises by half after 2 s of the last."""
    t = np.arange(1000.0) * 0.01
    u = np.where((t >= 5) & (t < 8), 20.0, 0.0)
    f = np.where(t < 1, 0.0, 1.0 - u / 40)
    v = np.select([t < 1, t < 9], [0.0, 0.02], 0.03)
    return t, f, u, v


def test_steps_are_where_voltage_and_speed_are_constant_and_the_surfaces_slide() -> None:
    t, f, u, v = made()
    found = sliding_steps(t, f, u, v, shortest_step=0.5, settling_time=0.2, tolerance=0.05)
    assert found.steps == [(100, 500), (500, 800), (800, 900), (900, 1000)]
    assert found.voltages == [0, 20, 0, 0]
    assert found.speeds == approx([0.02, 0.02, 0.02, 0.03])
    assert found.threshold == approx(1.0)
    assert [part.start for part in found.settled] == [120, 520, 820, 920]
    assert [part.stop for part in found.settled] == approx([498, 798, 898, 998], abs=1)
    assert found.at_rest.tolist() == [0.0] * 100
    longer = sliding_steps(t, f, u, v, shortest_step=0.5, settling_time=0.5, tolerance=0.05)
    assert longer.steps == [(100, 500), (500, 800)]  # twice the settling time at least
    by_force = sliding_steps(t, f, u, None, shortest_step=0.5, settling_time=0.2, tolerance=0.05)
    assert by_force.steps == [(100, 500), (500, 800), (800, 1000)]
    assert np.isnan(by_force.speeds).all()


def test_stated_steps_take_the_place_of_those_of_the_voltage() -> None:
    t, f, u, v = made()
    number = np.select([(t >= 2) & (t < 4), (t >= 6) & (t < 7)], [1.0, 2.0], 0.0)
    found = sliding_steps(t, f, u, v, shortest_step=0.5, settling_time=0.2, tolerance=0.05, stated=number)
    assert found.steps == [(200, 400), (600, 700)]


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"shortest_step": 0.0}, "shortest_step must be positive"),
        ({"tolerance": 0.0}, "tolerance must be positive"),
        ({"settling_time": -1.0}, "settling_time must not be negative"),
        ({"shortest_step": 5.0}, "voltage_peak_to_peak is constant nowhere for 5 s"),
        ({"settling_time": 2.6}, "constant nowhere for 5.2 s"),
    ],
)
def test_steps_that_cannot_be_are_refused(changed: dict[str, float], words: str) -> None:
    t, f, u, v = made()
    given: dict[str, Any] = {"shortest_step": 0.5, "settling_time": 0.2, "tolerance": 0.05} | changed
    with raises(InvalidInput, match=words):
        sliding_steps(t, f, u, v, **given)


def test_a_recording_of_rest_has_no_step() -> None:
    t = np.arange(1000.0) * 0.01
    with raises(InvalidInput, match="at no constant voltage_peak_to_peak do the surfaces slide for 1 s"):
        sliding_steps(t, 0 * t, 0 * t, 0 * t, shortest_step=1.0, settling_time=0.2, tolerance=0.05)
