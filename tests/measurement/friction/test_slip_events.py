"""Chains of slips by hand, spectra of known noise, and the matched filter against correlation in time."""

import itertools

import numpy as np
import pytest
from pytest import approx

from sonolube.measurement.friction.slip_events import (
    _best_chain,
    _bursts,
    _maxima,
    _periods,
    _sawtooth_power,
    _smoothed,
    find_slips,
    noise_spectra,
)


def peaks(size: int, heights: dict[int, float]) -> np.ndarray:
    response = np.zeros(size)
    for place, height in heights.items():
        response[place] = height
    return response


def test_a_local_maximum_exceeds_what_follows_and_is_not_below_what_precedes() -> None:
    response = np.array([2.0, 1.0, 3.0, 3.0, 1.0, 4.0, 5.0, 6.0])
    assert _maxima(response).tolist() == [False, False, True, False, False, False]  # of the inner six


def test_a_chain_links_maxima_six_tenths_to_sixteen_tenths_of_a_period_apart() -> None:
    # period 10: gaps of 6 to 16 samples. Each of height 4 gains 8 - 2 = 6.
    response = peaks(60, {5: 4.0, 10: 3.0, 11: 4.0, 27: 4.0, 44: 4.0})
    score, chain = _best_chain(response, 10, 2.0)
    assert chain.tolist() == [5, 11, 27]  # 17 samples on it ends; 10 is too near to 5 and worth less
    assert score == approx(18.0)
    assert _best_chain(peaks(60, {5: 4.0, 10: 4.0}), 10, 2.0)[1].size == 1
    assert _best_chain(peaks(60, {5: 4.0, 11: 4.0}), 10, 2.0)[1].tolist() == [5, 11]
    assert _best_chain(peaks(60, {5: 4.0, 21: 4.0}), 10, 2.0)[1].tolist() == [5, 21]
    assert _best_chain(peaks(60, {5: 4.0, 22: 4.0}), 10, 2.0)[1].size == 1


def test_a_slip_counts_up_to_eight_standard_deviations_and_from_one_and_a_half() -> None:
    assert _best_chain(peaks(20, {7: 9.0}), 5, 3.0)[0] == approx(8**2 / 2 - 3)
    assert _best_chain(peaks(20, {7: 7.0}), 5, 3.0)[0] == approx(7**2 / 2 - 3)
    assert _best_chain(peaks(20, {7: 1.6}), 5, 0.5)[0] == approx(1.28 - 0.5)
    score, nothing = _best_chain(peaks(20, {7: 1.4}), 5, 0.5)
    assert (score, nothing.size) == (0.0, 0)
    # a weak slip is left out of the chain unless it joins stronger ones
    response = peaks(60, {10: 4.0, 20: 2.0, 30: 4.0})
    assert _best_chain(response, 10, 2.5)[1].tolist() == [10, 20, 30]  # 5.5 - 0.5 + 5.5
    assert _best_chain(peaks(60, {10: 2.0, 20: 4.0}), 10, 2.5)[1].tolist() == [20]


def test_further_bursts_are_chains_that_would_be_detected_alone() -> None:
    strong = dict.fromkeys((20, 30, 40, 50), 5.0)  # 4 (12.5 - 2) = 42
    later = dict.fromkeys((120, 130, 140, 150), 4.5)  # 4 (10.125 - 2) = 32.5
    weak = dict.fromkeys((220, 230, 240, 250), 3.5)  # 4 (6.125 - 2) = 16.5, below 20
    response = peaks(300, {**later, **strong, **weak, 160: 2.1})  # the last below half of the median
    first = _best_chain(response, 10, 2.0)[1]
    found = _bursts(response, 10, 2.0, first, 3)
    assert [burst.tolist() for burst in found] == [[23, 33, 43, 53], [123, 133, 143, 153]]


def test_the_periods_are_spaced_by_root_two_from_the_shortest_resolved_to_a_quarter_of_the_signal() -> None:
    coarse = _periods(1000, 1e-3)  # six samples to 250
    assert coarse == [round(6 * 2 ** (k / 2)) for k in range(11)]
    assert 6 * 2 ** (11 / 2) > 250 > coarse[-1]
    fine = _periods(100_000, 1e-4)  # two milliseconds to a second
    assert fine[0] == 20
    assert fine[-1] <= 10_000 < fine[-1] * 1.5
    assert _periods(23, 1e-3) == []
    assert _periods(24, 1e-3) == [6]


@pytest.mark.parametrize("gaps", [(10, 14, 8), (9, 9, 21)])
def test_a_sawtooth_explains_its_own_sum_of_squares(gaps: tuple[int, ...]) -> None:
    burst = 5 + np.cumsum([0, *gaps])
    signal = np.full(80, 7.0)
    for first, last in itertools.pairwise(burst):
        signal[first:last] = 0.3 * ((np.arange(last - first) + 0.5) / (last - first) - 0.5)
    # sum of ((i + 1/2)/n - 1/2)^2 over i is (n - 1/n)/12
    power = 0.09 * sum((n - 1 / n) / 12 for n in gaps)
    assert _sawtooth_power(signal, [burst]) == approx(power)
    assert _sawtooth_power(-signal, [burst]) == 0.0
    assert _sawtooth_power(signal, []) == 0.0
    two = np.concatenate([signal, signal])
    assert _sawtooth_power(two, [burst, burst + 80]) == approx(2 * power)


