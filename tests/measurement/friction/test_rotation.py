"""Rotation of a disc from pulses: published speeds, missing pulses, unequally spaced magnets."""

import numpy as np
import pytest
from hypothesis import given, strategies as st
from pytest import approx, raises
from tests.tiers import examples

from sonolube.errors import InvalidInput
from sonolube.measurement.friction.rotation import disc_rotation, hall_pulse_times, revolutions_at

MM = 1e-3


def bells(time: np.ndarray, at: np.ndarray, heights: np.ndarray, width: float = 0.01) -> np.ndarray:
    return np.asarray((heights * np.exp(-(((time[:, None] - at) / width) ** 2))).sum(axis=1))


@pytest.mark.parametrize(
    ("turns_per_minute", "diameter", "speed", "within"),
    [
        (6.67, 58.2, 20.3, 0.05),  # appendix A 3.1.6, with the diameter of E14
        (13.3, 58.2, 40.6, 0.1),  # appendix A 3.1.10
        (28.7, 58.2, 87.0, 0.5),
        (60 / 1.34, 28.0, 65.5, 0.2),  # section 4.1.2: 1.34 s between peaks
    ],
)
def test_published_speeds_follow_from_the_pulses(
    turns_per_minute: float, diameter: float, speed: float, within: float
) -> None:
    period = 60 / turns_per_minute
    t = np.arange(0, 12 * period, 0.0025)
    at = 0.4 * period + period * np.arange(11)
    found = disc_rotation(
        time=hall_pulse_times(time=t, magnetic_flux_density=0.01 + bells(t, at, np.full(11, 0.05))),
        groove_diameter=diameter * MM,
    )
    assert found.mean_rotation_speed == approx(1 / period, rel=1e-4)
    assert found.sliding_speed == approx(speed * MM, abs=within * MM)
    assert not found.interpolated.any()


def test_pulses_are_timed_between_samples() -> None:
    t = np.arange(0, 3, 0.0025)
    at = np.array([0.50113, 1.50071, 2.49967])
    assert hall_pulse_times(time=t, magnetic_flux_density=bells(t, at, np.ones(3), 0.02)) == approx(at, abs=2e-5)


def test_a_magnet_of_reversed_polarity_gives_the_same_pulses() -> None:
    t = np.arange(0, 3, 0.0025)
    at = np.array([0.5, 1.5, 2.5])
    assert hall_pulse_times(time=t, magnetic_flux_density=-bells(t, at, np.ones(3))) == approx(at, abs=1e-5)


@given(st.integers(1, 17), st.integers(1, 3), st.floats(0.1, 20))
@examples(60)
def test_missing_pulses_are_interpolated_and_flagged(first: int, lost: int, period: float) -> None:
    every = period * np.arange(22)
    gone = np.arange(first, first + lost)
    found = disc_rotation(time=np.delete(every, gone), groove_diameter=0.05)
    assert found.time == approx(every)
    assert np.flatnonzero(found.interpolated).tolist() == gone.tolist()
    assert found.revolutions == approx(np.arange(22))


def test_a_step_of_speed_is_not_a_missing_pulse() -> None:
    # D 2.4.2: 50 to 77 turns a minute as the vibration takes friction away, and back
    interval = np.concatenate([np.full(10, 60 / 50), np.full(10, 60 / 77), np.full(10, 60 / 50)])
    found = disc_rotation(time=np.cumsum(interval), groove_diameter=60 * MM)
    assert not found.interpolated.any()
    assert found.rotation_speed == approx(1 / interval[1:])


@given(st.lists(st.floats(0.2, 1.0), min_size=2, max_size=5), st.sets(st.integers(20, 60), max_size=4))
@examples(60)
def test_unequally_spaced_magnets_give_a_constant_speed(gaps: list[float], gone: set[int]) -> None:
    shares = np.array(gaps) / sum(gaps)
    if np.ptp(np.sort(shares)) < 0.05:
        shares = np.linspace(1, 2, shares.size) / np.linspace(1, 2, shares.size).sum()
    magnets = shares.size
    position = np.concatenate([[0.0], np.cumsum(np.tile(shares, 40))])
    kept = np.setdiff1d(np.arange(position.size), [i for i in gone if i < position.size - 1 and i % 7 == 0])
    found = disc_rotation(time=2.0 * position[kept], groove_diameter=0.05, magnets=magnets)
    assert found.time == approx(2.0 * position)
    assert found.rotation_speed == approx(0.5)
    assert np.flatnonzero(found.interpolated).tolist() == np.setdiff1d(np.arange(position.size), kept).tolist()


