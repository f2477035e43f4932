"""Estimates of stretches combined by hand, and cycles of known shape against their own formula and likelihoods."""

import numpy as np
import pytest
from pytest import approx
from scipy import stats

from sonolube.measurement.friction.force_cycle import (
    StickSlipBurst,
    StickSlipEstimate,
    _aligned,
    _fits,
    _inner,
    _is_steady_in_bursts,
    _other_origin,
    _steadiness,
    combined,
    find_cycle,
    not_detected,
)
from sonolube.measurement.statistics.autocorrelation import statistical_inefficiency

INTERVAL = 1e-3  # s
FREQUENCY = 73.0  # Hz: 13.7 samples a period, of which six harmonics are resolved; far from 50 and 60 Hz


def estimate(frequency: float, fall: float, drops: int, share: float, start: float) -> StickSlipEstimate:
    return StickSlipEstimate(
        stick_slip_frequency=frequency,
        spectral_frequency=frequency + 1,
        stick_slip_amplitude=fall,
        stick_slip_amplitude_uncertainty=fall / 10,
        stick_slip_amplitude_interval=(fall - 0.03, fall + 0.05),
        force_drops=drops,
        stick_slip_fraction=share,
        bursts=(StickSlipBurst(start_time=start, end_time=start + 1, force_drops=drops),),
        slip_time=start + np.arange(drops) / frequency,
    )


def test_stretches_are_weighted_by_their_slips_and_their_time() -> None:
    one, other = estimate(8.0, 0.2, 10, 0.9, 1.0), estimate(5.0, 0.4, 30, 0.5, 9.0)
    whole = combined([one, not_detected("noise", 3.0), other], [2.0, 5.0, 3.0])
    # weights 1/4 and 3/4 of 40 slips: 2 + 3.75 Hz; 0.05 + 0.3 N; error of hypot(0.02/4, 3 * 0.04/4)
    assert whole.detected
    assert whole.stick_slip_frequency == approx(5.75)
    assert whole.stick_slip_amplitude == approx(0.35)
    assert whole.stick_slip_amplitude_uncertainty == approx(np.hypot(0.005, 0.03))
    assert whole.stick_slip_amplitude_interval == approx((0.32, 0.40))
    assert whole.force_drops == 40
    assert whole.stick_slip_fraction == approx((0.9 * 2 + 0.5 * 3) / 10)
    assert whole.spectral_frequency == approx(3.0)  # of the longest
    assert [burst.start_time for burst in whole.bursts] == [1.0, 9.0]
    assert whole.slip_time == approx(np.concatenate([one.slip_time, other.slip_time]))


def test_without_slips_the_reason_is_that_of_the_longest_stretch_or_of_the_unresolved_one() -> None:
    short, long = not_detected("short", 4.0), not_detected("long", 6.0)
    coarse = not_detected("coarse", 99.0, resolved=False)
    assert combined([short, long], [1.0, 2.0]).reason == "long"
    assert combined([short, coarse, long], [1.0, 1.0, 2.0]).reason == "coarse"
    alone = estimate(8.0, 0.2, 10, 0.9, 1.0)
    assert combined([alone], [2.0]) is alone
    nothing = combined([], [])
    assert (nothing.detected, nothing.resolved, nothing.stick_slip_frequency) == (False, True, 0.0)
    assert "without a gap" in nothing.reason
    assert (short.resolved, short.stick_slip_frequency, short.spectral_frequency) == (True, 4.0, 4.0)


def wave(cycles: np.ndarray) -> np.ndarray:
    """Fundamental at its maximum, and harmonics 2 and 6: a skewed cycle in N, 6 being the highest that is resolved."""
    angle = 2 * np.pi * cycles
    return np.asarray(3 * np.cos(angle) - 0.6 * np.sin(2 * angle) + 0.1 * np.cos(6 * angle))


