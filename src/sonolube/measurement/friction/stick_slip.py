"""Stick-slip in a friction force signal: recurring slips, the fall of the force in a slip, and when it happens."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike
from scipy.signal import detrend
from scipy.signal.windows import hann
from scipy.stats import t as student

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput
from sonolube.measurement.friction.force_cycle import (
    MIN_SAMPLES_OF_CYCLE,
    SHARE_OF_VARIANCE,
    ForceCycle,
    StickSlipBurst,
    StickSlipEstimate,
    combined,
    find_cycle,
    not_detected,
)
from sonolube.measurement.friction.slip_events import DETECTION_SCORE, Indices, SlipChain, find_slips, noise_spectra
from sonolube.measurement.statistics.autocorrelation import correlated_mean
from sonolube.measurement.time_series import changes_rate, even_stretches, evenly_sampled, require_time_series

_MIN_SAMPLES = 64
_MIN_SLIPS = 3
_LINE = 0.03  # of its frequency, about a line that comes and goes
_PADDING = 4  # zero padding of the spectrum, in lengths of the signal
_SLOW_FALL = 0.2  # of the period, from which a cycle has no sawtooth's ramps
_FEW_SAMPLES = 16  # of a period, below which slips cannot be told from the ramps
_SAME_FREQUENCY = 0.1  # relative deviation of the frequencies of slips and cycle
_CLEAR = 8.0  # falls over the noise from which the duration of a slip is measured
_HALF = 0.5  # of the median fall, from which a slip at the end of a burst is one
_TIMING = 20  # of a gap, over which a slip may be moved to where the force falls
_OVERSHOOT = 0.8  # of the fall below its middle
_PROFILE = 0.25  # of a period, before and after a slip


def estimate_stick_slip(
    *, time: ArrayLike, friction_force: ArrayLike, minimum_drop: float | None = None
) -> StickSlipEstimate:
    r"""Whether a friction force shows stick-slip, its frequency, the mean fall of the force, and its bursts.

    Parameters
    ----------
    time : array_like, shape (samples,)
        Increasing; it is cut at gaps, and a clock that jitters is made even. [s]
    friction_force : array_like, shape (samples,)
        Cut where values are missing. [N]
    minimum_drop : float or None
        Smallest mean fall, in N, that counts as stick-slip.

    Returns
    -------
    StickSlipEstimate

    Raises
    ------
    InvalidInput
        If no 64 consecutive samples are even and known, or `minimum_drop` is not positive.

    See Also
    --------
    stick_slip_of_parts : of the steps of one recording.

    Notes
    -----
    Slips are found by `find_slips`: a matched filter, which at a standard deviation of the noise of half the fall
    detects ten slips of fifty samples a period. The fall is the mean rise of the force over the stick phases between
    slips: the slope of a line fitted with weights :math:`(1 - x^2)^2` that vanish at the slips, times the duration. A
    difference of maximum and minimum would add the range of the noise; the weights leave out the ringing of the sensor.
    The interval is Student's of the mean over the stick phases, with the covariance of neighbours, which share a slip,
    and to either side what the force rises in one sample; it reaches down to the range of the mean cycle.

    Near the natural frequency of the holder a slip takes as long as the stick. Such a steady cycle is found by
    `find_cycle`; its fall is the range of the fitted cycle, its interval at least that of one sample.
    No fall, and no end of its interval, exceeds the range of the force.

    A period of fewer than six samples does not show its shape: where such a line holds half of the variance, the
    estimate says that stick-slip cannot be seen at this rate. D's 400 Hz give its 100 Hz four samples.

    References
    ----------
    .. [1] D 2.3.2 to 2.3.4, figure 2.17.

    Examples
    --------
    >>> import numpy as np
    >>> from sonolube.measurement import estimate_stick_slip
    >>> time = np.arange(0, 10, 1e-3)
    >>> found = estimate_stick_slip(time=time, friction_force=1.0 + 0.2 * (2.0 * time % 1.0))
    >>> round(found.stick_slip_frequency, 3), round(found.stick_slip_amplitude, 2)
    (2.0, 0.2)
    """
    t, f = require_time_series(time=time, friction_force=friction_force)
    if minimum_drop is not None:
        require_positive(minimum_drop=minimum_drop)
    known = np.isfinite(f)
    if changes_rate(time=t):
        raise InvalidInput(
            "the samples are not evenly spaced in time, which stick-slip needs; measure a part of one rate"
        )
    return stick_slip_of_parts([t[known]], [f[known]], minimum_drop=minimum_drop or 0.0)[0]


def stick_slip_of_parts(
    times: Sequence[Floats], forces: Sequence[Floats], *, minimum_drop: float = 0.0
) -> list[StickSlipEstimate]:
    """Stick-slip of each part of a recording, the noise being known from all of them.

    Parameters
    ----------
    times : sequence of ndarray
        Of the samples of each part, in s; cut into stretches without a gap.
    forces : sequence of ndarray
        Friction force in each part, without missing values and wobble, in N.
    minimum_drop : float
        Smallest mean fall that counts, in N.

    Returns
    -------
    list of StickSlipEstimate
        A part without 64 even samples has a reason.

    Raises
    ------
    InvalidInput
        If no part has 64 samples without a gap.

    See Also
    --------
    noise_spectra : the noise that is common to the parts.
    """
    found = [even_stretches(time=t, fewest=_MIN_SAMPLES) for t in times]
    intervals = [interval for interval, stretches in found if stretches]
    if not intervals:
        longest = max(t.size for t in times)
        raise InvalidInput(
            f"friction_force has {longest} samples without an even stretch of {_MIN_SAMPLES}; stick-slip needs one"
        )
    interval = float(np.median(intervals))
    pieces = [
        (part, evenly_sampled(time=times[part][each], signal=forces[part][each], sample_interval=interval))
        for part, (_, stretches) in enumerate(found)
        for each in stretches
    ]
    signals = [np.asarray(detrend(force)) for _, (_, force) in pieces]
    spectra = noise_spectra(signals, sample_interval=interval)
    estimates: list[list[StickSlipEstimate]] = [[] for _ in times]
    spans: list[list[float]] = [[] for _ in times]
    for (part, (t, force)), signal, spectrum in zip(pieces, signals, spectra, strict=True):
        spans[part].append(float(t[-1] - t[0]))
        if np.std(signal) > 1e-12 * float(np.max(np.abs(force))):
            estimates[part].append(_estimate(t, force, signal, spectrum, interval, minimum_drop))
        else:
            estimates[part].append(not_detected("the friction is constant", 0.0))
    return [combined(own, span) for own, span in zip(estimates, spans, strict=True)]


def _estimate(
    t: Floats, force: Floats, signal: Floats, spectrum: Floats, interval: float, minimum: float
) -> StickSlipEstimate:
    """Stick-slip of one stretch by its slips, or by its steady cycle where these have no ramps."""
    frequency, share = _spectral_peak(signal, interval)
    fastest = 1 / (MIN_SAMPLES_OF_CYCLE * interval)
    if frequency > fastest and share > SHARE_OF_VARIANCE:
        reason = (
            f"it cannot be seen at this rate: the force swings at {frequency:.3g} Hz, {1 / (frequency * interval):.2g} "
            f"samples a period; sample at {2 * MIN_SAMPLES_OF_CYCLE * frequency:.2g} Hz or more"
        )
        return not_detected(reason, frequency, resolved=False)
    cycle, other = find_cycle(signal, sample_interval=interval, frequency=frequency)
    chain = find_slips(signal, spectrum=spectrum, sample_interval=interval)
    if cycle is not None and _is_smooth(cycle, interval):
        found = _by_cycle(t, force, cycle, frequency)
    elif cycle is not None and not _has_frequency(chain, cycle.frequency * interval):
        found = _by_slips(t, force, [cycle.slips], frequency)
    elif chain.bursts and not other:
        found = _by_slips(t, force, chain.bursts, frequency)
    else:
        recur = f"falls of the force recur no more than noise explains (score {chain.score:.3g} of {DETECTION_SCORE:g})"
        reason = f"{other or recur}; the spectrum peaks at {frequency:.3g} Hz; sought up to {fastest:.3g} Hz"
        return not_detected(reason, frequency)
    if found.force_drops < _MIN_SLIPS:
        return not_detected(f"{found.force_drops} falls of the force are too few to recur", frequency)
    if not found.stick_slip_amplitude > max(minimum, found.stick_slip_amplitude_uncertainty):
        return not_detected(f"the force falls by {found.stick_slip_amplitude:.3g} N only", frequency)
    return found


def _is_smooth(cycle: ForceCycle, interval: float) -> bool:
    """Whether a cycle falls too slowly, or has too few samples, for the ramps of a sawtooth."""
    return cycle.fall_share > _SLOW_FALL or cycle.frequency * interval * _FEW_SAMPLES > 1


def _has_frequency(chain: SlipChain, frequency: float) -> bool:
    """Whether the slips of a chain recur at a frequency, in periods a sample."""
    if not chain.bursts:
        return False
    gaps = np.concatenate([np.diff(burst) for burst in chain.bursts])
    return abs(float(np.mean(gaps)) * frequency - 1) < _SAME_FREQUENCY


def _by_slips(t: Floats, signal: Floats, bursts: Sequence[Indices], spectral: float) -> StickSlipEstimate:
    """Estimate from the slips of all bursts."""
    falls, noise = _falls(signal, bursts)
    if noise * _CLEAR < np.median(falls):
        bursts = [_without_false_ends(signal, burst, _HALF * float(np.median(falls))) for burst in bursts]
        bursts = [_at_steepest(signal, burst) for burst in bursts]
        falls, noise = _falls(signal, bursts)
    gaps = np.concatenate([np.diff(burst) for burst in bursts])
    if noise * _CLEAR < np.mean(falls):
        falls = falls * (1 - _slip_duration(signal, bursts, float(np.mean(falls))) / gaps)
    interval = float(t[-1] - t[0]) / (t.size - 1)
    period = float(np.mean(gaps)) * interval
    highest = np.array([float(np.ptp(signal[a:b])) for burst in bursts for a, b in pairwise(burst)])
    mean, error = float(min(np.mean(falls), np.mean(highest))), _standard_error(falls)
    reach = float(student.ppf(0.975, max(falls.size - 1, 1))) * error + mean / float(np.mean(gaps))
    cycle = _mean_profile(signal, bursts, 0.5)  # whose range is below the rise of the ramps where slips are not sudden
    smooth = mean - float(np.ptp(cycle)) if cycle.size and noise * _CLEAR < mean else 0.0
    ends = _within_range(mean - max(smooth, 0.0), reach, signal)[0], _within_range(mean, reach, signal)[1]
    spans = tuple(
        StickSlipBurst(
            start_time=float(max(t[0], t[burst[0]] - (t[burst[-1]] - t[burst[0]]) / (burst.size - 1))),
            end_time=float(t[burst[-1]]),
            force_drops=int(burst.size),
        )
        for burst in bursts
    )
    return StickSlipEstimate(
        stick_slip_frequency=1 / period,
        spectral_frequency=spectral,
        stick_slip_amplitude=mean,
        stick_slip_amplitude_uncertainty=error,
        stick_slip_amplitude_interval=ends,
        force_drops=sum(burst.size for burst in bursts),
        stick_slip_fraction=float(min(1.0, sum(s.end_time - s.start_time for s in spans) / (t[-1] - t[0]))),
        bursts=spans,
        slip_time=t[np.concatenate(bursts)] - interval / 2,
    )


def _falls(signal: Floats, bursts: Sequence[Indices]) -> tuple[Floats, float]:
    """Rise over each stick phase between slips, and the standard deviation of the noise about the lines."""
    rises, squares, count = [], 0.0, 0
    for burst in bursts:
        for first, last in pairwise(burst):
            part = signal[first:last]
            x = (2 * np.arange(part.size) + 1) / part.size - 1
            weight = (1 - x**2) ** 2
            slope = float((weight * x) @ part / ((weight * x) @ x))
            rises.append(2 * slope)
            residual = part - slope * x - np.average(part, weights=weight)
            inner = residual[np.abs(x) < 0.5]
            squares, count = squares + float(inner @ inner), count + inner.size
    return np.array(rises), float(np.sqrt(squares / max(count, 1)))


def _without_false_ends(signal: Floats, burst: Indices, least: float) -> Indices:
    """Burst without slips at its ends whose stick phase rises too little, such as the ringing of the last."""
    enough = np.flatnonzero(_falls(signal, [burst])[0] >= least)
    return burst[enough[0] : enough[-1] + 2] if enough.size > 1 else burst


def _at_steepest(signal: Floats, burst: Indices) -> Indices:
    """Slips of a burst moved to the middle of the fall between the lines before and after it."""
    gap = int(np.median(np.diff(burst)))
    reach, half = max(2, gap // _TIMING), gap // 4
    position = np.arange(-half, half) + 0.5
    shape = np.sign(-position) / 2 + position / gap
    moved = burst.copy()
    for number, slip in enumerate(burst):
        if reach + half <= slip <= signal.size - reach - half:
            match = np.correlate(signal[slip - reach - half : slip + reach + half] - signal[slip], shape, "valid")
            moved[number] = slip - reach + int(np.argmax(match))
    return moved


def _standard_error(falls: Floats) -> float:
    """Standard error of the mean of rises, of which neighbours share the slip between them."""
    if falls.size < 2:
        return float("inf")
    residual = falls - falls.mean()
    variance = float(residual @ residual) / (falls.size - 1)
    shared = float(residual[:-1] @ residual[1:]) / (falls.size - 1) + variance / falls.size
    return float(np.sqrt((variance + 2 * max(shared, 0.0)) / falls.size))


def _mean_profile(signal: Floats, bursts: Sequence[Indices], share: float) -> Floats:
    """Mean of the force about the slips, a share of their median gap before and after; empty where none fits in."""
    half = int(max(2, share * np.median(np.concatenate([np.diff(burst) for burst in bursts]))))
    slips = np.concatenate(bursts)
    slips = slips[(slips >= half) & (slips <= signal.size - half)]
    return np.mean(signal[slips[:, None] + np.arange(-half, half)], axis=0) if slips.size else np.empty(0)


def _slip_duration(signal: Floats, bursts: Sequence[Indices], fall: float) -> float:
    """Mean duration of a slip in samples, 0 for a fall between two samples, by the mean profile of slips."""
    profile = _mean_profile(signal, bursts, _PROFILE)
    if not profile.size:
        return 0.0
    reach = profile.size // 2
    middle = (np.median(profile[: reach // 2]) + np.median(profile[-(reach // 2) :])) / 2
    relative = (profile - middle) / fall
    if relative.min() < -_OVERSHOOT:  # of a sensor that rings, whose reading takes longer than the slip
        return 0.0
    below = np.flatnonzero(relative < -0.3)
    end = int(below[0]) if below.size else reach
    above = np.flatnonzero(relative[:end] > 0.3)
    start = int(above[-1]) if above.size else end - 1
    if end - start < 2:
        return 0.0
    upper, lower = relative[start : start + 2], relative[end - 1 : end + 1]
    begins = start + (upper[0] - 0.3) / (upper[0] - upper[1])
    ends = end - 1 + (lower[0] + 0.3) / (lower[0] - lower[1])
    return float((ends - begins) / 0.6)


def _by_cycle(t: Floats, force: Floats, cycle: ForceCycle, spectral: float) -> StickSlipEstimate:
    """Estimate by a steady cycle without ramps: its range in each section."""
    mean = float(min(np.mean(cycle.falls), np.ptp(force)))
    spread = correlated_mean(cycle.falls)
    resolution = max(cycle.truncation, mean * cycle.frequency * float(t[-1] - t[0]) / (t.size - 1))
    reach = float(student.ppf(0.975, max(spread.effective_samples - 1, 1))) * spread.uncertainty + resolution
    breaks = np.flatnonzero(np.diff(cycle.sections[:, 0]) > cycle.sections[0, 1] - cycle.sections[0, 0] + 1) + 1
    bursts = tuple(
        StickSlipBurst(
            start_time=float(t[part[0, 0]]),
            end_time=float(t[part[-1, 1]]),
            force_drops=round(float(t[part[-1, 1]] - t[part[0, 0]]) * cycle.frequency),
        )
        for part in np.split(cycle.sections, breaks)
    )
    return StickSlipEstimate(
        stick_slip_frequency=cycle.frequency,
        spectral_frequency=spectral,
        stick_slip_amplitude=mean,
        stick_slip_amplitude_uncertainty=spread.uncertainty,
        stick_slip_amplitude_interval=_within_range(mean, reach, force),
        force_drops=sum(burst.force_drops for burst in bursts),
        stick_slip_fraction=min(1.0, sum(b.end_time - b.start_time for b in bursts) / float(t[-1] - t[0])),
        bursts=bursts,
    )


def _within_range(mean: float, reach: float, signal: Floats) -> tuple[float, float]:
    """Interval about a fall, which neither rises nor exceeds the range of the force."""
    return max(0.0, mean - reach), min(mean + reach, float(np.ptp(signal)))


def _spectral_peak(f: Floats, interval: float) -> tuple[float, float]:
    """Frequency, in Hz, and share of the power of the highest local maximum of the spectrum, refined."""
    size = _PADDING * f.size
    power = np.abs(np.fft.rfft(f * hann(f.size, sym=False), size)) ** 2
    first = 2 * _PADDING  # below this bin lies the main lobe of the window
    inner = power[first:-1]
    peaks = np.flatnonzero((inner > power[first - 1 : -2]) & (inner >= power[first + 1 :])) + first
    if not peaks.size:
        return float((first + np.argmax(power[first:])) / (size * interval)), 0.0
    peak = int(peaks[np.argmax(power[peaks])])
    reach = max(first, round(_LINE * peak))
    share = float(power[max(0, peak - reach) : peak + reach + 1].sum() / power.sum())
    below, at, above = np.log(np.maximum(power[peak - 1 : peak + 2], 1e-300))
    curvature = below - 2 * at + above
    shift = float(np.clip(0.5 * (below - above) / curvature, -0.5, 0.5)) if curvature else 0.0
    return float((peak + shift) / (size * interval)), share