def test_a_lower_prominence_includes_weak_magnets() -> None:
    t = np.arange(0, 5, 0.001)
    at = np.arange(0.25, 5, 0.5)
    readings = bells(t, at, np.where(np.arange(at.size) % 2, 0.2, 1.0))
    assert hall_pulse_times(time=t, magnetic_flux_density=readings).size == 5
    assert hall_pulse_times(time=t, magnetic_flux_density=readings, prominence=0.1).size == 10


def test_revolutions_between_pulses_of_constant_speed_are_linear_in_time() -> None:
    found = disc_rotation(time=1.0 + 2.0 * np.arange(6), groove_diameter=0.05)
    assert revolutions_at(found, time=[0.0, 1.0, 2.0, 11.0, 13.0]) == approx([-0.5, 0.0, 0.5, 5.0, 6.0])


@pytest.mark.parametrize(
    ("time", "magnets", "match"),
    [
        ([1.0], 1, "a revolution needs 2 pulses, got 1"),
        ([1.0, 1.0], 1, "must increase"),
        ([1.0, 2.0], 0, "magnets must be"),
    ],
)
def test_too_few_or_unsorted_pulses_are_refused(time: list[float], magnets: int, match: str) -> None:
    with raises(InvalidInput, match=match):
        disc_rotation(time=time, groove_diameter=0.05, magnets=magnets)


def test_a_constant_probe_signal_is_refused() -> None:
    with raises(InvalidInput, match="does not vary"):
        hall_pulse_times(time=np.arange(10.0), magnetic_flux_density=np.ones(10))


def test_the_vertex_of_a_parabola_through_uneven_samples_is_exact() -> None:
    t = np.array([0.0, 1.0, 1.5, 2.5, 3.0, 5.0, 6.0, 6.5])
    b = np.zeros(8)
    b[1:4] = 5 - (t[1:4] - 1.7) ** 2  # highest at 1.5
    b[4:7] = 40 - 3 * (t[4:7] - 4.6) ** 2  # highest at 5
    assert hall_pulse_times(time=t, magnetic_flux_density=b, prominence=0.01) == approx([1.7, 4.6])


def test_a_reading_with_missing_values_or_without_a_pulse_is_read_or_refused() -> None:
    t = np.arange(0, 3, 0.0025)
    b = bells(t, np.array([0.5, 1.5, 2.5]), np.ones(3))
    b[10:20] = np.nan
    assert hall_pulse_times(time=t, magnetic_flux_density=b) == approx([0.5, 1.5, 2.5], abs=1e-5)
    with raises(InvalidInput, match="shows no pulse"):
        hall_pulse_times(time=np.arange(10.0), magnetic_flux_density=np.arange(10.0))
    for prominence in (0.009, 1.01):
        with raises(InvalidInput, match="prominence"):
            hall_pulse_times(time=t, magnetic_flux_density=b, prominence=prominence)


def test_one_turn_is_known_by_a_count_of_the_samples_at_both_ends_and_by_the_clock() -> None:
    one = disc_rotation(time=[2.0, 2.5], groove_diameter=0.04)
    assert one.rotation_speed_uncertainty == approx(2 * 5e-5 / np.sqrt(3))
    counted = disc_rotation(time=[2.0, 2.5], groove_diameter=0.04, sample_interval=0.01)
    assert counted.rotation_speed_uncertainty == approx(2 * np.sqrt(2) * (0.01 / np.sqrt(12)) / 0.5, rel=1e-4)
    with raises(InvalidInput, match="sample_interval must not be negative"):
        disc_rotation(time=[2.0, 2.5], groove_diameter=0.04, sample_interval=-1.0)


@pytest.mark.parametrize("turns", [12, 60])
def test_the_mean_speed_lies_within_its_uncertainty_as_often_as_it_says(turns: int) -> None:
    rng = np.random.default_rng(3)
    scores = []
    for _ in range(400):
        times = np.arange(turns + 1) / 1.5 + rng.normal(0, 0.004, turns + 1)
        found = disc_rotation(time=times, groove_diameter=0.04)
        scores.append((found.mean_rotation_speed - 1.5) / found.rotation_speed_uncertainty)
    assert np.mean(scores) == approx(0.0, abs=0.2)
    assert 0.8 < np.std(scores) < 1.15
    assert 0.92 < np.mean(np.abs(scores) < 1.96) < 0.98


