"""Stick-slip in a friction force signal: recurring slips, the fall of the force in a slip, and when it happens."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike
from scipy.signal import detrend
from scipy.signal.windows import hann
from scipy.stats import t as student

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput
from sonolube.measurement.friction.slip_events import DETECTION_SCORE, Indices, find_slips, noise_spectra
from sonolube.measurement.time_series import require_time_series, uniform_sample_interval

_FEWEST_SAMPLES = 64
_PADDING = 4  # zero padding of the spectrum, in lengths of the signal
_UNRESOLVED = 1 / 8  # of the sampling rate, above which a period has too few samples to show a sawtooth
_LINE_SHARE = 0.5  # of the variance, in a spectral line of unresolved stick-slip
_CLEAR = 8.0  # falls over the noise from which the duration of a slip is measured
_HALF = 0.5  # of the median fall, from which a slip at the end of a burst is one
_TIMING = 20  # of a gap, over which a slip may be moved to where the force falls
_OVERSHOOT = 0.8  # of the fall below its middle
_PROFILE = 0.25  # of a period, before and after a slip


@dataclass(frozen=True, kw_only=True, slots=True)
class StickSlipBurst:
    """Time in which slips recur without interruption.

    Parameters
    ----------
    start_time : float
        Beginning of the stick phase before the first slip. [s]
    end_time : float
        Last slip. [s]
    force_drops : int
        Number of slips.
    """

    start_time: float
    end_time: float
    force_drops: int


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class StickSlipEstimate:
    """Stick-slip in a friction force: whether, how often, how much the force falls, and when.

    Parameters
    ----------
    detected : bool
        Whether sudden falls of the force recur more strongly than noise explains.
    reason : str
        Why stick-slip was not detected; empty where it was.
    stick_slip_frequency : float
        Slips per time within the bursts; the frequency of the spectral peak where not detected. [Hz]
    spectral_frequency : float
        Frequency of the highest peak of the spectrum, in Hz.
    stick_slip_amplitude : float
        Mean fall of the force in a slip; 0 where not detected. [N]
    stick_slip_amplitude_uncertainty : float
        Its standard error. [N]
    stick_slip_amplitude_interval : tuple of two float
        Its 95 % interval. [N]
    force_drops : int
        Number of slips found.
    stick_slip_fraction : float
        Share of the time in which slips recur. []
    bursts : tuple of StickSlipBurst
        When they do.
    slip_time : ndarray, shape (force_drops,)
        Time of each slip, in s.
    """

    detected: bool
    reason: str
    stick_slip_frequency: float
    spectral_frequency: float
    stick_slip_amplitude: float
    stick_slip_amplitude_uncertainty: float
    stick_slip_amplitude_interval: tuple[float, float]
    force_drops: int
    stick_slip_fraction: float
    bursts: tuple[StickSlipBurst, ...]
    slip_time: Floats


def estimate_stick_slip(
    *, time: ArrayLike, friction_force: ArrayLike, minimum_drop: float | None = None
) -> StickSlipEstimate:
    r"""Return whether a friction force shows stick-slip, its frequency, the mean fall of the force, and its bursts.

    Parameters
    ----------
    time : array_like, shape (samples,)
        Evenly spaced. [s]
    friction_force : array_like, shape (samples,)
        Without missing values. [N]
    minimum_drop : float or None
        Smallest mean fall, in N, that counts as stick-slip.

    Returns
    -------
    StickSlipEstimate

    Raises
    ------
    InvalidInput
        If the time has gaps, a value is missing, there are fewer than 64 samples, or `minimum_drop` is not positive.

    See Also
    --------
    stick_slip_of_parts : of the steps of one recording.

    Notes
    -----
    Slips are found by `find_slips`: a matched filter, which at a standard deviation of the noise of half the fall
    detects ten slips of fifty samples a period. The fall is the mean rise of the force over the stick phases between
    slips: the slope of a line fitted with weights :math:`(1 - x^2)^2` that vanish at the slips, times the duration. A
    difference of maximum and minimum would add the range of the noise; the weights leave out the ringing of the sensor.
    The interval is Student's of the mean over the stick phases, with the covariance of neighbours, which share a slip.

    A period of fewer than eight samples does not show its shape: there a spectral line of half the variance passes for
    stick-slip, its fall being the peak-to-peak value; D's 400 Hz resolve its 100 Hz by no more than four samples.

    References
    ----------
    .. [1] D 2.3.2 to 2.3.4, figure 2.17.
    """
    t, f = require_time_series(time=time, friction_force=friction_force)
    missing = int(np.isnan(f).sum())
    if missing or t.size < _FEWEST_SAMPLES:
        fault = f"misses {missing} values" if missing else f"has {t.size} samples"
        raise InvalidInput(
            f"friction_force {fault}; stick-slip needs at least {_FEWEST_SAMPLES} consecutive samples without a gap"
        )
    if minimum_drop is not None:
        require_positive(minimum_drop=minimum_drop)
    interval = uniform_sample_interval(time=t)
    return stick_slip_of_parts([t], [f], sample_interval=interval, minimum_drop=minimum_drop or 0.0)[0]


def stick_slip_of_parts(
    times: Sequence[Floats], forces: Sequence[Floats], *, sample_interval: float, minimum_drop: float = 0.0
) -> list[StickSlipEstimate]:
    """Return the stick-slip of each part of a recording, the noise being known from all of them.

    Parameters
    ----------
    times : sequence of ndarray
        Of the samples of each part, evenly spaced, at least 64, in s.
    forces : sequence of ndarray
        Friction force in each part, without missing values and wobble, in N.
    sample_interval : float
        Time between samples. [s]
    minimum_drop : float
        Smallest mean fall that counts, in N.

    Returns
    -------
    list of StickSlipEstimate

    Raises
    ------
    InvalidInput
        If a part has fewer than 64 samples.

    See Also
    --------
    noise_spectra : the noise that is common to the parts.
    """
    fewest = min(force.size for force in forces)
    if fewest < _FEWEST_SAMPLES:
        raise InvalidInput(f"friction_force has {fewest} samples; stick-slip needs at least {_FEWEST_SAMPLES}")
    signals = [np.asarray(detrend(force)) for force in forces]
    spectra = noise_spectra(signals, sample_interval=sample_interval)
    estimates = []
    for t, force, signal, spectrum in zip(times, forces, signals, spectra, strict=True):
        if np.std(signal) > 1e-12 * float(np.max(np.abs(force))):
            estimates.append(_estimate(t, force, signal, spectrum, sample_interval, minimum_drop))
        else:
            estimates.append(not_detected("the friction is constant", 0.0))
    return estimates


def _estimate(
    t: Floats, force: Floats, signal: Floats, spectrum: Floats, interval: float, minimum: float
) -> StickSlipEstimate:
    """Return the stick-slip of one part by its slips, or by a line above an eighth of the sampling rate."""
    frequency, share = _spectral_peak(signal, interval)
    chain = find_slips(signal, spectrum=spectrum, sample_interval=interval)
    if chain.bursts:
        found = _by_slips(t, force, chain.bursts, frequency)
    elif frequency * interval > _UNRESOLVED and share > _LINE_SHARE:
        found = _by_line(t, signal, frequency)
    else:
        reason = (
            f"falls of the force recur no more than noise explains (score {chain.score:.3g} of {DETECTION_SCORE:g})"
        )
        return not_detected(f"{reason}; the spectrum peaks at {frequency:.3g} Hz", frequency)
    if not found.stick_slip_amplitude > minimum:
        return not_detected(f"the force falls by {found.stick_slip_amplitude:.3g} N only", frequency)
    return found


def _by_slips(t: Floats, signal: Floats, bursts: Sequence[Indices], spectral: float) -> StickSlipEstimate:
    """Return the estimate from the slips of all bursts."""
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
    mean, error = float(np.mean(falls)), _standard_error(falls)
    reach = float(student.ppf(0.975, falls.size - 1)) * error
    spans = tuple(
        StickSlipBurst(
            start_time=float(max(t[0], t[burst[0]] - (t[burst[-1]] - t[burst[0]]) / (burst.size - 1))),
            end_time=float(t[burst[-1]]),
            force_drops=int(burst.size),
        )
        for burst in bursts
    )
    return StickSlipEstimate(
        detected=True,
        reason="",
        stick_slip_frequency=1 / period,
        spectral_frequency=spectral,
        stick_slip_amplitude=mean,
        stick_slip_amplitude_uncertainty=error,
        stick_slip_amplitude_interval=(mean - reach, mean + reach),
        force_drops=sum(burst.size for burst in bursts),
        stick_slip_fraction=float(min(1.0, sum(s.end_time - s.start_time for s in spans) / (t[-1] - t[0]))),
        bursts=spans,
        slip_time=t[np.concatenate(bursts)] - interval / 2,
    )


def _falls(signal: Floats, bursts: Sequence[Indices]) -> tuple[Floats, float]:
    """Return the rise over each stick phase between slips, and the standard deviation of the noise about the lines."""
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
    """Return a burst without slips at its ends whose stick phase rises too little, such as the ringing of the last."""
    enough = np.flatnonzero(_falls(signal, [burst])[0] >= least)
    return burst[enough[0] : enough[-1] + 2] if enough.size > 1 else burst


def _at_steepest(signal: Floats, burst: Indices) -> Indices:
    """Return the slips of a burst moved to the middle of the fall between the lines before and after it."""
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
    """Return the standard error of the mean of rises, of which neighbours share the slip between them."""
    residual = falls - falls.mean()
    variance = float(residual @ residual) / (falls.size - 1)
    shared = float(residual[:-1] @ residual[1:]) / (falls.size - 1) + variance / falls.size
    return float(np.sqrt((variance + 2 * max(shared, 0.0)) / falls.size))


def _slip_duration(signal: Floats, bursts: Sequence[Indices], fall: float) -> float:
    """Return the mean duration of a slip in samples, 0 for a fall between two samples, by the mean profile of slips."""
    reach = int(max(2, _PROFILE * np.median(np.concatenate([np.diff(burst) for burst in bursts]))))
    slips = np.concatenate(bursts)
    slips = slips[(slips >= reach) & (slips <= signal.size - reach)]
    if not slips.size:
        return 0.0
    profile = np.mean(signal[slips[:, None] + np.arange(-reach, reach)], axis=0)
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


def _by_line(t: Floats, signal: Floats, frequency: float) -> StickSlipEstimate:
    """Return the estimate for stick-slip whose periods have too few samples for a shape: a line of the spectrum."""
    duration = float(t[-1] - t[0])
    angle = 2 * np.pi * frequency * t
    waves = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    coefficients, residual, _, _ = np.linalg.lstsq(waves, signal)
    amplitude = float(np.hypot(*coefficients))
    noise = float(np.sqrt(residual.sum() / max(1, signal.size - 2)))
    error = 2 * noise * float(np.sqrt(2 / signal.size))
    return StickSlipEstimate(
        detected=True,
        reason="",
        stick_slip_frequency=frequency,
        spectral_frequency=frequency,
        stick_slip_amplitude=2 * amplitude,
        stick_slip_amplitude_uncertainty=error,
        stick_slip_amplitude_interval=(2 * amplitude - 1.96 * error, 2 * amplitude + 1.96 * error),
        force_drops=int(duration * frequency),
        stick_slip_fraction=1.0,
        bursts=(StickSlipBurst(start_time=float(t[0]), end_time=float(t[-1]), force_drops=int(duration * frequency)),),
        slip_time=np.empty(0),
    )


def not_detected(reason: str, spectral_frequency: float) -> StickSlipEstimate:
    """Return the estimate for a signal without recurring falls, with the reason and the frequency of its spectrum."""
    return StickSlipEstimate(
        detected=False,
        reason=reason,
        stick_slip_frequency=spectral_frequency,
        spectral_frequency=spectral_frequency,
        stick_slip_amplitude=0.0,
        stick_slip_amplitude_uncertainty=0.0,
        stick_slip_amplitude_interval=(0.0, 0.0),
        force_drops=0,
        stick_slip_fraction=0.0,
        bursts=(),
        slip_time=np.empty(0),
    )


def _spectral_peak(f: Floats, interval: float) -> tuple[float, float]:
    """Return frequency, in Hz, and share of the power of the highest spectral peak, refined by a parabola."""
    size = _PADDING * f.size
    power = np.abs(np.fft.rfft(f * hann(f.size, sym=False), size)) ** 2
    first = 2 * _PADDING  # below this bin lies the main lobe of the window
    peak = first + int(np.argmax(power[first:]))
    share = float(power[max(0, peak - first) : peak + first + 1].sum() / power.sum())
    shift = 0.0
    if 0 < peak < power.size - 1 and power[peak - 1 : peak + 2].min() > 0:
        below, at, above = np.log(power[peak - 1 : peak + 2])
        shift = 0.5 * (below - above) / (below - 2 * at + above) if below - 2 * at + above else 0.0
    return float((peak + shift) / (size * interval)), share
