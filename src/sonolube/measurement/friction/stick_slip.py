"""Stick-slip in a recorded friction force: how often and how far it falls."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.signal import detrend, find_peaks
from scipy.signal.windows import hann

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput
from sonolube.measurement.time_series import require_time_series, uniform_sample_interval

_FEWEST = 3  # events
_AGREEMENT = 0.2
_PADDING = 4


@dataclass(frozen=True, kw_only=True, slots=True)
class StickSlipEstimate:
    """Stick-slip as its events and its spectrum show it.

    Parameters
    ----------
    detected : bool
        Whether events recur and the spectrum agrees with them.
    reason : str
        Why not; empty when found.
    stick_slip_frequency : float
        Events per time, or of the highest peak of the spectrum where there are no events. [Hz]
    spectral_frequency : float
        Frequency of the highest peak of the spectrum, in Hz.
    stick_slip_amplitude : float
        Mean fall of friction from the end of a stick to the end of the slip; 0 without events. [N]
    stick_slip_amplitude_uncertainty : float
        Its standard error; 0 with fewer than two events. [N]
    events : int
        Slips seen.
    """

    detected: bool
    reason: str
    stick_slip_frequency: float
    spectral_frequency: float
    stick_slip_amplitude: float
    stick_slip_amplitude_uncertainty: float
    events: int


def estimate_stick_slip(
    *, time: ArrayLike, friction_force: ArrayLike, least_fall: float | None = None
) -> StickSlipEstimate:
    """Return frequency and amplitude of stick-slip.

    Parameters
    ----------
    time : array_like, shape (samples,)
        Evenly spaced. [s]
    friction_force : array_like, shape (samples,)
        Without missing values. [N]
    least_fall : float or None
        The least fall, in N, that is a slip; half the range from the 5th to the 95th percentile without it.

    Returns
    -------
    StickSlipEstimate

    Raises
    ------
    InvalidInput
        If the time has gaps, a value is missing, there are fewer than 16 samples, or `least_fall` is not positive.

    Notes
    -----
    An event is a maximum that stands out of its surroundings by `least_fall`; its fall is that to the lowest value
    before the next event. The spectrum is that of the force without its trend, under a Hann window, its peak refined
    by a parabola through the logarithms. Half the sampling rate bounds both: D's 400 Hz resolve its 100 Hz by four
    samples, and a fall by no better than that.

    References
    ----------
    .. [1] D 2.3.2 to 2.3.4, figure 2.17.
    """
    t, f = require_time_series(time=time, friction_force=friction_force)
    missing = int(np.isnan(f).sum())
    if missing or t.size < 16:
        what = f"misses {missing} values" if missing else f"has {t.size} samples"
        raise InvalidInput(f"friction_force {what}; stick-slip needs a stretch of at least 16 without a gap")
    interval = uniform_sample_interval(time=t)
    if least_fall is not None:
        require_positive(least_fall=least_fall)
    low, high = np.percentile(f, [5, 95])
    fall = least_fall if least_fall is not None else 0.5 * float(high - low)
    spectral = _spectral_peak(f, interval)
    if not fall > 1e-12 * float(np.max(np.abs(f))):
        return _nothing("the friction is constant", 0.0)
    peaks = find_peaks(f, prominence=fall)[0]
    if peaks.size < _FEWEST:
        return _nothing(f"{peaks.size} falls of at least {fall:.3g} N", spectral)
    falls = f[peaks[:-1]] - np.minimum.reduceat(f, peaks)[:-1]
    rate = float((peaks.size - 1) / (t[peaks[-1]] - t[peaks[0]]))
    agrees = abs(rate - spectral) <= _AGREEMENT * rate
    return StickSlipEstimate(
        detected=bool(agrees),
        reason="" if agrees else f"events recur at {rate:.3g} Hz, but the spectrum is highest at {spectral:.3g} Hz",
        stick_slip_frequency=rate,
        spectral_frequency=spectral,
        stick_slip_amplitude=float(np.mean(falls)),
        stick_slip_amplitude_uncertainty=float(np.std(falls, ddof=1) / np.sqrt(falls.size)),
        events=int(peaks.size),
    )


def _nothing(reason: str, spectral: float) -> StickSlipEstimate:
    return StickSlipEstimate(
        detected=False,
        reason=reason,
        stick_slip_frequency=spectral,
        spectral_frequency=spectral,
        stick_slip_amplitude=0.0,
        stick_slip_amplitude_uncertainty=0.0,
        events=0,
    )


def _spectral_peak(f: Floats, interval: float) -> float:
    size = _PADDING * f.size
    power = np.abs(np.fft.rfft(detrend(f) * hann(f.size, sym=False), size)) ** 2
    first = 2 * _PADDING  # below it the window's own width hides everything
    peak = first + int(np.argmax(power[first:]))
    shift = 0.0
    if 0 < peak < power.size - 1 and power[peak - 1 : peak + 2].min() > 0:
        below, at, above = np.log(power[peak - 1 : peak + 2])
        shift = 0.5 * (below - above) / (below - 2 * at + above) if below - 2 * at + above else 0.0
    return float((peak + shift) / (size * interval))