def test_a_steady_cycle_has_the_range_the_fall_and_the_slips_of_its_wave() -> None:
    shift = 0.15
    at = np.arange(1120) * INTERVAL * FREQUENCY + shift
    noise = 0.01 * np.random.default_rng(1).standard_normal(at.size)
    found, reason = find_cycle(wave(at) + noise, sample_interval=INTERVAL, frequency=FREQUENCY)
    assert found is not None
    assert reason == ""
    fine = np.arange(100_000) / 100_000
    top, bottom = fine[np.argmax(wave(fine))], fine[np.argmin(wave(fine))]
    share = (bottom - top) % 1
    assert found.frequency == FREQUENCY
    assert found.fall_share == approx(share, abs=1.5 / 256)
    assert found.falls == approx(np.full(10, np.ptp(wave(fine))), rel=0.01)  # ten sections of eight cycles, 110 samples
    lower = np.ptp(wave(fine) - 0.1 * np.cos(12 * np.pi * fine))
    assert found.truncation == approx(abs(np.ptp(wave(fine)) - lower), abs=0.01)
    assert found.sections.tolist() == [[110 * k, 110 * k + 109] for k in range(10)]
    middles = (top + share / 2 - shift + np.arange(90)) / (FREQUENCY * INTERVAL)
    expected = np.ceil(middles[(middles > 0) & (middles < 1100)])
    missed = [slip for slip in expected if np.min(np.abs(found.slips - slip)) > 1]
    wrong = [slip for slip in found.slips if np.min(np.abs(expected - slip)) > 1]
    assert len(missed) <= 1  # where two sections meet
    assert len(wrong) <= 1


def test_a_sine_falls_in_half_its_period_and_needs_six_samples_and_six_sections() -> None:
    def found(frequency: float, samples: int) -> bool:
        signal = np.cos(2 * np.pi * frequency * INTERVAL * np.arange(samples))
        signal += 1e-3 * np.random.default_rng(2).standard_normal(samples)
        return find_cycle(signal, sample_interval=INTERVAL, frequency=frequency)[0] is not None

    assert found(160.0, 300)  # 6.25 samples a period, six sections of 50
    assert not found(160.0, 299)
    assert not found(168.0, 300)  # 5.95 samples a period
    at = np.arange(600) * INTERVAL
    sine, _ = find_cycle(2 * np.sin(2 * np.pi * 80 * at), sample_interval=INTERVAL, frequency=80.0)
    assert sine is not None
    assert sine.fall_share == approx(0.5, abs=0.01)
    assert sine.falls == approx(4.0)
    assert find_cycle(np.ones(600), sample_interval=INTERVAL, frequency=0.0) == (None, "")


def test_a_cycle_that_rises_faster_than_it_falls_is_named() -> None:
    angle = 2 * np.pi * FREQUENCY * INTERVAL * np.arange(1120)
    slow = 3 * np.cos(angle) - 1.2 * np.sin(2 * angle)
    assert find_cycle(slow, sample_interval=INTERVAL, frequency=FREQUENCY) == (
        None,
        "the force rises faster than it falls in the cycle of 73 Hz",
    )
    assert find_cycle(slow[::-1], sample_interval=INTERVAL, frequency=FREQUENCY)[0] is not None


@pytest.mark.parametrize(
    ("frequency", "duration", "has_bursts", "word"),
    [
        (29.9, 100.0, False, "falls as slowly as it rises"),
        (29.9, 100.0, True, "falls as slowly as it rises"),
        (30.1, 100.0, False, ""),
        (150.29, 100.0, False, "hum of the mains"),  # within 0.3 Hz of three times 50 Hz
        (150.31, 100.0, False, ""),
        (149.71, 100.0, False, "hum of the mains"),
        (179.71, 100.0, False, "hum of the mains"),  # of three times 60 Hz
        (150.4, 1.0, False, "hum of the mains"),  # half a cycle in a second
        (150.51, 1.0, False, ""),
        (150.0, 100.0, True, ""),  # hum has no bursts
    ],
)
def test_a_slow_fall_is_wobble_below_thirty_hertz_and_hum_at_multiples_of_the_mains(
    frequency: float, duration: float, has_bursts: bool, word: str
) -> None:
    reason = _other_origin(frequency, duration, has_bursts=has_bursts)
    assert word in reason
    assert bool(reason) == bool(word)


