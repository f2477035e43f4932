"""Frequency and amplitude of stick-slip in a friction force signal, by its force drops and its spectrum."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.signal import detrend, find_peaks
from scipy.signal.windows import hann

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput
from sonolube.measurement.time_series import require_time_series, uniform_sample_interval

_FEWEST_DROPS = 3
_FREQUENCY_TOLERANCE = 0.2  # relative difference of event rate and spectral peak
_PADDING = 4  # zero padding of the spectrum, in lengths of the signal


@dataclass(frozen=True, kw_only=True, slots=True)
class StickSlipEstimate:
    """Frequency and amplitude of stick-slip, by force drops and spectrum.

    Parameters
    ----------
    detected : bool
        Whether force drops recur and the spectral peak agrees with their rate.
    reason : str
        Why stick-slip was not detected; empty where it was.
    stick_slip_frequency : float
        Force drops per time, or the frequency of the spectral peak where there are no drops. [Hz]
    spectral_frequency : float
        Frequency of the highest peak of the spectrum, in Hz.
    stick_slip_amplitude : float
        Mean force drop from the end of a stick phase to the end of the slip; 0 without drops. [N]
    stick_slip_amplitude_uncertainty : float
        Its standard error; 0 with fewer than two drops. [N]
    force_drops : int
        Number of force drops.
    """

    detected: bool
    reason: str
    stick_slip_frequency: float
    spectral_frequency: float
    stick_slip_amplitude: float
    stick_slip_amplitude_uncertainty: float
    force_drops: int


def estimate_stick_slip(
    *, time: ArrayLike, friction_force: ArrayLike, minimum_drop: float | None = None
) -> StickSlipEstimate:
    """Return frequency and amplitude of stick-slip by peak detection and the Hann-windowed spectrum.

    Parameters
    ----------
    time : array_like, shape (samples,)
        Evenly spaced. [s]
    friction_force : array_like, shape (samples,)
        Without missing values. [N]
    minimum_drop : float or None
        Smallest force drop, in N, that counts as a slip; half the range from the 5th to the 95th percentile without it.

    Returns
    -------
    StickSlipEstimate

    Raises
    ------
    InvalidInput
        If the time has gaps, a value is missing, there are fewer than 16 samples, or `minimum_drop` is not positive.

    Notes
    -----
    A slip begins at a maximum whose prominence is at least `minimum_drop`; its drop is that to the lowest value before
    the next such maximum. The spectrum is that of the detrended force under a Hann window, its peak refined by a
    parabola through the logarithms. Half the sampling rate bounds both: D's 400 Hz resolve its 100 Hz by four samples,
    and a drop by no better than that.

    References
    ----------
    .. [1] D 2.3.2 to 2.3.4, figure 2.17.
    """
    t, f = require_time_series(time=time, friction_force=friction_force)
    missing = int(np.isnan(f).sum())
    if missing or t.size < 16:
        fault = f"misses {missing} values" if missing else f"has {t.size} samples"
        raise InvalidInput(f"friction_force {fault}; stick-slip needs at least 16 consecutive samples without a gap")
    interval = uniform_sample_interval(time=t)
    if minimum_drop is not None:
        require_positive(minimum_drop=minimum_drop)
    low, high = np.percentile(f, [5, 95])
    threshold = minimum_drop if minimum_drop is not None else 0.5 * float(high - low)
    spectral_frequency = _spectral_peak_frequency(f, interval)
    if not threshold > 1e-12 * float(np.max(np.abs(f))):
        return _not_detected("the friction is constant", 0.0)
    peaks = find_peaks(f, prominence=threshold)[0]
    if peaks.size < _FEWEST_DROPS:
        return _not_detected(f"{peaks.size} force drops of at least {threshold:.3g} N", spectral_frequency)
    drops = f[peaks[:-1]] - np.minimum.reduceat(f, peaks)[:-1]
    rate = float((peaks.size - 1) / (t[peaks[-1]] - t[peaks[0]]))
    agrees = abs(rate - spectral_frequency) <= _FREQUENCY_TOLERANCE * rate
    disagreement = f"force drops recur at {rate:.3g} Hz, but the spectrum peaks at {spectral_frequency:.3g} Hz"
    return StickSlipEstimate(
        detected=bool(agrees),
        reason="" if agrees else disagreement,
        stick_slip_frequency=rate,
        spectral_frequency=spectral_frequency,
        stick_slip_amplitude=float(np.mean(drops)),
        stick_slip_amplitude_uncertainty=float(np.std(drops, ddof=1) / np.sqrt(drops.size)),
        force_drops=int(peaks.size),
    )


def _not_detected(reason: str, spectral_frequency: float) -> StickSlipEstimate:
    """Return the estimate for a signal without recurring force drops."""
    return StickSlipEstimate(
        detected=False,
        reason=reason,
        stick_slip_frequency=spectral_frequency,
        spectral_frequency=spectral_frequency,
        stick_slip_amplitude=0.0,
        stick_slip_amplitude_uncertainty=0.0,
        force_drops=0,
    )


def _spectral_peak_frequency(f: Floats, interval: float) -> float:
    """Return the frequency of the highest spectral peak, refined by a parabola through logarithms, in Hz."""
    size = _PADDING * f.size
    power = np.abs(np.fft.rfft(detrend(f) * hann(f.size, sym=False), size)) ** 2
    first = 2 * _PADDING  # below this bin lies the main lobe of the window
    peak = first + int(np.argmax(power[first:]))
    shift = 0.0
    if 0 < peak < power.size - 1 and power[peak - 1 : peak + 2].min() > 0:
        below, at, above = np.log(power[peak - 1 : peak + 2])
        shift = 0.5 * (below - above) / (below - 2 * at + above) if below - 2 * at + above else 0.0
    return float((peak + shift) / (size * interval))
