"""Mean friction at voltage steps: wobble of either kind, drift, run-in, bursts and noise of known size."""

from itertools import pairwise

import numpy as np
import pytest
from pytest import approx

from sonolube.measurement.friction.force_cycle import StickSlipBurst, StickSlipEstimate, not_detected
from sonolube.measurement.friction.step_means import (
    SampledParts,
    _burst_columns,
    _fixed_columns,
    _trend_columns,
    _trends,
    mean_of_parts,
    sampled_parts,
    without_wobble,
    wobble_columns,
)

TIME = np.arange(0.0, 24.4, 2e-3)
PARTS = [slice(*np.searchsorted(TIME, ends)) for ends in ((1.0, 12.4), (13.0, 16.4), (17.0, 20.4), (21.0, 24.4))]
LEVELS = (0.9, 0.35, 0.2, 0.15)
TURNS = 0.75


@pytest.mark.parametrize("in_proportion", [True, False])
def test_a_wobble_of_either_kind_is_taken_off_down_to_the_noise(in_proportion: bool) -> None:
    noise = 1e-3 * np.random.default_rng(3).standard_normal(TIME.size)
    force = np.zeros(TIME.size)
    for part, level in zip(PARTS, LEVELS, strict=True):
        amplitude = 0.06 * (level if in_proportion else 1.0)
        force[part] = level + amplitude * np.cos(2 * np.pi * TURNS * TIME[part] + 1)
    parts = sampled_parts(PARTS, time=TIME, friction_force=force + noise)
    waves, _ = wobble_columns(parts, revolutions=[TURNS * time for time in parts.times], harmonics=2)
    left = without_wobble(parts, waves)
    assert max(float(np.std(each)) for each in left) < 1.1e-3


def parts_of(times: list[np.ndarray], forces: list[np.ndarray]) -> SampledParts:
    return SampledParts(times=tuple(times), forces=tuple(forces), block_samples=1)


def test_blocks_last_sixteen_milliseconds_and_are_a_fortieth_of_the_shortest_part_at_most() -> None:
    def size(interval: float, *lengths: int) -> int:
        ends = np.cumsum([0, *lengths])
        time = interval * np.arange(ends[-1])
        slices = [slice(a, b) for a, b in pairwise(ends)]
        return sampled_parts(slices, time=time, friction_force=np.ones(time.size)).block_samples

    assert size(2e-3, 1000, 500) == 8
    assert size(2e-3, 1000, 240) == 6  # a fortieth of 240
    assert size(2e-3, 1000, 20) == 1
    assert size(0.1, 1000, 1000) == 1
    assert size(1e-3, 660_000, 80_000) == 37  # no more than 20 000 blocks


def test_missing_samples_are_left_out_and_blocks_are_averages_without_the_rest() -> None:
    time = np.arange(12.0)
    force = np.array([1.0, 2, np.nan, 4, 5, 6, 7, 8, 9, 10, np.nan, 12])
    parts = sampled_parts([slice(0, 6), slice(6, 12)], time=time, friction_force=force)
    assert parts.times[0].tolist() == [0, 1, 3, 4, 5]
    assert parts.forces[1].tolist() == [7, 8, 9, 10, 12]
    blocks = SampledParts(times=parts.times, forces=parts.forces, block_samples=2)
    assert [each.tolist() for each in blocks.averaged(blocks.forces)] == [[1.5, 4.5], [7.5, 9.5]]
    columns = np.column_stack([force[3:10], -2 * force[3:10]])
    assert blocks.averaged([columns])[0].tolist() == [[4.5, -9], [6.5, -13], [8.5, -17]]


def test_given_revolutions_are_corrected_and_less_than_a_turn_is_no_rotation() -> None:
    times = [np.arange(0, 10, 0.02), np.arange(11, 20, 0.02)]
    forces = [2 + 0.1 * np.cos(2 * np.pi * 0.7 * t + 1) for t in times]
    parts = parts_of(times, forces)
    waves, factor = wobble_columns(parts, revolutions=[0.69 * t for t in times], harmonics=1)
    assert factor == approx(0.7 / 0.69, rel=1e-4)
    assert waves is not None
    assert np.std(np.concatenate([f - f.mean() for f in without_wobble(parts, waves)])) < 1e-3
    assert wobble_columns(parts, revolutions=[0.03 * t for t in times], harmonics=1) == (None, 0.0)
    found, speed = wobble_columns(parts, revolutions=None, harmonics=1)
    assert found is not None
    assert speed == approx(0.7, rel=1e-3)
    along, turns = wobble_columns(parts, revolutions=None, harmonics=1, places=[2 * t for t in times])
    assert along is not None
    assert turns == approx(0.35, rel=1e-3)
    rest = np.random.default_rng(1)
    noise = parts_of(times, [rest.standard_normal(t.size) for t in times])
    assert wobble_columns(noise, revolutions=None, harmonics=1) == (None, 0.0)
    assert without_wobble(noise, None)[1] is noise.forces[1]