def test_speeds_follow_from_each_revolution_and_the_uncertainty_from_their_scatter() -> None:
    found = disc_rotation(time=[2.0, 2.5, 3.3, 4.3], groove_diameter=0.04)
    assert found.rotation_speed == approx([2.0, 1.25, 1.0])
    assert found.sliding_speed == approx(np.pi * 0.04 * np.array([2.0, 1.25, 1.0]))
    assert found.mean_rotation_speed == approx(3 / 2.3)
    # second differences 0.3 s and 0.2 s: a pulse is known to sqrt((0.3**2 + 0.2**2) / 2 / 6) s
    pulse = np.sqrt((0.3**2 + 0.2**2) / 12)
    few = 12.14 / 1.96  # Student's factor of 95 % for 2 / 1.944 = 1.029 independent ones, by its table near 12.7 of one
    assert found.rotation_speed_uncertainty == approx(few * 3 / 2.3 * np.sqrt(2) * pulse / 2.3, rel=0.02)
    with raises(InvalidInput, match="groove_diameter must be positive"):
        disc_rotation(time=[2.0, 2.5], groove_diameter=0.0)
    with raises(InvalidInput, match="a revolution needs 4 pulses, got 3"):
        disc_rotation(time=[1.0, 2.0, 3.0], groove_diameter=0.04, magnets=3)


@pytest.mark.parametrize(
    ("interval", "steps"),
    [
        ([1.0, 2.45, 1.0], [1, 2, 1]),  # within a quarter of two
        ([1.0, 2.55, 1.0], [1, 3, 1]),  # within a quarter of three
        ([1.0, 1.52, 1.0], [1, 2, 1]),
        ([1.0, 1.48, 1.0], [1, 1, 1]),  # of one is no missing pulse
        ([1.0, 6.0, 1.0], [1, 6, 1]),  # five are missing
        ([1.0, 7.0, 1.0], [1, 1, 1]),
        ([1.0, 2.0, 2.0, 2.0], [1, 1, 1, 1]),  # a step of speed
        ([2.0, 1.0, 1.0], [2, 1, 1]),  # at the beginning
        ([1.0, 1.0, 3.0], [1, 1, 3]),  # at the end
        ([1.0, 2.45, 1.6], [1, 2, 1]),  # 2.45 and 1.53 times its neighbours: both within a quarter of two
        ([1.0, 2.6, 1.6], [1, 1, 1]),  # 2.6 times is not
        ([1.6, 2.6, 1.0], [1, 1, 1]),
    ],
)
def test_an_interval_is_several_revolutions_where_it_is_a_multiple_of_both_neighbours(
    interval: list[float], steps: list[int]
) -> None:
    found = disc_rotation(time=np.cumsum([0.0, *interval]), groove_diameter=0.05)
    assert np.diff(np.flatnonzero(~found.interpolated)).tolist() == steps


def test_fractions_are_those_of_the_two_revolutions_that_are_most_alike() -> None:
    fractions = np.array([0.2, 0.3, 0.5])
    # five revolutions that slow down, but for the third and fourth, which take 2 s each
    durations = np.repeat([1.6, 1.8, 2.0, 2.0, 2.3], 3)
    times = np.cumsum([0.0, *(np.tile(fractions, 5) * durations)])
    found = disc_rotation(time=times, groove_diameter=0.05, magnets=3)
    assert found.revolutions == approx(np.concatenate([[0.0], np.cumsum(np.tile(fractions, 5))]))
    assert not found.interpolated.any()
    assert found.rotation_speed[[0, -1]] == approx([1 / 1.6, 1 / 2.3])


def test_revolutions_between_pulses_of_a_steady_acceleration_are_close_to_its_parabola() -> None:
    turns = np.arange(12)
    time = np.sqrt(turns + 4.0)  # turns = time^2 - 4
    found = disc_rotation(time=time, groove_diameter=0.05)
    between = np.linspace(2.5, 3.8, 20)
    assert revolutions_at(found, time=between) == approx(between**2 - 4, abs=0.01)
    first, last = found.rotation_speed[0], found.rotation_speed[-1]
    ends = revolutions_at(found, time=[1.0, time[-1] + 0.5])
    assert ends == approx([-first * (2.0 - 1.0), 11 + 0.5 * last])