def test_a_spectrum_in_proportion_to_frequency_keeps_its_slope_and_low_bins_are_raised_thirtyfold() -> None:
    logs = np.arange(60.0)
    smooth = _smoothed(logs)
    assert smooth[0] == approx(1.5 + np.log(30))  # of the first bin, the median of bins 1 and 2
    assert smooth[1] == approx(1.5)
    assert smooth[2:50] == approx(logs[2:50])
    spike = np.zeros(60)
    spike[[3, 30]] = 9.0
    assert _smoothed(spike)[1:] == approx(0.0)  # a line is left out
    step = np.where(np.arange(60) < 6, 5.0, 0.0)
    assert _smoothed(step)[[4, 5, 6, 7]] == approx([5.0, 5.0, 0.0, 0.0])  # steep at low frequency stays steep


def test_white_noise_has_its_variance_at_every_frequency_and_parts_keep_their_strength() -> None:
    rng = np.random.default_rng(1)
    quiet, loud = 0.1 * rng.standard_normal(20_000), 3.0 * rng.standard_normal(30_000)
    one, other = noise_spectra([quiet, loud], sample_interval=1e-3)
    assert one.size == other.size == 251  # segments of half a second
    assert np.median(one[1:]) == approx(0.01, rel=0.15)
    assert np.median(other[1:]) == approx(9.0, rel=0.15)
    assert one[0] / one[1] > 20  # up to the lower of own and common
    (short,) = noise_spectra([rng.standard_normal(400)], sample_interval=1e-3)
    assert short.size == 51  # a quarter of the signal
    (slow,) = noise_spectra([rng.standard_normal(400)], sample_interval=0.1)
    assert slow.size == 9  # sixteen samples at least


def test_a_line_in_one_part_is_no_noise() -> None:
    rng = np.random.default_rng(2)
    quiet = rng.standard_normal(20_000)
    lined = rng.standard_normal(20_000) + 5 * np.sin(2 * np.pi * 0.1 * np.arange(20_000))
    spectra = noise_spectra([lined, quiet, quiet[::-1]], sample_interval=1e-3)
    assert spectra[0][50] < 2.0  # a tenth of a cycle a sample is bin 50 of 500


def test_the_silence_of_a_recording_without_noise_has_a_floor_below_the_signal() -> None:
    signal = np.sin(2 * np.pi * 0.1 * np.arange(4000))
    (spectrum,) = noise_spectra([signal], sample_interval=1e-3)
    # 1e-4 of the mean square 1/2, over ln 2 for the median
    assert np.median(spectrum) == approx(1e-4 * 0.5 / np.log(2), rel=0.01)


def sawtooth(period: int, slips: int, *, before: int, after: int) -> tuple[np.ndarray, np.ndarray]:
    """Unit falls within a sawtooth that begins and ends at its mean, in silence, and the samples after the falls."""
    ramp = (np.arange(period) + 0.5) / period - 0.5
    teeth = np.tile(ramp, slips + 1)[period // 2 : -(period // 2)]
    signal = np.concatenate([np.zeros(before), teeth, np.zeros(after)])
    return signal, before + period // 2 + period * np.arange(slips)


def test_slips_are_found_at_their_samples_and_none_beside_them() -> None:
    signal, at = sawtooth(40, 12, before=300, after=400)
    noise = 0.05
    signal = signal + noise * np.random.default_rng(3).standard_normal(signal.size)
    chain = find_slips(signal, spectrum=np.full(101, noise**2), sample_interval=1e-3)
    (burst,) = chain.bursts
    assert set(at) <= set(burst.tolist())
    assert burst.size <= at.size + 2
    assert chain.score > 20


@pytest.mark.parametrize("noise", [0.35, 0.5])
def test_the_score_of_weak_slips_is_that_of_the_filter_in_time(noise: float) -> None:
    # the template of 40 samples is the signal about a slip: z = sqrt(2 sum ((i + 1/2)/40)^2)/noise, i < 20
    signal, at = sawtooth(40, 14, before=200, after=200)
    chain = find_slips(signal, spectrum=np.full(201, noise**2), sample_interval=1e-3)
    half = np.arange(20)
    template = np.concatenate([(half + 0.5) / 40, (half - 19.5) / 40])
    response = np.correlate(signal, template, "valid") / (noise * np.linalg.norm(template))
    z = np.linalg.norm(template) / noise
    assert response[at - 20] == approx(z)
    per_period = -response[: response.size // 40 * 40].reshape(-1, 40).min(axis=1)
    rise = max(1.5, float(np.median(per_period))) ** 2
    cost = rise / 2 + max(1.0, rise / 6)
    assert [burst.tolist() for burst in chain.bursts] == [at.tolist()]
    rises = _best_chain(-response, 40, cost)[0]
    score = 14 * (z**2 / 2 - cost)
    assert chain.score == approx(min(score - rises, 2 * (score - 1.5 * rises)), rel=1e-6)


def test_three_slips_are_no_chain() -> None:
    signal, _ = sawtooth(40, 3, before=300, after=300)
    chain = find_slips(signal, spectrum=np.full(101, 0.05**2), sample_interval=1e-3)
    assert not chain.bursts