def test_the_fit_of_a_section_returns_its_coefficients_beside_level_and_drift() -> None:
    cycles = np.arange(100) / 12.5
    angle = 2 * np.pi * cycles
    first = (
        5 + 0.3 * cycles + 2 * np.cos(angle) - 1 * np.sin(angle) + 0.5 * np.cos(2 * angle) + 0.25 * np.sin(2 * angle)
    )
    noise = np.random.default_rng(3).standard_normal(100)
    coefficients, filled = _fits(np.stack([first, noise]), 12.5, 2)
    assert coefficients.shape == (2, 4)
    assert coefficients[0] == approx([2, 0.5, -1, 0.25])  # cosines, then sines
    assert filled.tolist() == [True, False]  # four of a hundred degrees of freedom hold no half of noise


def test_the_score_of_a_steady_power_is_the_likelihood_ratio_of_gamma_over_exponential() -> None:
    power = stats.gamma(9.0, scale=0.4).rvs(300, random_state=4)
    shape, _, _ = stats.gamma.fit(power, floc=0)
    ratio = stats.gamma(shape, scale=power.mean() / shape).logpdf(power).sum()
    ratio -= stats.expon(scale=power.mean()).logpdf(power).sum()
    assert _steadiness(power) == approx(ratio / statistical_inefficiency(power), rel=1e-3)
    assert _steadiness(stats.expon().rvs(4000, random_state=5)) < 3  # chi-squared of one degree over two
    assert _steadiness(np.array([1.0, 0.0, 2.0])) == 0.0


def test_the_score_of_bursts_is_the_likelihood_ratio_of_normal_over_exponential() -> None:
    rng = np.random.default_rng(6)
    empty = np.array([False] * 40 + [True] * 10)
    for size in range(8, 40):
        own = 1 + 0.2 * rng.uniform(-1, 1, size)
        power = np.concatenate([own, np.zeros(40 - size), np.full(10, 0.05)])
        whole = np.arange(50) < size
        ratio = stats.norm(own.mean(), own.std()).logpdf(own).sum()
        ratio -= stats.expon(own.min(), own.mean() - own.min()).logpdf(own).sum()
        assert _is_steady_in_bursts(power, whole, empty) == (ratio / statistical_inefficiency(own) >= 12)


def test_bursts_are_steady_where_six_sections_vary_by_less_than_three_tenths_and_leave_a_tenth() -> None:
    def steady(*, deviation: float = 0.1, between: float = 0.0, sections: int = 100, gaps: bool = True) -> bool:
        own = np.tile([1 - deviation, 1 + deviation], sections // 2 + 1)[:sections]
        if sections >= 100:
            own[0] = 1 - 12 * deviation / 4  # one weak section: no threshold
        power = np.append(own, np.full(10, between))
        whole = np.arange(power.size) < sections
        return _is_steady_in_bursts(power, whole, ~whole & gaps)

    assert steady()
    assert steady(deviation=0.28)
    assert not steady(deviation=0.32)
    assert steady(between=0.099)
    assert not steady(between=0.101)
    assert not steady(gaps=False)
    assert steady(deviation=0.0, sections=6)  # an equal power needs no likelihood
    assert not steady(deviation=0.0, sections=5)


def test_an_inner_section_has_both_neighbours() -> None:
    chosen = np.array([True, True, False, True, True, True, False, True])
    assert _inner(chosen).tolist() == [True, False, False, False, True, False, False, False]
    assert _inner(np.array([False, True, True])).tolist() == [False, False, True]


def test_sections_are_turned_to_a_fundamental_of_phase_zero_before_their_mean() -> None:
    shifts = np.array([0.1, -0.2, 0.35])
    turns = 2 * np.pi * shifts
    # cos(x + s) + 0.5 sin(2 x + 2 s): cosines (1st, 2nd), then sines
    sections = np.stack([np.cos(turns), 0.5 * np.sin(2 * turns), -np.sin(turns), 0.5 * np.cos(2 * turns)], axis=1)
    mean, found = _aligned(sections, 2)
    phases = 2 * np.pi * np.arange(256) / 256
    assert found == approx(shifts)
    assert mean == approx(np.cos(phases) + 0.5 * np.sin(2 * phases))