NONE = not_detected("none", 0.0)


def test_means_of_parts_in_white_noise_have_its_variance_over_their_samples() -> None:
    rng = np.random.default_rng(2)
    times = [np.arange(0, 400) * 0.02, 10 + np.arange(0, 900) * 0.02]
    forces = [level + 0.05 * rng.standard_normal(t.size) for level, t in zip((1.0, 0.4), times, strict=True)]
    found = mean_of_parts(parts_of(times, forces), waves=None, stick_slip=[NONE, NONE], onset=-0.1)
    assert found.friction_force == approx([force.mean() for force in forces], abs=2e-3)
    assert np.sqrt(np.diag(found.covariance)) == approx([0.05 / 20, 0.05 / 30], rel=0.35)


def test_drift_belongs_to_the_mean_of_a_part_and_run_in_does_not() -> None:
    rng = np.random.default_rng(3)
    times = [np.arange(0, 600) * 0.02, 13 + np.arange(0, 400) * 0.02]
    noise = [0.01 * rng.standard_normal(t.size) for t in times]
    drifting = [1 + 0.03 * t + e for t, e in zip(times, noise, strict=True)]
    found = mean_of_parts(parts_of(times, drifting), waves=None, stick_slip=[NONE, NONE], onset=-0.1)
    assert found.friction_force == approx([1 + 0.03 * t.mean() for t in times], abs=3e-3)
    running_in = [1 + 0.5 * np.exp(-(t + 0.1) / 2.0) + e for t, e in zip(times, noise, strict=True)]
    found = mean_of_parts(parts_of(times, running_in), waves=None, stick_slip=[NONE, NONE], onset=-0.1)
    assert found.friction_force == approx([1.0, 1.0], abs=4e-3)
    assert np.sqrt(found.covariance[0, 0]) > 1.2 * 0.01 / np.sqrt(600)


def test_a_noisy_part_does_not_enlarge_the_error_of_a_quiet_one() -> None:
    rng = np.random.default_rng(4)
    times = [np.arange(0, 400) * 0.02, 10 + np.arange(0, 400) * 0.02]
    forces = [1 + scale * rng.standard_normal(400) for scale in (0.1, 0.01)]
    found = mean_of_parts(parts_of(times, forces), waves=None, stick_slip=[NONE, NONE], onset=-0.1)
    assert np.sqrt(np.diag(found.covariance)) == approx([0.1 / 20, 0.01 / 20], rel=0.35)


def test_a_part_shorter_than_a_turn_takes_its_wobble_from_the_others() -> None:
    rng = np.random.default_rng(5)
    times = [np.arange(0, 800) * 0.02, 17 + np.arange(0, 40) * 0.02]
    forces = [
        level + 0.2 * np.cos(2 * np.pi * 0.5 * t) + 0.01 * rng.standard_normal(t.size)
        for level, t in zip((1.0, 0.6), times, strict=True)
    ]
    waves = [np.column_stack([np.cos(np.pi * t), np.sin(np.pi * t)]) for t in times]
    found = mean_of_parts(parts_of(times, forces), waves=waves, stick_slip=[NONE, NONE], onset=-0.1)
    assert found.friction_force == approx([1.0, 0.6], abs=8e-3)


def burst(start: float, end: float, slips: list[float]) -> StickSlipEstimate:
    return StickSlipEstimate(
        stick_slip_frequency=1.0,
        spectral_frequency=1.0,
        force_drops=len(slips),
        bursts=(StickSlipBurst(start_time=start, end_time=end, force_drops=len(slips)),),
        slip_time=np.array(slips),
    )


def test_the_teeth_of_a_burst_rise_from_minus_to_plus_a_half_between_its_slips() -> None:
    t = np.arange(20.0) + 0.5
    # slips at 6, 10 and 12: mean gap 3, so that the burst is from 3 to 15; that at 17 is beyond its end
    teeth, within = _burst_columns(t, burst(3.0, 12.0, [6.0, 10.0, 12.0, 17.0]))
    third, quarter, half = (np.arange(3) + 0.5) / 3 - 0.5, (np.arange(4) + 0.5) / 4 - 0.5, np.array([-0.25, 0.25])
    empty = np.zeros
    assert teeth[:, 0] == approx(np.concatenate([empty(6), quarter, half, empty(8)]))  # whole cycles
    assert teeth[:, 1] == approx(np.concatenate([empty(3), third, empty(14)]))  # before the first slip
    assert teeth[:, 2] == approx(np.concatenate([empty(12), third, empty(5)]))  # after the last
    assert within[:, 0].tolist() == [0] * 3 + [1] * 12 + [0] * 5


