"""Falls, durations and standard errors of slips computed by hand, and parts of a recording."""

import numpy as np
import pytest
from pytest import approx, raises
from scipy import stats

from sonolube.errors import InvalidInput
from sonolube.measurement.friction.force_cycle import ForceCycle
from sonolube.measurement.friction.slip_events import SlipChain
from sonolube.measurement.friction.stick_slip import (
    _at_steepest,
    _by_cycle,
    _by_slips,
    _falls,
    _has_frequency,
    _is_smooth,
    _mean_profile,
    _slip_duration,
    _spectral_peak,
    _standard_error,
    _within_range,
    _without_false_ends,
    estimate_stick_slip,
    stick_slip_of_parts,
)

PERIOD = 40


def teeth(heights: list[float], *, period: int = PERIOD, fall: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Stick phases that rise by given heights from level 1, and the samples at which each begins, and the end."""
    ramps = [1 + height * ((np.arange(period) + 0.5) / period - 0.5) for height in heights]
    signal = np.concatenate(ramps)
    if fall:
        signal = np.convolve(np.pad(signal, fall, mode="edge"), np.ones(fall) / fall, "same")[fall:-fall]
    return signal, period * np.arange(len(heights) + 1)


def test_the_rise_of_each_stick_phase_is_its_slope_times_its_duration() -> None:
    signal, at = teeth([0.2, 0.3, 0.1])
    falls, noise = _falls(signal, [at[:3], at[2:]])
    assert falls == approx([0.2, 0.3, 0.1])
    assert noise == approx(0.0, abs=1e-12)
    rng = np.random.default_rng(1)
    many, places = teeth([0.2] * 200)
    assert _falls(many + 0.05 * rng.standard_normal(many.size), [places])[1] == approx(0.05, rel=0.05)


def test_the_weight_of_a_stick_phase_vanishes_at_the_slips_and_is_even() -> None:
    signal, at = teeth([0.2])
    x = (2 * np.arange(PERIOD) + 1) / PERIOD - 1
    ringing = np.zeros(PERIOD)
    ringing[[0, -1]] = 1.0, -0.5
    weight = (1 - x**2) ** 2
    # a disturbance d changes the rise by 2 sum(w x d)/sum(w x^2)
    change = 2 * float(np.sum(weight * x * ringing) / np.sum(weight * x**2))
    assert abs(change) < 0.0025  # of 1.5
    assert _falls(signal + ringing, [at])[0] == approx([0.2 + change])


def test_ends_of_a_burst_that_rise_too_little_are_no_slips() -> None:
    signal, at = teeth([0.02, 0.2, 0.05, 0.2, 0.03])
    assert _without_false_ends(signal, at, 0.1).tolist() == [40, 80, 120, 160]
    assert _without_false_ends(signal, at, 0.01).tolist() == at.tolist()
    assert _without_false_ends(signal, at, 0.3).tolist() == at.tolist()  # none is enough: as it was


def test_a_slip_is_moved_to_where_the_force_falls() -> None:
    signal, at = teeth([0.2] * 6)
    shifted = at[1:-1] + np.array([1, -2, 2, 0, -1])
    assert _at_steepest(signal, shifted).tolist() == at[1:-1].tolist()
    edge = np.array([3, 40, 80, 238])  # too near to the ends of the signal to be moved
    assert _at_steepest(signal, edge).tolist() == [3, 40, 80, 238]


def test_the_standard_error_counts_the_slip_that_neighbours_share() -> None:
    # residuals 1, 2, -1, -2 about 5: variance 10/3; neighbours 2 - 2 + 2 = 2 over 3, plus 10/12
    falls = np.array([6.0, 7.0, 4.0, 3.0])
    assert _standard_error(falls) == approx(np.sqrt((10 / 3 + 2 * (2 / 3 + 10 / 12)) / 4))
    # residuals 1, -1, 1, -1: neighbours -1 + 1/3 below zero do not count; variance 4/3
    assert _standard_error(np.array([6.0, 4.0, 6.0, 4.0])) == approx(np.sqrt(4 / 3 / 4))
    assert _standard_error(np.array([6.0, 4.0])) == approx(np.sqrt(2.0 / 2))
    assert _standard_error(np.array([6.0])) == np.inf


def test_the_mean_profile_is_of_the_slips_that_have_room() -> None:
    signal = np.arange(100.0)
    bursts = [np.array([3, 23, 43]), np.array([70, 92])]  # gaps 20, 20, 22: a quarter is five samples
    assert _mean_profile(signal, bursts, 0.25) == approx(np.mean([23, 43, 70, 92]) + np.arange(-5, 5))
    assert _mean_profile(signal, [np.array([10, 25, 55, 90])], 0.5) == approx(np.mean([25, 55]) + np.arange(-15, 15))
    assert _mean_profile(np.zeros(20), [np.array([4, 24])], 0.5).size == 0
    assert _mean_profile(signal, [np.array([50, 52])], 0.25) == approx(51 + np.arange(-2, 2))  # two samples at least


@pytest.mark.parametrize("duration", [4, 6, 8])
def test_a_linear_fall_takes_its_samples(duration: int) -> None:
    phase = (np.arange(1200) + 0.5) % 100
    rise = 100.0 - duration
    force = np.where(phase < rise, phase / rise, (100 - phase) / duration) - 0.5
    at = np.arange(1, 11) * 100 - duration // 2
    # between the levels of a quarter of a period around it; the ramps there cut the fall by their own slope
    assert _slip_duration(force, [at], 1.0) == approx(duration, rel=0.12)


def test_a_fall_between_two_samples_takes_none_and_ringing_is_no_duration() -> None:
    signal, at = teeth([1.0] * 8)
    assert _slip_duration(signal, [at[1:-1]], 1.0) == 0.0
    signal[at[1:-1] + 2] -= 0.9  # the reading overshoots by more than 0.8 below the middle
    assert _slip_duration(signal, [at[1:-1]], 1.0) == 0.0
    assert _slip_duration(np.zeros(30), [np.array([2, 28])], 1.0) == 0.0  # no room for a profile


def test_the_interval_of_a_fall_is_neither_negative_nor_wider_than_the_force() -> None:
    force = np.array([1.0, 3.5])
    assert _within_range(1.0, 0.4, force) == approx((0.6, 1.4))
    assert _within_range(1.0, 2.0, force) == approx((0.0, 2.5))


@pytest.mark.parametrize("frequency", [9.0, 31.4, 180.3])
def test_the_spectrum_peaks_at_a_line_and_holds_its_share(frequency: float) -> None:
    t = np.arange(2000.0) * 2e-3
    rng = np.random.default_rng(2)
    sine = np.sqrt(2) * np.sin(2 * np.pi * frequency * t + 0.4)
    found, share = _spectral_peak(sine, 2e-3)
    assert found == approx(frequency, abs=0.005)
    assert share > 0.99
    mixed, half = _spectral_peak(sine + rng.standard_normal(t.size), 2e-3)  # as much noise as line
    assert mixed == approx(frequency, abs=0.02)
    assert half == approx(0.5, abs=0.06)


def test_drift_below_two_cycles_is_no_line() -> None:
    t = np.arange(2000.0) * 2e-3
    slow = np.cos(2 * np.pi * 0.3 * t) + 0.1 * np.cos(2 * np.pi * 20 * t)
    assert _spectral_peak(slow, 2e-3)[0] == approx(20.0, abs=0.01)


def cycle(*, share: float, frequency: float = 50.0) -> ForceCycle:
    return ForceCycle(
        frequency=frequency,
        fall_share=share,
        falls=np.array([0.9, 1.1, 1.0, 1.2, 0.8, 1.0]),
        truncation=0.05,
        slips=np.arange(3),
        sections=np.array([[0, 159], [160, 319], [640, 799], [800, 959]]),
    )


def test_a_cycle_is_smooth_above_a_fifth_or_below_sixteen_samples() -> None:
    assert _is_smooth(cycle(share=0.21), 1e-3)
    assert not _is_smooth(cycle(share=0.19), 1e-3)  # twenty samples a period
    assert _is_smooth(cycle(share=0.19, frequency=63.0), 1e-3)  # 15.9
    assert not _is_smooth(cycle(share=0.19, frequency=62.0), 1e-3)  # 16.1


def test_slips_have_a_frequency_within_a_tenth() -> None:
    chain = SlipChain(bursts=(np.array([0, 20, 40]), np.array([100, 122])))  # mean gap 62/3
    assert _has_frequency(chain, 3 / 62)
    assert _has_frequency(chain, 1.09 * 3 / 62)
    assert not _has_frequency(chain, 1.11 * 3 / 62)
    assert not _has_frequency(chain, 0.89 * 3 / 62)
    assert not _has_frequency(SlipChain(), 3 / 62)


def test_a_steady_cycle_in_two_bursts_is_reported_by_its_sections() -> None:
    t = np.arange(1001.0) * 1e-3 + 5
    force = np.linspace(0, 4, 1001)
    found = _by_cycle(t, force, cycle(share=0.5), 49.0)
    assert (found.stick_slip_frequency, found.spectral_frequency) == (50.0, 49.0)
    assert found.stick_slip_amplitude == approx(1.0)
    assert [b.start_time for b in found.bursts] == approx([5.0, 5.64])
    assert [b.end_time for b in found.bursts] == approx([5.319, 5.959])
    assert [b.force_drops for b in found.bursts] == [16, 16]  # 0.319 s times 50 Hz is 15.95
    assert found.force_drops == 32
    assert found.stick_slip_fraction == approx(0.638)
    # one sample of a period of twenty: 0.05 N, as much as the truncation; Student's interval about the mean beside it
    low, high = found.stick_slip_amplitude_interval
    assert low + high == approx(2.0)
    error = found.stick_slip_amplitude_uncertainty
    least = 0.05 + stats.t.ppf(0.975, 5) * np.std([0.9, 1.1, 1.0, 1.2, 0.8, 1.0], ddof=1) / np.sqrt(6)
    assert high - 1.0 >= 0.05 + 1.9 * error
    assert high - 1.0 == approx(least, rel=0.5)
    assert _by_cycle(t, force / 8, cycle(share=0.5), 49.0).stick_slip_amplitude == approx(0.5)  # the range of the force


def test_the_estimate_by_slips_spans_from_the_stick_before_the_first_slip() -> None:
    signal, at = teeth([0.2, 0.2, 0.2, 0.2, 0.2])
    t = 3 + 0.01 * np.arange(float(signal.size))
    found = _by_slips(t, signal, [at[1:-1]], 2.4)
    assert found.stick_slip_frequency == approx(1 / 0.4)
    assert found.spectral_frequency == 2.4
    assert found.stick_slip_amplitude == approx(0.2, rel=0.03)
    (burst,) = found.bursts
    assert (burst.start_time, burst.end_time) == approx((3.0, 4.6))
    assert burst.force_drops == 4
    assert found.force_drops == 4
    assert found.slip_time == approx(3 + 0.01 * (at[1:-1] - 0.5))  # between the samples
    assert found.stick_slip_fraction == approx(1.6 / 1.99)


def test_the_estimate_of_rises_of_unequal_height_has_students_interval_and_one_sample() -> None:
    heights = [0.2, 0.24, 0.18, 0.22, 0.16, 0.2]
    signal, at = teeth([0.2, *heights, 0.2])
    signal = signal + 0.04 * np.random.default_rng(3).standard_normal(signal.size)  # so that slips are left in place
    t = 0.01 * np.arange(float(signal.size))
    burst = at[1:-1]
    falls, noise = _falls(signal, [burst])
    assert noise * 8 > np.median(falls)
    found = _by_slips(t, signal, [burst], 2.5)
    mean, error = float(falls.mean()), _standard_error(falls)
    assert found.stick_slip_amplitude == approx(mean)
    assert found.stick_slip_amplitude_uncertainty == approx(error)
    reach = stats.t.ppf(0.975, 5) * error + mean / 40  # what the force rises in one sample of forty
    assert found.stick_slip_amplitude_interval == approx((mean - reach, mean + reach))


def test_parts_are_judged_one_by_one_at_their_common_interval() -> None:
    t = np.arange(4000.0) * 1e-3
    rng = np.random.default_rng(4)
    noisy = [0.01 * rng.standard_normal(t.size) for _ in range(2)]
    slipping = 1 + 0.25 * ((8 * t + 0.3) % 1) + noisy[0]
    found = stick_slip_of_parts([t, t + 10, t[:50] + 20, t + 30], [slipping, 1 + noisy[1], noisy[0][:50], 0 * t + 2])
    assert [each.detected for each in found] == [True, False, False, False]
    assert found[0].stick_slip_frequency == approx(8, rel=0.01)
    assert "no more than noise explains" in found[1].reason
    assert "sought up to 167 Hz" in found[1].reason  # six samples a period
    assert "without a gap" in found[2].reason
    assert found[3].reason == "the friction is constant"
    with raises(InvalidInput, match="has 63 samples without an even stretch of 64"):
        stick_slip_of_parts([t[:63], t[:20]], [t[:63], t[:20]])


def test_the_smallest_fall_that_counts_must_be_positive_and_is_inclusive_of_none_below() -> None:
    t = np.arange(4000.0) * 1e-3
    force = 1 + 0.25 * ((8 * t + 0.3) % 1) + 0.01 * np.random.default_rng(5).standard_normal(t.size)
    with raises(InvalidInput, match="minimum_drop must be positive"):
        estimate_stick_slip(time=t, friction_force=force, minimum_drop=0.0)
    assert estimate_stick_slip(time=t, friction_force=force, minimum_drop=0.24).detected
    assert not estimate_stick_slip(time=t, friction_force=force, minimum_drop=0.26).detected


def test_a_line_of_less_than_six_samples_a_period_is_unresolved_only_where_it_dominates() -> None:
    t = np.arange(2000) / 400
    rng = np.random.default_rng(6)
    line, noise = np.sin(2 * np.pi * 90 * t), rng.standard_normal(t.size)
    found = estimate_stick_slip(time=t, friction_force=line + 0.3 * noise)
    assert not found.resolved
    assert "the force swings at 90 Hz, 4.4 samples a period; sample at 1.1e+03 Hz or more" in found.reason
    assert estimate_stick_slip(time=t, friction_force=0.5 * line + noise).resolved
