"""Slips in a friction force: matched filter of a sawtooth in noise of any colour, and chains of recurring slips."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter, uniform_filter1d

from sonolube.checks import Floats

Indices = NDArray[np.int64]

DETECTION_SCORE = 20.0
"""Excess of the log-likelihood ratio of a chain of falls over that of rises from which it is stick-slip."""

_SEGMENT = 0.5  # s, of the spectrum of the noise
_LONGEST_PERIOD = 1.0  # s; slower sawteeth cannot be told from drift
_SHORTEST_PERIOD = 2e-3  # s
_SHORTEST_SAMPLES = 6  # of a period, below which its shape is not resolved
_SCALE_RATIO = np.sqrt(2)  # between the periods of neighbouring templates
_GAPS = 0.6, 1.6  # shortest and longest time between slips over the period of the template
_LARGEST_RESPONSE = 8.0  # counted of one slip, in standard deviations, so that no single step makes a chain
_MIN_RESPONSE = 1.5
_EVENT_COST = 1.0  # beyond that of the largest rise in a period
_RISE_SPREAD = 6.0  # square of a rise over the further cost, against the random walk of scores of large symmetric waves
_RISE_RATIO = 1.5  # of the scores of falls and rises, which are equal for whatever is symmetric in time
_FILLED = 0.7  # of the signal, by slips that are sought without a spectrum of the noise
_CLEAR_GAIN = 15.0  # score of each of them; noise with memory stays below
_WEAKEST = 0.5  # of the median response of a chain, below which its first and last slips are noise
_FEWEST = 4  # slips in a chain
_FLOOR = 1e-4  # least power of the noise over that of the signal, where a recording is free of noise
_SMOOTHING = 4  # bins on either side over which the spectrum is smoothed


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class SlipChain:
    """Slips that recur, by the template with the highest score.

    Parameters
    ----------
    bursts : tuple of ndarray of int
        Indices of the samples after each fall, one array per burst of consecutive slips.
    score : float
        Of the highest-scoring burst; stick-slip from `DETECTION_SCORE` on.
    """

    bursts: tuple[Indices, ...] = ()
    score: float = 0.0


def noise_spectra(parts: Sequence[Floats], *, sample_interval: float) -> list[Floats]:
    """Power spectrum of the noise in each part of a signal, smoothed.

    Parameters
    ----------
    parts : sequence of ndarray
        Evenly spaced, each of at least 64 samples.
    sample_interval : float
        Time between samples. [s]

    Returns
    -------
    list of ndarray, shape (segment // 2 + 1,)
        In units of the signal squared per sample, over frequencies up to half the sampling rate. What lies below the
        first bin is raised thirtyfold, so that drift has no weight.

    Notes
    -----
    Medians over segments of half a second and over neighbouring frequencies leave out bursts and lines, such as
    stick-slip itself. The spectrum of a part is the lower, at each frequency, of its own and of the median over all
    parts, each scaled to the median of the part over frequencies: noise may differ between parts in strength.
    """
    size = int(min(min(part.size for part in parts) // 4, max(16, round(_SEGMENT / sample_interval))))
    window = np.hanning(size + 2)[1:-1]
    power = []
    for part in parts:
        segments = np.lib.stride_tricks.sliding_window_view(part, size)[:: max(1, size // 2)]
        segments = segments - segments.mean(axis=1, keepdims=True)
        floor = max(_FLOOR * float(np.mean(part**2)), 1e-300)
        power.append(np.maximum(np.abs(np.fft.rfft(segments * window, axis=1)) ** 2 / (window @ window), floor))
    own = [_smoothed(np.log(np.median(one, axis=0) / np.log(2))) for one in power]
    scales = [float(np.median(logs)) for logs in own]
    scaled = [one / np.exp(scale) for one, scale in zip(power, scales, strict=True)]
    common = _smoothed(np.log(np.median(np.concatenate(scaled), axis=0) / np.log(2)))
    return [np.exp(np.minimum(logs, common + scale)) for logs, scale in zip(own, scales, strict=True)]


def _smoothed(logs: Floats) -> Floats:
    """Logarithm of a spectrum smoothed over neighbouring frequencies."""
    smooth = uniform_filter1d(median_filter(logs, 2 * _SMOOTHING + 1, mode="nearest"), 7, mode="nearest")
    for k in range(min(2 * _SMOOTHING + 1, logs.size)):  # narrower where the spectrum of drift is steep
        half = min(max(k // 2, 1), _SMOOTHING)
        smooth[k] = np.median(logs[max(1, k - half) : k + half + 1])
    smooth[0] = smooth[min(1, smooth.size - 1)] + np.log(30.0)
    return np.asarray(smooth)


def find_slips(signal: Floats, *, spectrum: Floats, sample_interval: float) -> SlipChain:
    r"""Recurring slips of a signal in noise of a known spectrum.

    Parameters
    ----------
    signal : ndarray, shape (samples,)
        Evenly spaced, of zero mean.
    spectrum : ndarray
        From `noise_spectra`.
    sample_interval : float
        Time between samples. [s]

    Returns
    -------
    SlipChain
        Without bursts where no chain of four slips is found.

    Notes
    -----
    A slip is a sudden fall between two slow rises of half a period. With the Fourier transforms Y of the signal and H
    of the template and the spectrum S of the noise, its matched filter responds in standard deviations by

    .. math:: z(t) = \frac{\mathcal{F}^{-1}[Y H^* / S]}{\sqrt{\sum |H|^2 / S}} .

    A chain of slips, with gaps of 0.6 to 1.6 periods, scores :math:`\sum (z^2/2 - c)`, found by dynamic programming,
    for periods from six samples to a quarter of the signal, and last for the median gap. What is symmetric in time
    (Gaussian noise of any colour, wobble, hum) scores equally for rises, :math:`-z`; their largest response in a median
    period gives the cost c, and their score is deducted. Of periods that score enough, the one whose sawtooth explains
    most of the signal counts: stick-slip that fills a long signal is part of its own noise, and wrong periods score
    too. Where nothing is found, S is taken as flat, for clear stick-slip.

    References
    ----------
    .. [1] G. L. Turin, IRE Trans. Inf. Theory 6, 311 (1960). doi:10.1109/TIT.1960.1057571
    """
    periods = _periods(signal.size, sample_interval)
    if not periods:
        return SlipChain()
    flat = np.full(spectrum.size, np.median(spectrum[spectrum.size // 2 :]))
    best = _best_of_periods(signal, spectrum, periods)
    if best.bursts:
        return best
    clear = _best_of_periods(signal, flat, periods)
    slips = sum(burst.size for burst in clear.bursts)
    span = sum(int(burst[-1] - burst[0]) for burst in clear.bursts)
    return clear if span >= _FILLED * signal.size and clear.score >= _CLEAR_GAIN * slips else best


def _best_of_periods(signal: Floats, spectrum: Floats, periods: Sequence[int]) -> SlipChain:
    """Chains whose sawtooth holds the most power, and then those of the template for their median gap."""
    best, most = SlipChain(), 0.0
    size = 1 << int(np.ceil(np.log2(signal.size + 2 * periods[-1])))
    weight = 1 / np.interp(np.fft.rfftfreq(size), np.linspace(0, 0.5, spectrum.size), spectrum)
    weighted = np.fft.rfft(signal, size) * weight
    for period in periods:
        chain = _chain_of_period(weighted, weight, signal.size, size, period)
        power = _sawtooth_power(signal, chain.bursts)
        if power > most or (most == 0 and chain.score > best.score):
            best, most = chain, power
    if not best.bursts:
        return best
    gap = round(float(np.median(np.concatenate([np.diff(burst) for burst in best.bursts]))))
    matched = _chain_of_period(weighted, weight, signal.size, size, min(max(gap, periods[0]), periods[-1]))
    return matched if matched.bursts else best


def _sawtooth_power(signal: Floats, bursts: Sequence[Indices]) -> float:
    """Sum of squares that a sawtooth rising between the slips explains; 0 where the force does not rise."""
    if not bursts:
        return 0.0
    product, square = 0.0, 0.0
    for burst in bursts:
        gaps = np.repeat(np.diff(burst), np.diff(burst))
        rise = (np.arange(burst[0], burst[-1]) + 0.5 - np.repeat(burst[:-1], np.diff(burst))) / gaps - 0.5
        product += float(rise @ signal[burst[0] : burst[-1]])
        square += float(rise @ rise)
    return product**2 / square if product > 0 else 0.0


def _periods(samples: int, interval: float) -> list[int]:
    """Periods of the templates, in samples, from the shortest resolved to a quarter of the signal."""
    shortest = max(_SHORTEST_SAMPLES, round(_SHORTEST_PERIOD / interval))
    longest = min(samples / 4, _LONGEST_PERIOD / interval)
    if longest < shortest:
        return []
    count = int(np.log(longest / shortest) / np.log(_SCALE_RATIO)) + 1
    return [round(shortest * _SCALE_RATIO**k) for k in range(count)]


def _chain_of_period(weighted: Floats, weight: Floats, samples: int, size: int, period: int) -> SlipChain:
    """Chains of slips by the template of one period, and their score above that of rises."""
    half = max(2, period // 2)
    position = np.arange(-half, half) + 0.5
    shape = np.fft.rfft(np.where(position < 0, position + half, position - half) / (2 * half), size)
    power = np.abs(shape) ** 2 * weight
    variance = (2 * power.sum() - power[0] - power[-1]) / size
    response = np.fft.irfft(weighted * np.conj(shape), size)[: samples - 2 * half] / np.sqrt(variance)
    strongest = np.sort(np.abs(response[1:-1][_maxima(np.abs(response))]))[-_FEWEST:]
    response *= min(1.0, _LARGEST_RESPONSE / max(float(strongest[0]), 1.0)) if strongest.size else 1.0
    periods = response.size // period
    if periods < _FEWEST - 1:
        return SlipChain()
    largest_rise = float(np.median(-response[: periods * period].reshape(periods, period).min(axis=1)))
    rise = max(largest_rise, _MIN_RESPONSE) ** 2
    cost = rise / 2 + max(_EVENT_COST, rise / _RISE_SPREAD)
    score, chain = _best_chain(response, period, cost)
    if chain.size < _FEWEST:
        return SlipChain()
    rises = _best_chain(-response, period, cost)[0]
    excess = min(score - rises, 2 * (score - _RISE_RATIO * rises))
    if excess < DETECTION_SCORE:
        return SlipChain(score=max(0.0, excess))
    return SlipChain(bursts=_bursts(response, period, cost, chain, half), score=excess)


def _bursts(response: Floats, period: int, cost: float, first: Indices, half: int) -> tuple[Indices, ...]:
    """Best chain and the further ones that would be detected beside it, in order of time."""
    remaining, chains, chain = response.copy(), [], first
    score = DETECTION_SCORE
    while chain.size >= _FEWEST and score >= DETECTION_SCORE:
        strong = np.flatnonzero(response[chain] >= _WEAKEST * np.median(response[chain]))
        chains.append(chain[strong[0] : strong[-1] + 1] + half)
        remaining[max(0, chain[0] - period // 2) : chain[-1] + period // 2 + 1] = 0.0
        score, chain = _best_chain(remaining, period, cost)
    return tuple(sorted(chains, key=lambda indices: int(indices[0])))


def _maxima(response: Floats) -> NDArray[np.bool_]:
    """Which values but the first and last are local maxima."""
    inner = response[1:-1]
    return (inner >= response[:-2]) & (inner > response[2:])


def _best_chain(response: Floats, period: int, cost: float) -> tuple[float, Indices]:
    """Score and the indices of the chain of maxima with the highest score."""
    maxima = np.flatnonzero(_maxima(response) & (response[1:-1] > _MIN_RESPONSE)) + 1
    if not maxima.size:
        return 0.0, maxima
    gain = (np.minimum(response[maxima], _LARGEST_RESPONSE) ** 2 / 2 - cost).tolist()
    earliest = np.searchsorted(maxima, maxima - _GAPS[1] * period).tolist()
    latest = np.searchsorted(maxima, maxima - _GAPS[0] * period, side="right").tolist()
    score, before = [0.0] * maxima.size, [-1] * maxima.size
    for i, own in enumerate(gain):
        best = 0.0
        for j in range(earliest[i], latest[i]):
            if score[j] > best:
                best, before[i] = score[j], j
        score[i] = best + own
    last = int(np.argmax(score))
    chain, at = [], last
    while at >= 0:
        chain.append(at)
        at = before[at]
    return score[last], maxima[chain[::-1]]