def test_a_burst_shifts_a_level_where_a_twentieth_is_within_it_and_without() -> None:
    t = np.arange(100.0) + 0.5

    def shifts(first: float, last: float) -> int:
        slips = np.arange(first + 1, last + 0.01)
        return int(_burst_columns(t, burst(first, last, slips.tolist()))[1].shape[1])

    assert shifts(10.0, 16.0) == 1  # seven samples, with the stick phase after the last slip
    assert shifts(10.0, 13.0) == 0  # four
    assert shifts(2.0, 95.0) == 1
    assert shifts(1.0, 97.0) == 0
    nothing, none = _burst_columns(t, NONE)
    assert (nothing.shape, none.shape) == ((100, 0), (100, 0))
    single, _ = _burst_columns(t, burst(10.0, 20.0, [15.0]))
    assert single.shape == (100, 0)


def test_levels_waves_teeth_and_shifts_stand_side_by_side() -> None:
    times = [np.arange(2.0), np.arange(3.0)]
    parts = parts_of(times, times)
    waves = [np.full((2, 1), 7.0), np.full((3, 1), 8.0)]
    own = [(np.full((2, 1), 3.0), np.empty((2, 0))), (np.full((3, 1), 4.0), np.full((3, 1), 5.0))]
    columns, shifts = _fixed_columns(parts, waves, own)
    assert shifts == 1
    assert columns[0].tolist() == [[1, 0, 7, 3, 0, 0]] * 2
    assert columns[1].tolist() == [[0, 1, 8, 0, 4, 5]] * 3
    assert _fixed_columns(parts, None, own)[0][1].tolist() == [[0, 1, 0, 4, 5]] * 3


def test_run_in_is_offered_in_proportion_to_the_level_for_time_constants_up_to_the_first_part() -> None:
    times = [2 + np.arange(0, 500) * 0.02, 14 + np.arange(0, 200) * 0.02]
    values = [np.full(500, 2.0), np.full(200, -0.5)]
    columns = _trend_columns(parts_of(times, values), values, 1.5)
    first, last = times[0][0], times[1][-1]
    assert columns[0][0, 0] == approx(-0.5)
    assert columns[1][-1, 0] == approx(0.5)
    assert columns[1][10, 0] == approx((times[1][10] - (first + last) / 2) / (last - first))
    span = times[0][-1] - 1.5
    for t, column, share in zip(times, columns, (1.0, -0.25), strict=True):
        assert column[:, 1] == approx(share * np.exp(-(t - 1.5) / (0.05 * span)))
        assert column[:, 12] == approx(share * np.exp(-(t - 1.5) / span))
        assert column[:, 24] == approx(share * (t - 1.5) / span * np.exp(-(t - 1.5) / span))  # by ln tau


def test_the_chances_of_run_in_and_drift_add_up() -> None:
    found = _trends(2.0)
    assert sum(each.probability for each in found) == approx(1.0)
    assert sum(each.probability for each in found if len(each.columns) > 1) == approx(0.5)
    assert sum(each.probability for each in found if 0 in each.columns) == approx(0.1)
    assert {each.deviations[0] for each in found if each.columns == (0,)} == {0.02, 0.2}


def settling(seed: int, share: float) -> tuple[float, float]:
    """Deviation of the mean of a part that settles, and its standard error; drawn as an AR(1) process by hand."""
    rng = np.random.default_rng(seed)
    t, noise = 0.5 + 0.02 * np.arange(500), np.zeros(500)
    for number in range(1, 500):
        noise[number] = 0.6 * noise[number - 1] + 0.01 * rng.standard_normal()
    force = 1 + share * rng.standard_normal() * np.exp(-t / (10 * rng.uniform(0.1, 0.9))) + noise
    found = mean_of_parts(parts_of([t], [force]), waves=None, stick_slip=[NONE], onset=0.0)
    return float(found.friction_force[0]) - 1.0, float(np.sqrt(found.covariance[0, 0]))


@pytest.mark.parametrize("share", [0.0, 0.03, 0.1])
def test_a_mean_errs_as_its_standard_error_states_with_a_run_in_that_may_not_stand_out(share: float) -> None:
    found = np.array([settling(seed, share) for seed in range(24)])
    z = found[:, 0] / found[:, 1]
    assert 0.55 < np.sqrt(np.mean(z**2)) < 1.4  # of 24 standard normal numbers in 99.8 % of cases: 0.58 to 1.45
    assert np.mean(np.abs(z) < 1.96) > 0.8  # 0.95 in the mean; 19 of 24 or fewer in 0.6 % of cases


def test_a_run_in_that_cannot_be_excluded_widens_the_standard_error_of_a_short_part_alone() -> None:
    short, long = (
        mean_of_parts(
            parts_of([t], [1 + 0.01 * np.random.default_rng(6).standard_normal(t.size)]),
            waves=None,
            stick_slip=[NONE],
            onset=t[0] - 0.1,
        )
        for t in (np.arange(0, 100) * 0.02, np.arange(0, 4000) * 0.02)
    )
    assert np.sqrt(short.covariance[0, 0]) > 1.3 * 0.01 / np.sqrt(100)
    assert np.sqrt(long.covariance[0, 0]) < 1.6 * 0.01 / np.sqrt(4000)
